// The same small grid in every format that can be written here; orientations, time steps, components and what becomes
// of grids that are none.

#include "src/io/validate_grid.h"
#include "tests/unit/io/sample_grids.h"
#include "tetravox/error.h"
#include "tetravox/io.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

namespace tetravox {

namespace {

using test::GridSample;
using test::TemporaryDirectory;

std::string sample_path(const GridSample& sample, const TemporaryDirectory& directory) {
  sample.write(directory.path());
  return sample.main_file.empty() ? directory.path().string() : directory.file(sample.main_file);
}

std::vector<double> expected_values() {
  std::vector<double> values;
  for (std::size_t n = 0; n < test::kSamplePoints; ++n) values.push_back(static_cast<double>(n + 1));
  return values;
}

Error error_of(const std::string& path, const ReadOptions& options = {}) {
  try {
    read_dataset(path, options);
  } catch (const Error& error) {
    return error;
  }
  ADD_FAILURE() << path << " was read";
  return Error(ErrorCode::kInternal, "");
}

bool contains(const Error& error, const std::string& words) {
  return std::string(error.what()).find(words) != std::string::npos;
}

bool has_note(const Dataset& dataset, const std::string& words) {
  return std::any_of(dataset.info.notes.begin(), dataset.info.notes.end(),
                     [&](const std::string& note) { return note.find(words) != std::string::npos; });
}

/// World position of a point of the lattice.
std::array<double, 3> point(const GridShape& shape, std::array<std::size_t, 3> index) {
  std::array<double, 3> out = shape.origin;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double x = shape.coordinates[axis].empty() ? static_cast<double>(index[axis]) * shape.spacing[axis]
                                                     : shape.coordinates[axis][index[axis]];
    for (std::size_t row = 0; row < 3; ++row) out[row] += shape.direction[3 * row + axis] * x;
  }
  return out;
}

void expect_point(const GridShape& shape, std::array<std::size_t, 3> index, std::array<double, 3> expected) {
  const auto actual = point(shape, index);
  for (std::size_t row = 0; row < 3; ++row) EXPECT_NEAR(actual[row], expected[row], 1e-5) << row;
}

/// A grid from a file of this name and content.
Dataset read_text_file(const TemporaryDirectory& directory, const std::string& name, const std::string& text,
                       const ReadOptions& options = {}) {
  test::write_text(directory.file(name), text);
  return read_dataset(directory.file(name), options);
}

class Grids : public testing::TestWithParam<GridSample> {};

TEST_P(Grids, HoldTheSample) {
  const TemporaryDirectory directory;
  const GridSample& sample = GetParam();
  const Dataset dataset = read_dataset(sample_path(sample, directory));
  ASSERT_TRUE(dataset.is_grid());
  const GridData& grid = dataset.grid;
  EXPECT_EQ(grid.shape.dimensions, (std::array<std::uint32_t, 3>{4, 3, 5}));
  EXPECT_EQ(grid.type, sample.type);
  EXPECT_EQ(grid.components, 1);
  EXPECT_EQ(grid.component, 0);
  EXPECT_EQ(grid.association, Association::kPoint);
  EXPECT_EQ(test::grid_values(grid), expected_values());
  const double origin[] = {10, 20, 30}, spacing[] = {0.5, 1, 2};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    EXPECT_NEAR(grid.shape.origin[axis], sample.has_origin ? origin[axis] : 0.0, 1e-12);
    EXPECT_NEAR(grid.shape.spacing[axis], sample.has_spacing ? spacing[axis] : 1.0, 1e-12);
    EXPECT_TRUE(grid.shape.coordinates[axis].empty());
  }
  EXPECT_EQ(grid.shape.direction, GridShape{}.direction);
  EXPECT_TRUE(dataset.mesh.points.empty());
}

