#include "tetravox/dataset.h"
#include "tetravox/error.h"

#include <gtest/gtest.h>

#include <string>

namespace tetravox {
namespace {

ArrayInfo make_array(const std::string& name, Association association, int components, double min, double max) {
  ArrayInfo array;
  array.name = name;
  array.association = association;
  array.components = components;
  array.component_ranges.assign(static_cast<std::size_t>(components), {min, max});
  array.magnitude_range = {min, max};
  return array;
}

std::string chosen_name(const DatasetInfo& info, const ArrayRequest& request = {}) {
  return info.arrays[choose_array(info, request)].name;
}

TEST(Dataset, CellTypeNames) {
  EXPECT_EQ(cell_type_name(10), "tetrahedron");
  EXPECT_EQ(cell_type_name(25), "quadratic hexahedron");
  EXPECT_EQ(cell_type_name(42), "polyhedron");
  EXPECT_EQ(cell_type_name(5), "cell type 5");
  EXPECT_EQ(cell_type_name(255), "cell type 255");
}

TEST(Dataset, ChoosesWhatAStrangerWantsToSee) {
  DatasetInfo info;
  const auto add = [&](const std::string& name, Association association, int components, double min, double max) {
    info.arrays.insert(info.arrays.begin(), make_array(name, association, components, min, max));
    EXPECT_EQ(chosen_name(info), name);
  };
  add("ones", Association::kCell, 1, 1, 1);
  add("GlobalElementId", Association::kCell, 1, 1, 100);
  add("velocity", Association::kCell, 3, 0, 1);
  add("displacement", Association::kPoint, 3, 0, 1);
  add("EQPS", Association::kCell, 1, 0, 1);
  add("fluid", Association::kPoint, 1, 0, 1);
  info.arrays.insert(info.arrays.begin(), make_array("constant", Association::kPoint, 1, 3, 3));
  info.arrays.insert(info.arrays.begin(), make_array("vtkOriginalPointIds", Association::kPoint, 1, 0, 9));
  info.arrays.insert(info.arrays.begin(), make_array("node_ids", Association::kPoint, 1, 0, 9));
  EXPECT_EQ(chosen_name(info), "fluid");
  info.arrays.push_back(make_array("later", Association::kPoint, 1, 0, 1));
  EXPECT_EQ(chosen_name(info), "fluid");
}

TEST(Dataset, FindsWhatIsAskedFor) {
  DatasetInfo info;
  info.source = "a.vtu";
  info.arrays = {make_array("p", Association::kCell, 1, 0, 1), make_array("p", Association::kPoint, 1, 0, 1),
                 make_array("v", Association::kPoint, 3, 0, 1)};
  EXPECT_EQ(choose_array(info, {"p", {}, {}}), 1u);
  EXPECT_EQ(choose_array(info, {"p", Association::kCell, {}}), 0u);
  EXPECT_EQ(choose_array(info, {"", Association::kCell, {}}), 0u);
  EXPECT_EQ(choose_array(info, {"v", {}, 2}), 2u);
  EXPECT_EQ(choose_array(info, {"v", {}, kMagnitude}), 2u);
  const ArrayRequest wrong[] = {
      {"q", {}, {}}, {"v", Association::kCell, {}}, {"v", {}, 3}, {"v", {}, -2}, {"P", {}, {}}};
  for (const ArrayRequest& request : wrong) try {
      choose_array(info, request);
      ADD_FAILURE() << request.name;
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::kInvalidArgument);
    }
  try {
    choose_array(info, wrong[0]);
  } catch (const Error& error) {
    EXPECT_EQ(std::string(error.what()),
              "a.vtu has no array 'q'; there are: 'p' (cell), 'p' (point), 'v' (point, 3 components)");
  }
  info.arrays.clear();
  try {
    choose_array(info, {});
    ADD_FAILURE();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::kNothingToDraw);
  }
}

}  // namespace
}  // namespace tetravox
