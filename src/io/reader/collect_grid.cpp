// One block of VTK -> a regular grid: its lattice, and its values as they are.

#include "src/io/reader/collect.h"
#include "src/io/validate_grid.h"
#include "src/support/threads.h"

#include <vtkCellData.h>
#include <vtkDataArray.h>
#include <vtkDataSetAttributes.h>
#include <vtkImageData.h>
#include <vtkMatrix3x3.h>
#include <vtkPointData.h>
#include <vtkRectilinearGrid.h>

#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstring>

namespace tetravox::io {

namespace {

/// Coordinates count as evenly spaced where they are, to this part of the spacing.
constexpr double kEvenWithin = 1e-6;
/// Values are moved in pieces of this size, bytes; smaller arrays do not give their memory back.
constexpr std::size_t kMoveBytes = std::size_t{16} << 20;
constexpr std::size_t kGrain = std::size_t{1} << 16;

/// Whether a cell or point is marked as a duplicate or hidden.
bool has_marks(vtkDataSet& data) {
  for (vtkDataSetAttributes* attributes : {static_cast<vtkDataSetAttributes*>(data.GetPointData()),
                                           static_cast<vtkDataSetAttributes*>(data.GetCellData())}) {
    vtkDataArray* marks = attributes->GetArray(vtkDataSetAttributes::GhostArrayName());
    if (!marks) continue;
    double range[2] = {0.0, 0.0};
    marks->GetRange(range);
    if (range[1] != 0.0) return true;
  }
  return false;
}

/// Puts an axis' coordinates into the shape: as a spacing where they are even, turned where they descend. False where
/// they neither ascend nor descend strictly.
bool set_axis(vtkDataArray& array, std::size_t axis, GridShape& shape) {
  const auto count = static_cast<std::size_t>(array.GetNumberOfTuples());
  if (count != shape.dimensions[axis]) return false;
  std::vector<double> values(count);
  convert_values(array, 0, 0, count, values.data());
  for (const double value : values)
    if (!std::isfinite(value)) return false;
  if (count < 2) return true;
  const double sign = values[1] < values[0] ? -1.0 : 1.0;
  for (double& value : values) value *= sign;
  for (std::size_t i = 1; i < count; ++i)
    if (!(values[i] > values[i - 1])) return false;
  shape.direction[4 * axis] = sign;
  const double spacing = (values.back() - values.front()) / static_cast<double>(count - 1);
  if (!std::isfinite(spacing)) return false;
  bool is_even = true;
  for (std::size_t i = 0; i < count && is_even; ++i)
    is_even = std::abs(values[i] - (values.front() + static_cast<double>(i) * spacing)) <= kEvenWithin * spacing;
  if (is_even) {
    shape.origin[axis] = sign * values.front();
    shape.spacing[axis] = spacing;
  } else {
    shape.coordinates[axis] = std::move(values);
  }
  return true;
}

std::optional<GridShape> shape_of_rectilinear(vtkRectilinearGrid& grid) {
  GridShape shape;
  int dimensions[3];
  grid.GetDimensions(dimensions);
  vtkDataArray* const arrays[3] = {grid.GetXCoordinates(), grid.GetYCoordinates(), grid.GetZCoordinates()};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    shape.dimensions[axis] = static_cast<std::uint32_t>(std::max(dimensions[axis], 0));
    if (!arrays[axis] || !set_axis(*arrays[axis], axis, shape)) return std::nullopt;
  }
  return shape;
}

/// The lattice of an image; what makes no sense of its origin, spacing and direction becomes 0, 1 and the identity.
GridShape shape_of_image(vtkImageData& image, std::vector<std::string>& notes) {
  GridShape shape;
  std::array<int, 6> extent{};
  image.GetExtent(extent.data());
  const double* matrix = image.GetDirectionMatrix()->GetData();
  std::copy(matrix, matrix + 9, shape.direction.begin());
  image.GetSpacing(shape.spacing.data());
  image.GetOrigin(shape.origin.data());
  mend_orientation(shape, notes);
  std::array<double, 3> first{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    shape.dimensions[axis] = static_cast<std::uint32_t>(std::max(extent[2 * axis + 1] - extent[2 * axis] + 1, 0));
    first[axis] = extent[2 * axis] * shape.spacing[axis];
  }
  for (std::size_t row = 0; row < 3; ++row)
    for (std::size_t axis = 0; axis < 3; ++axis) shape.origin[row] += shape.direction[3 * row + axis] * first[axis];
  return shape;
}

/// Positions along k that were read apart from the image.
void set_slices(const std::vector<double>& slices, GridShape& shape) {
  if (slices.size() == shape.dimensions[2] && slices.size() > 1) shape.coordinates[2] = slices;
}

ScalarType scalar_type_of(vtkDataArray& array) {
  if (array.GetDataType() == VTK_FLOAT) return ScalarType::kFloat32;
  if (array.GetDataType() == VTK_DOUBLE) return ScalarType::kFloat64;
  const bool is_signed = array.GetDataTypeMin() < 0.0;
  switch (array.GetDataTypeSize()) {
    case 1:
      return is_signed ? ScalarType::kInt8 : ScalarType::kUint8;
    case 2:
      return is_signed ? ScalarType::kInt16 : ScalarType::kUint16;
    case 4:
      return is_signed ? ScalarType::kInt32 : ScalarType::kUint32;
    default:
      return is_signed ? ScalarType::kInt64 : ScalarType::kUint64;
  }
}

/// Copies bytes piece by piece, and gives the whole pages of each piece back to the system.
void move_bytes(std::byte* from, std::byte* to, std::size_t size) {
  const auto page = static_cast<std::uintptr_t>(sysconf(_SC_PAGESIZE));
  for (std::size_t done = 0; done < size; done += kMoveBytes) {
    const std::size_t count = std::min(kMoveBytes, size - done);
    std::memcpy(to + done, from + done, count);
    const auto begin = (reinterpret_cast<std::uintptr_t>(from + done) + page - 1) / page * page;
    const auto end = reinterpret_cast<std::uintptr_t>(from + done + count) / page * page;
    if (count == kMoveBytes && begin < end) madvise(reinterpret_cast<void*>(begin), end - begin, MADV_DONTNEED);
  }
}

std::array<ValueRange, 3> bounds_of(const GridShape& shape) {
  std::array<ValueRange, 3> bounds;
  for (std::size_t row = 0; row < 3; ++row) {
    bounds[row] = {shape.origin[row], shape.origin[row]};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const auto& uneven = shape.coordinates[axis];
      const double first = uneven.empty() ? 0.0 : uneven.front();
      const double last = uneven.empty() ? (shape.dimensions[axis] - 1.0) * shape.spacing[axis] : uneven.back();
      const double part = shape.direction[3 * row + axis];
      const auto [low, high] = std::minmax({part * first, part * last});
      bounds[row].min += low;
      bounds[row].max += high;
    }
  }
  return bounds;
}

}  // namespace

