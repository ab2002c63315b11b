#pragma once

/// A mesh of cells or a regular grid with one scalar field, as it stands in a file, and what is known about that file.
///
/// `MeshData` and `GridData` are bundles of views: readers hand over shared memory or a mapped file, generators hand
/// over vectors; `storage` keeps either alive. Nothing is copied on the way to `prepare_mesh` (mesh.h) or
/// `prepare_grid` (grid.h).

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace tetravox {

/// Cell types by VTK's numbers and VTK's order of corners.
enum class CellType : std::uint8_t {
  kTetrahedron = 10,
  kVoxel = 11,
  kHexahedron = 12,
  kWedge = 13,
  kPyramid = 14,
  kPentagonalPrism = 15,
  kHexagonalPrism = 16,
  kQuadraticTetrahedron = 24,
  kQuadraticHexahedron = 25,
  kQuadraticWedge = 26,
  kQuadraticPyramid = 27,
  kTriquadraticHexahedron = 29,
  kQuadraticLinearWedge = 31,
  kBiquadraticQuadraticWedge = 32,
  kBiquadraticQuadraticHexahedron = 33,
  kTriquadraticPyramid = 37,
  kPolyhedron = 42
};

/// Name of a cell type as users know it ("tetrahedron", "quadratic hexahedron"); "cell type N" for others.
std::string cell_type_name(std::uint8_t type);

enum class Association : std::uint8_t {
  kPoint,  ///< one value a point, linear in between
  kCell    ///< one value a cell, constant inside it
};

/// Which of a vector's components is drawn; 0, 1, 2, ... or the Euclidean length.
inline constexpr int kMagnitude = -1;

struct ValueRange {
  double min = 0.0;
  double max = 0.0;
};

/// Number types of grid values, as they stand in files.
enum class ScalarType : std::uint8_t {
  kInt8,
  kUint8,
  kInt16,
  kUint16,
  kInt32,
  kUint32,
  kInt64,
  kUint64,
  kFloat32,
  kFloat64
};

/// "int8" ... "float64", and back; bytes of one value.
/// @throws Error (kInvalidArgument) that lists the names there are.
std::string scalar_type_name(ScalarType type);
ScalarType scalar_type_from_name(const std::string& name);
std::size_t scalar_type_size(ScalarType type);

/// The lattice of a grid. Point (i, j, k) lies at origin + direction * (x_i, y_j, z_k), world units, where x_i is
/// i * spacing[0], or coordinates[0][i] where that axis is uneven; likewise y and z.
struct GridShape {
  std::array<std::uint32_t, 3> dimensions{};  ///< lattice points along i, j, k; cells are one fewer
  std::array<double, 3> origin{};
  std::array<double, 3> spacing{1, 1, 1};                      ///< positive
  std::array<double, 9> direction{1, 0, 0, 0, 1, 0, 0, 0, 1};  ///< row major, invertible; column a: where axis a points
  std::array<std::vector<double>, 3> coordinates;  ///< uneven axes: [dimensions[a]], strictly ascending; else empty

  bool operator==(const GridShape&) const = default;
};

/// What is known of one array without holding its values.
struct ArrayInfo {
  std::string name;
  Association association = Association::kPoint;
  int components = 1;
  std::string type;                          ///< number type as in the file: "uint8", "float32", ...
  std::vector<ValueRange> component_ranges;  ///< [components], of finite values, over the cells that are drawn
  ValueRange magnitude_range;                ///< equals component_ranges[0] for scalars
  std::uint64_t nan_count = 0;               ///< tuples with a value that is not finite
};

/// Cells that a file holds and tetravox does not draw, and points merged, counted.
struct LeftOut {
  std::uint64_t lower_dimension = 0;  ///< vertices, lines, triangles, ...
  std::uint64_t ghost = 0;            ///< duplicate cells of a partition
  std::uint64_t blanked = 0;          ///< hidden cells
  std::uint64_t unsupported = 0;      ///< volume cells of a type that is not known
};

/// Summary of a file (or of an embedded dataset).
struct DatasetInfo {
  std::string source;  ///< path or "builtin:NAME" as given
  std::string format;  ///< "VTK XML unstructured grid (VTU)", ...
  std::uint64_t point_count = 0;
  std::uint64_t cell_count = 0;  ///< cells to draw
  std::uint64_t block_count = 1;
  std::optional<GridShape> grid;                                  ///< set for grids, empty for meshes
  std::vector<std::pair<CellType, std::uint64_t>> cells_by_type;  ///< of a mesh
  LeftOut left_out;
  std::vector<ArrayInfo> arrays;
  std::array<ValueRange, 3> bounds;  ///< world units
  std::vector<double> times;         ///< time steps the file holds, ascending; empty where it has none
  std::size_t time_index = 0;        ///< the step that was read
  std::vector<std::string> notes;    ///< one-line remarks that a user should see
};

/// A further field of a mesh, at the same points or cells as the one that is drawn.
struct OtherField {
  std::span<const double> scalars;  ///< [points] or [cells], as `MeshData::scalars`
  std::string array_name;
  int component = 0;  ///< component of the array, or `kMagnitude`
};

/// Views of a mesh and of the scalar field to draw. Ids are below 2^32 - 1. Immutable; safe to read from many threads.
struct MeshData {
  std::span<const double> points;               ///< [points][3], world coordinates
  std::span<const CellType> cell_types;         ///< [cells]
  std::span<const std::uint64_t> cell_offsets;  ///< [cells + 1] into `connectivity`
  /// Point ids of each cell in VTK's order. A polyhedron's entry is its face stream:
  /// face count, then for each face its point count and its point ids.
  std::span<const std::uint32_t> connectivity;
  std::span<const double>
      scalars;  ///< [points] or [cells] by `association`; a value that is not finite counts as missing
  Association association = Association::kPoint;
  std::string array_name;          ///< what `scalars` holds
  int component = 0;               ///< component of the array, or `kMagnitude`
  std::vector<OtherField> others;  ///< for functions of several variables (multidimensional.h)
  std::shared_ptr<const void> storage;

  std::size_t point_count() const { return points.size() / 3; }
  std::size_t cell_count() const { return cell_types.size(); }
};

/// Views of a grid and of the array to draw, in the number type of the file. Immutable; safe to read from many threads.
struct GridData {
  GridShape shape;
  Association association = Association::kPoint;  ///< a value at each lattice point, or one in each cell
  ScalarType type = ScalarType::kUint8;
  int components = 1;                 ///< interleaved, in [1, 4]
  int component = 0;                  ///< the one to draw, or `kMagnitude`
  std::span<const std::byte> values;  ///< [k][j][i][components], i fastest, this machine's byte order
  std::string array_name;
  std::shared_ptr<const void> storage;

  /// How many values there are along i, j, k: the shape's points or cells.
  std::array<std::size_t, 3> value_dimensions() const {
    const std::size_t fewer = association == Association::kCell ? 1 : 0;
    return {shape.dimensions[0] - fewer, shape.dimensions[1] - fewer, shape.dimensions[2] - fewer};
  }
};

/// A mesh or a grid together with its summary.
struct Dataset {
  DatasetInfo info;
  MeshData mesh;
  GridData grid;
  std::vector<GridData> other_grids;  ///< further fields of a grid: the same shape and association

  bool is_grid() const { return info.grid.has_value(); }
};

/// Which field of a file is wanted. Everything left open is chosen from the data by `choose_array`.
struct ArrayRequest {
  std::string name;                        ///< empty: choose
  std::optional<Association> association;  ///< needed only where a point and a cell array share a name
  std::optional<int> component;            ///< needed only for vectors; default `kMagnitude` there
};

/// Index into `info.arrays` of the array that `request` names, or of the one a stranger would want to see:
/// scalars before vectors, varying before constant, quantities before ids, point before cell data.
/// @throws Error (kInvalidArgument) that lists what there is when the request cannot be met; (kNothingToDraw) without
/// arrays.
std::size_t choose_array(const DatasetInfo& info, const ArrayRequest& request);
/// The same for an array that is wanted beside `first`: it is named, and has the association of `first`.
/// @throws Error (kInvalidArgument) that says which arrays do not go together.
std::size_t choose_other_array(const DatasetInfo& info, const ArrayRequest& request, const ArrayInfo& first);

/// The component of `array` that a request means: the only one, the one asked for, or `kMagnitude`.
int choose_component(const ArrayInfo& array, const ArrayRequest& request);

/// Makes an embedded dataset: a mesh ("sphere", "buckyball", "duct", with optional "?cells=N": about N cells), or a
/// grid ("marschner-lobb", "hydrogen", "turbulence", with optional "?size=N&type=uint8": N^3 points of that number
/// type).
/// `name` may carry the prefix "builtin:". Deterministic. Sources and formulas: src/mesh/builtin.cpp and
/// src/grid/builtin.cpp.
/// @throws Error (kInvalidArgument) that lists the names there are; (kOutOfMemory).
Dataset make_builtin(const std::string& name);
/// The same with the array that `request` asks for ("duct" and "hydrogen" have several), and with `others` beside it.
Dataset make_builtin(const std::string& name, const ArrayRequest& request,
                     const std::vector<ArrayRequest>& others = {});

/// Names and one-line descriptions of the embedded datasets.
std::vector<std::pair<std::string, std::string>> builtin_names();

}  // namespace tetravox