TEST_P(Grids, AreSummarised) {
  const TemporaryDirectory directory;
  const GridSample& sample = GetParam();
  ReadOptions options;
  options.only_info = true;
  const Dataset dataset = read_dataset(sample_path(sample, directory), options);
  ASSERT_TRUE(dataset.is_grid());
  EXPECT_TRUE(dataset.grid.values.empty());
  const DatasetInfo& info = dataset.info;
  EXPECT_EQ(info.point_count, 60u);
  EXPECT_EQ(info.cell_count, 24u);
  EXPECT_TRUE(info.cells_by_type.empty());
  ASSERT_EQ(info.arrays.size(), 1u);
  EXPECT_EQ(info.arrays[0].type, scalar_type_name(sample.type));
  EXPECT_EQ(info.arrays[0].component_ranges.at(0).min, 1.0);
  EXPECT_EQ(info.arrays[0].magnitude_range.max, 60.0);
  EXPECT_EQ(info.arrays[0].nan_count, 0u);
  EXPECT_NEAR(info.bounds[0].max - info.bounds[0].min, sample.has_spacing ? 1.5 : 3.0, 1e-12);
  EXPECT_NEAR(info.bounds[2].max - info.bounds[2].min, sample.has_spacing ? 8.0 : 4.0, 1e-12);
  EXPECT_TRUE(info.notes.empty()) << info.notes.front();
}

INSTANTIATE_TEST_SUITE_P(All, Grids, testing::ValuesIn(test::grid_samples()),
                         [](const auto& instance) { return instance.param.name; });

const char* const kShearedVti =
    "<VTKFile type=\"ImageData\" version=\"1.0\" byte_order=\"LittleEndian\">\n"
    "<ImageData WholeExtent=\"2 4 0 1 0 1\" Origin=\"1 2 3\" Spacing=\"2 1 1\" Direction=\"0 -1 0.5 1 0 0 0 0 1\">\n"
    "<Piece Extent=\"2 4 0 1 0 1\"><PointData/><CellData><DataArray type=\"Int16\" Name=\"C\" format=\"ascii\">\n"
    "-5 7</DataArray></CellData></Piece></ImageData></VTKFile>\n";

TEST(Vti, DirectionExtentAndCellData) {
  const TemporaryDirectory directory;
  const Dataset dataset = read_text_file(directory, "a.vti", kShearedVti);
  const GridData& grid = dataset.grid;
  EXPECT_EQ(grid.association, Association::kCell);
  EXPECT_EQ(grid.type, ScalarType::kInt16);
  EXPECT_EQ(test::grid_values(grid), (std::vector<double>{-5, 7}));
  expect_point(grid.shape, {0, 0, 0}, {1, 2 + 4, 3});
  expect_point(grid.shape, {1, 1, 1}, {1 - 1 + 0.5, 2 + 6, 3 + 1});
  EXPECT_EQ(dataset.info.cell_count, 2u);
}

TEST(Vti, ImplausibleOrientationFallsBack) {
  const TemporaryDirectory directory;
  std::string text = kShearedVti;
  text.replace(text.find("0 -1 0.5 1 0 0 0 0 1"), 20, "1 0 0 1 0 0 0 0 1");
  const Dataset flat = read_text_file(directory, "a.vti", text);
  EXPECT_EQ(flat.grid.shape.direction, GridShape{}.direction);
  EXPECT_TRUE(has_note(flat, "direction"));
  text = kShearedVti;
  text.replace(text.find("Spacing=\"2 1 1\""), 15, "Spacing=\"0 1 1\"");
  const Dataset dataset = read_text_file(directory, "b.vti", text);
  EXPECT_EQ(dataset.grid.shape.spacing[0], 1.0);
  EXPECT_TRUE(has_note(dataset, "spacing"));
}

TEST(Vti, NegativeSpacingTurnsItsAxis) {
  const TemporaryDirectory directory;
  std::string text = kShearedVti;
  text.replace(text.find("Spacing=\"2 1 1\""), 15, "Spacing=\"-2 1 1\"");
  const GridShape shape = read_text_file(directory, "a.vti", text).grid.shape;
  EXPECT_EQ(shape.spacing[0], 2.0);
  expect_point(shape, {1, 0, 0}, {1, 2 - 6, 3});
}

