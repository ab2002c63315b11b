#include "src/io/reader/collect.h"
#include "src/io/validate_mesh.h"
#include "src/support/threads.h"

#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkCellType.h>
#include <vtkDataArray.h>
#include <vtkDataSetAttributes.h>
#include <vtkIdTypeArray.h>
#include <vtkImageData.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkRectilinearGrid.h>
#include <vtkStructuredGrid.h>
#include <vtkTypeInt32Array.h>
#include <vtkTypeInt64Array.h>
#include <vtkUnsignedCharArray.h>
#include <vtkUnstructuredGrid.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

namespace tetravox::io {

namespace {

constexpr std::size_t kGrain = std::size_t{1} << 15;

/// What becomes of a cell.
enum class Fate : std::uint8_t { kLowerDimension, kDrawn, kGhost, kBlanked, kUnsupported };

/// Fate of a cell type by itself; empty for numbers that are no type of VTK.
std::optional<Fate> fate_of_type(int type) {
  if (corner_count(static_cast<CellType>(type)) > 0 || type == VTK_POLYHEDRON) return Fate::kDrawn;
  switch (type) {
    case VTK_CONVEX_POINT_SET:
    case VTK_PARAMETRIC_TETRA_REGION:
    case VTK_PARAMETRIC_HEX_REGION:
    case VTK_HIGHER_ORDER_TETRAHEDRON:
    case VTK_HIGHER_ORDER_WEDGE:
    case VTK_HIGHER_ORDER_PYRAMID:
    case VTK_HIGHER_ORDER_HEXAHEDRON:
    case VTK_LAGRANGE_TETRAHEDRON:
    case VTK_LAGRANGE_HEXAHEDRON:
    case VTK_LAGRANGE_WEDGE:
    case VTK_LAGRANGE_PYRAMID:
    case VTK_BEZIER_TETRAHEDRON:
    case VTK_BEZIER_HEXAHEDRON:
    case VTK_BEZIER_WEDGE:
    case VTK_BEZIER_PYRAMID:
      return Fate::kUnsupported;
    case VTK_QUADRATIC_EDGE:
    case VTK_QUADRATIC_TRIANGLE:
    case VTK_QUADRATIC_QUAD:
    case VTK_QUADRATIC_POLYGON:
    case VTK_BIQUADRATIC_QUAD:
    case VTK_QUADRATIC_LINEAR_QUAD:
    case VTK_BIQUADRATIC_TRIANGLE:
    case VTK_CUBIC_LINE:
    case VTK_PARAMETRIC_CURVE:
    case VTK_PARAMETRIC_SURFACE:
    case VTK_PARAMETRIC_TRI_SURFACE:
    case VTK_PARAMETRIC_QUAD_SURFACE:
    case VTK_HIGHER_ORDER_EDGE:
    case VTK_HIGHER_ORDER_TRIANGLE:
    case VTK_HIGHER_ORDER_QUAD:
    case VTK_HIGHER_ORDER_POLYGON:
    case VTK_LAGRANGE_CURVE:
    case VTK_LAGRANGE_TRIANGLE:
    case VTK_LAGRANGE_QUADRILATERAL:
    case VTK_BEZIER_CURVE:
    case VTK_BEZIER_TRIANGLE:
    case VTK_BEZIER_QUADRILATERAL:
      return Fate::kLowerDimension;
    default:
      break;
  }
  if (type >= VTK_EMPTY_CELL && type <= VTK_QUAD) return Fate::kLowerDimension;
  return std::nullopt;
}

/// Views the arrays of an unstructured grid after checking that they fit each other.
UnstructuredCells view_cells(vtkUnstructuredGrid& grid, const std::string& place) {
  UnstructuredCells view;
  const auto count = static_cast<std::size_t>(grid.GetNumberOfCells());
  vtkCellArray* cells = grid.GetCells();
  vtkUnsignedCharArray* types = grid.GetCellTypesArray();
  if (!types || static_cast<std::size_t>(types->GetNumberOfValues()) < count)
    fail_file(place, "cell types are missing");
  view.types = types->GetPointer(0);
  std::int64_t id_count = 0, offset_count = 0;
  if (cells->IsStorage64Bit()) {
    view.offsets64 = reinterpret_cast<const std::int64_t*>(cells->GetOffsetsArray64()->GetPointer(0));
    view.ids64 = reinterpret_cast<const std::int64_t*>(cells->GetConnectivityArray64()->GetPointer(0));
    offset_count = cells->GetOffsetsArray64()->GetNumberOfValues();
    id_count = cells->GetConnectivityArray64()->GetNumberOfValues();
  } else {
    view.offsets32 = cells->GetOffsetsArray32()->GetPointer(0);
    view.ids32 = cells->GetConnectivityArray32()->GetPointer(0);
    offset_count = cells->GetOffsetsArray32()->GetNumberOfValues();
    id_count = cells->GetConnectivityArray32()->GetNumberOfValues();
  }
  if (offset_count < static_cast<std::int64_t>(count) + 1) fail_file(place, "cell offsets are missing");
  for (std::size_t i = 0; i < count; ++i)
    if (view.offset(i) < 0 || view.offset(i + 1) < view.offset(i) || view.offset(i + 1) > id_count)
      fail_file(place, "cell " + std::to_string(i) + ": the cell offsets do not ascend within the connectivity");
  if (vtkIdTypeArray* faces = grid.GetFaces())
    view.faces = {faces->GetPointer(0), static_cast<std::size_t>(faces->GetNumberOfValues())};
  if (vtkIdTypeArray* locations = grid.GetFaceLocations())
    view.face_locations = {locations->GetPointer(0), static_cast<std::size_t>(locations->GetNumberOfValues())};
  return view;
}

/// The face stream of a polyhedron.
std::span<const vtkIdType> face_stream(const UnstructuredCells& cells, std::size_t cell, const std::string& place) {
  const auto fail = [&]() {
    fail_file(place, "cell " + std::to_string(cell) + ": the faces of a polyhedron are missing or damaged");
  };
  if (cell >= cells.face_locations.size() || cells.face_locations[cell] < 0 ||
      static_cast<std::size_t>(cells.face_locations[cell]) >= cells.faces.size())
    fail();
  const auto stream = cells.faces.subspan(static_cast<std::size_t>(cells.face_locations[cell]));
  std::size_t at = 1;
  for (vtkIdType face = 0; face < stream[0]; ++face) {
    if (at >= stream.size() || stream[at] < 0 || static_cast<std::size_t>(stream[at]) >= stream.size() - at) fail();
    at += 1 + static_cast<std::size_t>(stream[at]);
  }
  return stream.first(at);
}

Block make_block(vtkDataSet& data, const std::string& place) {
  Block block;
  block.data = &data;
  block.point_count = static_cast<std::uint64_t>(data.GetNumberOfPoints());
  block.all_cells = static_cast<std::uint64_t>(data.GetNumberOfCells());
  block.is_drawn.assign(block.all_cells, 0);
  block.is_point_used.assign(block.point_count, 0);
  int dimensions[3] = {0, 0, 0};
  if (auto* grid = vtkUnstructuredGrid::SafeDownCast(&data)) {
    if (grid->GetNumberOfCells() > 0) block.cells = view_cells(*grid, place);
    return block;
  }
  if (auto* structured = vtkStructuredGrid::SafeDownCast(&data))
    structured->GetDimensions(dimensions);
  else if (auto* rectilinear = vtkRectilinearGrid::SafeDownCast(&data))
    rectilinear->GetDimensions(dimensions);
  else if (auto* image = vtkImageData::SafeDownCast(&data))
    image->GetDimensions(dimensions);
  std::copy(dimensions, dimensions + 3, block.dimensions.begin());
  const std::int64_t points = block.dimensions[0] * block.dimensions[1] * block.dimensions[2];
  if (points > 0 && static_cast<std::uint64_t>(points) != block.point_count)
    fail_file(place, "its extent does not fit its number of points");
  return block;
}

/// Corners of a cell of the lattice in VTK's order of a hexahedron.
std::array<std::uint64_t, 8> lattice_corners(const std::array<std::int64_t, 3>& dimensions, std::size_t cell) {
  const auto nx = static_cast<std::uint64_t>(dimensions[0]), ny = static_cast<std::uint64_t>(dimensions[1]);
  const std::uint64_t i = cell % (nx - 1), j = cell / (nx - 1) % (ny - 1), k = cell / (nx - 1) / (ny - 1);
  const std::uint64_t a = i + nx * (j + ny * k), layer = nx * ny;
  return {a, a + 1, a + nx + 1, a + nx, a + layer, a + layer + 1, a + layer + nx + 1, a + layer + nx};
}

/// Calls `visit(id)` for every point id of a cell; a polyhedron's counts are left out.
template <class Visit>
void visit_ids(const Block& block, std::size_t cell, const std::string& place, const Visit& visit) {
  if (!block.cells) {
    for (const std::uint64_t id : lattice_corners(block.dimensions, cell)) visit(static_cast<std::int64_t>(id));
    return;
  }
  const UnstructuredCells& cells = *block.cells;
  if (cells.types[cell] != VTK_POLYHEDRON) {
    for (std::int64_t at = cells.offset(cell); at < cells.offset(cell + 1); ++at) visit(cells.id(at));
    return;
  }
  const auto stream = face_stream(cells, cell, place);
  for (std::size_t at = 1; at < stream.size(); at += 1 + static_cast<std::size_t>(stream[at]))
    for (vtkIdType k = 1; k <= stream[at]; ++k) visit(stream[at + static_cast<std::size_t>(k)]);
}

std::size_t connectivity_size(const Block& block, std::size_t cell, const std::string& place) {
  if (!block.cells) return 8;
  if (block.cells->types[cell] == VTK_POLYHEDRON) return face_stream(*block.cells, cell, place).size();
  return static_cast<std::size_t>(block.cells->offset(cell + 1) - block.cells->offset(cell));
}

/// Marks of duplicate and hidden cells and points.
struct GhostMarks {
  const unsigned char* cells = nullptr;
  const unsigned char* points = nullptr;
};

GhostMarks find_ghost_marks(vtkDataSet& data) {
  const auto find = [](vtkDataSetAttributes* attributes, vtkIdType count) -> const unsigned char* {
    auto* array = vtkUnsignedCharArray::SafeDownCast(attributes->GetArray(vtkDataSetAttributes::GhostArrayName()));
    return array && array->GetNumberOfComponents() == 1 && array->GetNumberOfTuples() >= count ? array->GetPointer(0)
                                                                                               : nullptr;
  };
  return {find(data.GetCellData(), data.GetNumberOfCells()), find(data.GetPointData(), data.GetNumberOfPoints())};
}

Fate fate_of_cell(const Block& block, const GhostMarks& marks, std::size_t cell, const std::string& place) {
  const bool is_flat = !block.cells && std::min({block.dimensions[0], block.dimensions[1], block.dimensions[2]}) < 2;
  const auto fate = block.cells ? fate_of_type(block.cells->types[cell])
                                : std::optional(is_flat ? Fate::kLowerDimension : Fate::kDrawn);
  if (!fate)
    fail_file(place,
              "cell " + std::to_string(cell) + ": unknown cell type " + std::to_string(block.cells->types[cell]));
  if (*fate == Fate::kLowerDimension) return *fate;
  const int mark = marks.cells ? marks.cells[cell] : 0;
  if (mark & vtkDataSetAttributes::DUPLICATECELL) return Fate::kGhost;
  if (mark & (vtkDataSetAttributes::HIDDENCELL | vtkDataSetAttributes::REFINEDCELL)) return Fate::kBlanked;
  return *fate;
}

/// Checks a cell's ids and marks its points; false where one of them is hidden.
bool take_points(Block& block, const GhostMarks& marks, std::size_t cell, const std::string& place) {
  bool is_visible = true;
  visit_ids(block, cell, place, [&](std::int64_t id) {
    if (id < 0 || static_cast<std::uint64_t>(id) >= block.point_count)
      fail_file(place, "cell " + std::to_string(cell) + ": point id " + std::to_string(id) + " where there are " +
                           std::to_string(block.point_count) + " points");
    if (marks.points && (marks.points[id] & vtkDataSetAttributes::HIDDENPOINT)) is_visible = false;
  });
  if (is_visible)
    visit_ids(block, cell, place, [&](std::int64_t id) { block.is_point_used[static_cast<std::size_t>(id)] = 1; });
  return is_visible;
}

using TypeCounts = std::map<CellType, std::uint64_t>;

void examine_cells(Block& block, const std::string& place, LeftOut& left_out, TypeCounts& counts) {
  const GhostMarks marks = find_ghost_marks(*block.data);
  for (std::size_t cell = 0; cell < block.all_cells; ++cell) {
    Fate fate = fate_of_cell(block, marks, cell, place);
    if (fate == Fate::kDrawn && !take_points(block, marks, cell, place)) fate = Fate::kBlanked;
    switch (fate) {
      case Fate::kLowerDimension:
        ++left_out.lower_dimension;
        break;
      case Fate::kGhost:
        ++left_out.ghost;
        break;
      case Fate::kBlanked:
        ++left_out.blanked;
        break;
      case Fate::kUnsupported:
        ++left_out.unsupported;
        break;
      case Fate::kDrawn:
        block.is_drawn[cell] = 1;
        ++block.cell_count;
        block.connectivity_count += connectivity_size(block, cell, place);
        ++counts[block.cells ? static_cast<CellType>(block.cells->types[cell]) : CellType::kHexahedron];
    }
  }
}

void add_bounds(const Block& block, const std::string& place, std::array<ValueRange, 3>& bounds) {
  for (std::size_t i = 0; i < block.point_count; ++i) {
    if (!block.is_point_used[i]) continue;
    double point[3];
    block.data->GetPoint(static_cast<vtkIdType>(i), point);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (!std::isfinite(point[axis])) fail_file(place, "point " + std::to_string(i) + ": a coordinate is not finite");
      bounds[axis].min = std::min(bounds[axis].min, point[axis]);
      bounds[axis].max = std::max(bounds[axis].max, point[axis]);
    }
  }
}

Block examine_block(vtkDataSet& data, std::size_t index, const std::string& file, LeftOut& left_out, TypeCounts& counts,
                    std::array<ValueRange, 3>& bounds) {
  try {
    Block block = make_block(data, file);
    examine_cells(block, file, left_out, counts);
    add_bounds(block, file, bounds);
    return block;
  } catch (const Error& error) {
    if (index == 0) throw;
    throw Error(error.code(), error.what() + (" (block " + std::to_string(index) + ")"));
  }
}

void write_lattice_points(vtkRectilinearGrid& grid, double* points) {
  int dimensions[3];
  grid.GetDimensions(dimensions);
  std::array<std::vector<double>, 3> axes;
  vtkDataArray* const arrays[3] = {grid.GetXCoordinates(), grid.GetYCoordinates(), grid.GetZCoordinates()};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    axes[axis].resize(static_cast<std::size_t>(dimensions[axis]));
    convert_values(*arrays[axis], 0, 0, axes[axis].size(), axes[axis].data());
  }
  for (const double z : axes[2])
    for (const double y : axes[1])
      for (const double x : axes[0]) {
        *points++ = x;
        *points++ = y;
        *points++ = z;
      }
}

