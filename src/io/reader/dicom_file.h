#pragma once

/// One DICOM file (DICOM PS3.5 "Data Structures and Encoding", PS3.10 "Media Storage and File Format"): what is needed
/// to place and read its pixels. Uncompressed transfer syntaxes only.

#include "tetravox/dataset.h"

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace tetravox::io {

using Vector3 = std::array<double, 3>;

struct DicomFile {
  std::string name;
  std::string series;                    ///< its UID
  std::string photometric;               ///< "MONOCHROME2", "RGB", ...
  std::optional<std::int64_t> instance;  ///< number in its series
  std::uint64_t rows = 0, columns = 0;
  std::uint64_t frames = 1;
  std::uint64_t samples = 1;  ///< components
  bool is_planar = false;     ///< components after each other, in each frame
  unsigned bits_allocated = 0, bits_stored = 0, high_bit = 0;
  bool is_signed = false;
  bool is_big_endian = false;
  double slope = 1.0, intercept = 0.0;               ///< value = stored * slope + intercept
  std::array<double, 2> pixel_spacing{1, 1};         ///< between rows, between columns; mm
  double thickness = 0.0;                            ///< distance of slices as far as one file tells; 0: not at all
  std::vector<Vector3> positions;                    ///< of the first pixel; one, one a frame, or none
  std::optional<std::array<double, 6>> orientation;  ///< along a row, along a column
  std::string_view pixels;                           ///< into the bytes that were parsed; empty: no image

  std::uint64_t frame_bytes() const { return rows * columns * samples * (bits_allocated / 8); }
};

/// Parses the bytes of a file called `name`, which must outlive the result.
/// @throws Error: kBadFile where it is damaged or its pixels are not all there, kUnsupported where they are compressed.
DicomFile parse_dicom(std::string_view bytes, const std::string& name);

}  // namespace tetravox::io
