#include "src/io/reader/collect.h"
#include "src/support/threads.h"

#include <vtkCellData.h>
#include <vtkDataArray.h>
#include <vtkDataSetAttributes.h>
#include <vtkPointData.h>
#include <vtkSetGet.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <mutex>
#include <string_view>
#include <type_traits>
#include <utility>

namespace tetravox::io {

namespace {

constexpr std::size_t kGrain = std::size_t{1} << 15;
/// More components than this are not a field that one could draw.
constexpr int kMostComponents = 4096;

std::string type_name(int vtk_type) {
  switch (vtk_type) {
    case VTK_BIT:
      return "bit";
    case VTK_FLOAT:
      return "float32";
    case VTK_DOUBLE:
      return "float64";
    default:
      break;
  }
  const int bits = 8 * vtkDataArray::GetDataTypeSize(vtk_type);
  const bool is_signed = vtkDataArray::GetDataTypeMin(vtk_type) < 0.0;
  return (is_signed ? "int" : "uint") + std::to_string(bits);
}

vtkDataSetAttributes& attributes_of(const Block& block, Association association) {
  vtkDataSet& data = *block.data;
  if (association == Association::kPoint) return *data.GetPointData();
  return *data.GetCellData();
}

/// The array's name as it is shown and asked for.
std::string shown_name(vtkDataArray& array) {
  const std::string name = clean_line(array.GetName() ? array.GetName() : "", 200);
  return name.empty() ? "unnamed" : name;
}

bool is_marker(vtkDataArray& array) {
  return array.GetName() && std::strcmp(array.GetName(), vtkDataSetAttributes::GhostArrayName()) == 0;
}

/// Ranges and missing values of part of an array.
struct Statistics {
  std::vector<ValueRange> components;
  ValueRange magnitude;
  std::uint64_t missing = 0;

  static constexpr double kInfinity = std::numeric_limits<double>::infinity();
  explicit Statistics(int count)
      : components(static_cast<std::size_t>(count), {kInfinity, -kInfinity}), magnitude{kInfinity, -kInfinity} {}