/// Copies coordinates; a point that no drawn cell uses and that is not finite goes to where a used one is.
void write_points(const Block& block, double* points) {
  if (auto* rectilinear = vtkRectilinearGrid::SafeDownCast(block.data)) {
    write_lattice_points(*rectilinear, points);
  } else if (vtkImageData::SafeDownCast(block.data)) {
    for (std::size_t i = 0; i < block.point_count; ++i) block.data->GetPoint(static_cast<vtkIdType>(i), points + 3 * i);
  } else {
    vtkDataArray& array = *static_cast<vtkPointSet*>(block.data.Get())->GetPoints()->GetData();
    std::vector<double> axis_values(std::min<std::size_t>(block.point_count, kGrain));
    for (std::size_t first = 0; first < block.point_count; first += kGrain) {
      const std::size_t count = std::min<std::size_t>(kGrain, block.point_count - first);
      for (int axis = 0; axis < 3; ++axis) {
        convert_values(array, axis, first, count, axis_values.data());
        for (std::size_t i = 0; i < count; ++i) points[3 * (first + i) + axis] = axis_values[i];
      }
    }
  }
  const auto used = std::find(block.is_point_used.begin(), block.is_point_used.end(), 1) - block.is_point_used.begin();
  for (std::size_t i = 0; i < block.point_count; ++i)
    if (!block.is_point_used[i] &&
        !(std::isfinite(points[3 * i]) && std::isfinite(points[3 * i + 1]) && std::isfinite(points[3 * i + 2])))
      std::copy_n(points + 3 * used, 3, points + 3 * i);
}

