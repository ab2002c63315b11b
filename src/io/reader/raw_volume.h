#pragma once

/// Volumes whose files are a header and numbers in a row: NRRD, MetaImage, NIfTI, MRC. Their headers are parsed here
/// and not by VTK 9.1, which drops orientations, takes zeros for values that are missing, and cannot inflate NRRD; the
/// values are read once, into the place they are handed over from.

#include "src/io/formats.h"
#include "src/io/reader/blocks.h"
#include "src/io/reader/volume_stream.h"
#include "tetravox/dataset.h"

#include <vtkImageData.h>
#include <vtkSmartPointer.h>

#include <array>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace tetravox::io {

/// Position of the first value, and the steps from one value to the next along i, j, k, world units.
struct VolumeFrame {
  std::array<double, 3> origin{};
  std::array<std::array<double, 3>, 3> steps{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
};

struct RawVolume {
  std::array<std::uint64_t, 3> points{1, 1, 1};
  std::uint64_t components = 1;
  bool is_planar = false;  ///< all values of one component, of all time steps, before those of the next
  ScalarType type = ScalarType::kUint8;
  bool is_big_endian = false;
  bool is_text = false;
  std::string array_name;
  VolumeFrame frame;
  std::vector<double> times;  ///< time steps, slowest but for planar components; empty: one volume
  VolumeFiles files;
};

/// Reads the step that is asked for.
/// @throws Error (kBadFile) that names `path` or the data file.
FileContents read_raw_volume(const RawVolume& volume, const std::string& path, const TimeRequest& time);

/// An image of uninitialised values. @throws Error (kBadFile) for sizes that make no sense.
vtkSmartPointer<vtkImageData> make_image(const std::array<std::uint64_t, 3>& points, std::uint64_t components,
                                         ScalarType type, const std::string& array_name, const std::string& path);
/// Its values.
std::span<std::byte> image_bytes(vtkImageData& image);
/// The product of all sizes and of the number type's, checked. @throws Error (kBadFile).
std::uint64_t count_bytes(std::span<const std::uint64_t> sizes, ScalarType type, const std::string& path);
/// Puts the frame into the image; what makes no sense of it is replaced, and `notes` say so.
void set_frame(vtkImageData& image, const VolumeFrame& frame, std::vector<std::string>& notes);

// Helpers for headers in text.
std::string_view trim(std::string_view text);
std::vector<std::string> split_words(std::string_view text);
/// A number that takes up the whole word; "nan" and "inf" are numbers.
std::optional<double> to_double(std::string_view word);
std::optional<std::int64_t> to_integer(std::string_view word);
/// The words as numbers. @throws Error (kBadFile) that names `field` where one is not.
std::vector<double> to_doubles(std::string_view text, const std::string& field, const std::string& path);
/// The words as positive whole numbers. @throws Error (kBadFile).
std::vector<std::uint64_t> to_sizes(std::string_view text, const std::string& field, const std::string& path);
/// Names made from a pattern with one %d (of any width), for first, first + step, ... last.
/// @throws Error (kBadFile) for another pattern or too many names.
std::vector<std::string> expand_pattern(const std::string& pattern, std::int64_t first, std::int64_t last,
                                        std::int64_t step, const std::string& path);

}  // namespace tetravox::io