  static void add(ValueRange& range, double value) {
    range.min = std::min(range.min, value);
    range.max = std::max(range.max, value);
  }
  static void add(ValueRange& range, const ValueRange& other) {
    range.min = std::min(range.min, other.min);
    range.max = std::max(range.max, other.max);
  }
  void merge(const Statistics& other) {
    for (std::size_t c = 0; c < components.size(); ++c) add(components[c], other.components[c]);
    add(magnitude, other.magnitude);
    missing += other.missing;
  }
};

template <class T>
double value_as_double(T value) {
  return static_cast<double>(value);
}

/// Which tuples count; an empty mask: all.
bool counts(std::span<const std::uint8_t> mask, std::size_t tuple) { return mask.empty() || mask[tuple]; }

/// Adds whole numbers [first, last), which are all finite.
template <class T>
void add_whole_numbers(const T* values, std::size_t first, std::size_t last, Statistics& statistics) {
  T least = values[first], most = values[first];
  for (std::size_t i = first + 1; i < last; ++i) {
    least = std::min(least, values[i]);
    most = std::max(most, values[i]);
  }
  const ValueRange range{value_as_double(least), value_as_double(most)};
  Statistics::add(statistics.components[0], range);
  Statistics::add(statistics.magnitude, range);
}

/// Adds tuples [first, last) of plain memory to `statistics`, where `mask` says so.
template <class T>
void add_tuples(const T* values, std::size_t components, std::span<const std::uint8_t> mask, std::size_t first,
                std::size_t last, Statistics& statistics) {
  if constexpr (std::is_integral_v<T>)
    if (mask.empty() && components == 1 && first < last) return add_whole_numbers(values, first, last, statistics);
  for (std::size_t i = first; i < last; ++i) {
    if (!counts(mask, i)) continue;
    const T* tuple = values + i * components;
    double square_sum = 0.0;
    bool is_finite = true;
    for (std::size_t c = 0; c < components; ++c) {
      const double value = value_as_double(tuple[c]);
      if (std::isfinite(value))
        Statistics::add(statistics.components[c], value);
      else
        is_finite = false;
      square_sum += value * value;
    }
    if (is_finite)
      Statistics::add(statistics.magnitude, components == 1 ? value_as_double(tuple[0]) : std::sqrt(square_sum));
    else
      ++statistics.missing;
  }
}

/// The same for arrays of any layout.
void add_tuples_slowly(vtkDataArray& array, std::span<const std::uint8_t> mask, std::size_t first, std::size_t last,
                       Statistics& statistics) {
  const auto components = static_cast<std::size_t>(array.GetNumberOfComponents());
  std::vector<double> tuple(components);
  const std::uint8_t one = 1;
  for (std::size_t i = first; i < last; ++i) {
    if (!counts(mask, i)) continue;
    for (std::size_t c = 0; c < components; ++c)
      tuple[c] = array.GetComponent(static_cast<vtkIdType>(i), static_cast<int>(c));
    add_tuples(tuple.data(), components, {&one, 1}, 0, 1, statistics);
  }
}

void add_part(vtkDataArray& array, std::span<const std::uint8_t> mask, std::size_t first, std::size_t last,
              Statistics& statistics) {
  const auto components = static_cast<std::size_t>(array.GetNumberOfComponents());
  if (array.HasStandardMemoryLayout() && array.GetDataType() != VTK_BIT) {
    switch (array.GetDataType()) {
      vtkTemplateMacro(
          add_tuples(static_cast<const VTK_TT*>(array.GetVoidPointer(0)), components, mask, first, last, statistics));
    }
    return;
  }
  add_tuples_slowly(array, mask, first, last, statistics);
}

void add_array(vtkDataArray& array, std::span<const std::uint8_t> mask, Statistics& statistics) {
  std::mutex mutex;
  support::parallel_chunks(static_cast<std::size_t>(array.GetNumberOfTuples()), kGrain,
                           [&](std::size_t begin, std::size_t end) {
                             Statistics part(array.GetNumberOfComponents());
                             add_part(array, mask, begin, end, part);
                             const std::lock_guard lock(mutex);
                             statistics.merge(part);
                           });
}

ValueRange finite_range(const ValueRange& range) { return range.min <= range.max ? range : ValueRange{}; }

/// Fills in ranges and missing values of one array over all blocks.
void measure_array(const std::vector<Block>& blocks, ArrayInfo& info) {
  Statistics statistics(info.components);
  for (const Block& block : blocks) {
    const auto& mask = info.association == Association::kPoint ? block.is_point_used : block.is_drawn;
    if (vtkDataArray* array = find_array(block, info))
      add_array(*array, mask, statistics);
    else
      statistics.missing += static_cast<std::uint64_t>(std::count(mask.begin(), mask.end(), 1));
  }
  info.component_ranges = statistics.components;
  for (ValueRange& range : info.component_ranges) range = finite_range(range);
  info.magnitude_range = finite_range(statistics.magnitude);
  info.nan_count = statistics.missing;
}

void check_length(vtkDataArray& array, const Block& block, Association association, const std::string& file) {
  const std::uint64_t tuples = association == Association::kPoint ? block.point_count : block.all_cells;
  if (static_cast<std::uint64_t>(array.GetNumberOfTuples()) != tuples)
    fail_file(file, "array '" + shown_name(array) + "' has " + std::to_string(array.GetNumberOfTuples()) +
                        " values instead of " + std::to_string(tuples));
}

/// Lists the arrays of one association, each once.
void list_arrays(const std::vector<Block>& blocks, Association association, const std::string& file,
                 std::vector<ArrayInfo>& infos) {
  for (const Block& block : blocks) {
    vtkDataSetAttributes& attributes = attributes_of(block, association);
    for (int i = 0; i < attributes.GetNumberOfArrays(); ++i) {
      vtkDataArray* array = attributes.GetArray(i);  // Null for arrays of text.
      if (!array || is_marker(*array) || array->GetNumberOfComponents() < 1 ||
          array->GetNumberOfComponents() > kMostComponents)
        continue;
      check_length(*array, block, association, file);
      ArrayInfo info;
      info.name = shown_name(*array);
      info.association = association;
      info.components = array->GetNumberOfComponents();
      info.type = type_name(array->GetDataType());
      const bool is_known = std::any_of(infos.begin(), infos.end(), [&](const ArrayInfo& known) {
        return known.name == info.name && known.association == association && known.components == info.components;
      });
      if (!is_known) infos.push_back(std::move(info));
    }
  }
}

/// Converts `count` tuples of plain memory.
template <class T>
void convert_plain(const T* tuples, std::size_t components, int component, std::size_t count, double* values) {
  for (std::size_t i = 0; i < count; ++i, tuples += components) {
    if (component != kMagnitude) {
      values[i] = value_as_double(tuples[component]);
      continue;
    }
    double square_sum = 0.0;
    for (std::size_t c = 0; c < components; ++c) square_sum += value_as_double(tuples[c]) * value_as_double(tuples[c]);
    values[i] = std::sqrt(square_sum);
  }
}

}  // namespace

vtkDataArray* find_array(const Block& block, const ArrayInfo& info) {
  vtkDataSetAttributes& attributes = attributes_of(block, info.association);
  for (int i = 0; i < attributes.GetNumberOfArrays(); ++i) {
    vtkDataArray* array = attributes.GetArray(i);
    if (array && !is_marker(*array) && array->GetNumberOfComponents() == info.components &&
        shown_name(*array) == info.name)
      return array;
  }
  return nullptr;
}

void convert_values(vtkDataArray& array, int component, std::size_t first, std::size_t count, double* values) {
  const auto components = static_cast<std::size_t>(array.GetNumberOfComponents());
  if (array.HasStandardMemoryLayout() && array.GetDataType() != VTK_BIT) {
    switch (array.GetDataType()) {
      vtkTemplateMacro(convert_plain(static_cast<const VTK_TT*>(array.GetVoidPointer(0)) + first * components,
                                     components, component, count, values));
    }
    return;
  }
  std::vector<double> tuple(components);
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t c = 0; c < components; ++c)
      tuple[c] = array.GetComponent(static_cast<vtkIdType>(first + i), static_cast<int>(c));
    convert_plain(tuple.data(), components, component, 1, values + i);
  }
}

