/// Writes an embedded dataset, so that other programs can draw it: a mesh as a VTK XML unstructured grid (appended,
/// raw), a grid as a RAW file, in a directory under the name that tells its layout. Prints the file's path.
///
///     export_builtin buckyball out.vtu
///     export_builtin "turbulence?size=64" out        writes out/turbulence_64x64x64_uint8.raw

#include "tetravox/dataset.h"
#include "tetravox/error.h"

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <span>
#include <string>
#include <vector>

namespace {

using tetravox::Association;
using tetravox::Dataset;
using tetravox::Error;
using tetravox::ErrorCode;
using tetravox::GridData;
using tetravox::MeshData;

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

/// "NAME_256x256x256_uint8.raw", the convention of the Open SciVis Datasets.
std::string raw_name(const Dataset& dataset) {
  std::string name = dataset.info.source.substr(dataset.info.source.find(':') + 1);
  name.resize(std::min(name.size(), name.find('?')));
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

/// Writes to `out`, or below it where it is a directory.
std::string write_dataset(const Dataset& dataset, const std::string& out) {
  if (!dataset.is_grid()) {
    write_vtu(out, dataset.mesh);
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
    std::fprintf(stderr, "usage: export_builtin MESH OUT.vtu\n       export_builtin GRID DIRECTORY|OUT.raw\n");
    return 2;
  }
  try {
    std::printf("%s\n", write_dataset(tetravox::make_builtin(argv[1]), argv[2]).c_str());
  } catch (const Error& error) {
    std::fprintf(stderr, "export_builtin: %s\n", error.what());
    return 1;
  }
  return 0;
}
