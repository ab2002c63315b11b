#include "src/io/raw_file.h"

#include "src/grid/survey.h"
#include "src/io/byte_order.h"
#include "src/io/formats.h"
#include "src/io/mapped_file.h"
#include "src/io/validate_grid.h"
#include "src/support/memory.h"
#include "src/support/threads.h"
#include "tetravox/error.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <memory>
#include <optional>
#include <string_view>
#include <vector>

namespace tetravox::io {

namespace {

namespace fs = std::filesystem;

/// Files that are not mapped are read in pieces of this size, bytes.
constexpr std::size_t kPieceBytes = std::size_t{16} << 20;
constexpr const char* kArrayName = "values";
constexpr const char* kExampleName = "name_256x256x256_uint8.raw";

[[noreturn]] void fail(ErrorCode code, const std::string& path, const std::string& what) {
  throw Error(code, "'" + path + "': " + what);
}

/// Three positive numbers with an x between them; empty for anything else.
template <class T>
std::optional<std::array<T, 3>> parse_triple(std::string_view text) {
  std::array<T, 3> numbers{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::size_t size = axis < 2 ? text.find('x') : text.size();
    if (size == std::string_view::npos || size == 0 || text[0] == '-') return std::nullopt;
    const auto [end, error] = std::from_chars(text.data(), text.data() + size, numbers[axis]);
    if (error != std::errc() || end != text.data() + size || !(numbers[axis] > T{0})) return std::nullopt;
    text.remove_prefix(std::min(size + 1, text.size()));
  }
  return numbers;
}

std::optional<ScalarType> find_scalar_type(const std::string& name) {
  try {
    return scalar_type_from_name(name);
  } catch (const Error&) {
    return std::nullopt;
  }
}

/// A layout with nothing left open.
struct Layout {
  GridShape shape;
  ScalarType type = ScalarType::kUint8;
  int components = 1;
  bool is_big_endian = false;
  std::uint64_t header_bytes = 0;
};

std::string describe_dimensions(const std::array<std::uint32_t, 3>& dimensions) {
  return std::to_string(dimensions[0]) + " x " + std::to_string(dimensions[1]) + " x " + std::to_string(dimensions[2]);
}

/// The product of `factors`; empty where it is more than 64 bits can hold.
std::optional<std::uint64_t> multiply(std::initializer_list<std::uint64_t> factors) {
  std::uint64_t product = 1;
  for (const std::uint64_t factor : factors)
    if (__builtin_mul_overflow(product, factor, &product)) return std::nullopt;
  return product;
}

/// Number types of this size, as a choice for people.
std::string types_of_size(std::uint64_t bytes) {
  switch (bytes) {
    case 1:
      return "uint8 or int8";
    case 2:
      return "uint16 or int16";
    case 4:
      return "float32, uint32 or int32";
    case 8:
      return "float64, uint64 or int64";
    default:
      return {};
  }
}

/// What to try with a file of `file_bytes`, in words: types and components that fit the dimensions, and a header that
/// leaves the `value_bytes` of the layout. Empty where nothing does.
std::string propose(const std::array<std::uint32_t, 3>& dimensions, std::uint64_t file_bytes,
                    std::uint64_t header_bytes, std::optional<std::uint64_t> value_bytes) {
  const auto points = multiply({dimensions[0], dimensions[1], dimensions[2]});
  std::vector<std::string> proposals;
  if (points && *points > 0 && file_bytes > header_bytes && (file_bytes - header_bytes) % *points == 0) {
    const std::uint64_t tuple = (file_bytes - header_bytes) / *points;
    for (std::uint64_t components = 1; components <= 4; ++components) {
      const std::string types = tuple % components == 0 ? types_of_size(tuple / components) : "";
      const std::string prefix = components > 1 ? "--components " + std::to_string(components) + " " : "";
      if (!types.empty()) proposals.push_back(prefix + "--scalar-type " + types);
    }
  }
  if (value_bytes && file_bytes > *value_bytes)
    proposals.push_back("--header-bytes " + std::to_string(file_bytes - *value_bytes));
  std::string text;
  for (const std::string& proposal : proposals) text += (text.empty() ? "" : "; or ") + proposal;
  return text.empty() ? text : text + " would fit";
}

/// A file beside `path` that may be its header, or nothing.
std::string find_header(const std::string& path) {
  for (const char* ending : {".mhd", ".nhdr", ".hdr"}) {
    std::error_code error;
    const fs::path header = fs::path(path).replace_extension(ending);
    if (header != fs::path(path) && fs::is_regular_file(header, error)) return header.string();
  }
  return {};
}

[[noreturn]] void fail_unknown(const std::string& path) {
  const std::string header = find_header(path);
  fail(ErrorCode::kInvalidArgument, path,
       "a RAW file has no header, and its name does not tell its layout as " + std::string(kExampleName) + " does: " +
           (header.empty() ? "name its header if it has one (.mhd, .nhdr), or give --dimensions and --scalar-type"
                           : "name its header '" + header + "' instead, or give --dimensions and --scalar-type"));
}

/// What is given, then what the name says, then what is usual.
Layout complete_layout(const std::string& path, const RawLayout& given, std::uint64_t file_bytes) {
  const RawLayout named = parse_raw_name(path);
  Layout layout;
  if (!given.dimensions && !named.dimensions) fail_unknown(path);
  layout.shape.dimensions = given.dimensions ? *given.dimensions : *named.dimensions;
  layout.header_bytes = given.header_bytes;
  const std::optional<ScalarType> type = given.type ? given.type : named.type;
  if (!type) {
    const std::string proposal = propose(layout.shape.dimensions, file_bytes, given.header_bytes, {});
    fail(ErrorCode::kInvalidArgument, path,
         "its number type is not known: " + (proposal.empty() ? "give --scalar-type" : proposal));
  }
  layout.type = *type;
  layout.shape.spacing = given.spacing.value_or(named.spacing.value_or(layout.shape.spacing));
  for (const double spacing : layout.shape.spacing)
    if (!(spacing > 0.0) || !std::isfinite(spacing))
      fail(ErrorCode::kInvalidArgument, path, "a spacing must be a number above 0");
  layout.components = given.components.value_or(1);
  if (layout.components < 1 || layout.components > 4)
    fail(ErrorCode::kInvalidArgument, path, std::to_string(layout.components) + " components are not from 1 to 4");
  layout.is_big_endian = given.is_big_endian.value_or(false);
  validate_grid_shape(layout.shape, path);
  return layout;
}

/// Bytes of the values.
/// @throws Error (kBadFile) where the file has not exactly as many behind its header.
std::size_t check_size(const std::string& path, const Layout& layout, std::uint64_t file_bytes) {
  const auto& dimensions = layout.shape.dimensions;
  const auto components = static_cast<std::uint64_t>(layout.components);
  const auto values =
      multiply({dimensions[0], dimensions[1], dimensions[2], components, scalar_type_size(layout.type)});
  std::uint64_t wanted = 0;
  const bool is_known = values && !__builtin_add_overflow(*values, layout.header_bytes, &wanted);
  if (is_known && wanted == file_bytes) return *values;
  std::string message = "the file has " + std::to_string(file_bytes) + " bytes, but ";
  if (layout.header_bytes > 0) message += std::to_string(layout.header_bytes) + " bytes of header and ";
  message += describe_dimensions(dimensions) + (components > 1 ? " x " + std::to_string(components) : "") + " " +
             scalar_type_name(layout.type) + " are " +
             (is_known ? std::to_string(wanted) : "more than any file holds") + ": ";
  const std::string proposal = propose(dimensions, file_bytes, layout.header_bytes, values);
  fail(ErrorCode::kBadFile, path,
       message +
           (proposal.empty() ? "give the --dimensions and --scalar-type that the file was written with" : proposal));
}

/// An open file, closed in the end.
class OpenFile {
 public:
  explicit OpenFile(const std::string& path) : descriptor_(open(path.c_str(), O_RDONLY | O_CLOEXEC)) {
    if (descriptor_ < 0) throw Error(ErrorCode::kFileNotFound, "cannot open '" + path + "': " + std::strerror(errno));
  }
  OpenFile(const OpenFile&) = delete;
  OpenFile& operator=(const OpenFile&) = delete;
  ~OpenFile() { close(descriptor_); }
  int descriptor() const { return descriptor_; }
  std::uint64_t size() const {
    struct stat status {};
    return fstat(descriptor_, &status) == 0 ? static_cast<std::uint64_t>(status.st_size) : 0;
  }