/// A VTI file of 2 x 2 x 2 points with this point data.
std::string cube_text(const std::string& point_data, const std::string& cell_data = {}) {
  return "<VTKFile type=\"ImageData\" version=\"1.0\" byte_order=\"LittleEndian\">\n"
         "<ImageData WholeExtent=\"0 1 0 1 0 1\" Origin=\"0 0 0\" Spacing=\"1 1 1\">\n<Piece Extent=\"0 1 0 1 0 1\">"
         "<PointData>" +
         point_data + "</PointData><CellData>" + cell_data + "</CellData></Piece></ImageData></VTKFile>\n";
}

std::string array_text(const std::string& type, int components, int tuples, const std::string& name = "A") {
  std::string out = "<DataArray type=\"" + type + "\" Name=\"" + name + "\" NumberOfComponents=\"" +
                    std::to_string(components) + "\" format=\"ascii\">";
  for (int i = 0; i < components * tuples; ++i) out += std::to_string(i) + ' ';
  return out + "</DataArray>";
}

TEST(Components, UpToFourStayTogether) {
  const TemporaryDirectory directory;
  for (int components = 1; components <= 4; ++components) {
    const Dataset dataset = read_text_file(directory, "a.vti", cube_text(array_text("UInt8", components, 8)));
    EXPECT_EQ(dataset.grid.components, components);
    EXPECT_EQ(dataset.grid.type, ScalarType::kUint8);
    EXPECT_EQ(dataset.grid.component, components == 1 ? 0 : kMagnitude);
    EXPECT_EQ(dataset.grid.values.size(), 8u * static_cast<std::size_t>(components));
  }
  ReadOptions options;
  options.array.component = 2;
  EXPECT_EQ(read_text_file(directory, "a.vti", cube_text(array_text("UInt8", 3, 8)), options).grid.component, 2);
}

TEST(Components, OfMoreThanFourOneIsMade) {
  const TemporaryDirectory directory;
  ReadOptions options;
  options.array.component = 5;
  const std::string text = cube_text(array_text("Int32", 9, 8));
  const GridData grid = read_text_file(directory, "a.vti", text, options).grid;
  EXPECT_EQ(grid.components, 1);
  EXPECT_EQ(grid.component, 0);
  EXPECT_EQ(grid.type, ScalarType::kFloat64);
  EXPECT_EQ(test::grid_values(grid).at(1), 9.0 + 5.0);
  EXPECT_NEAR(test::grid_values(read_text_file(directory, "a.vti", text).grid).at(0), std::sqrt(204.0), 1e-12);
}

TEST(Components, AllNumberTypesStay) {
  const TemporaryDirectory directory;
  for (const char* type :
       {"Int8", "UInt8", "Int16", "UInt16", "Int32", "UInt32", "Int64", "UInt64", "Float32", "Float64"}) {
    const Dataset dataset = read_text_file(directory, "a.vti", cube_text(array_text(type, 1, 8)));
    std::string name = type;
    std::transform(name.begin(), name.end(), name.begin(), [](char c) { return static_cast<char>(std::tolower(c)); });
    EXPECT_EQ(scalar_type_name(dataset.grid.type), name);
    EXPECT_EQ(test::grid_values(dataset.grid).at(7), 7.0);
  }
}

TEST(Components, MissingValuesAreCounted) {
  const TemporaryDirectory directory;
  const Dataset dataset = read_text_file(
      directory, "a.nrrd", "NRRD0004\ntype: float\nencoding: text\ndimension: 3\nsizes: 2 2 2\n\n1 2 nan 4 5 -3 inf 8");
  EXPECT_EQ(dataset.info.arrays[0].nan_count, 2u);
  EXPECT_EQ(dataset.info.arrays[0].component_ranges[0].min, -3.0);
  EXPECT_EQ(dataset.info.arrays[0].component_ranges[0].max, 8.0);
  EXPECT_TRUE(std::isnan(test::grid_values(dataset.grid)[2]));
}

TEST(NoArrays, AreAHomogeneousBody) {
  const TemporaryDirectory directory;
  const Dataset dataset = read_text_file(directory, "a.vti", cube_text(""));
  EXPECT_EQ(dataset.grid.array_name, "(uniform)");
  EXPECT_EQ(dataset.grid.association, Association::kCell);
  EXPECT_EQ(test::grid_values(dataset.grid), std::vector<double>{1.0});
}

