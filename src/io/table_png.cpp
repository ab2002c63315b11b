#include "src/io/table_image.h"

#include "tetravox/error.h"

#include <png.h>

#include <cerrno>
#include <csetjmp>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <memory>

namespace tetravox::io {
namespace {

void ignore_message(png_structp, png_const_charp) {}
[[noreturn]] void leave_on_error(png_structp png, png_const_charp) { png_longjmp(png, 1); }

struct ReaderDeleter {
  png_infop info = nullptr;
  void operator()(png_struct* png) { png_destroy_read_struct(&png, &info, nullptr); }
};
struct FileCloser {
  void operator()(std::FILE* file) { std::fclose(file); }
};

/// Reads as far as the first pixel; false where libpng gives up. No object with a destructor is made in here.
bool read_head(png_structp png, png_infop info) {
  if (setjmp(png_jmpbuf(png))) return false;
  png_read_info(png, info);
  return true;
}

/// Turns every kind of PNG into 16 bits a channel with alpha; false as above.
bool read_rows(png_structp png, png_infop info, png_bytepp rows, std::size_t row_bytes) {
  if (setjmp(png_jmpbuf(png))) return false;
  png_set_expand_16(png);
  png_set_gray_to_rgb(png);
  png_set_interlace_handling(png);
  png_read_update_info(png, info);
  if (png_get_rowbytes(png, info) != row_bytes) return false;
  png_read_image(png, rows);
  return true;
}

}  // namespace

void require_table_size(const std::string& path, std::size_t width, std::size_t height, std::size_t largest) {
  if (width >= 2 && height >= 2 && width <= largest && height <= largest) return;
  throw Error(ErrorCode::kUnsupported, "'" + path + "' has " + std::to_string(width) + " x " + std::to_string(height) +
                                           " pixels: a table has from 2 to " + std::to_string(largest) + " a side");
}

TableImage read_png_table(const std::string& path, std::size_t largest) {
  const std::unique_ptr<std::FILE, FileCloser> file(std::fopen(path.c_str(), "rbe"));
  if (!file) throw Error(ErrorCode::kFileNotFound, "cannot open '" + path + "': " + std::strerror(errno));
  const Error out_of_memory(ErrorCode::kOutOfMemory, "not enough memory to read '" + path + "'");
  const Error damaged(ErrorCode::kBadFile, "'" + path + "' is not a PNG, or a damaged one");
  png_structp png = png_create_read_struct(PNG_LIBPNG_VER_STRING, nullptr, leave_on_error, ignore_message);
  if (!png) throw out_of_memory;
  std::unique_ptr<png_struct, ReaderDeleter> owner(png);
  png_infop info = owner.get_deleter().info = png_create_info_struct(png);
  if (!info) throw out_of_memory;
  png_init_io(png, file.get());
  if (!read_head(png, info)) throw damaged;

  TableImage image;
  image.width = png_get_image_width(png, info);
  image.height = png_get_image_height(png, info);
  require_table_size(path, image.width, image.height, largest);
  if (!(png_get_color_type(png, info) & PNG_COLOR_MASK_ALPHA) && !png_get_valid(png, info, PNG_INFO_tRNS))
    throw Error(ErrorCode::kUnsupported,
                "'" + path + "' has no alpha, which a table takes as opacity: save it as RGBA");
  const std::size_t count = 4 * image.width * image.height;
  std::vector<png_byte> bytes(2 * count);
  std::vector<png_bytep> rows;
  for (std::size_t y = 0; y < image.height; ++y) rows.push_back(bytes.data() + 8 * image.width * y);
  if (!read_rows(png, info, rows.data(), 8 * image.width)) throw damaged;
  image.rgba.resize(count);
  for (std::size_t i = 0; i < count; ++i)
    image.rgba[i] = static_cast<float>(bytes[2 * i] << 8 | bytes[2 * i + 1]) / 65535.0f;
  return image;
}

}  // namespace tetravox::io
