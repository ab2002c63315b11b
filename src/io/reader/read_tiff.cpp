// TIFF: a file of several pages, or a directory of slices in the order in which people count. Through libtiff, whose
// complaints VTK 9.1 passes over; rows from the bottom to the top, as VTK has them.

#include "src/io/formats.h"
#include "src/io/reader/raw_volume.h"
#include "src/io/reader/status.h"
#include "src/io/reader_protocol.h"

#include <sys/stat.h>
#include <tiffio.h>

#include <algorithm>
#include <cstdarg>
#include <cstdio>
#include <cstring>
#include <memory>

namespace tetravox::io {

namespace {

/// No compressor of TIFF makes more bytes than this of one.
constexpr std::uint64_t kMostInflation = 8192;
constexpr std::size_t kMostPages = 100'000;

/// libtiff's first complaint about the file that is being read.
std::string& complaint() {
  static std::string text;
  return text;
}

void keep_complaint(const char*, const char* format, va_list arguments) {
  char text[256];
  std::vsnprintf(text, sizeof text, format, arguments);
  if (complaint().empty()) complaint() = clean_line(text, 200);
}

[[noreturn]] void fail_tiff(const std::string& path) {
  fail_file(path, complaint().empty() ? "it could not be read" : complaint());
}

struct Page {
  std::string path;
  std::uint64_t offset = 0;  ///< of its directory in the file
  std::uint32_t width = 0, height = 0;
  std::uint16_t bits = 1, samples = 1, format = SAMPLEFORMAT_UINT, planar = PLANARCONFIG_CONTIG;
  std::uint16_t photometric = PHOTOMETRIC_MINISBLACK, compression = COMPRESSION_NONE;

  bool is_like(const Page& other) const {
    return width == other.width && height == other.height && bits == other.bits && samples == other.samples &&
           format == other.format;
  }
};

class TiffFile {
 public:
  explicit TiffFile(const std::string& path) : path_(path) {
    complaint().clear();
    TIFFSetErrorHandler(keep_complaint);
    TIFFSetWarningHandler(nullptr);
    file_.reset(TIFFOpen(path.c_str(), "rm"));
    if (!file_) fail_tiff(path);
  }
  TIFF* get() const { return file_.get(); }

  /// The pages that hold a slice, not a thumbnail or mask.
  std::vector<Page> list_pages() {
    std::vector<Page> pages;
    do {
      if (!complaint().empty()) fail_tiff(path_);
      std::uint32_t kind = 0;
      TIFFGetFieldDefaulted(get(), TIFFTAG_SUBFILETYPE, &kind);
      if ((kind & (FILETYPE_REDUCEDIMAGE | FILETYPE_MASK)) == 0) pages.push_back(read_page());
      if (pages.size() > kMostPages) fail_file(path_, "it has too many pages");
    } while (TIFFReadDirectory(get()) != 0);
    if (!complaint().empty()) fail_tiff(path_);
    if (pages.empty()) fail_file(path_, "it holds no page");
    return pages;
  }

 private:
  struct Close {
    void operator()(TIFF* file) const { TIFFClose(file); }
  };

  Page read_page() {
    Page page;
    page.path = path_;
    page.offset = TIFFCurrentDirOffset(get());
    TIFFGetField(get(), TIFFTAG_IMAGEWIDTH, &page.width);
    TIFFGetField(get(), TIFFTAG_IMAGELENGTH, &page.height);
    TIFFGetFieldDefaulted(get(), TIFFTAG_BITSPERSAMPLE, &page.bits);
    TIFFGetFieldDefaulted(get(), TIFFTAG_SAMPLESPERPIXEL, &page.samples);
    TIFFGetFieldDefaulted(get(), TIFFTAG_SAMPLEFORMAT, &page.format);
    TIFFGetFieldDefaulted(get(), TIFFTAG_PLANARCONFIG, &page.planar);
    TIFFGetField(get(), TIFFTAG_PHOTOMETRIC, &page.photometric);
    TIFFGetFieldDefaulted(get(), TIFFTAG_COMPRESSION, &page.compression);
    if (page.format == SAMPLEFORMAT_VOID) page.format = SAMPLEFORMAT_UINT;
    if (page.width == 0 || page.height == 0) fail_file(path_, "a page has no pixels");
    return page;
  }

  std::string path_;
  std::unique_ptr<TIFF, Close> file_;
};

ScalarType type_of(const Page& page) {
  const bool is_signed = page.format == SAMPLEFORMAT_INT;
  if (page.format == SAMPLEFORMAT_IEEEFP) {
    if (page.bits == 32) return ScalarType::kFloat32;
    if (page.bits == 64) return ScalarType::kFloat64;
  } else if (is_signed || page.format == SAMPLEFORMAT_UINT) {
    switch (page.bits) {
      case 8:
        return is_signed ? ScalarType::kInt8 : ScalarType::kUint8;
      case 16:
        return is_signed ? ScalarType::kInt16 : ScalarType::kUint16;
      case 32:
        return is_signed ? ScalarType::kInt32 : ScalarType::kUint32;
      case 64:
        return is_signed ? ScalarType::kInt64 : ScalarType::kUint64;
      default:
        break;
    }
  }
  throw Error(ErrorCode::kUnsupported, "'" + page.path + "' has samples of " + std::to_string(page.bits) +
                                           " bits or of an unusual kind: write 8, 16 or 32 bits");
}

/// Copies a block of pixels to its place; rows are turned over. `plane`: of separate components, otherwise all.
struct Target {
  std::span<std::byte> values;
  const Page& page;
  std::size_t sample_bytes;

