// Real grids: dimensions, spacing, ranges and means as VTK 9.1's readers give them.

#include "tests/unit/io/sample_files.h"
#include "tests/unit/io/sample_grids.h"
#include "tetravox/error.h"
#include "tetravox/io.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cstdint>
#include <filesystem>

namespace tetravox {

namespace {

const std::filesystem::path kData = std::filesystem::path(TETRAVOX_SHARED_DIR) / "data";

struct Expected {
  const char* file;
  const char* array;
  ScalarType type;
  std::array<std::uint32_t, 3> dimensions;
  std::array<double, 3> spacing, origin;
  double min, max, mean;
  bool is_cell_data = false;
};

/// How GoogleTest prints an expectation.
void PrintTo(const Expected& expected, std::ostream* out) { *out << expected.file; }

constexpr Expected kExpectations[] = {
    {"neghip.slc", "SLCImage", ScalarType::kUint8, {66, 66, 66}, {1, 1, 1}, {0, 0, 0}, 0, 255, 16.7799795},
    {"embryo.slc", "SLCImage", ScalarType::kUint8, {256, 256, 256}, {1, 1, 1}, {0, 0, 0}, 0, 197, 3.79828280},
    {"ironProt.vtk", "scalars", ScalarType::kUint8, {68, 68, 68}, {1, 1, 1}, {0, 0, 0}, 0, 255, 13.1382588},
    {"hydrogen.vti",
     "probability_density",
     ScalarType::kFloat32,
     {64, 64, 64},
     {1, 1, 1},
     {0, 0, 0},
     0,
     1,
     0.0185242053},
    {"HeadMRVolume.mhd", "MetaImage", ScalarType::kUint8, {48, 62, 42}, {4, 4, 4}, {0, 0, 0}, 0, 255, 24.468222},
    {"avg152T1_RL_nifti.nii.gz",
     "NIFTI",
     ScalarType::kUint8,
     {91, 109, 91},
     {2, 2, 2},
     {-90, -126, -72},
     0,
     255,
     82.8971615},
    {"ch2.nii.gz", "NIFTI", ScalarType::kUint8, {181, 217, 181}, {1, 1, 1}, {-90, -125, -71}, 0, 254, 44.6117736},
    {"DICOM_Stack",
     "DICOM",
     ScalarType::kUint16,
     {512, 512, 3},
     {0.9765625, 0.9765625, 12},
     {-250, -250, -12},
     0,
     346,
     4.373793284},
    {"RectilinearGrid.vtr",
     "Pressure",
     ScalarType::kFloat32,
     {129, 65, 65},
     {1, 0.09375, 1},
     {0, -3, 0},
     -23594520576.0,
     112037625856.0,
     10696052.262388017,
     true},
};

class SharedGrid : public testing::TestWithParam<Expected> {
 protected:
  void SetUp() override {
    if (!std::filesystem::exists(kData / GetParam().file)) GTEST_SKIP() << "no data in " << kData;
  }
};

TEST_P(SharedGrid, IsWhatVtkReads) {
  const Expected& expected = GetParam();
  ReadOptions options;
  options.array.name = expected.array;
  const Dataset dataset = read_dataset((kData / expected.file).string(), options);
  ASSERT_TRUE(dataset.is_grid());
  const GridData& grid = dataset.grid;
  EXPECT_EQ(grid.type, expected.type);
  EXPECT_EQ(grid.components, 1);
  EXPECT_EQ(grid.shape.dimensions, expected.dimensions);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    EXPECT_NEAR(grid.shape.spacing[axis], expected.spacing[axis], 1e-6);
    EXPECT_NEAR(grid.shape.origin[axis], expected.origin[axis], 1e-4);
  }
  EXPECT_EQ(grid.shape.direction, GridShape{}.direction);
  const std::vector<double> values = test::grid_values(grid);
  EXPECT_EQ(grid.association, expected.is_cell_data ? Association::kCell : Association::kPoint);
  EXPECT_EQ(dataset.info.point_count,
            std::uint64_t{expected.dimensions[0]} * expected.dimensions[1] * expected.dimensions[2]);
  ASSERT_EQ(values.size(), expected.is_cell_data ? dataset.info.cell_count : dataset.info.point_count);
  const auto [low, high] = std::minmax_element(values.begin(), values.end());
  EXPECT_EQ(*low, expected.min);
  EXPECT_EQ(*high, expected.max);
  double sum = 0.0;
  for (const double value : values) sum += value;
  EXPECT_NEAR(sum / static_cast<double>(values.size()), expected.mean, 1e-6 * expected.mean);
}

TEST_P(SharedGrid, SummaryNeedsNoValues) {
  const Expected& expected = GetParam();
  ReadOptions options;
  options.only_info = true;
  const Dataset dataset = read_dataset((kData / expected.file).string(), options);
  ASSERT_TRUE(dataset.is_grid());
  EXPECT_EQ(dataset.info.grid->dimensions, expected.dimensions);
  EXPECT_TRUE(dataset.grid.values.empty());
  EXPECT_TRUE(dataset.info.cells_by_type.empty());
  const auto array = std::find_if(dataset.info.arrays.begin(), dataset.info.arrays.end(),
                                  [&](const ArrayInfo& a) { return a.name == expected.array; });
  ASSERT_NE(array, dataset.info.arrays.end());
  EXPECT_EQ(array->type, scalar_type_name(expected.type));
  EXPECT_EQ(array->component_ranges.at(0).min, expected.min);
  EXPECT_EQ(array->component_ranges.at(0).max, expected.max);
  EXPECT_EQ(array->nan_count, 0u);
}

INSTANTIATE_TEST_SUITE_P(All, SharedGrid, testing::ValuesIn(kExpectations), [](const auto& instance) {
  std::string name = instance.param.file;
  for (char& c : name)
    if (!std::isalnum(static_cast<unsigned char>(c))) c = '_';
  return name;
});

TEST(SharedGrids, UnevenAxesAreKept) {
  if (!std::filesystem::exists(kData)) GTEST_SKIP() << "no data in " << kData;
  const Dataset dataset = read_dataset((kData / "RectilinearGrid.vtr").string());
  const GridShape& shape = dataset.grid.shape;
  ASSERT_EQ(shape.coordinates[0].size(), 129u);
  EXPECT_EQ(shape.coordinates[0].front(), -7.5);
  EXPECT_EQ(shape.coordinates[0].back(), 4.0);
  EXPECT_TRUE(shape.coordinates[1].empty());
  ASSERT_EQ(shape.coordinates[2].size(), 65u);
  EXPECT_EQ(dataset.info.arrays.size(), 9u);
  EXPECT_EQ(dataset.info.bounds[0].min, -7.5);
  EXPECT_EQ(dataset.info.bounds[2].max, 3.0);
}

TEST(SharedGrids, SformComesBeforeVoxelSizes) {
  if (!std::filesystem::exists(kData)) GTEST_SKIP() << "no data in " << kData;
  const Dataset dataset = read_dataset((kData / "ch2.nii.gz").string());
  EXPECT_EQ(dataset.info.bounds[0].min, -90.0);
  EXPECT_EQ(dataset.info.bounds[1].max, 91.0);
  EXPECT_EQ(dataset.info.bounds[2].max, 109.0);
}

}  // namespace

}  // namespace tetravox