std::vector<ArrayInfo> examine_arrays(const std::vector<Block>& blocks, const std::string& file,
                                      std::vector<std::string>& notes) {
  std::vector<ArrayInfo> infos;
  list_arrays(blocks, Association::kPoint, file, infos);
  list_arrays(blocks, Association::kCell, file, infos);
  for (ArrayInfo& info : infos) {
    measure_array(blocks, info);
    const auto lacking =
        std::count_if(blocks.begin(), blocks.end(), [&](const Block& b) { return !find_array(b, info); });
    if (lacking > 0)
      notes.push_back("array '" + info.name + "' is missing in " + std::to_string(lacking) + " of " +
                      std::to_string(blocks.size()) + " blocks, which are transparent when it is drawn");
  }
  return infos;
}

void write_scalars(const std::vector<Block>& blocks, const ArrayInfo& info, int component, double* scalars) {
  for (const Block& block : blocks) {
    vtkDataArray* array = find_array(block, info);
    const bool is_point = info.association == Association::kPoint;
    double* out = scalars + (is_point ? block.first_point : block.first_cell);
    if (!array) {
      std::fill_n(out, is_point ? block.point_count : block.cell_count, std::numeric_limits<double>::quiet_NaN());
    } else if (is_point || block.cell_count == block.all_cells) {
      support::parallel_chunks(is_point ? block.point_count : block.all_cells, kGrain,
                               [&](std::size_t begin, std::size_t end) {
                                 convert_values(*array, component, begin, end - begin, out + begin);
                               });
    } else {
      for (std::size_t cell = 0; cell < block.all_cells; ++cell)
        if (block.is_drawn[cell]) convert_values(*array, component, cell, 1, out++);
    }
  }
}

}  // namespace tetravox::io
