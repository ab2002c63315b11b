/// Embedded datasets by name and options.

#include "tetravox/dataset.h"
#include "tetravox/error.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <string>

namespace tetravox::test {
namespace {

/// The message with which a name is refused.
std::string refusal_of(const std::string& name) {
  try {
    make_builtin(name);
    ADD_FAILURE() << name;
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::kInvalidArgument) << error.what();
    EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
    return error.what();
  }
  return {};
}

TEST(Builtins, AreMadeByTheNamesThatAreListed) {
  std::set<std::string> grids;
  for (const auto& [name, description] : builtin_names()) {
    const Dataset dataset = make_builtin("builtin:" + name);
    EXPECT_FALSE(description.empty());
    EXPECT_EQ(dataset.info.source, "builtin:" + name);
    EXPECT_EQ(make_builtin(name).info.source, "builtin:" + name);
    EXPECT_EQ(dataset.info.format, "embedded");
    EXPECT_EQ(dataset.is_grid(), dataset.mesh.points.empty());
    EXPECT_EQ(dataset.is_grid(), !dataset.grid.values.empty());
    if (dataset.is_grid()) grids.insert(name);
  }
  EXPECT_EQ(builtin_names().size(), 6u);
  EXPECT_EQ(grids, (std::set<std::string>{"hydrogen", "marschner-lobb", "turbulence"}));
}

TEST(Builtins, OptionsAreHeeded) {
  EXPECT_EQ(make_builtin("sphere?cells=40").info.cell_count, 40u);
  EXPECT_EQ(make_builtin("sphere?cells=9000&cells=40").info.cell_count, 40u);
  EXPECT_EQ(make_builtin("duct", {"speed", {}, {}}).mesh.array_name, "speed");
  const Dataset grid = make_builtin("builtin:hydrogen?type=float64&size=9");
  EXPECT_EQ(grid.info.source, "builtin:hydrogen?type=float64&size=9");
  EXPECT_EQ(grid.grid.type, ScalarType::kFloat64);
  EXPECT_EQ(grid.grid.shape.dimensions, (std::array<std::uint32_t, 3>{9, 9, 9}));
  const Dataset one = make_builtin("turbulence?size=16&seed=1"), other = make_builtin("turbulence?size=16&seed=2");
  EXPECT_FALSE(std::ranges::equal(one.grid.values, other.grid.values));
  EXPECT_TRUE(std::ranges::equal(make_builtin("turbulence?size=16").grid.values,
                                 make_builtin("turbulence?size=16&seed=0").grid.values));
}

TEST(Builtins, WrongNamesAndOptionsAreRefused) {
  for (const char* name : {"",
                           "builtin:",
                           "builtin:cube",
                           "sphere2",
                           "sphere?",
                           "sphere?cells",
                           "sphere?cells=",
                           "sphere?cells=0",
                           "sphere?cells=-5",
                           "sphere?cells=1e6",
                           "sphere?cells=600000000",
                           "sphere?cells=99999999999999999999",
                           "sphere?size=5",
                           "sphere?cells=10&",
                           "sphere?cells=10&x=1",
                           "sphere?&cells=10",
                           "builtin:builtin:sphere",
                           "hydrogen?",
                           "hydrogen?cells=5",
                           "hydrogen?size=1",
                           "hydrogen?size=4097",
                           "hydrogen?size=16x16",
                           "hydrogen?seed=1",
                           "hydrogen?type=",
                           "hydrogen?type=char",
                           "turbulence?seed=-1",
                           "turbulence?seed=",
                           "turbulence?seed=18446744073709551616",
                           "turbulence?size=16?type=uint8",
                           "marschner-lobb?=3"})
    refusal_of(name);
  EXPECT_EQ(refusal_of("cube"),
            "there is no embedded dataset 'cube'; there are: sphere, buckyball, duct, marschner-lobb, hydrogen, "
            "turbulence");
  EXPECT_EQ(refusal_of("sphere?cells=2"), "builtin:sphere?cells=2: cells=2 is not a number from 5 to 500000000");
  EXPECT_EQ(refusal_of("turbulence?grain=2"),
            "builtin:turbulence?grain=2: 'grain=2' is not an option; there is: size=N, type=T, seed=N");
  EXPECT_NE(refusal_of("hydrogen?type=half").find("uint8, int16"), std::string::npos);
}

TEST(Builtins, FurtherArraysComeBesideTheFirst) {
  const Dataset duct = make_builtin("duct?cells=500", {"pressure", {}, {}}, {{"speed", {}, {}}, {"pressure", {}, {}}});
  ASSERT_EQ(duct.mesh.others.size(), 2u);
  EXPECT_EQ(duct.mesh.others[0].array_name, "speed");
  EXPECT_TRUE(
      std::ranges::equal(duct.mesh.others[0].scalars, make_builtin("duct?cells=500", {"speed", {}, {}}).mesh.scalars));
  EXPECT_TRUE(std::ranges::equal(duct.mesh.others[1].scalars, duct.mesh.scalars));
  EXPECT_THROW(make_builtin("duct", {"pressure", {}, {}}, {{"volume", {}, {}}}), Error);

  const Dataset atom = make_builtin("hydrogen?size=20&type=float64", {}, {{"wave", {}, {}}});
  EXPECT_EQ(atom.grid.array_name, "density");
  ASSERT_EQ(atom.info.arrays.size(), 2u);
  ASSERT_EQ(atom.other_grids.size(), 1u);
  const auto values = [](const GridData& grid, std::size_t i) {
    return reinterpret_cast<const double*>(grid.values.data())[i];
  };
  for (std::size_t i = 0; i < 8000; i += 7) {
    const double wave = 2.0 * values(atom.other_grids[0], i) - 1.0;
    EXPECT_NEAR(values(atom.grid, i), wave * wave, 1e-12);
  }
  EXPECT_LT(atom.info.arrays[1].component_ranges[0].min, 0.5);
}

TEST(Builtins, ArraysThatAreNotThereAreRefused) {
  EXPECT_THROW(make_builtin("duct", {"temperature", {}, {}}), Error);
  EXPECT_THROW(make_builtin("hydrogen", {"temperature", {}, {}}), Error);
  EXPECT_THROW(make_builtin("hydrogen", {"", Association::kCell, {}}), Error);
  EXPECT_NO_THROW(make_builtin("hydrogen", {"density", Association::kPoint, 0}));
}

TEST(Builtins, MemoryIsCheckedFirst) {
  try {
    make_builtin("turbulence?size=4096&type=float64");
    GTEST_SKIP() << "this machine has 576 GiB of memory to spare";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::kOutOfMemory) << error.what();
  }
}

}  // namespace
}  // namespace tetravox::test
