#include "tests/unit/io/sample_files.h"

#include "tests/unit/io/hdf5_writing.h"

#include <unistd.h>

#include <array>
#include <bit>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <sstream>
#include <stdexcept>

namespace tetravox::test {

namespace {

namespace fs = std::filesystem;

constexpr int kPoints = 12;

std::array<double, 3> point(int id) {
  return {static_cast<double>(id % 3), static_cast<double>(id / 3 % 2), static_cast<double>(id / 6)};
}

std::array<int, 8> cube(int cell) {
  return {cell, cell + 1, cell + 4, cell + 3, cell + 6, cell + 7, cell + 10, cell + 9};
}

std::string points_text(double shift = 0.0) {
  std::ostringstream out;
  for (int i = 0; i < kPoints; ++i) out << point(i)[0] + shift << ' ' << point(i)[1] << ' ' << point(i)[2] << '\n';
  return out.str();
}

std::string cubes_text(const std::string& prefix = {}) {
  std::ostringstream out;
  for (int cell = 0; cell < 2; ++cell) {
    out << prefix;
    for (const int id : cube(cell)) out << id << ' ';
    out << '\n';
  }
  return out.str();
}

const char* const kValues = "0 1 2 3 4 5 6 7 8 9 10 11\n";
const char* const kXmlData =
    "<PointData><DataArray type=\"Float32\" Name=\"S\" format=\"ascii\">0 1 2 3 4 5 6 7 8 9 10 11</DataArray>"
    "</PointData>\n<CellData><DataArray type=\"Int32\" Name=\"C\" format=\"ascii\">5 7</DataArray></CellData>\n";

template <class T>
void append(std::string& out, T value, bool is_big_endian = false) {
  char bytes[sizeof(T)];
  std::memcpy(bytes, &value, sizeof(T));
  if (is_big_endian)
    for (std::size_t i = 0; i < sizeof(T) / 2; ++i) std::swap(bytes[i], bytes[sizeof(T) - 1 - i]);
  out.append(bytes, sizeof(T));
}

void write_vtu(const fs::path& directory) { write_text(directory / "mesh.vtu", vtu_text()); }

void write_polyhedra(const fs::path& directory) {
  std::ostringstream faces, offsets;
  int end = 0;
  for (int cell = 0; cell < 2; ++cell) {
    const auto c = cube(cell);
    constexpr int kFaces[6][4] = {{0, 3, 2, 1}, {4, 5, 6, 7}, {0, 1, 5, 4}, {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}};
    faces << "6 ";
    for (const auto& face : kFaces)
      faces << "4 " << c[face[0]] << ' ' << c[face[1]] << ' ' << c[face[2]] << ' ' << c[face[3]] << ' ';
    end += 31;
    offsets << end << ' ';
  }
  std::string text = vtu_text();
  const auto replace = [&](const std::string& from, const std::string& to) {
    text.replace(text.find(from), from.size(), to);
  };
  replace("12 12</DataArray></Cells>", "42 42</DataArray><DataArray type=\"Int64\" Name=\"faces\" format=\"ascii\">" +
                                           faces.str() +
                                           "</DataArray><DataArray type=\"Int64\" Name=\"faceoffsets\" "
                                           "format=\"ascii\">" +
                                           offsets.str() + "</DataArray></Cells>");
  write_text(directory / "mesh.vtu", text);
}

/// A VTU file with raw appended data.
void write_vtu_appended(const fs::path& directory) {
  std::string data;
  std::ostringstream head;
  const auto array = [&](const char* type, const char* attributes, const std::string& bytes) {
    head << "<DataArray type=\"" << type << "\" " << attributes << " format=\"appended\" offset=\"" << data.size()
         << "\"/>\n";
    append(data, static_cast<std::uint32_t>(bytes.size()));
    data += bytes;
  };
  std::string scalars, cells, points, connectivity, offsets;
  for (int i = 0; i < kPoints; ++i) {
    append(scalars, static_cast<float>(i));
    for (const double x : point(i)) append(points, x);
  }
  for (int cell = 0; cell < 2; ++cell) {
    append(cells, std::int32_t{5 + 2 * cell});
    for (const int id : cube(cell)) append(connectivity, std::int64_t{id});
    append(offsets, std::int64_t{8 * (cell + 1)});
  }
  head << "<VTKFile type=\"UnstructuredGrid\" version=\"0.1\" byte_order=\"LittleEndian\">\n<UnstructuredGrid>\n"
       << "<Piece NumberOfPoints=\"12\" NumberOfCells=\"2\">\n<PointData>";
  array("Float32", "Name=\"S\"", scalars);
  head << "</PointData>\n<CellData>";
  array("Int32", "Name=\"C\"", cells);
  head << "</CellData>\n<Points>";
  array("Float64", "NumberOfComponents=\"3\"", points);
  head << "</Points>\n<Cells>";
  array("Int64", "Name=\"connectivity\"", connectivity);
  array("Int64", "Name=\"offsets\"", offsets);
  array("UInt8", "Name=\"types\"", "\x0c\x0c");
  head << "</Cells>\n</Piece>\n</UnstructuredGrid>\n<AppendedData encoding=\"raw\">\n_" << data
       << "\n</AppendedData>\n</VTKFile>\n";
  write_text(directory / "mesh.vtu", head.str());
}

void write_vts(const fs::path& directory) {
  write_text(directory / "mesh.vts",
             std::string("<VTKFile type=\"StructuredGrid\" version=\"0.1\" byte_order=\"LittleEndian\">\n"
                         "<StructuredGrid WholeExtent=\"0 2 0 1 0 1\">\n<Piece Extent=\"0 2 0 1 0 1\">\n") +
                 kXmlData + "<Points><DataArray type=\"Float64\" NumberOfComponents=\"3\" format=\"ascii\">\n" +
                 points_text() + "</DataArray></Points>\n</Piece></StructuredGrid></VTKFile>\n");
}

void write_pvtu(const fs::path& directory) {
  // Each piece holds both cubes and owns one; the other is a ghost.
  const auto ghosts = [](const char* values) {
    return std::string("<DataArray type=\"UInt8\" Name=\"vtkGhostType\" format=\"ascii\">") + values + "</DataArray>";
  };
  write_text(directory / "piece_0.vtu", vtu_text(ghosts("0 1")));
  write_text(directory / "piece_1.vtu", vtu_text(ghosts("1 0")));
  write_text(directory / "mesh.pvtu",
             "<VTKFile type=\"PUnstructuredGrid\" version=\"0.1\" byte_order=\"LittleEndian\">\n"
             "<PUnstructuredGrid GhostLevel=\"1\">\n"
             "<PPointData><PDataArray type=\"Float32\" Name=\"S\"/></PPointData>\n"
             "<PCellData><PDataArray type=\"Int32\" Name=\"C\"/></PCellData>\n"
             "<PPoints><PDataArray type=\"Float64\" NumberOfComponents=\"3\"/></PPoints>\n"
             "<Piece Source=\"piece_0.vtu\"/>\n<Piece Source=\"piece_1.vtu\"/>\n</PUnstructuredGrid>\n</VTKFile>\n");
}

void write_vtm(const fs::path& directory) {
  fs::create_directories(directory / "parts");
  write_text(directory / "parts" / "a.vtu", vtu_text());
  write_text(directory / "parts" / "b.vtu", vtu_text({}, 2.0));
  write_text(directory / "mesh.vtm",
             "<?xml version=\"1.0\"?>\n<VTKFile type=\"vtkMultiBlockDataSet\" version=\"1.0\" "
             "byte_order=\"LittleEndian\">\n<vtkMultiBlockDataSet>\n<DataSet index=\"0\" file=\"parts/a.vtu\"/>\n"
             "<Block index=\"1\"><DataSet index=\"0\"/><DataSet index=\"1\" file=\"parts/b.vtu\"/></Block>\n"
             "</vtkMultiBlockDataSet>\n</VTKFile>\n");
}

void write_pvd(const fs::path& directory) {
  write_text(directory / "a.vtu", vtu_text());
  write_text(directory / "b.vtu", vtu_text({}, 2.0));
  write_text(
      directory / "mesh.pvd",
      "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"0.1\">\n<Collection>\n"
      "<DataSet timestep=\"0\" part=\"0\" file=\"a.vtu\"/>\n<DataSet timestep=\"0\" part=\"1\" file=\"b.vtu\"/>\n"
      "<DataSet timestep=\"0.5\" part=\"0\" file=\"a.vtu\"/>\n</Collection>\n</VTKFile>\n");
}

std::string legacy_data() {
  std::string text =
      "CELL_DATA 2\nSCALARS C int 1\nLOOKUP_TABLE default\n5 7\nPOINT_DATA 12\nSCALARS S float 1\n"
      "LOOKUP_TABLE default\n";
  return text += kValues;
}

void write_legacy_text(const fs::path& directory) {
  write_text(directory / "mesh.vtk",
             "# vtk DataFile Version 3.0\ntwo cubes\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 12 double\n" +
                 points_text() + "CELLS 2 18\n" + cubes_text("8 ") + "CELL_TYPES 2\n12\n12\n" + legacy_data());
}

void write_legacy_binary(const fs::path& directory) {
  std::string out = "# vtk DataFile Version 3.0\ntwo cubes\nBINARY\nDATASET UNSTRUCTURED_GRID\nPOINTS 12 double\n";
  for (int i = 0; i < kPoints; ++i)
    for (const double x : point(i)) append(out, x, true);
  out += "\nCELLS 2 18\n";
  for (int cell = 0; cell < 2; ++cell) {
    append(out, std::int32_t{8}, true);
    for (const int id : cube(cell)) append(out, std::int32_t{id}, true);
  }
  out += "\nCELL_TYPES 2\n";
  for (int cell = 0; cell < 2; ++cell) append(out, std::int32_t{12}, true);
  out += "\nCELL_DATA 2\nSCALARS C int 1\nLOOKUP_TABLE default\n";
  for (int cell = 0; cell < 2; ++cell) append(out, std::int32_t{5 + 2 * cell}, true);
  out += "\nPOINT_DATA 12\nSCALARS S float 1\nLOOKUP_TABLE default\n";
  for (int i = 0; i < kPoints; ++i) append(out, static_cast<float>(i), true);
  write_text(directory / "mesh.vtk", out + "\n");
}

void write_legacy_structured(const fs::path& directory) {
  write_text(directory / "mesh.vtk",
             "# vtk DataFile Version 3.0\ntwo cubes\nASCII\nDATASET STRUCTURED_GRID\nDIMENSIONS 3 2 2\n"
             "POINTS 12 double\n" +
                 points_text() + legacy_data());
}

void write_ucd_text(const fs::path& directory) {
  std::ostringstream out;
  out << "# two cubes\n12 2 1 1 0\n";
  for (int i = 0; i < kPoints; ++i)
    out << i + 1 << ' ' << point(i)[0] << ' ' << point(i)[1] << ' ' << point(i)[2] << '\n';
  for (int cell = 0; cell < 2; ++cell) {
    out << cell + 1 << " 1 hex";
    for (const int id : cube(cell)) out << ' ' << id + 1;
    out << '\n';
  }
  out << "1 1\nS, none\n";
  for (int i = 0; i < kPoints; ++i) out << i + 1 << ' ' << i << '\n';
  out << "1 1\nC, none\n1 5\n2 7\n";
  write_text(directory / "mesh.inp", out.str());
}

void write_ucd_binary(const fs::path& directory) {
  std::string out(1, '\7');
  for (const std::int32_t number : {12, 2, 1, 1, 0, 16}) append(out, number);
  for (int cell = 0; cell < 2; ++cell)
    for (const std::int32_t number : {cell + 1, 1, 8, 7}) append(out, number);  // Type 7 is the hexahedron.
  for (int cell = 0; cell < 2; ++cell)
    for (const int id : cube(cell)) append(out, std::int32_t{id + 1});
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (int i = 0; i < kPoints; ++i) append(out, static_cast<float>(point(i)[axis]));
  const auto data = [&](const char* label, const std::vector<float>& values) {
    std::string labels = label;
    labels.resize(2048, '\0');
    out += labels;
    append(out, std::int32_t{1});
    append(out, std::int32_t{1});
    append(out, values.front());
    append(out, values.back());
    for (const float value : values) append(out, value);
    append(out, std::int32_t{1});
  };
  data("S.", {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11});
  data("C.", {5, 7});
  write_text(directory / "mesh.inp", out);
}

void write_ensight(const fs::path& directory) {
  std::ostringstream geometry, nodes, elements;
  geometry << "two cubes\n-\nnode id assign\nelement id assign\npart\n         1\ncubes\ncoordinates\n        12\n";
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (int i = 0; i < kPoints; ++i) geometry << ' ' << point(i)[axis] << ".00000e+00\n";
  geometry << "hexa8\n         2\n";
  for (int cell = 0; cell < 2; ++cell) {
    for (const int id : cube(cell)) {
      geometry.width(10);
      geometry << id + 1;
    }
    geometry << '\n';
  }
  nodes << "S\npart\n         1\ncoordinates\n";
  for (int i = 0; i < kPoints; ++i) nodes << ' ' << i << ".0\n";
  elements << "C\npart\n         1\nhexa8\n 5.0\n 7.0\n";
  write_text(directory / "mesh.geo", geometry.str());
  for (const char* step : {"0000", "0001"}) {
    write_text(directory / (std::string("S.") + step), nodes.str());
    write_text(directory / (std::string("C.") + step), elements.str());
  }
  write_text(directory / "mesh.case",
             "FORMAT\ntype: ensight gold\n\nGEOMETRY\nmodel: mesh.geo\n\nVARIABLE\nscalar per node: 1 S S.****\n"
             "scalar per element: 1 C C.****\n\nTIME\ntime set: 1\nnumber of steps: 2\nfilename start number: 0\n"
             "filename increment: 1\ntime values: 0.0 0.5\n");
}

std::string foam_header(const char* type, const char* object) {
  return std::string("FoamFile\n{\n    version 2.0;\n    format ascii;\n    class ") + type + ";\n    object " +
         object + ";\n}\n";
}

void write_openfoam(const fs::path& directory) {
  const fs::path mesh = directory / "constant" / "polyMesh";
  fs::create_directories(mesh);
  fs::create_directories(directory / "system");
  std::ostringstream points, faces;
  for (int i = 0; i < kPoints; ++i) points << '(' << point(i)[0] << ' ' << point(i)[1] << ' ' << point(i)[2] << ")\n";
  faces << "4(1 4 10 7)\n4(0 6 9 3)\n";
  for (int i = 0; i < 2; ++i)
    faces << "4(" << i << ' ' << i + 1 << ' ' << i + 7 << ' ' << i + 6 << ")\n4(" << i + 3 << ' ' << i + 9 << ' '
          << i + 10 << ' ' << i + 4 << ")\n4(" << i << ' ' << i + 3 << ' ' << i + 4 << ' ' << i + 1 << ")\n4(" << i + 6
          << ' ' << i + 7 << ' ' << i + 10 << ' ' << i + 9 << ")\n";
  faces << "4(2 5 11 8)\n";
  write_text(directory / "case.foam", "");
  write_text(directory / "system" / "controlDict",
             foam_header("dictionary", "controlDict") +
                 "application x;\nstartFrom startTime;\nstartTime 0;\nstopAt endTime;\nendTime 1;\ndeltaT 0.5;\n"
                 "writeControl timeStep;\nwriteInterval 1;\n");
  write_text(mesh / "points", foam_header("vectorField", "points") + "12\n(\n" + points.str() + ")\n");
  write_text(mesh / "faces", foam_header("faceList", "faces") + "11\n(\n" + faces.str() + ")\n");
  write_text(mesh / "owner", foam_header("labelList", "owner") + "11\n(\n0 0 0 0 0 0 1 1 1 1 1\n)\n");
  write_text(mesh / "neighbour", foam_header("labelList", "neighbour") + "1\n(\n1\n)\n");
  write_text(mesh / "boundary", foam_header("polyBoundaryMesh", "boundary") +
                                    "1\n(\nwalls\n{\n type wall;\n nFaces 10;\n startFace 1;\n}\n)\n");
  for (const char* time : {"0", "0.5"}) {
    fs::create_directories(directory / time);
    write_text(directory / time / "C",
               foam_header("volScalarField", "C") +
                   "dimensions [0 0 0 0 0 0 0];\ninternalField nonuniform List<scalar>\n2\n(\n5\n7\n)\n;\n"
                   "boundaryField\n{\n walls\n {\n  type zeroGradient;\n }\n}\n");
  }
}

/// Grid and solution; `is_multi_grid` also blanks nothing but carries the blanking array.
void write_plot3d(const fs::path& directory, bool is_multi_grid) {
  std::string grid, solution;
  const auto header = [&](std::string& out) {
    if (is_multi_grid) append(out, std::int32_t{1}, true);
    for (const std::int32_t n : {3, 2, 2}) append(out, n, !is_multi_grid ? false : true);
  };
  const bool big = is_multi_grid;
  header(grid);
  header(solution);
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (int i = 0; i < kPoints; ++i) append(grid, static_cast<float>(point(i)[axis]), big);
  if (is_multi_grid)
    for (int i = 0; i < kPoints; ++i) append(grid, std::int32_t{1}, big);
  for (int i = 0; i < 4; ++i) append(solution, 0.5f, big);
  for (int variable = 0; variable < 5; ++variable)
    for (int i = 0; i < kPoints; ++i) append(solution, static_cast<float>(i), big);
  write_text(directory / "mesh.xyz", grid);
  write_text(directory / "mesh.q", solution);
}

void write_plot3d_text(const fs::path& directory) {
  std::ostringstream grid, solution;
  grid << "3 2 2\n";
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (int i = 0; i < kPoints; ++i) grid << point(i)[axis] << '\n';
  solution << "3 2 2\n0.5 0.5 0.5 0.5\n";
  for (int variable = 0; variable < 5; ++variable) solution << kValues;
  write_text(directory / "mesh.xyz", grid.str());
  write_text(directory / "mesh.q", solution.str());
}

void write_vtkhdf(const fs::path& directory) {
  fs::create_directories(directory);
  const hid_t file = H5Fcreate((directory / "mesh.vtkhdf").c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
  const hid_t group = H5Gcreate2(file, "VTKHDF", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
  write_vtkhdf_type(group, "UnstructuredGrid");
  const std::int64_t points = 12, cells = 2, ids = 16, offsets[3] = {0, 8, 16};
  std::vector<double> coordinates;
  std::vector<std::int64_t> connectivity;
  std::vector<float> scalars;
  for (int i = 0; i < kPoints; ++i) {
    for (const double x : point(i)) coordinates.push_back(x);
    scalars.push_back(static_cast<float>(i));
  }
  for (int cell = 0; cell < 2; ++cell)
    for (const int id : cube(cell)) connectivity.push_back(id);
  const unsigned char types[2] = {12, 12};
  const std::int32_t values[2] = {5, 7};
  write_hdf5(group, "NumberOfPoints", H5T_NATIVE_INT64, {1}, &points);
  write_hdf5(group, "NumberOfCells", H5T_NATIVE_INT64, {1}, &cells);
  write_hdf5(group, "NumberOfConnectivityIds", H5T_NATIVE_INT64, {1}, &ids);
  write_hdf5(group, "Points", H5T_NATIVE_DOUBLE, {12, 3}, coordinates.data());
  write_hdf5(group, "Connectivity", H5T_NATIVE_INT64, {16}, connectivity.data());
  write_hdf5(group, "Offsets", H5T_NATIVE_INT64, {3}, offsets);
  write_hdf5(group, "Types", H5T_NATIVE_UCHAR, {2}, types);
  const hid_t point_data = H5Gcreate2(group, "PointData", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
  const hid_t cell_data = H5Gcreate2(group, "CellData", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
  write_hdf5(point_data, "S", H5T_NATIVE_FLOAT, {12}, scalars.data());
  write_hdf5(cell_data, "C", H5T_NATIVE_INT32, {2}, values);
  H5Gclose(point_data);
  H5Gclose(cell_data);
  H5Gclose(group);
  H5Fclose(file);
}

}  // namespace

TemporaryDirectory::TemporaryDirectory() {
  std::string name = (fs::temp_directory_path() / "tetravox-io-XXXXXX").string();
  if (!mkdtemp(name.data())) throw std::runtime_error("cannot make a temporary directory");
  path_ = name;
}

TemporaryDirectory::~TemporaryDirectory() {
  std::error_code ignored;
  fs::remove_all(path_, ignored);
}

std::string read_text(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  std::ostringstream text;
  text << in.rdbuf();
  if (!in) throw std::runtime_error("cannot read " + path);
  return text.str();
}

void write_text(const fs::path& path, const std::string& text) {
  fs::create_directories(path.parent_path());
  std::ofstream out(path, std::ios::binary);
  out << text;
  if (!out.flush()) throw std::runtime_error("cannot write " + path.string());
}

std::string vtu_text(const std::string& extra_cell_data, double shift) {
  std::string data = kXmlData;
  data.insert(data.find("</CellData>"), extra_cell_data);
  return "<VTKFile type=\"UnstructuredGrid\" version=\"0.1\" byte_order=\"LittleEndian\">\n<UnstructuredGrid>\n"
         "<Piece NumberOfPoints=\"12\" NumberOfCells=\"2\">\n" +
         data + "<Points><DataArray type=\"Float64\" NumberOfComponents=\"3\" format=\"ascii\">\n" +
         points_text(shift) +
         "</DataArray></Points>\n<Cells><DataArray type=\"Int64\" Name=\"connectivity\" format=\"ascii\">\n" +
         cubes_text() +
         "</DataArray><DataArray type=\"Int64\" Name=\"offsets\" format=\"ascii\">8 16</DataArray>"
         "<DataArray type=\"UInt8\" Name=\"types\" format=\"ascii\">12 12</DataArray></Cells>\n"
         "</Piece></UnstructuredGrid></VTKFile>\n";
}

const std::vector<Sample>& samples() {
  static const std::vector<Sample> list = [] {
    std::vector<Sample> out;
    const auto add = [&](const char* name, const char* file, auto write, std::vector<std::string> victims = {}) {
      if (victims.empty()) victims = {file};
      out.push_back({name, file, "", std::move(victims), write, "S", true, 1});
      return &out.back();
    };
    add("vtu", "mesh.vtu", write_vtu);
    add("vtu_polyhedra", "mesh.vtu", write_polyhedra);
    add("vtu_appended", "mesh.vtu", write_vtu_appended);
    add("vts", "mesh.vts", write_vts);
    add("pvtu", "mesh.pvtu", write_pvtu, {"mesh.pvtu", "piece_1.vtu"});
    add("vtm", "mesh.vtm", write_vtm, {"mesh.vtm", "parts/b.vtu"})->copies = 2;
    add("pvd", "mesh.pvd", write_pvd, {"mesh.pvd", "b.vtu"})->copies = 2;
    add("legacy_text", "mesh.vtk", write_legacy_text);
    add("legacy_binary", "mesh.vtk", write_legacy_binary);
    add("legacy_structured", "mesh.vtk", write_legacy_structured);
    add("ucd_text", "mesh.inp", write_ucd_text);
    add("ucd_binary", "mesh.inp", write_ucd_binary);
    add("ensight", "mesh.case", write_ensight, {"mesh.case", "mesh.geo", "S.0000", "C.0000"});
    add("openfoam", "case.foam", write_openfoam,
        {"system/controlDict", "constant/polyMesh/points", "constant/polyMesh/faces", "constant/polyMesh/owner",
         "constant/polyMesh/neighbour", "constant/polyMesh/boundary", "0/C"})
        ->point_array.clear();
    const auto single = [](const fs::path& directory) { write_plot3d(directory, false); };
    const auto multi = [](const fs::path& directory) { write_plot3d(directory, true); };
    const auto add_plot3d = [&](const char* name, auto write) {
      Sample* sample = add(name, "mesh.xyz", write, {"mesh.xyz", "mesh.q"});
      sample->solution_file = "mesh.q";
      sample->point_array = "Density";
      sample->has_cell_data = false;
    };
    add_plot3d("plot3d_single", single);
    add_plot3d("plot3d_multi_blanking", multi);
    add_plot3d("plot3d_text", write_plot3d_text);
    add("vtkhdf", "mesh.vtkhdf", write_vtkhdf);
    return out;
  }();
  return list;
}

}  // namespace tetravox::test