TEST(Ghosts, MakeAMeshOfTheGrid) {
  const TemporaryDirectory directory;
  std::string text = kShearedVti;
  text.insert(text.find("</CellData>"),
              "<DataArray type=\"UInt8\" Name=\"vtkGhostType\" format=\"ascii\">0 32</DataArray>");
  const Dataset dataset = read_text_file(directory, "a.vti", text);
  EXPECT_FALSE(dataset.is_grid());
  EXPECT_EQ(dataset.mesh.cell_count(), 1u);
  EXPECT_EQ(dataset.info.left_out.blanked, 1u);
  EXPECT_NEAR(dataset.mesh.points[1], 6.0, 1e-12);  // The second coordinate of the first point, turned.
  text.replace(text.find(">0 32<"), 6, ">0 0<");
  EXPECT_TRUE(read_text_file(directory, "b.vti", text).is_grid());
}

TEST(Blocks, SeveralGridsMakeAMesh) {
  const TemporaryDirectory directory;
  test::write_text(directory.file("a.vti"), cube_text(array_text("UInt8", 1, 8)));
  const Dataset dataset = read_text_file(
      directory, "a.vtm",
      "<VTKFile type=\"vtkMultiBlockDataSet\" version=\"1.0\"><vtkMultiBlockDataSet><DataSet index=\"0\" "
      "file=\"a.vti\"/><DataSet index=\"1\" file=\"a.vti\"/></vtkMultiBlockDataSet></VTKFile>");
  EXPECT_FALSE(dataset.is_grid());
  EXPECT_EQ(dataset.mesh.cell_count(), 2u);
  EXPECT_EQ(dataset.mesh.scalars[15], 7.0);
}

/// A VTR file of 2 x 2 x `count` points.
std::string vtr_text(const std::string& z, int count) {
  std::string out =
      "<VTKFile type=\"RectilinearGrid\" version=\"1.0\" byte_order=\"LittleEndian\"><RectilinearGrid "
      "WholeExtent=\"E\">"
      "<Piece Extent=\"E\"><PointData>" +
      array_text("UInt8", 1, 4 * count) +
      "</PointData><Coordinates><DataArray type=\"Float64\" format=\"ascii\">0 1</DataArray><DataArray "
      "type=\"Float64\" "
      "format=\"ascii\">0 1</DataArray><DataArray type=\"Float64\" format=\"ascii\">" +
      z + "</DataArray></Coordinates></Piece></RectilinearGrid></VTKFile>";
  for (std::size_t at; (at = out.find("\"E\"")) != std::string::npos;)
    out.replace(at, 3, "\"0 1 0 1 0 " + std::to_string(count - 1) + "\"");
  return out;
}

TEST(Rectilinear, EvenUnevenAndDescendingAxes) {
  const TemporaryDirectory directory;
  const GridShape even = read_text_file(directory, "a.vtr", vtr_text("5 7.0000001 9", 3)).grid.shape;
  EXPECT_TRUE(even.coordinates[2].empty());
  EXPECT_DOUBLE_EQ(even.spacing[2], 2.0);
  EXPECT_DOUBLE_EQ(even.origin[2], 5.0);
  const GridShape uneven = read_text_file(directory, "b.vtr", vtr_text("5 7.1 9", 3)).grid.shape;
  EXPECT_EQ(uneven.coordinates[2], (std::vector<double>{5, 7.1, 9}));
  for (const char* z : {"9 7 5", "9 7.1 5"}) {
    const Dataset dataset = read_text_file(directory, "c.vtr", vtr_text(z, 3));
    const GridShape& shape = dataset.grid.shape;
    EXPECT_EQ(shape.direction[8], -1.0);
    expect_point(shape, {0, 0, 0}, {0, 0, 9});
    expect_point(shape, {1, 0, 2}, {1, 0, 5});
    EXPECT_EQ(dataset.info.bounds[2].min, 5.0);
    EXPECT_EQ(dataset.info.bounds[2].max, 9.0);
  }
  EXPECT_FALSE(read_text_file(directory, "d.vtr", vtr_text("5 9 7", 3)).is_grid());
}