 private:
  int descriptor_ = -1;
};

[[noreturn]] void fail_changed(const std::string& path) {
  fail(ErrorCode::kBadFile, path, "the file became shorter while it was read: wait until it is written");
}

/// Reads `values` from their place in the file and brings them into this machine's byte order.
void read_values(const OpenFile& file, const Layout& layout, std::span<std::byte> values, const std::string& path,
                 const Progress& progress) {
  std::size_t done = 0;
  while (done < values.size()) {
    support::throw_if_cancelled(progress);
    const std::span<std::byte> piece = values.subspan(done, std::min(kPieceBytes, values.size() - done));
    for (std::size_t read = 0; read < piece.size();) {
      const ssize_t count = pread(file.descriptor(), piece.data() + read, piece.size() - read,
                                  static_cast<off_t>(layout.header_bytes + done + read));
      if (count < 0 && errno == EINTR) continue;
      if (count < 0) fail(ErrorCode::kBadFile, path, std::string("cannot be read: ") + std::strerror(errno));
      if (count == 0) fail_changed(path);
      read += static_cast<std::size_t>(count);
    }
    to_native_order(piece, scalar_type_size(layout.type), layout.is_big_endian);
    done += piece.size();
    if (progress.report) progress.report("read", static_cast<double>(done) / static_cast<double>(values.size()));
  }
}

/// Puts the values of a file that cannot be viewed as it is into memory.
void load_values(const OpenFile& file, const Layout& layout, std::size_t bytes, const std::string& path,
                 const Progress& progress, GridData& grid) {
  support::require_memory(bytes, "reading '" + path + "'");
  const std::shared_ptr<std::byte[]> values = std::make_unique_for_overwrite<std::byte[]>(bytes);
  read_values(file, layout, {values.get(), bytes}, path, progress);
  grid.values = {values.get(), bytes};
  grid.storage = values;
}

}  // namespace

RawLayout parse_raw_name(const std::string& path) {
  RawLayout layout;
  const std::string stem = fs::path(path).stem().string();
  std::vector<std::string> words;
  for (std::size_t begin = 0; begin <= stem.size();) {
    const std::size_t end = std::min(stem.find('_', begin), stem.size());
    words.push_back(stem.substr(begin, end - begin));
    begin = end + 1;
  }
  // From behind, as a name may hold anything: the type, a spacing, the dimensions.
  std::optional<ScalarType> type = find_scalar_type(words.back());
  if (type) words.pop_back();
  std::vector<std::string> triples;
  while (!words.empty() && triples.size() < 2 && parse_triple<double>(words.back())) {
    triples.push_back(words.back());
    words.pop_back();
  }
  if (triples.empty()) return layout;
  layout.dimensions = parse_triple<std::uint32_t>(triples.back());
  if (!layout.dimensions) return layout;
  layout.type = type;
  if (triples.size() == 2) layout.spacing = parse_triple<double>(triples.front());
  return layout;
}

bool is_raw_file(const std::string& path, const RawLayout& layout) {
  std::error_code error;
  return (layout.dimensions || has_ending(path, ".raw")) && !fs::is_directory(path, error);
}

void require_no_layout(const RawLayout& layout, const std::string& path) {
  if (layout.dimensions || layout.type || layout.components || layout.spacing || layout.is_big_endian ||
      layout.header_bytes > 0)
    fail(ErrorCode::kInvalidArgument, path,
         "a layout of bytes is for RAW files: leave it out, or give --dimensions if this is one");
}

Dataset read_raw_file(const std::string& path, const RawLayout& given, const Progress& progress) {
  check_file(path);
  const OpenFile file(path);
  const std::uint64_t file_bytes = file.size();
  const Layout layout = complete_layout(path, given, file_bytes);
  const std::size_t bytes = check_size(path, layout, file_bytes);
  Dataset dataset;
  dataset.info.source = path;
  dataset.info.format = format_name(Format::kRaw);
  GridData& grid = dataset.grid;
  grid.shape = layout.shape;
  grid.type = layout.type;
  grid.components = layout.components;
  grid.array_name = kArrayName;
  const std::size_t value_size = scalar_type_size(layout.type);
  std::shared_ptr<const MappedFile> mapped;
  if (is_native_order(value_size, layout.is_big_endian) && layout.header_bytes % value_size == 0)
    mapped = MappedFile::map(file.descriptor(), file_bytes);
  if (mapped) {
    grid.values = mapped->bytes().subspan(layout.header_bytes);
    grid.storage = mapped;
    mapped->expect_one_pass(true);
  } else {
    load_values(file, layout, bytes, path, progress, grid);
  }
  grid::describe_grid(grid, dataset.info, progress);
  if (mapped) {
    if (mapped->was_cut_short()) fail_changed(path);
    mapped->expect_one_pass(false);
  }
  if (progress.report) progress.report("read", 1.0);
  return dataset;
}

}  // namespace tetravox::io
