#pragma once

/// NumPy arrays of numbers, read.

#include <cstddef>
#include <string>
#include <vector>

namespace tetravox::io {

/// An array in C order: the last axis fastest.
struct NpyArray {
  std::vector<std::size_t> shape;
  std::vector<float> values;
  bool is_whole = false;  ///< bytes, not floats
};

/// Reads an .npy file (version 1 to 3) of float32, float64 or uint8 in C order, little-endian. `largest`: numbers that
/// it may hold.
/// @throws Error that names the file: kFileNotFound; kBadFile for what is no such file or has another length than its
/// shape says; kUnsupported for other types and orders and for larger arrays.
NpyArray read_npy(const std::string& path, std::size_t largest);

}  // namespace tetravox::io