  void put(const std::byte* block, std::size_t x, std::size_t y, std::size_t columns, std::size_t rows,
           std::size_t row_bytes, std::size_t plane) const {
    const std::size_t samples = page.samples, width = page.width, height = page.height;
    const bool is_separate = page.planar == PLANARCONFIG_SEPARATE && samples > 1;
    for (std::size_t row = 0; row < rows && y + row < height; ++row) {
      const std::byte* from = block + row * row_bytes;
      std::byte* to = values.data() + ((height - 1 - y - row) * width + x) * samples * sample_bytes;
      const std::size_t count = std::min(columns, width - x);
      if (!is_separate) {
        std::memcpy(to, from, count * samples * sample_bytes);
        continue;
      }
      for (std::size_t i = 0; i < count; ++i)
        std::memcpy(to + (i * samples + plane) * sample_bytes, from + i * sample_bytes, sample_bytes);
    }
  }
};

void read_strips(TIFF* file, const Target& target) {
  const Page& page = target.page;
  std::uint32_t rows_per_strip = page.height;
  TIFFGetFieldDefaulted(file, TIFFTAG_ROWSPERSTRIP, &rows_per_strip);
  rows_per_strip = std::clamp<std::uint32_t>(rows_per_strip, 1, page.height);
  const std::size_t planes = page.planar == PLANARCONFIG_SEPARATE ? page.samples : 1;
  const std::size_t row_bytes = std::size_t{page.width} * (page.samples / planes) * target.sample_bytes;
  std::vector<std::byte> strip(row_bytes * rows_per_strip);
  std::uint32_t index = 0;
  for (std::size_t plane = 0; plane < planes; ++plane)
    for (std::uint32_t y = 0; y < page.height; y += rows_per_strip, ++index) {
      const std::size_t rows = std::min(rows_per_strip, page.height - y);
      const auto bytes = static_cast<tmsize_t>(rows * row_bytes);
      if (TIFFReadEncodedStrip(file, index, strip.data(), bytes) != bytes || !complaint().empty()) fail_tiff(page.path);
      target.put(strip.data(), 0, y, page.width, rows, row_bytes, plane);
    }
}

void read_tiles(TIFF* file, const Target& target) {
  const Page& page = target.page;
  std::uint32_t width = 0, height = 0;
  TIFFGetField(file, TIFFTAG_TILEWIDTH, &width);
  TIFFGetField(file, TIFFTAG_TILELENGTH, &height);
  const tmsize_t bytes = TIFFTileSize(file), row_bytes = TIFFTileRowSize(file);
  const std::size_t planes = page.planar == PLANARCONFIG_SEPARATE ? page.samples : 1;
  const std::uint64_t needed = std::uint64_t{width} * (page.samples / planes) * target.sample_bytes;
  if (width == 0 || height == 0 || bytes <= 0 || static_cast<std::uint64_t>(row_bytes) < needed ||
      static_cast<std::uint64_t>(bytes) / height < needed || static_cast<std::uint64_t>(bytes) > (1u << 30))
    fail_file(page.path, "its tiles make no sense");
  std::vector<std::byte> tile(static_cast<std::size_t>(bytes));
  for (std::size_t plane = 0; plane < planes; ++plane)
    for (std::uint64_t y = 0; y < page.height; y += height)
      for (std::uint64_t x = 0; x < page.width; x += width) {
        const tmsize_t got = TIFFReadTile(file, tile.data(), static_cast<std::uint32_t>(x),
                                          static_cast<std::uint32_t>(y), 0, static_cast<std::uint16_t>(plane));
        if (got != bytes || !complaint().empty()) fail_tiff(page.path);
        target.put(tile.data(), x, y, width, height, static_cast<std::size_t>(row_bytes), plane);
      }
}

void read_pixels(TIFF* file, const Page& page, std::span<std::byte> values) {
  if (page.photometric == PHOTOMETRIC_YCBCR) {
    if (page.compression != COMPRESSION_JPEG)
      throw Error(ErrorCode::kUnsupported, "'" + page.path + "' has colour differences for values: write it as RGB");
    TIFFSetField(file, TIFFTAG_JPEGCOLORMODE, JPEGCOLORMODE_RGB);
  }
  const Target target{values, page, scalar_type_size(type_of(page))};
  if (TIFFIsTiled(file))
    read_tiles(file, target);
  else
    read_strips(file, target);
}

/// What ImageJ writes into the description: "key=value" lines.
struct ImageJ {
  std::optional<double> images, spacing;
};

ImageJ parse_description(TIFF* file) {
  ImageJ out;
  const char* description = nullptr;
  if (TIFFGetField(file, TIFFTAG_IMAGEDESCRIPTION, &description) == 0 || !description) return out;
  const std::string_view text = description;
  if (!text.starts_with("ImageJ=")) return out;
  for (const std::string& word : split_words(text)) {
    if (word.starts_with("images=")) out.images = to_double(std::string_view(word).substr(7));
    if (word.starts_with("spacing=")) out.spacing = to_double(std::string_view(word).substr(8));
  }
  return out;
}

/// Distances of values where ImageJ wrote them; others write the resolution of a printer or scanner.
VolumeFrame parse_frame(TIFF* file, const ImageJ& remarks) {
  VolumeFrame frame;
  if (!remarks.spacing) return frame;
  float x = 0.0f, y = 0.0f;
  TIFFGetField(file, TIFFTAG_XRESOLUTION, &x);
  TIFFGetField(file, TIFFTAG_YRESOLUTION, &y);
  if (x > 0.0f && y > 0.0f) {
    frame.steps[0][0] = 1.0 / x;
    frame.steps[1][1] = 1.0 / y;
  }
  frame.steps[2][2] = *remarks.spacing;
  return frame;
}

/// All pages of a file, or of a directory of files of one page each.
std::vector<Page> list_pages(const std::string& path, VolumeFrame& frame) {
  struct stat status {};
  const bool is_directory = stat(path.c_str(), &status) == 0 && S_ISDIR(status.st_mode);
  std::vector<std::string> files{path};
  if (is_directory) {
    files = list_files(path);
    std::erase_if(files,
                  [](const std::string& file) { return !has_ending(file, ".tif") && !has_ending(file, ".tiff"); });
  }
  std::vector<Page> pages;
  for (const std::string& name : files) {
    TiffFile file(name);
    const ImageJ remarks = parse_description(file.get());
    if (pages.empty()) frame = parse_frame(file.get(), remarks);
    const std::vector<Page> more = file.list_pages();
    if (is_directory && files.size() > 1 && more.size() > 1)
      throw Error(ErrorCode::kUnsupported, "'" + path + "' holds TIFF files of several pages: name one of them");
    if (!is_directory && remarks.images && *remarks.images > static_cast<double>(more.size()))
      fail_file(path, "it holds " + std::to_string(more.size()) + " pages, and says that there are more");
    pages.insert(pages.end(), more.begin(), more.end());
  }
  if (pages.empty()) throw Error(ErrorCode::kUnsupported, "'" + path + "' holds no TIFF file");
  return pages;
}

void require_like(const std::vector<Page>& pages) {
  for (std::size_t k = 1; k < pages.size(); ++k)
    if (!pages[k].is_like(pages[0]))
      throw Error(ErrorCode::kUnsupported,
                  "'" + pages[k].path + "', slice " + std::to_string(k) + ": " + std::to_string(pages[k].width) +
                      " x " + std::to_string(pages[k].height) + " pixels of " + std::to_string(pages[k].bits) +
                      " bits do not go with the " + std::to_string(pages[0].width) + " x " +
                      std::to_string(pages[0].height) + " of " + std::to_string(pages[0].bits) + " bits of the first");
}

/// A file is not much shorter than its pixels.
void require_length(const Page& page) {
  const std::uint64_t bytes =
      count_bytes(std::array<std::uint64_t, 3>{page.width, page.height, page.samples}, type_of(page), page.path);
  if (bytes / (page.compression == COMPRESSION_NONE ? 1 : kMostInflation) > file_size(page.path))
    fail_file(page.path, "it is too short for its " + std::to_string(page.width) + " x " + std::to_string(page.height) +
                             " pixels");
}

}  // namespace

FileContents read_tiff(const std::string& path) {
  VolumeFrame frame;
  const std::vector<Page> pages = list_pages(path, frame);
  const Page& first = pages.front();
  require_like(pages);
  for (const Page& page : pages) require_length(page);
  FileContents contents;
  const auto image = make_image({first.width, first.height, pages.size()}, first.samples, type_of(first), "TIFF", path);
  throw_if_vtk_failed(path);
  const std::span<std::byte> values = image_bytes(*image);
  const std::size_t plane = values.size() / pages.size();
  std::unique_ptr<TiffFile> file;
  for (std::size_t k = 0; k < pages.size(); ++k) {
    if (!file || pages[k].path != pages[k - 1].path) file = std::make_unique<TiffFile>(pages[k].path);
    if (TIFFSetSubDirectory(file->get(), pages[k].offset) == 0) fail_tiff(pages[k].path);
    read_pixels(file->get(), pages[k], values.subspan(k * plane, plane));
    send_progress(0.9 * static_cast<double>(k + 1) / static_cast<double>(pages.size()));
  }
  if (first.photometric == PHOTOMETRIC_MINISWHITE) contents.notes.emplace_back("small values are bright in this file");
  if (first.photometric == PHOTOMETRIC_PALETTE) contents.notes.emplace_back("values are places in the file's palette");
  set_frame(*image, frame, contents.notes);
  contents.blocks.emplace_back(image);
  return contents;
}

}  // namespace tetravox::io
