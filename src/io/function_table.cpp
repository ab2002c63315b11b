/// Tables of functions of several variables, from pictures and arrays.

#include "src/io/formats.h"
#include "src/io/npy_file.h"
#include "src/io/table_image.h"

#include "tetravox/error.h"
#include "tetravox/io.h"

#include <algorithm>
#include <string>

namespace tetravox {
namespace {

constexpr std::size_t kLargestOfTwo = 1024, kLargestOfThree = 128;  // entries an axis

[[noreturn]] void fail(const std::string& path, const std::string& what) {
  throw Error(ErrorCode::kUnsupported, "'" + path + "': " + what);
}

/// The first variable to the right, the second one upwards.
FunctionTable table_from_image(const io::TableImage& image) {
  FunctionTable table;
  table.sizes = {image.width, image.height};
  const auto row = static_cast<std::ptrdiff_t>(4 * image.width);
  for (auto y = static_cast<std::ptrdiff_t>(image.height); y-- > 0;)
    table.rgba.insert(table.rgba.end(), image.rgba.begin() + y * row, image.rgba.begin() + (y + 1) * row);
  return table;
}

std::string describe(const std::vector<std::size_t>& shape) {
  std::string text;
  for (const std::size_t length : shape) text += (text.empty() ? "" : ", ") + std::to_string(length);
  return "(" + text + ")";
}

FunctionTable table_from_array(const std::string& path, io::NpyArray array, std::size_t variables) {
  const std::size_t largest = variables == 3 ? kLargestOfThree : kLargestOfTwo;
  const auto is_length = [&](std::size_t length) { return length >= 2 && length <= largest; };
  const bool has_shape = array.shape.size() == variables + 1 && array.shape.back() == 4 &&
                         std::all_of(array.shape.begin(), array.shape.end() - 1, is_length);
  if (!has_shape)
    fail(path, "an array of shape " + describe(array.shape) + " where a table of " + std::to_string(variables) +
                   " variables has " + (variables == 3 ? "(n3, n2, n1, 4)" : "(n2, n1, 4)") + ", each n from 2 to " +
                   std::to_string(largest));
  FunctionTable table;
  table.sizes.assign(array.shape.rbegin() + 1, array.shape.rend());
  table.rgba = std::move(array.values);
  if (array.is_whole)
    for (float& value : table.rgba) value /= 255.0f;
  return table;
}

}  // namespace

FunctionTable read_function_table(const std::string& path, std::size_t variables) {
  if (variables < 2 || variables > 3)
    throw Error(ErrorCode::kInvalidArgument, "a table has two or three variables, not " + std::to_string(variables));
  const bool is_png = io::has_ending(path, ".png"), is_exr = io::has_ending(path, ".exr");
  if (io::has_ending(path, ".npy"))
    return table_from_array(path, io::read_npy(path, 4 * kLargestOfThree * kLargestOfThree * kLargestOfThree),
                            variables);
  if (!is_png && !is_exr)
    throw Error(ErrorCode::kInvalidArgument, "'" + path + "' is no table: these end in .npy, .png or .exr");
  if (variables == 3) fail(path, "a picture has two variables: save a table of three as .npy, (n3, n2, n1, 4)");
  return table_from_image(is_png ? io::read_png_table(path, kLargestOfTwo) : io::read_exr_table(path, kLargestOfTwo));
}

}  // namespace tetravox
