// Public meshes, read whole. The numbers were established with VTK's Python interface, cell by cell.

#include "tetravox/error.h"
#include "tetravox/io.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

namespace tetravox {

namespace {

const std::filesystem::path kData = std::filesystem::path(TETRAVOX_SHARED_DIR) / "data";

struct Expected {
  const char* file;
  const char* array;  ///< empty: the file has none
  std::uint64_t points, cells, blocks;
  double min, max;  ///< of the scalar, or of the vectors' lengths
  std::vector<std::pair<CellType, std::uint64_t>> types;
  const char* solution = "";
};

void PrintTo(const Expected& expected, std::ostream* out) { *out << expected.file << ":" << expected.array; }

const std::vector<Expected>& expectations() {
  using T = CellType;
  static const std::vector<Expected> list{
      {"bluntfin.vtu", "Density", 40960, 224874, 1, 0.192599997, 4.97749996, {{T::kTetrahedron, 224874}}},
      {"post.vtu", "Pressure", 109744, 616050, 1, -0.216618463, 1.75833488, {{T::kTetrahedron, 616050}}},
      {"can.vtu", "EQPS", 6724, 4800, 1, 0.0215831306, 2.89394164, {{T::kHexahedron, 4800}}},
      {"can.vtu", "VEL", 6724, 4800, 1, 2006.41765, 5221.3289, {{T::kHexahedron, 4800}}},
      {"bluntfin.vts", "Momentum", 40960, 37479, 1, 0, 6.25567747, {{T::kHexahedron, 37479}}},
      {"bluntfinxyz.bin",
       "Density",
       40960,
       37479,
       1,
       0.192599997,
       4.97749996,
       {{T::kHexahedron, 37479}},
       "bluntfinq.bin"},
      {"CylinderQuadratic.vtk", "pressure", 2814, 1522, 1, -98.4391761, 7234.48675, {{T::kQuadraticTetrahedron, 1522}}},
      {"PentaHexa.vtk", "scalar2", 401, 210, 1, 0, 1, {{T::kPentagonalPrism, 60}, {T::kHexagonalPrism, 150}}},
      {"hexa.vtk", "scalars", 12167, 10648, 1, 0.75306499, 17.320507, {{T::kHexahedron, 10648}}},
      {"notch_stress_fixed.vtk",
       "Nodal Stress",
       3537,
       2192,
       1,
       3206.61368,
       8109795.91,
       {{T::kHexahedron, 2188}, {T::kWedge, 4}}},
      {"office.binary.vtk", "vectors", 8400, 7220, 1, 0, 0.804935019, {{T::kHexahedron, 7220}}},
      {"post-coarse.vtk", "Pressure", 2288, 8750, 1, 0.35536769, 1.64124048, {{T::kTetrahedron, 8750}}},
      {"tetraMesh.vtk", "scalars", 55, 160, 1, 0, 4, {{T::kTetrahedron, 160}}},
      {"disk_out_ref.ex2", "Temp", 8499, 7472, 1, 293.149994, 913.150024, {{T::kHexahedron, 7472}}},
      {"disk_out_ref.ex2", "V", 8499, 7472, 1, 0, 22.4188202, {{T::kHexahedron, 7472}}},
      {"sqnz_s.adf.cgns", "Density", 15228, 11264, 12, 0.160091819, 0.973550786, {{T::kHexahedron, 11264}}},
      {"cells/HexagonalPrism.vtu", "", 12, 1, 1, 1, 1, {{T::kHexagonalPrism, 1}}},
      {"cells/Hexahedron.vtu", "", 8, 1, 1, 1, 1, {{T::kHexahedron, 1}}},
      {"cells/PentagonalPrism.vtu", "", 10, 1, 1, 1, 1, {{T::kPentagonalPrism, 1}}},
      {"cells/Pyramid.vtu", "", 5, 1, 1, 1, 1, {{T::kPyramid, 1}}},
      {"cells/Tetra.vtu", "", 4, 1, 1, 1, 1, {{T::kTetrahedron, 1}}},
      {"cells/Voxel.vtu", "", 8, 1, 1, 1, 1, {{T::kVoxel, 1}}},
      {"cells/Wedge.vtu", "", 6, 1, 1, 1, 1, {{T::kWedge, 1}}},
      {"cells/QuadraticPyramid.vtu", "DistanceToCenter", 153, 48, 1, 0, 1.73205078, {{T::kQuadraticPyramid, 48}}},
      {"cells/QuadraticTetra.vtu", "DistanceToCenter", 189, 96, 1, 0, 1.73205078, {{T::kQuadraticTetrahedron, 96}}},
      {"cells/QuadraticWedge.vtu", "DistanceToCenter", 93, 16, 1, 0, 1.73205078, {{T::kQuadraticWedge, 16}}},
      {"cells/TriQuadraticHexahedron.vtu", "material", 117, 7, 1, 1, 1, {{T::kTriquadraticHexahedron, 7}}},
  };
  return list;
}

class SharedData : public testing::TestWithParam<Expected> {
 protected:
  void SetUp() override {
    if (!std::filesystem::exists(kData / GetParam().file)) GTEST_SKIP() << "no data in " << kData;
  }
};

void expect_info(const DatasetInfo& info, const Expected& expected) {
  EXPECT_EQ(info.point_count, expected.points);
  EXPECT_EQ(info.cell_count, expected.cells);
  EXPECT_EQ(info.block_count, expected.blocks);
  EXPECT_EQ(info.cells_by_type, expected.types);
  EXPECT_EQ(info.left_out.unsupported, 0u);
  if (!*expected.array) {  // a homogeneous body
    ASSERT_EQ(info.arrays.size(), 1u);
    EXPECT_EQ(info.arrays[0].name, "(uniform)");
    EXPECT_EQ(info.arrays[0].association, Association::kCell);
    return;
  }
  const auto array = std::find_if(info.arrays.begin(), info.arrays.end(),
                                  [&](const ArrayInfo& a) { return a.name == expected.array; });
  ASSERT_NE(array, info.arrays.end());
  EXPECT_NEAR(array->magnitude_range.min, expected.min, 1e-8 * std::abs(expected.min));
  EXPECT_NEAR(array->magnitude_range.max, expected.max, 1e-8 * std::abs(expected.max));
  EXPECT_EQ(array->nan_count, 0u);
}

TEST_P(SharedData, CountsAndRanges) {
  const Expected& expected = GetParam();
  ReadOptions options;
  if (*expected.solution) options.grid_file = (kData / expected.solution).string();
  options.only_info = true;
  const Dataset summary = read_dataset((kData / expected.file).string(), options);
  expect_info(summary.info, expected);
  EXPECT_EQ(summary.mesh.cell_count(), 0u);
  options.only_info = false;
  options.array.name = expected.array;
  const Dataset dataset = read_dataset((kData / expected.file).string(), options);
  expect_info(dataset.info, expected);
  EXPECT_EQ(dataset.mesh.point_count(), expected.points);
  EXPECT_EQ(dataset.mesh.cell_count(), expected.cells);
  const auto [low, high] = std::minmax_element(dataset.mesh.scalars.begin(), dataset.mesh.scalars.end());
  EXPECT_LE(*low, expected.min + 1e-8 * std::abs(expected.min));
  EXPECT_GE(*high, expected.max - 1e-8 * std::abs(expected.max));
}

INSTANTIATE_TEST_SUITE_P(All, SharedData, testing::ValuesIn(expectations()), [](const auto& instance) {
  std::string name = std::string(instance.param.file) + "_" + instance.param.array;
  for (char& c : name)
    if (!std::isalnum(static_cast<unsigned char>(c))) c = '_';
  return name;
});

TEST(SharedDataRefusals, Surfaces) {
  if (!std::filesystem::exists(kData)) GTEST_SKIP() << "no data in " << kData;
  const auto code_of = [](const char* file) {
    try {
      read_dataset((kData / file).string());
    } catch (const Error& error) {
      return error.code();
    }
    return ErrorCode::kInternal;
  };
  for (const char* file : {"cells/Line.vtu", "cells/Pixel.vtu", "cells/PolyLine.vtu", "cells/Polygon.vtu",
                           "cells/PolyVertex.vtu", "cells/Quad.vtu", "cells/Triangle.vtu", "cells/Vertex.vtu"})
    EXPECT_EQ(code_of(file), ErrorCode::kNothingToDraw) << file;
}

}  // namespace

}  // namespace tetravox
