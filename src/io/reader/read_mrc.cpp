// MRC (Cheng and others 2015, "MRC2014: Extensions to the MRC format header for electron cryo-microscopy and
// tomography"), with CCP4's maps and IMOD's variants.

#include "src/io/reader/raw_volume.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <numbers>

namespace tetravox::io {

namespace {

constexpr std::size_t kHeaderBytes = 1024;
constexpr std::int32_t kImodStamp = 1146047817;

class Header {
 public:
  Header(std::string bytes, const std::string& path) : bytes_(std::move(bytes)) {
    if (bytes_.size() < kHeaderBytes) fail_file(path, "it is shorter than its header");
    // Machine stamps are often wrong: judge by what the numbers say.
    for (const bool is_swapped : {false, true}) {
      is_swapped_ = is_swapped;
      if (is_plausible()) return;
    }
    fail_file(path, "its dimensions, mode or axes make no sense");
  }
  std::int32_t integer(std::size_t word) const { return number<std::int32_t>(4 * word); }
  double real(std::size_t word) const { return number<float>(4 * word); }
  bool is_big_endian() const { return is_swapped_ == (std::endian::native == std::endian::little); }
  /// World axis, 0, 1 or 2, along which columns, rows and sections run. Old files leave them 0.
  std::array<std::size_t, 3> axes() const {
    std::array<std::size_t, 3> out{0, 1, 2};
    if (integer(16) != 0)
      for (std::size_t i = 0; i < 3; ++i) out[i] = static_cast<std::size_t>(integer(16 + i)) - 1;
    return out;
  }

 private:
  template <class T>
  T number(std::size_t at) const {
    std::array<char, sizeof(T)> bytes{};
    std::memcpy(bytes.data(), bytes_.data() + at, sizeof(T));
    if (is_swapped_) std::reverse(bytes.begin(), bytes.end());
    return std::bit_cast<T>(bytes);
  }
  bool is_plausible() const {
    for (std::size_t i = 0; i < 3; ++i)
      if (integer(i) < 1 || integer(i) > (1 << 24)) return false;
    if (integer(3) < 0 || integer(3) > 101 || integer(23) < 0) return false;
    std::array<std::int32_t, 3> map{integer(16), integer(17), integer(18)};
    std::sort(map.begin(), map.end());
    return map == std::array<std::int32_t, 3>{1, 2, 3} || map == std::array<std::int32_t, 3>{0, 0, 0};
  }
  std::string bytes_;
  bool is_swapped_ = false;
};

void set_type(const Header& header, RawVolume& volume, const std::string& path) {
  // IMOD wrote bytes without a sign, and says so.
  const bool is_imod = header.integer(38) == kImodStamp;
  switch (header.integer(3)) {
    case 0:
      volume.type = is_imod && (header.integer(39) & 1) == 0 ? ScalarType::kUint8 : ScalarType::kInt8;
      return;
    case 1:
      volume.type = ScalarType::kInt16;
      return;
    case 2:
      volume.type = ScalarType::kFloat32;
      return;
    case 3:
      volume.type = ScalarType::kInt16;
      volume.components = 2;
      return;
    case 4:
      volume.type = ScalarType::kFloat32;
      volume.components = 2;
      return;
    case 6:
      volume.type = ScalarType::kUint16;
      return;
    case 16:
      volume.components = 3;
      return;
    default:
      throw Error(ErrorCode::kUnsupported, "'" + path + "' is of MRC mode " + std::to_string(header.integer(3)) +
                                               ": write it in mode 0, 1, 2 or 6");
  }
}

/// Edges of the unit cell as world vectors: a along x, b in the x-y plane.
std::array<std::array<double, 3>, 3> cell_edges(const Header& header) {
  constexpr double kDegree = std::numbers::pi / 180.0;
  std::array<double, 3> cosine{};
  for (std::size_t i = 0; i < 3; ++i) {
    const double angle = header.real(13 + i);
    // Right angles are exact, and what is no angle is taken as one.
    cosine[i] = angle > 0.0 && angle < 180.0 && angle != 90.0 ? std::cos(angle * kDegree) : 0.0;
  }
  const double sine = std::sqrt(1.0 - cosine[2] * cosine[2]);
  const double y = (cosine[0] - cosine[1] * cosine[2]) / sine;
  const double z = std::sqrt(std::max(0.0, 1.0 - cosine[1] * cosine[1] - y * y));
  std::array<std::array<double, 3>, 3> edges{{{1, 0, 0}, {cosine[2], sine, 0}, {cosine[1], y, z}}};
  for (std::size_t i = 0; i < 3; ++i)
    for (double& part : edges[i]) part *= header.real(10 + i);
  return edges;
}

VolumeFrame parse_frame(const Header& header) {
  const auto edges = cell_edges(header);
  const auto axes = header.axes();
  VolumeFrame frame;
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t axis = axes[i];
    const std::int32_t intervals = header.integer(7 + axis);
    for (std::size_t row = 0; row < 3; ++row) frame.steps[i][row] = intervals > 0 ? edges[axis][row] / intervals : 0.0;
  }
  for (std::size_t row = 0; row < 3; ++row) frame.origin[row] = header.real(49 + row);
  // CCP4 leaves the origin 0 and counts the first column, row and section in intervals.
  if (frame.origin == std::array<double, 3>{})
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t row = 0; row < 3; ++row) frame.origin[row] += frame.steps[i][row] * header.integer(4 + i);
  return frame;
}

}  // namespace

FileContents read_mrc(const std::string& path) {
  const Header header(read_head(path, kHeaderBytes), path);
  RawVolume volume;
  for (std::size_t i = 0; i < 3; ++i) volume.points[i] = static_cast<std::uint64_t>(header.integer(i));
  set_type(header, volume, path);
  volume.is_big_endian = header.is_big_endian();
  volume.array_name = "MRC";
  volume.frame = parse_frame(header);
  volume.files.paths = {path};
  volume.files.offset = kHeaderBytes + static_cast<std::uint64_t>(header.integer(23));
  return read_raw_volume(volume, path, {});
}

}  // namespace tetravox::io
