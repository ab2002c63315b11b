#include "src/io/reader/raw_volume.h"

#include "src/io/byte_order.h"
#include "src/io/collections.h"
#include "src/io/reader/file_checks.h"
#include "src/io/reader/status.h"
#include "src/io/time_steps.h"
#include "src/io/validate_grid.h"
#include "src/support/threads.h"

#include <vtkDataArray.h>
#include <vtkPointData.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstring>
#include <limits>

namespace tetravox::io {

namespace {

constexpr std::string_view kBlanks = " \t\r\n\v\f";
constexpr std::size_t kGrain = std::size_t{1} << 16;
/// Values are read in pieces of this size, bytes, with progress in between.
constexpr std::size_t kPieceBytes = std::size_t{16} << 20;
/// More components than this are not a field that one could draw.
constexpr std::uint64_t kMostComponents = 4096;

int vtk_type(ScalarType type) {
  constexpr int kTypes[] = {VTK_SIGNED_CHAR, VTK_UNSIGNED_CHAR, VTK_SHORT,     VTK_UNSIGNED_SHORT,
                            VTK_INT,         VTK_UNSIGNED_INT,  VTK_LONG_LONG, VTK_UNSIGNED_LONG_LONG,
                            VTK_FLOAT,       VTK_DOUBLE};
  return kTypes[static_cast<std::size_t>(type)];
}

/// Reads `out` with progress: `done` of `all` bytes were there before.
void read_with_progress(VolumeStream& stream, std::span<std::byte> out, std::uint64_t done, std::uint64_t all) {
  for (std::size_t at = 0; at < out.size(); at += kPieceBytes) {
    stream.read(out.subspan(at, std::min(kPieceBytes, out.size() - at)));
    const double read = static_cast<double>(done) + static_cast<double>(at);
    send_progress(0.9 * read / static_cast<double>(std::max<std::uint64_t>(all, 1)));
  }
}

/// Puts component `c` of `count` among the values of all.
void spread_component(std::span<const std::byte> plane, std::size_t value_size, std::size_t c, std::size_t count,
                      std::span<std::byte> values) {
  support::parallel_chunks(plane.size() / value_size, kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      std::memcpy(values.data() + (i * count + c) * value_size, plane.data() + i * value_size, value_size);
  });
}

/// Reads binary values; returns bytes of the file that are left over.
std::uint64_t read_binary(const RawVolume& volume, std::size_t step, std::span<std::byte> values) {
  const std::uint64_t steps = std::max<std::uint64_t>(volume.times.size(), 1);
  VolumeStream stream(volume.files, values.size() * steps);
  if (volume.is_planar && volume.components > 1) {
    const std::size_t size = values.size() / static_cast<std::size_t>(volume.components);
    std::vector<std::byte> plane(size);
    for (std::size_t c = 0; c < volume.components; ++c) {
      stream.skip(size * step);
      read_with_progress(stream, plane, c * size, values.size());
      stream.skip(size * (steps - 1 - step));
      spread_component(plane, scalar_type_size(volume.type), c, static_cast<std::size_t>(volume.components), values);
    }
  } else {
    stream.skip(values.size() * step);
    read_with_progress(stream, values, 0, values.size());
    // A compressed stream is followed to its end, where its checksum is.
    if (volume.files.is_compressed) stream.skip(values.size() * (steps - 1 - step));
  }
  to_native_order(values, scalar_type_size(volume.type), volume.is_big_endian);
  return step + 1 == steps || volume.files.is_compressed ? stream.count_rest() : 0;
}

/// Looks whether the files can hold `bytes`. @throws Error that names the header as well as the data file.
void check_files(const VolumeFiles& files, std::uint64_t bytes, const std::string& path) {
  try {
    VolumeStream(files, bytes);
  } catch (const Error& error) {
    if (files.paths.front() == path) throw;
    throw Error(error.code(), "'" + path + "': " + error.what());
  }
}

/// Converts the next `count` words of `text`; false where there are fewer, or one is no number of this type.
template <class T>
bool convert_words(std::string_view& text, std::size_t count, T* out) {
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t begin = text.find_first_not_of(kBlanks);
    if (begin == std::string_view::npos) return false;
    const std::size_t end = std::min(text.find_first_of(kBlanks, begin), text.size());
    const auto value = to_double(text.substr(begin, end - begin));
    if (!value) return false;
    if constexpr (std::is_integral_v<T>) {
      const auto whole = to_integer(text.substr(begin, end - begin));
      if (!whole && sizeof(T) < 8) return false;
      if (sizeof(T) < 8 && (*whole < static_cast<std::int64_t>(std::numeric_limits<T>::min()) ||
                            *whole > static_cast<std::int64_t>(std::numeric_limits<T>::max())))
        return false;
      out[i] = whole ? static_cast<T>(*whole) : static_cast<T>(*value);
    } else {
      out[i] = static_cast<T>(*value);
    }
    text.remove_prefix(end);
  }
  return true;
}