TEST(SingleSlices, HaveNoVolume) {
  const TemporaryDirectory directory;
  test::write_text(directory.file("a.dcm"), test::dicom_slice(2));
  test::write_text(directory.file("a.tif"), test::tiff_file({std::string(12, 'x')}, 4, 3));
  for (const char* name : {"a.dcm", "a.tif"}) {
    const Error error = error_of(directory.file(name));
    EXPECT_EQ(error.code(), ErrorCode::kNothingToDraw) << name;
    EXPECT_TRUE(contains(error, "single slice")) << error.what();
  }
}

std::string nrrd_text(const std::string& fields, const std::string& values) {
  return "NRRD0004\ntype: uint8\nencoding: text\n" + fields + "\n" + values;
}

TEST(Nrrd, ShearedDirectionsAndOrigin) {
  const TemporaryDirectory directory;
  const Dataset dataset = read_text_file(
      directory, "a.nrrd",
      nrrd_text("dimension: 3\nsizes: 2 2 2\nspace dimension: 3\nspace directions: (0,2,0) (-3,0,0) (1,0,1)\n"
                "space origin: (1,2,3)\n",
                "1 2 3 4 5 6 7 8"));
  expect_point(dataset.grid.shape, {1, 0, 0}, {1, 4, 3});
  expect_point(dataset.grid.shape, {0, 1, 0}, {-2, 2, 3});
  expect_point(dataset.grid.shape, {1, 1, 1}, {-1, 4, 4});
  EXPECT_TRUE(dataset.info.notes.empty());
}

TEST(Nrrd, SpacingsMinimaAndCenters) {
  const TemporaryDirectory directory;
  const Dataset dataset = read_text_file(
      directory, "a.nrrd",
      nrrd_text("dimension: 3\nsizes: 2 2 2\nspacings: 2 NaN 0.5\naxis mins: 10 20 30\ncenters: cell node node\n",
                "1 2 3 4 5 6 7 8"));
  expect_point(dataset.grid.shape, {0, 0, 0}, {11, 20, 30});
  expect_point(dataset.grid.shape, {1, 1, 1}, {13, 21, 30.5});
}

TEST(Nrrd, ComponentsAndTimeSteps) {
  const TemporaryDirectory directory;
  const std::string values = "0 1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16 17 18 19 20 21 22 23";
  const Dataset colour = read_text_file(
      directory, "a.nrrd", nrrd_text("dimension: 4\nsizes: 3 2 2 2\nkinds: RGB-color domain domain domain\n", values));
  EXPECT_EQ(colour.grid.components, 3);
  EXPECT_EQ(test::grid_values(colour.grid)[4], 4.0);
  std::string bytes;
  for (int i = 0; i < 16; ++i) bytes += static_cast<char>(i);
  const std::string text =
      "NRRD0004\ntype: uint8\nencoding: raw\ndimension: 4\nsizes: 2 2 2 2\n"
      "space directions: (1,0,0) (0,1,0) (0,0,1) none\n\n" +
      bytes;
  ReadOptions options;
  options.time.index = 1;
  const Dataset second = read_text_file(directory, "b.nrrd", text, options);
  EXPECT_EQ(second.info.times.size(), 2u);
  EXPECT_EQ(second.info.time_index, 1u);
  EXPECT_EQ(test::grid_values(second.grid)[0], 8.0);
}

TEST(Nrrd, FilesByPatternListAndSkips) {
  const TemporaryDirectory directory;
  for (int k = 0; k < 3; ++k)
    test::write_text(directory.file("s0" + std::to_string(k) + ".raw"),
                     "skip\nXX" + std::string(4, static_cast<char>(k)));
  const std::string head =
      "NRRD0004\ntype: uchar\nencoding: raw\ndimension: 3\nsizes: 2 2 3\nline skip: 1\nbyte skip: 2\n";
  const std::vector<double> expected{0, 0, 0, 0, 1, 1, 1, 1, 2, 2, 2, 2};
  EXPECT_EQ(test::grid_values(read_text_file(directory, "a.nhdr", head + "data file: s%02d.raw 0 2 1\n").grid),
            expected);
  EXPECT_EQ(test::grid_values(
                read_text_file(directory, "b.nhdr", head + "data file: LIST\ns00.raw\ns01.raw\ns02.raw\n").grid),
            expected);
  std::string from_end = head;
  from_end.replace(from_end.find("line skip: 1\nbyte skip: 2"), 25, "byte skip: -1");
  EXPECT_EQ(test::grid_values(read_text_file(directory, "c.nhdr", from_end + "data file: s%02d.raw 0 2 1\n").grid),
            expected);
}

