// Further arrays read in the same pass: of meshes, grids and RAW files; components; what does not go together.

#include "src/io/reader_protocol.h"
#include "tests/unit/io/sample_grids.h"
#include "tetravox/error.h"
#include "tetravox/io.h"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>
#include <string>
#include <vector>

namespace tetravox {

namespace {

using test::TemporaryDirectory;

Error error_of(const std::string& path, const ReadOptions& options) {
  try {
    read_dataset(path, options);
  } catch (const Error& error) {
    EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
    return error;
  }
  ADD_FAILURE() << path << " was read";
  return Error(ErrorCode::kInternal, "");
}

void expect_words(const Error& error, const std::vector<std::string>& words) {
  EXPECT_EQ(error.code(), ErrorCode::kInvalidArgument) << error.what();
  for (const std::string& word : words)
    EXPECT_NE(std::string(error.what()).find(word), std::string::npos) << word << ": " << error.what();
}

/// A VTU file with the point arrays S, V (three components) and W = 100 - S, and the cell arrays C, D.
std::string mesh_text() {
  std::string vectors, falling;
  for (int i = 0; i < 12; ++i) {
    vectors += std::to_string(3 * i) + " " + std::to_string(4 * i) + " 0 ";
    falling += std::to_string(100 - i) + " ";
  }
  std::string text = test::vtu_text("<DataArray type=\"Float32\" Name=\"D\" format=\"ascii\">-1 -2</DataArray>");
  const std::string end = "</PointData>";
  text.insert(text.find(end), "<DataArray type=\"Float32\" Name=\"V\" NumberOfComponents=\"3\" format=\"ascii\">" +
                                  vectors + "</DataArray><DataArray type=\"Float32\" Name=\"W\" format=\"ascii\">" +
                                  falling + "</DataArray>");
  return text;
}

/// A VTI file of 3 x 2 x 2 points: A = 0 .. 11 as uint8, B with two float32 components, H with six; cell array C.
std::string grid_text() {
  std::string a, b, h;
  for (int i = 0; i < 12; ++i) {
    a += std::to_string(i) + " ";
    b += std::to_string(3 * i) + " " + std::to_string(4 * i) + " ";
    for (int c = 0; c < 6; ++c) h += std::to_string(10 * i + c) + " ";
  }
  return "<VTKFile type=\"ImageData\" version=\"0.1\" byte_order=\"LittleEndian\">\n"
         "<ImageData WholeExtent=\"0 2 0 1 0 1\" Origin=\"0 0 0\" Spacing=\"1 1 1\"><Piece Extent=\"0 2 0 1 0 1\">\n"
         "<PointData><DataArray type=\"UInt8\" Name=\"A\" format=\"ascii\">" +
         a + "</DataArray><DataArray type=\"Float32\" Name=\"B\" NumberOfComponents=\"2\" format=\"ascii\">" + b +
         "</DataArray><DataArray type=\"Int16\" Name=\"H\" NumberOfComponents=\"6\" format=\"ascii\">" + h +
         "</DataArray></PointData>\n<CellData><DataArray type=\"UInt8\" Name=\"C\" format=\"ascii\">1 2</DataArray>"
         "</CellData></Piece></ImageData></VTKFile>\n";
}

/// The file and what reads it.
struct Input {
  TemporaryDirectory directory;
  std::string path;

