// NIfTI-1, NIfTI-2 and Analyze 7.5 (Cox and others 2004; nifti.nimh.nih.gov/nifti-1/documentation). World is
// right-anterior-superior, in the units of the file.

#include "src/io/formats.h"
#include "src/io/reader/raw_volume.h"

#include <sys/stat.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>

namespace tetravox::io {

namespace {

constexpr std::size_t kSize1 = 348, kSize2 = 540;

/// Fields of a header in either byte order.
class Header {
 public:
  Header(std::string bytes, const std::string& path) : bytes_(std::move(bytes)) {
    if (bytes_.size() < kSize1) fail_file(path, "it is shorter than a NIfTI header");
    for (const bool is_swapped : {false, true}) {
      is_swapped_ = is_swapped;
      const auto size = static_cast<std::uint32_t>(number<std::int32_t>(0));
      if (size == kSize1 || (size == kSize2 && bytes_.size() >= kSize2)) {
        is_two_ = size == kSize2;
        return;
      }
    }
    fail_file(path, "its header does not begin with its own size, 348 or 540");
  }

  template <class T>
  T number(std::size_t at) const {
    std::array<char, sizeof(T)> bytes{};
    std::memcpy(bytes.data(), bytes_.data() + at, sizeof(T));
    if (is_swapped_) std::reverse(bytes.begin(), bytes.end());
    return std::bit_cast<T>(bytes);
  }
  bool is_two() const { return is_two_; }
  bool is_big_endian() const { return is_swapped_ == (std::endian::native == std::endian::little); }
  /// A whole number or a real number, by its places in the two versions.
  std::int64_t dimension(std::size_t i) const {
    return is_two_ ? number<std::int64_t>(16 + 8 * i) : number<std::int16_t>(40 + 2 * i);
  }
  double real(std::size_t place1, std::size_t place2) const {
    return is_two_ ? number<double>(place2) : static_cast<double>(number<float>(place1));
  }
  double pixel_size(std::size_t i) const { return real(76 + 4 * i, 104 + 8 * i); }
  int code(std::size_t place1, std::size_t place2) const {
    return is_two_ ? number<std::int32_t>(place2) : number<std::int16_t>(place1);
  }
  int datatype() const { return number<std::int16_t>(is_two_ ? 12 : 70); }
  int bits() const { return number<std::int16_t>(is_two_ ? 14 : 72); }
  int qform_code() const { return code(252, 344); }
  int sform_code() const { return code(254, 348); }
  double sform(std::size_t row, std::size_t column) const {
    return real(280 + 16 * row + 4 * column, 400 + 32 * row + 8 * column);
  }
  double quaternion(std::size_t i) const { return real(256 + 4 * i, 352 + 8 * i); }
  double quaternion_offset(std::size_t i) const { return real(268 + 4 * i, 376 + 8 * i); }
  double data_offset() const { return is_two_ ? static_cast<double>(number<std::int64_t>(168)) : number<float>(108); }
  double slope() const { return real(112, 176); }
  double intercept() const { return real(116, 184); }
  /// "n+1": the data are in the same file; "ni1": in another; neither: Analyze 7.5.
  std::string_view magic() const { return std::string_view(bytes_).substr(is_two_ ? 4 : 344, 3); }
  bool is_nifti() const { return magic().starts_with("n"); }
  bool is_single() const { return magic() == "n+1" || magic() == "n+2"; }

