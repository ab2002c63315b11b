#include "src/io/image_png.h"

#include "tetravox/error.h"

#include "src/support/threads.h"

#include <png.h>

#include <cmath>
#include <csetjmp>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <memory>
#include <vector>

namespace tetravox::io {
namespace {

constexpr char kSceneKey[] = "tetravox scene";
constexpr png_alloc_size_t kLargestText = 64u << 20;  // bytes of one text chunk, unpacked

/// Deflate level: above 4 files shrink by a few per cent and take twice the time.
constexpr int kCompressionLevel = 4;

/// `value` in [0, 1] as an integer of `largest` steps, rounded to nearest; below 0 and NaN become 0.
std::uint32_t quantise(double value, double largest) {
  if (!(value > 0.0)) return 0;
  return static_cast<std::uint32_t>(std::floor(std::fmin(value, 1.0) * largest + 0.5));
}

/// Turns one row of premultiplied floats into PNG samples (16 bits: the high byte first).
void convert_row(const float* pixels, int width, const WriteOptions& options, std::vector<png_byte>& row) {
  const int channels = options.use_alpha ? 4 : 3;
  const double largest = options.bit_depth == 16 ? 65535.0 : 255.0;
  png_byte* out = row.data();
  for (int x = 0; x < width; ++x, pixels += 4) {
    const double alpha = pixels[3];
    for (int c = 0; c < channels; ++c) {
      double value = alpha;
      if (c < 3 && options.use_alpha) value = alpha > 0.0 ? pixels[c] / alpha : 0.0;
      if (!options.use_alpha) value = pixels[c] + (1.0 - alpha) * options.background[static_cast<std::size_t>(c)];
      const std::uint32_t sample = quantise(value, largest);
      if (options.bit_depth == 16) *out++ = static_cast<png_byte>(sample >> 8);
      *out++ = static_cast<png_byte>(sample & 0xFFu);
    }
  }
}

/// Keeps libpng quiet: what went wrong is told by the caller, in one line.
void ignore_message(png_structp, png_const_charp) {}
[[noreturn]] void leave_on_error(png_structp png, png_const_charp) { png_longjmp(png, 1); }

void write_bytes(png_structp png, png_bytep bytes, png_size_t count) {
  if (!static_cast<OutputFile*>(png_get_io_ptr(png))->try_write(bytes, count)) png_error(png, "write");
}
void flush_bytes(png_structp) {}

/// The text chunks: the scene, packed, and the software that wrote it.
void set_texts(png_structp png, png_infop info, const std::string& scene) {
  std::string scene_key = kSceneKey, scene_text = scene, software_key = "Software", software = "tetravox";
  png_text texts[2] = {};
  texts[0].compression = PNG_TEXT_COMPRESSION_NONE;
  texts[0].key = software_key.data();
  texts[0].text = software.data();
  texts[1].compression = PNG_ITXT_COMPRESSION_zTXt;
  texts[1].key = scene_key.data();
  texts[1].text = scene_text.data();
  png_set_text(png, info, texts, scene.empty() ? 1 : 2);
}

enum class Outcome { kDone, kFailed, kCancelled };

/// Everything that may jump: no object with a destructor is made between setjmp and the end.
Outcome run_writer(png_structp png, png_infop info, const Image& image, const WriteOptions& options,
                   const Progress& progress, std::vector<png_byte>& row) {
  if (setjmp(png_jmpbuf(png))) return Outcome::kFailed;
  png_write_info(png, info);
  for (int y = 0; y < image.height; ++y) {
    if (progress.cancelled && progress.cancelled->load(std::memory_order_relaxed)) return Outcome::kCancelled;
    convert_row(image.pixel(0, y), image.width, options, row);
    png_write_row(png, row.data());
  }
  png_write_end(png, nullptr);
  return Outcome::kDone;
}

/// Sets header and texts; may jump like `run_writer`.
Outcome prepare_writer(png_structp png, png_infop info, const Image& image, const WriteOptions& options) {
  if (setjmp(png_jmpbuf(png))) return Outcome::kFailed;
  png_set_IHDR(png, info, static_cast<png_uint_32>(image.width), static_cast<png_uint_32>(image.height),
               options.bit_depth, options.use_alpha ? PNG_COLOR_TYPE_RGB_ALPHA : PNG_COLOR_TYPE_RGB, PNG_INTERLACE_NONE,
               PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  png_set_compression_level(png, kCompressionLevel);
  return Outcome::kDone;
}

struct WriterDeleter {
  png_infop info = nullptr;
  void operator()(png_struct* png) { png_destroy_write_struct(&png, &info); }
};
struct ReaderDeleter {
  png_infop info = nullptr;
  void operator()(png_struct* png) { png_destroy_read_struct(&png, &info, nullptr); }
};
struct FileCloser {
  void operator()(std::FILE* file) { std::fclose(file); }
};

/// Reads as far as the first pixel; false where libpng gives up.
bool run_reader(png_structp png, png_infop info) {
  if (setjmp(png_jmpbuf(png))) return false;
  png_read_info(png, info);
  return true;
}

/// Asks for RGB of 8 or 16 bits, whatever the file holds, most significant byte first.
bool ask_for_colors(png_structp png, png_infop info) {
  if (setjmp(png_jmpbuf(png))) return false;
  png_set_expand(png);
  png_set_gray_to_rgb(png);
  png_set_strip_alpha(png);
  png_set_interlace_handling(png);
  png_read_update_info(png, info);
  return true;
}

bool read_rows(png_structp png, std::vector<png_bytep>& rows) {
  if (setjmp(png_jmpbuf(png))) return false;
  png_read_image(png, rows.data());
  png_read_end(png, nullptr);
  return true;
}

/// A PNG that has been read as far as its first pixel.
class OpenPng {
 public:
  explicit OpenPng(const std::string& path) : path_(path), file_(std::fopen(path.c_str(), "rbe")) {
    if (!file_) throw Error(ErrorCode::kFileNotFound, "cannot open '" + path + "': " + std::strerror(errno));
    png_.reset(png_create_read_struct(PNG_LIBPNG_VER_STRING, nullptr, leave_on_error, ignore_message));
    if (png_) png_.get_deleter().info = png_create_info_struct(png());
    if (!png_ || !info()) throw Error(ErrorCode::kOutOfMemory, "not enough memory to read '" + path + "'");
    png_set_chunk_malloc_max(png(), kLargestText);
    png_init_io(png(), file_.get());
    require(run_reader(png(), info()));
  }

  png_structp png() const { return png_.get(); }
  png_infop info() const { return png_.get_deleter().info; }
  void require(bool is_good) const {
    if (!is_good) throw Error(ErrorCode::kBadFile, "'" + path_ + "' is not a PNG, or a damaged one");
  }

 private:
  std::string path_;
  std::unique_ptr<std::FILE, FileCloser> file_;
  std::unique_ptr<png_struct, ReaderDeleter> png_;
};

}  // namespace

void write_png(OutputFile& file, const Image& image, const WriteOptions& options, const Progress& progress) {
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, leave_on_error, ignore_message);
  if (!png) throw Error(ErrorCode::kOutOfMemory, "not enough memory to write a PNG");
  std::unique_ptr<png_struct, WriterDeleter> owner(png);
  owner.get_deleter().info = png_create_info_struct(png);
  png_infop info = owner.get_deleter().info;
  if (!info) throw Error(ErrorCode::kOutOfMemory, "not enough memory to write a PNG");