  Input(const std::string& name, const std::string& text) : path(directory.file(name)) { test::write_text(path, text); }
  Dataset read(const ArrayRequest& array, const std::vector<ArrayRequest>& others) const {
    return read_dataset(path, options(array, others));
  }
  Error refuse(const ArrayRequest& array, const std::vector<ArrayRequest>& others) const {
    return error_of(path, options(array, others));
  }
  static ReadOptions options(const ArrayRequest& array, const std::vector<ArrayRequest>& others) {
    ReadOptions options;
    options.array = array;
    options.others = others;
    return options;
  }
};

TEST(OtherArrays, OfAMeshComeInTheOrderAskedFor) {
  const Input input("mesh.vtu", mesh_text());
  const Dataset dataset = input.read({"S", {}, {}}, {{"W", {}, {}}, {"V", {}, {}}, {"V", {}, 1}, {"S", {}, {}}});
  const MeshData& mesh = dataset.mesh;
  EXPECT_EQ(mesh.array_name, "S");
  ASSERT_EQ(mesh.others.size(), 4u);
  const double expected[4] = {97.0, 15.0, 12.0, 3.0};
  const char* names[4] = {"W", "V", "V", "S"};
  const int components[4] = {0, kMagnitude, 1, 0};
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(mesh.others[i].array_name, names[i]);
    EXPECT_EQ(mesh.others[i].component, components[i]);
    ASSERT_EQ(mesh.others[i].scalars.size(), 12u);
    EXPECT_EQ(mesh.others[i].scalars[3], expected[i]);
  }
}

TEST(OtherArrays, OfCellsGoWithCells) {
  const Input input("mesh.vtu", mesh_text());
  const Dataset dataset = input.read({"C", {}, {}}, {{"D", {}, {}}});
  ASSERT_EQ(dataset.mesh.others.size(), 1u);
  ASSERT_EQ(dataset.mesh.others[0].scalars.size(), 2u);
  EXPECT_EQ(dataset.mesh.others[0].scalars[1], -2.0);
  expect_words(input.refuse({"S", {}, {}}, {{"D", {}, {}}}), {"'S' (point)", "'D' (cell)", "do not go together"});
  expect_words(input.refuse({"S", {}, {}}, {{"W", Association::kCell, {}}}), {"no cell array 'W'"});
}

TEST(OtherArrays, WrongOnesAreRefused) {
  const Input input("mesh.vtu", mesh_text());
  expect_words(input.refuse({"S", {}, {}}, {{"X", {}, {}}}), {"no array 'X'", "'W' (point)"});
  expect_words(input.refuse({"S", {}, {}}, {{"V", {}, 3}}), {"'V' with component 3"});
  expect_words(input.refuse({"S", {}, {}}, {{"", {}, {}}}), {"has no name"});
  expect_words(input.refuse({"S", {}, {}}, std::vector<ArrayRequest>(9, {"W", {}, {}})), {"9 further arrays", "8"});
}

TEST(OtherArrays, OfAGridShareTheValuesOfOneArray) {
  const Input input("grid.vti", grid_text());
  const Dataset dataset = input.read({"B", {}, 1}, {{"A", {}, {}}, {"B", {}, 0}, {"H", {}, 5}, {"H", {}, 2}});
  ASSERT_TRUE(dataset.is_grid());
  ASSERT_EQ(dataset.other_grids.size(), 4u);
  const GridData& a = dataset.other_grids[0];
  EXPECT_EQ(a.type, ScalarType::kUint8);
  EXPECT_EQ(a.shape, dataset.grid.shape);
  EXPECT_EQ(test::grid_values(a)[7], 7.0);
  const GridData& b = dataset.other_grids[1];
  EXPECT_EQ(b.values.data(), dataset.grid.values.data());
  EXPECT_EQ(b.component, 0);
  EXPECT_EQ(dataset.grid.component, 1);
  EXPECT_EQ(test::grid_values(b)[2 * 7 + 1], 28.0);
  // Of more components than a grid has, each is an array of its own.
  for (const auto& [index, component] : {std::pair(2, 5), std::pair(3, 2)}) {
    const GridData& h = dataset.other_grids[static_cast<std::size_t>(index)];
    EXPECT_EQ(h.type, ScalarType::kFloat64);
    EXPECT_EQ(h.components, 1);
    EXPECT_EQ(test::grid_values(h)[7], 70.0 + component);
  }
  expect_words(input.refuse({"A", {}, {}}, {{"C", {}, {}}}), {"'A' (point)", "'C' (cell)"});
}

TEST(OtherArrays, OfARawFileAreItsComponents) {
  const Input input("two_2x2x2_uint8.raw", "\1\2\3\4\5\6\7\10\11\12\13\14\15\16\17\20");
  ReadOptions options;
  options.raw.components = 2;
  options.array.component = 1;
  options.others = {{"values", {}, 0}, {"values", {}, {}}};
  const Dataset dataset = read_dataset(input.path, options);
  ASSERT_EQ(dataset.other_grids.size(), 2u);
  EXPECT_EQ(dataset.grid.component, 1);
  EXPECT_EQ(dataset.other_grids[0].component, 0);
  EXPECT_EQ(dataset.other_grids[1].component, kMagnitude);
  EXPECT_EQ(dataset.other_grids[0].values.data(), dataset.grid.values.data());
  options.others = {{"values", {}, 2}};
  expect_words(error_of(input.path, options), {"'values' with component 2"});
}

TEST(OtherArrays, AreNotReadForASummary) {
  const Input input("grid.vti", grid_text());
  ReadOptions options = Input::options({"B", {}, 1}, {{"A", {}, {}}});
  options.only_info = true;
  EXPECT_TRUE(read_dataset(input.path, options).other_grids.empty());
  EXPECT_TRUE(read_dataset("builtin:hydrogen", options = Input::options({}, {{"wave", {}, {}}})).other_grids.size() ==
              1);
  options.only_info = true;
  EXPECT_TRUE(read_dataset("builtin:hydrogen", options).other_grids.empty());
}

TEST(ReaderProtocol, CarriesFurtherArrays) {
  io::ReaderRequest request{
      "a=b.vtu",
      Input::options({"S", Association::kPoint, 2}, {{"x=y", Association::kCell, {}}, {"z", {}, kMagnitude}}), 1};
  const std::vector<std::string> arguments = io::format_request(request);
  std::vector<const char*> views;
  for (const std::string& argument : arguments) views.push_back(argument.c_str());
  const ReadOptions read = io::parse_request(views).options;
  ASSERT_EQ(read.others.size(), 2u);
  EXPECT_EQ(read.array.name, "S");
  EXPECT_EQ(read.array.component, 2);
  EXPECT_EQ(read.others[0].name, "x=y");
  EXPECT_EQ(read.others[0].association, Association::kCell);
  EXPECT_FALSE(read.others[0].component);
  EXPECT_FALSE(read.others[1].association);
  EXPECT_EQ(read.others[1].component, kMagnitude);
}

TEST(ReaderProtocol, FieldsOfADescriptionAreCounted) {
  io::Description description;
  description.others = {{"a", kMagnitude, ScalarType::kInt16, 3}, {"b", 2, ScalarType::kUint8, 4}};
  const std::vector<std::byte> bytes = io::encode_description(description);
  const io::Description read = io::decode_description(bytes);
  ASSERT_EQ(read.others.size(), 2u);
  EXPECT_EQ(read.others[0].component, kMagnitude);
  EXPECT_EQ(read.others[1].array_name, "b");
  EXPECT_EQ(read.others[1].components, 4);
  for (std::size_t size = 0; size < bytes.size(); ++size)
    EXPECT_THROW(io::decode_description(std::span(bytes).first(size)), std::out_of_range);
  description.others.resize(kMostOtherArrays + 1);
  EXPECT_THROW(io::decode_description(io::encode_description(description)), std::out_of_range);
}

}  // namespace

}  // namespace tetravox