/// Appends a cell's entry of the connectivity; returns its end.
std::uint32_t* write_cell(const Block& block, std::size_t cell, std::uint32_t* out) {
  const auto first = static_cast<std::uint32_t>(block.first_point);
  if (block.cells && block.cells->types[cell] == VTK_POLYHEDRON) {
    const auto stream = face_stream(*block.cells, cell, {});
    *out++ = static_cast<std::uint32_t>(stream[0]);
    for (std::size_t at = 1; at < stream.size();) {
      const auto corners = static_cast<std::size_t>(stream[at++]);
      *out++ = static_cast<std::uint32_t>(corners);
      for (const std::size_t end = at + corners; at < end;) *out++ = first + static_cast<std::uint32_t>(stream[at++]);
    }
    return out;
  }
  visit_ids(block, cell, {}, [&](std::int64_t id) { *out++ = first + static_cast<std::uint32_t>(id); });
  return out;
}

}  // namespace

std::vector<Block> examine_blocks(const FileContents& contents, const std::string& file, DatasetInfo& info) {
  std::vector<Block> blocks;
  TypeCounts counts;
  std::uint64_t points = 0, cells = 0, connectivity = 0;
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  std::array<ValueRange, 3> bounds;
  bounds.fill({kInfinity, -kInfinity});
  for (std::size_t i = 0; i < contents.blocks.size(); ++i) {
    Block block = examine_block(*contents.blocks[i], i, file, info.left_out, counts, bounds);
    if (block.cell_count == 0) continue;
    block.first_point = points;
    block.first_cell = cells;
    block.first_connectivity = connectivity;
    points += block.point_count;
    cells += block.cell_count;
    connectivity += block.connectivity_count;
    blocks.push_back(std::move(block));
  }
  constexpr std::uint64_t kMost = std::numeric_limits<std::uint32_t>::max() - 1;
  if (points > kMost || cells > kMost)
    throw Error(ErrorCode::kUnsupported, "'" + file + "' has more than 2^32 - 2 points or cells: draw it in parts");
  info.point_count = points;
  info.cell_count = cells;
  info.block_count = std::max<std::uint64_t>(1, blocks.size());
  info.cells_by_type.assign(counts.begin(), counts.end());
  if (cells > 0) info.bounds = bounds;
  return blocks;
}

void write_block(const Block& block, const MeshArrays& mesh) {
  write_points(block, mesh.points + 3 * block.first_point);
  std::uint32_t* out = mesh.connectivity + block.first_connectivity;
  std::uint64_t index = block.first_cell;
  for (std::size_t cell = 0; cell < block.all_cells; ++cell) {
    if (!block.is_drawn[cell]) continue;
    mesh.cell_types[index] = block.cells ? static_cast<CellType>(block.cells->types[cell]) : CellType::kHexahedron;
    out = write_cell(block, cell, out);
    mesh.cell_offsets[++index] = static_cast<std::uint64_t>(out - mesh.connectivity);
  }
}

}  // namespace tetravox::io