  png_set_write_fn(png, &file, write_bytes, flush_bytes);
  if (prepare_writer(png, info, image, options) != Outcome::kDone)
    throw Error(ErrorCode::kCannotWrite,
                "a PNG cannot hold " + std::to_string(image.width) + " x " + std::to_string(image.height) + " pixels");
  set_texts(png, info, options.scene);
  std::vector<png_byte> row(static_cast<std::size_t>(image.width) * 8);
  const Outcome outcome = run_writer(png, info, image, options, progress, row);
  if (outcome == Outcome::kFailed) file.fail();
  if (outcome == Outcome::kCancelled) support::throw_if_cancelled(progress);
}

WriteOptions read_png_options(const std::string& path) {
  const OpenPng opened(path);
  png_structp png = opened.png();
  png_infop info = opened.info();
  WriteOptions options;
  options.use_alpha = (png_get_color_type(png, info) & PNG_COLOR_MASK_ALPHA) != 0;
  options.bit_depth = png_get_bit_depth(png, info) == 16 ? 16 : 8;
  png_textp texts = nullptr;
  const int count = png_get_text(png, info, &texts, nullptr);
  for (int i = 0; i < count; ++i) {
    const bool is_international = texts[i].compression >= PNG_ITXT_COMPRESSION_NONE;
    const std::size_t length = is_international ? texts[i].itxt_length : texts[i].text_length;
    if (std::strcmp(texts[i].key, kSceneKey) == 0 && texts[i].text) options.scene.assign(texts[i].text, length);
  }
  return options;
}

Pixels read_png_pixels(const std::string& path, std::size_t most) {
  const OpenPng opened(path);
  png_structp png = opened.png();
  Pixels pixels =
      make_pixels(path, png_get_image_width(png, opened.info()), png_get_image_height(png, opened.info()), most);
  opened.require(ask_for_colors(png, opened.info()));
  const bool is_wide = png_get_bit_depth(png, opened.info()) == 16;
  const std::size_t row_bytes = png_get_rowbytes(png, opened.info());
  std::vector<png_byte> bytes(row_bytes * static_cast<std::size_t>(pixels.height));
  std::vector<png_bytep> rows;
  for (int y = 0; y < pixels.height; ++y) rows.push_back(bytes.data() + row_bytes * static_cast<std::size_t>(y));
  opened.require(read_rows(png, rows));
  for (std::size_t i = 0; i < pixels.colors.size(); ++i)
    pixels.colors[i] = is_wide ? static_cast<float>(256 * bytes[2 * i] + bytes[2 * i + 1]) / 65535.0f
                               : static_cast<float>(bytes[i]) / 255.0f;
  return pixels;
}

}  // namespace tetravox::io