std::optional<GridBlock> find_grid(const FileContents& contents, std::vector<std::string>& notes) {
  if (contents.blocks.size() != 1) return std::nullopt;
  vtkDataSet& data = *contents.blocks.front();
  GridBlock grid;
  if (auto* image = vtkImageData::SafeDownCast(&data)) {
    grid.shape = shape_of_image(*image, notes);
    set_slices(contents.slice_coordinates, grid.shape);
  } else if (auto* rectilinear = vtkRectilinearGrid::SafeDownCast(&data)) {
    const auto shape = shape_of_rectilinear(*rectilinear);
    if (!shape) return std::nullopt;
    grid.shape = *shape;
  } else {
    return std::nullopt;
  }
  if (has_marks(data)) return std::nullopt;
  grid.block.data = &data;
  grid.block.point_count = static_cast<std::uint64_t>(data.GetNumberOfPoints());
  grid.block.cell_count = grid.block.all_cells = static_cast<std::uint64_t>(data.GetNumberOfCells());
  return grid;
}

bool is_flat(const GridShape& shape) { return *std::min_element(shape.dimensions.begin(), shape.dimensions.end()) < 2; }

void examine_grid(const GridBlock& grid, const std::string& file, DatasetInfo& info) {
  const GridShape& shape = grid.shape;
  std::uint64_t points = 1;
  for (const std::uint32_t count : shape.dimensions) points *= count;
  if (points != grid.block.point_count) fail_file(file, "its extent does not fit its number of points");
  info.point_count = points;
  if (is_flat(shape)) {
    info.left_out.lower_dimension = grid.block.all_cells;
    return;
  }
  info.cell_count = grid.block.all_cells;
  info.grid = shape;
  info.bounds = bounds_of(shape);
  for (const ValueRange& range : info.bounds)
    if (!std::isfinite(range.min) || !std::isfinite(range.max)) fail_file(file, "its bounds are not finite");
}

GridValues plan_grid_values(vtkDataArray& array, int component) {
  GridValues plan;
  const int components = array.GetNumberOfComponents();
  const auto tuples = static_cast<std::uint64_t>(array.GetNumberOfTuples());
  plan.is_raw = components <= 4 && array.HasStandardMemoryLayout() && array.GetDataType() != VTK_BIT;
  if (plan.is_raw) {
    plan.type = scalar_type_of(array);
    plan.components = components;
    plan.component = component;
  } else if (array.GetDataType() == VTK_BIT && components == 1) {
    plan.type = ScalarType::kUint8;
  }
  plan.bytes = tuples * static_cast<std::uint64_t>(plan.components) * scalar_type_size(plan.type);
  return plan;
}

void move_grid_values(vtkDataArray& array, const GridValues& plan, int component, std::byte* values) {
  const auto tuples = static_cast<std::size_t>(array.GetNumberOfTuples());
  if (plan.is_raw) return move_bytes(static_cast<std::byte*>(array.GetVoidPointer(0)), values, plan.bytes);
  if (plan.type == ScalarType::kUint8) {
    for (std::size_t i = 0; i < tuples; ++i)
      values[i] = static_cast<std::byte>(array.GetComponent(static_cast<vtkIdType>(i), 0) != 0.0);
    return;
  }
  auto* out = reinterpret_cast<double*>(values);
  support::parallel_chunks(tuples, kGrain, [&](std::size_t begin, std::size_t end) {
    convert_values(array, component, begin, end - begin, out + begin);
  });
}

}  // namespace tetravox::io
