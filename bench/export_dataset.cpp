/// Writes a dataset as tetravox sees it, so that other programs can draw the same: a mesh as a VTK XML unstructured
/// grid, a grid as VTK XML image data (both appended, raw), or as a RAW file, in a directory under the name that tells
/// its layout. Prints the file's path.
///
///     export_dataset builtin:buckyball out.vtu
///     export_dataset head.nii.gz out.vti                     its axes along the world's
///     export_dataset "builtin:turbulence?size=64" out        writes out/turbulence_64x64x64_uint8.raw

#include "src/grid/values.h"
#include "tetravox/dataset.h"
#include "tetravox/error.h"
#include "tetravox/io.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <limits>
#include <span>
#include <sstream>
#include <string>
#include <vector>

namespace {

using tetravox::Association;
using tetravox::Dataset;
using tetravox::Error;
using tetravox::ErrorCode;
using tetravox::GridData;
using tetravox::GridShape;
using tetravox::MeshData;
using tetravox::ScalarType;

/// The appended section: every block is its size in bytes (uint64) and its bytes.
class AppendedData {
 public:
  /// Adds a block and returns the `<DataArray>` that refers to it.
  template <class T>
  std::string add(const std::string& type, const std::string& name, int components, std::span<const T> values) {
    const std::uint64_t size = values.size_bytes();
    const std::string element = "<DataArray type=\"" + type + "\" Name=\"" + name + "\" NumberOfComponents=\"" +
                                std::to_string(components) + "\" format=\"appended\" offset=\"" +
                                std::to_string(bytes_.size()) + "\"/>\n";
    bytes_.append(reinterpret_cast<const char*>(&size), sizeof size);
    bytes_.append(reinterpret_cast<const char*>(values.data()), size);
    return element;
  }
  const std::string& bytes() const { return bytes_; }