bool convert_text(std::string_view& text, ScalarType type, std::span<std::byte> values) {
  const auto convert = [&]<class T>(T*) {
    return convert_words(text, values.size() / sizeof(T), reinterpret_cast<T*>(values.data()));
  };
  switch (type) {
    case ScalarType::kInt8:
      return convert(static_cast<std::int8_t*>(nullptr));
    case ScalarType::kUint8:
      return convert(static_cast<std::uint8_t*>(nullptr));
    case ScalarType::kInt16:
      return convert(static_cast<std::int16_t*>(nullptr));
    case ScalarType::kUint16:
      return convert(static_cast<std::uint16_t*>(nullptr));
    case ScalarType::kInt32:
      return convert(static_cast<std::int32_t*>(nullptr));
    case ScalarType::kUint32:
      return convert(static_cast<std::uint32_t*>(nullptr));
    case ScalarType::kInt64:
      return convert(static_cast<std::int64_t*>(nullptr));
    case ScalarType::kUint64:
      return convert(static_cast<std::uint64_t*>(nullptr));
    case ScalarType::kFloat32:
      return convert(static_cast<float*>(nullptr));
    case ScalarType::kFloat64:
      return convert(static_cast<double*>(nullptr));
  }
  return false;
}

/// Reads values in text: all of one file, which may hold one step only.
void read_text(const RawVolume& volume, std::span<std::byte> values, const std::string& path) {
  if (volume.files.paths.size() != 1 || volume.times.size() > 1 || (volume.is_planar && volume.components > 1))
    throw Error(ErrorCode::kUnsupported,
                "'" + path + "' holds text of several volumes or files: write it with binary values");
  const std::string& file = volume.files.paths.front();
  const MappedFile mapped(file);
  std::string_view text = mapped.text();
  text.remove_prefix(static_cast<std::size_t>(std::min<std::uint64_t>(volume.files.offset, text.size())));
  if (!convert_text(text, volume.type, values))
    fail_file(file, "its text holds fewer values than it should, or something that is no number");
}

}  // namespace

std::uint64_t count_bytes(std::span<const std::uint64_t> sizes, ScalarType type, const std::string& path) {
  constexpr std::uint64_t kMost = std::uint64_t{1} << 56;
  std::uint64_t bytes = scalar_type_size(type);
  for (const std::uint64_t size : sizes)
    if (__builtin_mul_overflow(bytes, size, &bytes) || bytes > kMost) fail_file(path, "its dimensions make no sense");
  return bytes;
}

vtkSmartPointer<vtkImageData> make_image(const std::array<std::uint64_t, 3>& points, std::uint64_t components,
                                         ScalarType type, const std::string& array_name, const std::string& path) {
  for (const std::uint64_t count : points)
    if (count < 1 || count > std::numeric_limits<std::int32_t>::max()) fail_file(path, "its dimensions make no sense");
  if (components < 1 || components > kMostComponents) fail_file(path, "its number of components makes no sense");
  count_bytes(std::array{points[0], points[1], points[2], components}, type, path);
  auto image = vtkSmartPointer<vtkImageData>::New();
  image->SetDimensions(static_cast<int>(points[0]), static_cast<int>(points[1]), static_cast<int>(points[2]));
  const auto array = vtkSmartPointer<vtkDataArray>::Take(vtkDataArray::CreateDataArray(vtk_type(type)));
  array->SetName(array_name.c_str());
  array->SetNumberOfComponents(static_cast<int>(components));
  array->SetNumberOfTuples(image->GetNumberOfPoints());
  image->GetPointData()->SetScalars(array);
  return image;
}

std::span<std::byte> image_bytes(vtkImageData& image) {
  vtkDataArray& array = *image.GetPointData()->GetScalars();
  const auto size =
      static_cast<std::size_t>(array.GetNumberOfValues()) * static_cast<std::size_t>(array.GetDataTypeSize());
  return {static_cast<std::byte*>(array.GetVoidPointer(0)), size};
}

void set_frame(vtkImageData& image, const VolumeFrame& frame, std::vector<std::string>& notes) {
  GridShape shape;
  shape.origin = frame.origin;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto& step = frame.steps[axis];
    const double length = std::hypot(step[0], step[1], step[2]);
    shape.spacing[axis] = length;
    for (std::size_t row = 0; row < 3; ++row) shape.direction[3 * row + axis] = step[row] / length;
  }
  mend_orientation(shape, notes);
  image.SetDirectionMatrix(shape.direction.data());
  image.SetOrigin(shape.origin.data());
  image.SetSpacing(shape.spacing.data());
}

