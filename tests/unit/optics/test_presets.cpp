#include "src/optics/color_maps.h"
#include "tests/unit/optics/expect_error.h"
#include "tetravox/transfer_function.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace tetravox {
namespace {

using testing::expect_error;

const char* const kColorMaps[] = {"viridis", "plasma",   "inferno",   "magma",   "cividis",
                                  "turbo",   "coolwarm", "grayscale", "rainbow", "jet"};

Color color_at(const TransferFunction& function, double value) {
  return eval_optical_function(make_optical_function(function, 1.0), value).color;
}

TEST(Presets, AreValidOverOddRanges) {
  const double huge = std::numeric_limits<double>::max(), tiny = std::numeric_limits<double>::denorm_min();
  const ValueRange ranges[] = {{0, 1},       {-huge, huge}, {0, tiny},         {-tiny, tiny},       {5, 5},
                               {0, 0},       {-3, -3},      {huge, huge},      {1e15, 1e15 + 0.25}, {1e-300, 1e300},
                               {tiny, huge}, {1, 10},       {7e22, 7.0001e22}, {-1e-5, 1e9}};
  for (std::string name : kColorMaps)
    for (const char* opacity : {"", ":linear", ":ramp", ":peaks", ":peaks=1", ":peaks=100", ":constant", ":constant=1"})
      for (const ValueRange& range : ranges)
        for (const bool logarithmic : {false, true}) {
          if (logarithmic && !(range.min > 0)) continue;
          const TransferFunction function = make_preset(name + opacity, {range, logarithmic, false});
          EXPECT_NO_THROW(make_optical_function(function, 1.0)) << name << opacity << " " << range.min;
          if (range.max > range.min) {
            EXPECT_EQ(function.points.front().value, range.min);
            EXPECT_EQ(function.points.back().value, range.max);
          }
        }
}

TEST(Presets, PutAConstantFieldInTheMiddle) {
  const TransferFunction function = make_preset("grayscale:linear", {{5, 5}});
  EXPECT_NEAR(color_at(function, 5)[0], 0.5, 1e-9);
}

TEST(Presets, HaveTheColorsTheyAreKnownFor) {
  const auto expect = [](const char* name, double t, Color color, double tolerance) {
    const Color found = color_at(make_preset(name, {{0, 1}}), t);
    for (int i = 0; i < 3; ++i) EXPECT_NEAR(found[i], color[i], tolerance) << name << " at " << t << " channel " << i;
  };
  // matplotlib 3.6, to two 8-bit steps.
  expect("viridis", 0.0, {0.267004, 0.004874, 0.329415}, 0.008);
  expect("viridis", 0.5, {0.127568, 0.566949, 0.550556}, 0.008);
  expect("viridis", 1.0, {0.993248, 0.906157, 0.143936}, 0.008);
  expect("plasma", 0.5, {0.798216, 0.280197, 0.469538}, 0.008);
  expect("inferno", 0.5, {0.735683, 0.215906, 0.330245}, 0.008);
  expect("magma", 0.5, {0.716387, 0.214982, 0.475290}, 0.008);
  expect("cividis", 0.5, {0.488697, 0.485318, 0.471008}, 0.01);
  expect("turbo", 0.5, {0.644, 0.990, 0.234}, 0.012);
  // Moreland 2009, table 1.
  expect("coolwarm", 0.0, {59 / 255.0, 76 / 255.0, 192 / 255.0}, 0.002);
  expect("coolwarm", 0.5, {221 / 255.0, 221 / 255.0, 221 / 255.0}, 0.003);
  expect("coolwarm", 0.25, {141 / 255.0, 176 / 255.0, 254 / 255.0}, 0.003);
  expect("coolwarm", 0.75, {244 / 255.0, 154 / 255.0, 123 / 255.0}, 0.003);
  expect("coolwarm", 1.0, {180 / 255.0, 4 / 255.0, 38 / 255.0}, 0.002);
  expect("grayscale", 0.3, {0.3, 0.3, 0.3}, 1e-12);
  expect("rainbow", 0.375, {0, 1, 0.5}, 1e-12);
  expect("jet", 0.5, {0.5, 1, 0.5}, 1e-12);
}

TEST(Presets, InvertTurnsColorsAndKeepsOpacities) {
  const TransferFunction plain = make_preset("viridis:ramp", {{2, 4}});
  const TransferFunction inverted = make_preset("viridis:ramp", {{2, 4}, false, true});
  for (const double value : {2.0, 2.7, 3.3, 4.0}) {
    const Color a = color_at(plain, value), b = color_at(inverted, 6.0 - value);
    for (int i = 0; i < 3; ++i) EXPECT_NEAR(a[i], b[i], 1e-9);
  }
  EXPECT_EQ(plain.points.front().absorption, inverted.points.front().absorption);
  EXPECT_EQ(plain.points.back().absorption, inverted.points.back().absorption);
}

TEST(Presets, LogarithmicFollowsTheLogarithmWithinItsBounds) {
  const TransferFunction function = make_preset("grayscale:linear", {{1e-3, 1e5}, true, false});
  for (int i = 0; i <= 2000; ++i) {
    const double t = i / 2000.0, value = 1e-3 * std::pow(10.0, 8.0 * t);
    EXPECT_NEAR(color_at(function, value)[0], t, 1.0 / 512) << value;
  }
  EXPECT_LT(function.points.size(), 2000u);
}

TEST(Presets, PeaksAreClearInBetween) {
  const TransferFunction function = make_preset("viridis:peaks=4", {{0, 1}});
  const OpticalFunction optical = make_optical_function(function, 1.0);
  for (int i = 0; i < 4; ++i) {
    EXPECT_GT(eval_optical_function(optical, (i + 0.5) / 4).extinction, 0.1);
    EXPECT_EQ(eval_optical_function(optical, i / 4.0).extinction, 0.0);
  }
}

TEST(Presets, RandomIsTheSameForASeedAndNotForAnother) {
  const auto one = make_preset("random=7", {{0, 1}}), same = make_preset("random=7", {{0, 1}});
  const auto other = make_preset("random=8", {{0, 1}});
  ASSERT_EQ(one.points.size(), same.points.size());
  for (std::size_t i = 0; i < one.points.size(); ++i) EXPECT_EQ(one.points[i].color, same.points[i].color);
  EXPECT_NE(one.points[0].color, other.points[0].color);
  EXPECT_NO_THROW(make_preset("random", {{0, 1}}));
  EXPECT_NO_THROW(make_preset("random=18446744073709551615", {{0, 1}}));
}

TEST(Presets, RandomNumbersArePinned) {
  // splitmix64 with seed 7: 0x63cbe1e459320dd7, ...: the same on every platform.
  EXPECT_NEAR(make_preset("random=7", {{0, 1}}).points[0].color[0],
              static_cast<double>(0x63cbe1e459320dd7u >> 11) * 0x1p-53, 1e-12);
}

TEST(Presets, ErrorsListWhatThereIs) {
  for (const char* name : {"", "viridi", "viridis:", "viridis:lin", ":linear", "viridis:peaks=0", "viridis:peaks=x",
                           "viridis:peaks=101", "viridis:constant=2", "viridis:constant=nan", "viridis:linear=3",
                           "viridis=3", "random=x", "random=-1", "random=7:bad", "viridis:ramp:ramp"})
    expect_error(
        ErrorCode::kInvalidArgument,
        [&] {
          make_preset(name, {{0, 1}});
        },
        "viridis", "peaks", "random");
  expect_error(
      ErrorCode::kInvalidArgument,
      [] {
        make_preset(std::string(100000, 'x'), {{0, 1}});
      },
      "not a name");
}

TEST(Presets, RefuseRangesThatMakeNoSense) {
  const double nan = std::nan("");
  for (const ValueRange& range : {ValueRange{1, 0}, {nan, 1}, {0, nan}, {0, HUGE_VAL}})
    expect_error(
        ErrorCode::kInvalidArgument, [&] { make_preset("viridis", {range}); }, "range");
  expect_error(
      ErrorCode::kInvalidArgument,
      [] {
        make_preset("viridis", {{0, 1}, true, false});
      },
      "logarithmic", "above 0");
}

TEST(Presets, AreListedMapsFirst) {
  const auto names = preset_names();
  ASSERT_GE(names.size(), 14u);
  for (std::size_t i = 0; i < 10; ++i) EXPECT_EQ(names[i].first, kColorMaps[i]);
  for (const auto& [name, description] : names) EXPECT_FALSE(description.empty()) << name;
}

}  // namespace
}  // namespace tetravox
