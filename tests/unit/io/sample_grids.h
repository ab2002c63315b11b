#pragma once

/// Small files of every format of grids, made at run time, that all hold the same grid: 4 x 3 x 5 points, values
/// `sample_value(i, j, k)`, spacing (0.5, 1, 2), origin (10, 20, 30) where the format has one.

#include "tests/unit/io/sample_files.h"
#include "tetravox/dataset.h"

#include <cstddef>
#include <cstdint>
#include <ostream>
#include <string>
#include <vector>

namespace tetravox::test {

inline constexpr std::size_t kSampleSize[3] = {4, 3, 5};
inline constexpr std::size_t kSamplePoints = 4 * 3 * 5;

/// Value at a point; below 256 and different at each.
inline int sample_value(std::size_t i, std::size_t j, std::size_t k) {
  return static_cast<int>(1 + i + 4 * j + 12 * k);
}

/// `main_file` may be empty: the directory itself is read.
struct GridSample : Sample {
  ScalarType type = ScalarType::kUint8;
  bool has_spacing = true;
  bool has_origin = true;
};

/// How GoogleTest prints a sample.
inline void PrintTo(const GridSample& sample, std::ostream* out) { *out << sample.name; }

const std::vector<GridSample>& grid_samples();

/// The sample's values as bytes of this number type.
std::string sample_bytes(ScalarType type, bool is_big_endian = false);

/// All values of a grid as doubles, [values][components].
std::vector<double> grid_values(const GridData& grid);

/// Text compressed as zlib or gzip do.
std::string deflate_text(const std::string& text, bool is_gzip);

/// Appends the bytes of a number.
void append_bytes(std::string& out, const void* value, std::size_t size, bool is_big_endian);
template <class T>
void append_number(std::string& out, T value, bool is_big_endian = false) {
  append_bytes(out, &value, sizeof value, is_big_endian);
}

// Parts of files that tests vary.
/// A NIfTI-1 header of the sample, 352 bytes, without sform or qform.
std::string nifti_header(std::int16_t datatype, std::int16_t bits);
template <class T>
void set_number(std::string& bytes, std::size_t at, T value) {
  std::string number;
  append_number(number, value);
  bytes.replace(at, number.size(), number);
}
/// One slice of the sample as a DICOM file of 16 bits a pixel, explicit little endian; `extra` elements come before the
/// pixels.
std::string dicom_slice(std::size_t k, const std::string& extra = {});
/// An element, explicit little endian.
std::string dicom_element(std::uint16_t group, std::uint16_t element, const std::string& type, std::string value);
/// A TIFF file of pages of bytes, rows from the top.
std::string tiff_file(const std::vector<std::string>& pages, std::uint32_t width, std::uint32_t height);
/// An MRC header of the sample, 1024 bytes.
std::string mrc_header(std::int32_t mode);

}  // namespace tetravox::test
