// The same small mesh in every format that can be written here.

#include "tests/unit/io/sample_files.h"
#include "tetravox/io.h"

#include <gtest/gtest.h>

#include <cmath>

namespace tetravox {

namespace {

using test::Sample;

Dataset read_sample(const Sample& sample, const test::TemporaryDirectory& directory, ReadOptions options = {}) {
  if (!sample.solution_file.empty()) options.grid_file = directory.file(sample.solution_file);
  return read_dataset(directory.file(sample.main_file), options);
}

class Formats : public testing::TestWithParam<Sample> {};

/// Volume, up to its sign, of a hexahedron with axis-aligned edges, by its first and its opposite corner.
double box_volume(const MeshData& mesh, std::size_t cell) {
  const auto ids = mesh.connectivity.subspan(mesh.cell_offsets[cell], 8);
  double volume = 1.0;
  for (std::size_t axis = 0; axis < 3; ++axis)
    volume *= mesh.points[3 * ids[6] + axis] - mesh.points[3 * ids[0] + axis];
  return volume;
}

TEST_P(Formats, HoldsTheTwoCubes) {
  const Sample& sample = GetParam();
  const test::TemporaryDirectory directory;
  sample.write(directory.path());
  const bool is_cell_only = sample.point_array.empty();
  ReadOptions options;
  options.array.name = sample.point_array;
  const Dataset dataset = read_sample(sample, directory, options);
  EXPECT_EQ(dataset.info.cell_count, 2u * sample.copies);
  EXPECT_EQ(dataset.mesh.cell_count(), 2u * sample.copies);
  EXPECT_DOUBLE_EQ(dataset.info.bounds[0].min, 0.0);
  EXPECT_DOUBLE_EQ(dataset.info.bounds[0].max, 2.0 * sample.copies);
  EXPECT_DOUBLE_EQ(dataset.info.bounds[2].max, 1.0);
  ASSERT_EQ(dataset.info.cells_by_type.size(), 1u);
  const bool is_hexahedral = dataset.info.cells_by_type[0].first == CellType::kHexahedron;
  for (std::size_t cell = 0; is_hexahedral && cell < dataset.mesh.cell_count(); ++cell)
    EXPECT_DOUBLE_EQ(std::abs(box_volume(dataset.mesh, cell)), 1.0);
  for (std::size_t i = 0; !is_cell_only && i < dataset.mesh.point_count(); ++i)
    EXPECT_DOUBLE_EQ(dataset.mesh.scalars[i], static_cast<double>(i % 12));
}

TEST_P(Formats, HoldsTheCellData) {
  const Sample& sample = GetParam();
  if (!sample.has_cell_data) GTEST_SKIP() << "the format has no cell data";
  const test::TemporaryDirectory directory;
  sample.write(directory.path());
  ReadOptions options;
  options.array.name = "C";
  const Dataset dataset = read_sample(sample, directory, options);
  ASSERT_EQ(dataset.mesh.association, Association::kCell);
  ASSERT_EQ(dataset.mesh.scalars.size(), dataset.mesh.cell_count());
  for (std::size_t i = 0; i < dataset.mesh.cell_count(); ++i)
    EXPECT_EQ(dataset.mesh.scalars[i], i % 2 == 0 ? 5.0 : 7.0);
}

INSTANTIATE_TEST_SUITE_P(All, Formats, testing::ValuesIn(test::samples()),
                         [](const auto& instance) { return instance.param.name; });

}  // namespace

}  // namespace tetravox