TEST(MetaImage, RowsOfTheMatrixAreAxes) {
  const TemporaryDirectory directory;
  const std::string head =
      "NDims = 3\nDimSize = 2 2 2\nElementSpacing = 2 3 4\nOffset = 1 2 3\nElementType = MET_UCHAR\n";
  const Dataset dataset = read_text_file(
      directory, "a.mha", head + "TransformMatrix = 0 1 0 -1 0 0 0 0 1\nElementDataFile = LOCAL\n12345678");
  expect_point(dataset.grid.shape, {1, 0, 0}, {1, 4, 3});
  expect_point(dataset.grid.shape, {0, 1, 0}, {-2, 2, 3});
  const Dataset singular = read_text_file(
      directory, "b.mha", head + "TransformMatrix = 0 0 0 0 0 0 0 0 0\nElementDataFile = LOCAL\n12345678");
  EXPECT_EQ(singular.grid.shape.direction, GridShape{}.direction);
  EXPECT_TRUE(has_note(singular, "direction"));
}

TEST(MetaImage, ListsPatternsTextAndChannels) {
  const TemporaryDirectory directory;
  for (int k = 1; k <= 2; ++k)
    test::write_text(directory.file("s" + std::to_string(k)), std::string(4, static_cast<char>(k)));
  const std::string head = "NDims = 3\nDimSize = 2 2 2\nElementType = MET_UCHAR\n";
  const std::vector<double> expected{1, 1, 1, 1, 2, 2, 2, 2};
  EXPECT_EQ(test::grid_values(read_text_file(directory, "a.mhd", head + "ElementDataFile = LIST\ns1\ns2\n").grid),
            expected);
  EXPECT_EQ(test::grid_values(read_text_file(directory, "b.mhd", head + "ElementDataFile = s%d 1 2 1\n").grid),
            expected);
  EXPECT_EQ(test::grid_values(read_text_file(directory, "c.mha",
                                             head + "BinaryData = False\nElementDataFile = LOCAL\n1 1 1 1 2 2 2 2\n")
                                  .grid),
            expected);
  const Dataset two = read_text_file(directory, "d.mha",
                                     head + "ElementNumberOfChannels = 2\nElementDataFile = LOCAL\n0123456789abcdef");
  EXPECT_EQ(two.grid.components, 2);
  EXPECT_TRUE(has_note(read_text_file(directory, "e.mha", head + "ElementDataFile = LOCAL\n123456789"), "goes on"));
}

TEST(Nifti, SformBeforeQformAndSheared) {
  const TemporaryDirectory directory;
  std::string header = test::nifti_header(2, 8);
  test::set_number(header, 254, std::int16_t{2});
  const float rows[3][4] = {{0, -2, 0.5f, 5}, {1, 0, 0, 6}, {0, 0, 3, 7}};
  for (std::size_t row = 0; row < 3; ++row)
    for (std::size_t column = 0; column < 4; ++column)
      test::set_number(header, 280 + 16 * row + 4 * column, rows[row][column]);
  const Dataset dataset = read_text_file(directory, "a.nii", header + test::sample_bytes(ScalarType::kUint8));
  expect_point(dataset.grid.shape, {0, 0, 0}, {5, 6, 7});
  expect_point(dataset.grid.shape, {1, 1, 1}, {5 - 2 + 0.5, 7, 10});
}

TEST(Nifti, QuaternionAndTurnedThirdAxis) {
  const TemporaryDirectory directory;
  std::string header = test::nifti_header(2, 8);
  test::set_number(header, 76, -1.0f);                                // The third axis is turned.
  test::set_number(header, 264, static_cast<float>(std::sqrt(0.5)));  // A quarter turn about z.
  const GridShape shape =
      read_text_file(directory, "a.nii", header + test::sample_bytes(ScalarType::kUint8)).grid.shape;
  expect_point(shape, {1, 0, 0}, {10, 20.5, 30});
  expect_point(shape, {0, 1, 0}, {9, 20, 30});
  expect_point(shape, {0, 0, 1}, {10, 20, 28});
}