FileContents read_raw_volume(const RawVolume& volume, const std::string& path, const TimeRequest& time) {
  FileContents contents;
  contents.times = volume.times;
  contents.time_index = pick_time(contents.times, time, path);
  const std::uint64_t steps = std::max<std::uint64_t>(volume.times.size(), 1);
  const std::uint64_t all = count_bytes(
      std::array{volume.points[0], volume.points[1], volume.points[2], volume.components, steps}, volume.type, path);
  // Look at the files before memory is taken for what they may not hold.
  if (!volume.is_text) check_files(volume.files, all, path);
  const auto image = make_image(volume.points, volume.components, volume.type, volume.array_name, path);
  throw_if_vtk_failed(path);
  const std::span<std::byte> values = image_bytes(*image);
  if (volume.is_text)
    read_text(volume, values, path);
  else if (const std::uint64_t rest = read_binary(volume, contents.time_index, values); rest > 0)
    contents.notes.emplace_back("the data file goes on behind the volume, which its header may state too small");
  set_frame(*image, volume.frame, contents.notes);
  contents.blocks.emplace_back(image);
  return contents;
}

std::string_view trim(std::string_view text) {
  const std::size_t begin = text.find_first_not_of(kBlanks);
  if (begin == std::string_view::npos) return {};
  return text.substr(begin, text.find_last_not_of(kBlanks) - begin + 1);
}

std::vector<std::string> split_words(std::string_view text) {
  std::vector<std::string> words;
  for (std::size_t at = 0; (at = text.find_first_not_of(kBlanks, at)) != std::string_view::npos;) {
    const std::size_t end = std::min(text.find_first_of(kBlanks, at), text.size());
    words.emplace_back(text.substr(at, end - at));
    at = end;
  }
  return words;
}

std::optional<double> to_double(std::string_view word) {
  if (word.starts_with('+')) word.remove_prefix(1);
  double value = 0.0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc() || end != word.data() + word.size()) return std::nullopt;
  return value;
}

std::optional<std::int64_t> to_integer(std::string_view word) {
  if (word.starts_with('+')) word.remove_prefix(1);
  std::int64_t value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc() || end != word.data() + word.size()) return std::nullopt;
  return value;
}

std::vector<double> to_doubles(std::string_view text, const std::string& field, const std::string& path) {
  std::vector<double> values;
  for (const std::string& word : split_words(text)) {
    const auto value = to_double(word);
    if (!value) fail_file(path, "'" + field + "' is not made of numbers");
    values.push_back(*value);
  }
  return values;
}

std::vector<std::uint64_t> to_sizes(std::string_view text, const std::string& field, const std::string& path) {
  std::vector<std::uint64_t> values;
  for (const std::string& word : split_words(text)) {
    const auto value = to_integer(word);
    if (!value || *value < 1) fail_file(path, "'" + field + "' is not made of positive whole numbers");
    values.push_back(static_cast<std::uint64_t>(*value));
  }
  return values;
}

std::vector<std::string> expand_pattern(const std::string& pattern, std::int64_t first, std::int64_t last,
                                        std::int64_t step, const std::string& path) {
  const std::size_t percent = pattern.find('%');
  const std::size_t type = pattern.find('d', percent);
  std::size_t width = 0;
  const std::string digits =
      percent < type && type != std::string::npos ? pattern.substr(percent + 1, type - percent - 1) : "x";
  const bool is_number = std::all_of(digits.begin(), digits.end(), [](char c) { return c >= '0' && c <= '9'; });
  if (is_number && !digits.empty()) width = static_cast<std::size_t>(to_integer(digits).value_or(99));
  if (!is_number || width > 20 || pattern.find('%', percent + 1) != std::string::npos)
    fail_file(path, "the pattern of its data files makes no sense");
  constexpr std::int64_t kFarthest = std::int64_t{1} << 40;
  const bool is_far = std::max({std::abs(first), std::abs(last), std::abs(step)}) > kFarthest;
  if (is_far || step == 0 || (last - first) / step < 0 ||
      (last - first) / step >= static_cast<std::int64_t>(kMostCollectionFiles))
    fail_file(path, "the range of its data files makes no sense");
  const char fill = digits.starts_with('0') ? '0' : ' ';
  std::vector<std::string> names;
  for (std::int64_t i = 0; i <= (last - first) / step; ++i) {
    std::string number = std::to_string(first + i * step);
    if (number.size() < width) number.insert(0, width - number.size(), fill);
    names.push_back(pattern.substr(0, percent) + number + pattern.substr(type + 1));
  }
  return names;
}

}  // namespace tetravox::io