 private:
  std::string bytes_;
};

/// `values` as int64, the type that VTK wants for connectivity and offsets.
template <class T>
std::vector<std::int64_t> to_int64(std::span<const T> values) {
  return {values.begin(), values.end()};
}

/// @throws Error (kCannotWrite) where not everything was written.
void finish(std::ofstream& file, const std::string& path) {
  if (!file.flush())
    throw Error(ErrorCode::kCannotWrite, path + " could not be written: check the folder and the disk");
}

void write_vtu(const std::string& path, const MeshData& mesh) {
  const auto connectivity = to_int64(mesh.connectivity);
  const auto offsets = to_int64(mesh.cell_offsets.subspan(1));  // VTU leaves out the leading zero
  std::vector<std::uint8_t> types;
  for (const tetravox::CellType type : mesh.cell_types) {
    if (type == tetravox::CellType::kPolyhedron)
      throw Error(ErrorCode::kUnsupported, "polyhedra are not exported: choose another dataset");
    types.push_back(static_cast<std::uint8_t>(type));
  }

  AppendedData data;
  const std::string scalars = data.add("Float64", mesh.array_name, 1, mesh.scalars);
  const std::string points = data.add("Float64", "Points", 3, mesh.points);
  const std::string cells = data.add("Int64", "connectivity", 1, std::span<const std::int64_t>(connectivity)) +
                            data.add("Int64", "offsets", 1, std::span<const std::int64_t>(offsets)) +
                            data.add("UInt8", "types", 1, std::span<const std::uint8_t>(types));
  const std::string where = mesh.association == Association::kPoint ? "PointData" : "CellData";

  std::ofstream file(path, std::ios::binary);
  file << "<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\">\n"
       << "<UnstructuredGrid>\n<Piece NumberOfPoints=\"" << mesh.point_count() << "\" NumberOfCells=\""
       << mesh.cell_count() << "\">\n"
       << "<" << where << " Scalars=\"" << mesh.array_name << "\">\n"
       << scalars << "</" << where << ">\n"
       << "<Points>\n"
       << points << "</Points>\n<Cells>\n"
       << cells << "</Cells>\n"
       << "</Piece>\n</UnstructuredGrid>\n<AppendedData encoding=\"raw\">\n_" << data.bytes()
       << "\n</AppendedData>\n</VTKFile>\n";
  finish(file, path);
}

/// An axis of the world as one of the grid's, which may run the other way.
struct WorldAxis {
  std::size_t grid_axis = 0;
  bool is_flipped = false;
  std::size_t count = 0;
  double origin = 0.0;  ///< of the lowest point
  double spacing = 1.0;
};

/// @throws Error (kUnsupported) for axes that are uneven or not along the world's.
std::array<WorldAxis, 3> find_world_axes(const GridShape& shape) {
  std::array<WorldAxis, 3> axes;
  for (std::size_t row = 0; row < 3; ++row) {
    WorldAxis& axis = axes[row];
    const double* direction = shape.direction.data() + 3 * row;
    while (axis.grid_axis < 2 && std::abs(direction[axis.grid_axis]) < 0.5) ++axis.grid_axis;
    for (std::size_t i = 0; i < 3; ++i)
      if (std::abs(std::abs(direction[i]) - (i == axis.grid_axis ? 1.0 : 0.0)) > 1e-6)
        throw Error(ErrorCode::kUnsupported, "the grid is not along the axes of the world: choose another dataset");
    if (!shape.coordinates[axis.grid_axis].empty())
      throw Error(ErrorCode::kUnsupported, "the grid has an uneven axis: choose another dataset");
    axis.is_flipped = direction[axis.grid_axis] < 0.0;
    axis.count = shape.dimensions[axis.grid_axis];
    axis.spacing = shape.spacing[axis.grid_axis];
    axis.origin = shape.origin[row] - (axis.is_flipped ? axis.spacing * static_cast<double>(axis.count - 1) : 0.0);
  }
  return axes;
}

/// The values that are drawn, [z][y][x] along the axes of the world.
std::vector<float> read_along_world(const GridData& grid, const std::array<WorldAxis, 3>& axes) {
  tetravox::grid::Block whole;
  for (std::size_t i = 0; i < 3; ++i) whole.count[i] = grid.shape.dimensions[i];
  std::vector<float> values(static_cast<std::size_t>(whole.size()));
  tetravox::grid::BlockReader(grid, {}).read(whole, values.data());

  const std::size_t columns = grid.shape.dimensions[0], rows = grid.shape.dimensions[1];
  const std::array<std::size_t, 3> strides{1, columns, columns * rows};
  const auto place = [&](const WorldAxis& axis, std::size_t i) {
    return (axis.is_flipped ? axis.count - 1 - i : i) * strides[axis.grid_axis];
  };
  std::vector<float> ordered;
  ordered.reserve(values.size());
  for (std::size_t z = 0; z < axes[2].count; ++z)
    for (std::size_t y = 0; y < axes[1].count; ++y)
      for (std::size_t x = 0; x < axes[0].count; ++x)
        ordered.push_back(values[place(axes[2], z) + place(axes[1], y) + place(axes[0], x)]);
  return ordered;
}

/// The values of a grid of points as image data: bytes as bytes, everything else as float.
void write_vti(const std::string& path, const GridData& grid) {
  if (grid.association != Association::kPoint)
    throw Error(ErrorCode::kUnsupported, "grids of cells are not exported: choose another dataset");
  const std::array<WorldAxis, 3> axes = find_world_axes(grid.shape);
  const std::vector<float> values = read_along_world(grid, axes);

  AppendedData data;
  std::string scalars;
  if (grid.type == ScalarType::kUint8) {
    std::vector<std::uint8_t> bytes(values.size());
    std::transform(values.begin(), values.end(), bytes.begin(),
                   [](float value) { return static_cast<std::uint8_t>(value); });
    scalars = data.add("UInt8", grid.array_name, 1, std::span<const std::uint8_t>(bytes));
  } else {
    scalars = data.add("Float32", grid.array_name, 1, std::span<const float>(values));
  }

  std::ostringstream extent, origin, spacing;
  origin.precision(std::numeric_limits<double>::max_digits10);
  spacing.precision(std::numeric_limits<double>::max_digits10);
  for (const WorldAxis& axis : axes) {
    extent << "0 " << axis.count - 1 << ' ';
    origin << axis.origin << ' ';
    spacing << axis.spacing << ' ';
  }
  std::ofstream file(path, std::ios::binary);
  file << "<VTKFile type=\"ImageData\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\">\n"
       << "<ImageData WholeExtent=\"" << extent.str() << "\" Origin=\"" << origin.str() << "\" Spacing=\""
       << spacing.str() << "\">\n<Piece Extent=\"" << extent.str() << "\">\n"
       << "<PointData Scalars=\"" << grid.array_name << "\">\n"
       << scalars << "</PointData>\n</Piece>\n</ImageData>\n<AppendedData encoding=\"raw\">\n_" << data.bytes()
       << "\n</AppendedData>\n</VTKFile>\n";
  finish(file, path);
}

/// "NAME_256x256x256_uint8.raw", the convention of the Open SciVis Datasets.
std::string raw_name(const Dataset& dataset) {
  std::string name = std::filesystem::path(dataset.info.source).filename().string();
  name.erase(0, name.find(':') + 1);
  name.resize(std::min(name.size(), name.find_first_of("?.")));
  char separator = '_';
  for (const std::uint32_t points : dataset.grid.shape.dimensions) {
    name += separator + std::to_string(points);
    separator = 'x';
  }
  return name + "_" + tetravox::scalar_type_name(dataset.grid.type) + ".raw";
}

void write_raw(const std::string& path, const GridData& grid) {
  std::ofstream file(path, std::ios::binary);
  file.write(reinterpret_cast<const char*>(grid.values.data()), static_cast<std::streamsize>(grid.values.size()));
  finish(file, path);
}

/// Writes to `out`, or below it where it is a directory. Returns the file's path.
std::string write_dataset(const Dataset& dataset, const std::string& out) {
  if (!dataset.is_grid()) {
    write_vtu(out, dataset.mesh);
    return out;
  }
  if (std::filesystem::path(out).extension() == ".vti") {
    write_vti(out, dataset.grid);
    return out;
  }
  const bool is_directory = std::filesystem::is_directory(out);
  const std::string path = is_directory ? (std::filesystem::path(out) / raw_name(dataset)).string() : out;
  write_raw(path, dataset.grid);
  return path;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) {
    std::fprintf(stderr, "usage: export_dataset MESH OUT.vtu\n       export_dataset GRID OUT.vti|OUT.raw|DIRECTORY\n");
    return 2;
  }
  try {
    std::printf("%s\n", write_dataset(tetravox::read_dataset(argv[1]), argv[2]).c_str());
  } catch (const Error& error) {
    std::fprintf(stderr, "export_dataset: %s\n", error.what());
    return 1;
  }
  return 0;
}