TEST(Nifti, TimeStepsVectorsAndScaling) {
  const TemporaryDirectory directory;
  const std::string bytes = test::sample_bytes(ScalarType::kUint8);
  std::string header = test::nifti_header(2, 8);
  test::set_number(header, 40, std::int16_t{4});
  test::set_number(header, 48, std::int16_t{2});
  test::set_number(header, 92, 1.5f);
  test::set_number(header, 112, 2.0f);
  ReadOptions options;
  options.time.index = 1;
  const Dataset second = read_text_file(directory, "a.nii", header + std::string(60, '\1') + bytes, options);
  EXPECT_EQ(second.info.times, (std::vector<double>{0.0, 1.5}));
  EXPECT_EQ(test::grid_values(second.grid), expected_values());
  EXPECT_TRUE(has_note(second, "scales"));
  test::set_number(header, 40, std::int16_t{5});
  test::set_number(header, 48, std::int16_t{1});
  test::set_number(header, 50, std::int16_t{2});
  const GridData vector = read_text_file(directory, "b.nii", header + std::string(60, '\1') + bytes).grid;
  EXPECT_EQ(vector.components, 2);
  EXPECT_EQ(test::grid_values(vector)[6], 1.0);
  EXPECT_EQ(test::grid_values(vector)[7], 4.0);
}

TEST(Dicom, RotatedSlicesAreSortedAlongTheirNormal) {
  const TemporaryDirectory directory;
  for (std::size_t k = 0; k < 5; ++k) {
    std::string file = test::dicom_slice(k);
    const auto replace = [&](const std::string& from, const std::string& to) {
      file.replace(file.find(from), from.size(), to);
    };
    replace("1\\0\\0\\0\\1\\0", "0\\1\\0\\0\\0\\1");  // Rows along y, columns along z, slices along x.
    replace("10\\20\\" + std::to_string(30 + 2 * k), std::to_string(30 + 2 * k) + "\\20\\10");
    test::write_text(directory.file(std::to_string((7 * k) % 5) + ".dcm"), file);
  }
  const Dataset dataset = read_dataset(directory.path().string());
  EXPECT_EQ(test::grid_values(dataset.grid), expected_values());
  expect_point(dataset.grid.shape, {1, 1, 1}, {32, 20.5, 11});
}

TEST(Dicom, MissingSlicesLeaveTheirPlace) {
  const TemporaryDirectory directory;
  for (const std::size_t k : {0, 1, 4})
    test::write_text(directory.file(std::to_string(k) + ".dcm"), test::dicom_slice(k));
  const Dataset dataset = read_dataset(directory.path().string());
  EXPECT_EQ(dataset.grid.shape.dimensions[2], 3u);
  expect_point(dataset.grid.shape, {0, 0, 1}, {10, 20, 32});
  expect_point(dataset.grid.shape, {0, 0, 2}, {10, 20, 38});
  EXPECT_TRUE(has_note(dataset, "distances"));
}

TEST(Dicom, SeriesSlopesAndCopies) {
  const TemporaryDirectory directory;
  const std::string rescale =
      test::dicom_element(0x0028, 0x1052, "DS", "-1024") + test::dicom_element(0x0028, 0x1053, "DS", "1");
  for (std::size_t k = 0; k < 5; ++k)
    test::write_text(directory.file(std::to_string(k)), test::dicom_slice(k, rescale));
  test::write_text(directory.file("copy"), test::dicom_slice(3, rescale));
  std::string other = test::dicom_slice(0);
  other.replace(other.find("1.2.3"), 5, "1.2.4");
  test::write_text(directory.file("other"), other);
  const Dataset dataset = read_dataset(directory.path().string());
  EXPECT_EQ(dataset.grid.type, ScalarType::kInt16);
  EXPECT_EQ(test::grid_values(dataset.grid)[59], 60.0 - 1024.0);
  EXPECT_EQ(dataset.grid.shape.dimensions[2], 5u);
  EXPECT_TRUE(has_note(dataset, "2 volumes"));
  EXPECT_TRUE(has_note(dataset, "1 slices at places"));
}