 private:
  std::string bytes_;
  bool is_swapped_ = false;
  bool is_two_ = false;
};

/// Number type and components of a datatype code.
struct Type {
  ScalarType type;
  std::uint64_t components;
};

Type parse_type(int code, const std::string& path) {
  switch (code) {
    case 2:
      return {ScalarType::kUint8, 1};
    case 4:
      return {ScalarType::kInt16, 1};
    case 8:
      return {ScalarType::kInt32, 1};
    case 16:
      return {ScalarType::kFloat32, 1};
    case 32:  // complex
      return {ScalarType::kFloat32, 2};
    case 64:
      return {ScalarType::kFloat64, 1};
    case 128:  // RGB
      return {ScalarType::kUint8, 3};
    case 256:
      return {ScalarType::kInt8, 1};
    case 512:
      return {ScalarType::kUint16, 1};
    case 768:
      return {ScalarType::kUint32, 1};
    case 1024:
      return {ScalarType::kInt64, 1};
    case 1280:
      return {ScalarType::kUint64, 1};
    case 1792:  // complex of doubles
      return {ScalarType::kFloat64, 2};
    case 2304:  // RGBA
      return {ScalarType::kUint8, 4};
    default:
      break;
  }
  if (code == 1 || code == 1536 || code == 2048)
    throw Error(ErrorCode::kUnsupported,
                "'" + path + "' has single bits or 128-bit numbers for values: write it with another number type");
  fail_file(path, "its number type " + std::to_string(code) + " is unknown");
}

VolumeFrame frame_of_sform(const Header& header) {
  VolumeFrame frame;
  for (std::size_t row = 0; row < 3; ++row) {
    for (std::size_t axis = 0; axis < 3; ++axis) frame.steps[axis][row] = header.sform(row, axis);
    frame.origin[row] = header.sform(row, 3);
  }
  return frame;
}

/// Method 2 of the standard: a rotation as a unit quaternion, of which b, c and d are stored.
VolumeFrame frame_of_qform(const Header& header) {
  double b = header.quaternion(0), c = header.quaternion(1), d = header.quaternion(2);
  double a = 1.0 - (b * b + c * c + d * d);
  if (a < 1e-7) {
    const double length = std::sqrt(b * b + c * c + d * d);
    b /= length, c /= length, d /= length;
    a = 0.0;
  } else {
    a = std::sqrt(a);
  }
  const double rotation[3][3] = {
      {a * a + b * b - c * c - d * d, 2 * (b * c - a * d), 2 * (b * d + a * c)},
      {2 * (b * c + a * d), a * a + c * c - b * b - d * d, 2 * (c * d - a * b)},
      {2 * (b * d - a * c), 2 * (c * d + a * b), a * a + d * d - b * b - c * c},
  };
  VolumeFrame frame;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double turn = axis == 2 && header.pixel_size(0) < 0.0 ? -1.0 : 1.0;
    for (std::size_t row = 0; row < 3; ++row)
      frame.steps[axis][row] = turn * rotation[row][axis] * std::abs(header.pixel_size(axis + 1));
    frame.origin[axis] = header.quaternion_offset(axis);
  }
  return frame;
}

/// The sform where there is one, as most programs prefer, otherwise the qform, otherwise voxel sizes alone.
VolumeFrame parse_frame(const Header& header) {
  if (header.is_nifti() && header.sform_code() > 0) return frame_of_sform(header);
  if (header.is_nifti() && header.qform_code() > 0) return frame_of_qform(header);
  VolumeFrame frame;
  for (std::size_t axis = 0; axis < 3; ++axis) frame.steps[axis][axis] = std::abs(header.pixel_size(axis + 1));
  return frame;
}

/// `path` with another ending; endings of compressed files are kept.
std::string sibling(const std::string& path, const std::string& ending) {
  const bool is_packed = has_ending(path, ".gz");
  const std::string plain = is_packed ? path.substr(0, path.size() - 3) : path;
  const std::string stem = plain.substr(0, plain.size() - 4);
  struct stat status {};
  for (const std::string& name : {stem + ending + (is_packed ? ".gz" : ""), stem + ending, stem + ending + ".gz"})
    if (stat(name.c_str(), &status) == 0) return name;
  throw Error(ErrorCode::kBadFile, "'" + path + "' goes with '" + stem + ending + "', which is missing");
}

/// Sizes along all seven axes, 1 where there is none.
std::array<std::uint64_t, 7> parse_sizes(const Header& header, const std::string& path) {
  const std::int64_t count = header.dimension(0);
  if (count < 1 || count > 7) fail_file(path, "its number of axes makes no sense");
  std::array<std::uint64_t, 7> sizes{1, 1, 1, 1, 1, 1, 1};
  for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) {
    const std::int64_t size = header.dimension(i + 1);
    if (size < 1 && i < 3) fail_file(path, "its dimensions make no sense");
    sizes[i] = static_cast<std::uint64_t>(std::max<std::int64_t>(size, 1));
  }
  return sizes;
}

/// Fills in the time steps (the fourth axis) and the components (the axes after it, whose volumes follow each other).
void set_steps(const Header& header, const std::array<std::uint64_t, 7>& sizes, RawVolume& volume,
               const std::string& path) {
  constexpr std::uint64_t kMostSteps = 1'000'000, kMostComponents = 4096;
  const std::uint64_t vectors = count_bytes(std::array{sizes[4], sizes[5], sizes[6]}, ScalarType::kUint8, path);
  if (sizes[3] > kMostSteps || vectors > kMostComponents) fail_file(path, "its dimensions make no sense");
  if (vectors > 1 && volume.components > 1)
    throw Error(ErrorCode::kUnsupported, "'" + path + "' has vectors of colours or complex numbers: give one volume");
  if (vectors > 1) {
    volume.components = vectors;
    volume.is_planar = true;
  }
  const double step = std::isfinite(header.pixel_size(4)) && header.pixel_size(4) > 0.0 ? header.pixel_size(4) : 1.0;
  for (std::uint64_t i = 0; sizes[3] > 1 && i < sizes[3]; ++i) volume.times.push_back(static_cast<double>(i) * step);
}

}  // namespace

FileContents read_nifti(const std::string& path, const TimeRequest& time) {
  const bool is_image = has_ending(path, ".img") || has_ending(path, ".img.gz");
  const std::string header_path = is_image ? sibling(path, ".hdr") : path;
  const Header header(read_head(header_path, kSize2), header_path);
  const auto [type, components] = parse_type(header.datatype(), header_path);
  if (header.bits() != static_cast<int>(8 * components * scalar_type_size(type)))
    fail_file(header_path, "its number type and its bits a voxel do not fit");
  RawVolume volume;
  const auto sizes = parse_sizes(header, header_path);
  std::copy_n(sizes.begin(), 3, volume.points.begin());
  volume.type = type;
  volume.components = components;
  volume.is_big_endian = header.is_big_endian();
  volume.array_name = "NIFTI";
  volume.frame = parse_frame(header);
  set_steps(header, sizes, volume, header_path);
  const double offset = header.data_offset();
  const double least = header.is_single() ? (header.is_two() ? kSize2 + 4.0 : kSize1 + 4.0) : 0.0;
  if (!(offset >= 0.0 && offset < 1e15)) fail_file(header_path, "the place of its values makes no sense");
  volume.files.paths = {header.is_single() ? header_path : is_image ? path : sibling(path, ".img")};
  volume.files.is_compressed = is_gzip(volume.files.paths.front());
  (volume.files.is_compressed ? volume.files.inflated_skip : volume.files.offset) =
      static_cast<std::uint64_t>(std::max(offset, least));
  FileContents contents = read_raw_volume(volume, path, time);
  const double slope = header.slope(), intercept = header.intercept();
  if (header.is_nifti() && std::isfinite(slope) && slope != 0.0 && (slope != 1.0 || intercept != 0.0))
    contents.notes.push_back("values are as stored; the file scales them by " + std::to_string(slope) + " and adds " +
                             std::to_string(intercept));
  return contents;
}

}  // namespace tetravox::io