TEST(Dicom, CompressedPixelsAreRefused) {
  const TemporaryDirectory directory;
  std::string file = test::dicom_slice(0);
  file.replace(file.find("1.2.840.10008.1.2.1"), 19, "1.2.840.10008.1.2.5");
  test::write_text(directory.file("a.dcm"), file);
  EXPECT_EQ(error_of(directory.file("a.dcm")).code(), ErrorCode::kUnsupported);
}

TEST(Tiff, SlicesMustBeAlike) {
  const TemporaryDirectory directory;
  test::write_text(directory.file("1.tif"), test::tiff_file({std::string(12, 'x')}, 4, 3));
  test::write_text(directory.file("2.tif"), test::tiff_file({std::string(12, 'x')}, 3, 4));
  const Error error = error_of(directory.path().string());
  EXPECT_EQ(error.code(), ErrorCode::kUnsupported);
  EXPECT_TRUE(contains(error, "2.tif") && contains(error, "3 x 4")) << error.what();
}

TEST(Mrc, ModesAxesAndAngles) {
  const TemporaryDirectory directory;
  std::string header = test::mrc_header(0);
  test::set_number(header, 64, std::int32_t{3});  // Columns along z, sections along x.
  test::set_number(header, 72, std::int32_t{1});
  test::set_number(header, 28, std::int32_t{5});
  test::set_number(header, 36, std::int32_t{4});
  test::set_number(header, 60, 60.0f);  // The angle of a and b.
  const Dataset dataset = read_text_file(directory, "a.mrc", header + test::sample_bytes(ScalarType::kUint8));
  EXPECT_EQ(dataset.grid.type, ScalarType::kInt8);
  expect_point(dataset.grid.shape, {1, 0, 0}, {10, 20, 32.5});
  expect_point(dataset.grid.shape, {0, 1, 0}, {10.5, 20 + std::sqrt(0.75), 30});
  expect_point(dataset.grid.shape, {0, 0, 1}, {10.4, 20, 30});
}

TEST(ValidateGrid, NamesWhatIsWrong) {
  const auto problem = [](const auto& damage) -> std::string {
    const std::vector<std::byte> values(24);
    GridData grid;
    grid.shape.dimensions = {2, 3, 4};
    grid.values = values;
    damage(grid);
    try {
      io::validate_grid(grid, "file");
    } catch (const Error& error) {
      return error.what();
    }
    return {};
  };
  const auto expect = [&](const char* words, const auto& damage) {
    EXPECT_NE(problem(damage).find(words), std::string::npos) << problem(damage);
  };
  using G = GridData&;
  EXPECT_EQ(problem([](G) {}), "");
  expect("no volume", [](G g) { g.shape.dimensions[1] = 1; });
  expect("no volume", [](G g) { g.shape.dimensions[1] = 0; });
  expect("24 bytes instead of 48", [](G g) { g.type = ScalarType::kInt16; });
  expect("24 bytes instead of 6", [](G g) { g.association = Association::kCell; });
  expect("make no sense", [](G g) { g.shape.dimensions = {~0u, ~0u, ~0u}; });
  expect("component", [](G g) { g.component = 1; });
  expect("component", [](G g) { g.components = 5; });
  expect("axis j of the grid: the spacing", [](G g) { g.shape.spacing[1] = 0.0; });
  expect("the spacing", [](G g) { g.shape.spacing[2] = NAN; });
  expect("origin", [](G g) { g.shape.origin[2] = INFINITY; });
  expect("direction", [](G g) { g.shape.direction[0] = 0.0; });
  expect("direction", [](G g) { g.shape.direction[5] = NAN; });
  expect("2 coordinates for 4", [](G g) { g.shape.coordinates[2] = {1, 2}; });
  expect("coordinate 2 does not ascend", [](G g) { g.shape.coordinates[1] = {1, 2, 2}; });
  expect("coordinate 1 is not finite", [](G g) { g.shape.coordinates[1] = {1, NAN, 2}; });
}

}  // namespace

}  // namespace tetravox
