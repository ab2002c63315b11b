#include "tests/unit/optics/expect_error.h"
#include "tetravox/transfer_function.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

namespace tetravox {
namespace {

using testing::expect_error;

TransferFunction make_function(Absorption absorption, std::vector<ControlPoint> points) {
  TransferFunction function;
  function.absorption = absorption;
  function.points = std::move(points);
  return function;
}

/// Extinction as it is defined: opacity linear between the points that enclose `value`.
double exact_extinction(const TransferFunction& function, double value, double unit_distance) {
  const auto& p = function.points;
  std::size_t i = 0;
  while (i + 2 < p.size() && value >= p[i + 1].value) ++i;
  const double t = std::clamp((value - p[i].value) / (p[i + 1].value - p[i].value), 0.0, 1.0);
  const double a = std::min(p[i].absorption, kLargestOpacity), b = std::min(p[i + 1].absorption, kLargestOpacity);
  return -std::log1p(-(a + (b - a) * t)) / unit_distance;
}

/// Largest ratio of the error in extinction to what is allowed, looked at densely.
double worst_error_ratio(const TransferFunction& function, double unit_distance, double tolerance) {
  const OpticalFunction optical = make_optical_function(function, unit_distance, tolerance);
  double worst = 0.0;
  for (std::size_t i = 0; i + 1 < optical.points.size(); ++i) {
    const double begin = optical.points[i].value, end = optical.points[i + 1].value;
    for (int k = 0; k < 16 && end > begin; ++k) {
      const double value = begin + (end - begin) * (k + 0.5) / 16;
      const double exact = exact_extinction(function, value, unit_distance);
      const double error = std::abs(eval_optical_function(optical, value).extinction - exact);
      worst = std::max(worst, error / (tolerance * exact + tolerance / unit_distance));
    }
  }
  return worst;
}

TEST(MakeOpticalFunction, PassesExtinctionsThrough) {
  const auto function = make_function(Absorption::kExtinction, {{0, {0.1, 0.2, 0.3}, 2}, {1, {1, 0, 0}, 0}});
  const OpticalFunction optical = make_optical_function(function, 1.0);
  ASSERT_EQ(optical.points.size(), 2u);
  EXPECT_EQ(optical.points[0].extinction, 2.0);
  EXPECT_EQ(optical.points[1].color, (Color{1, 0, 0}));
}

TEST(MakeOpticalFunction, TurnsConstantOpacityIntoExtinction) {
  const auto function = make_function(Absorption::kOpacity, {{0, {}, 0.5}, {1, {}, 0.5}});
  const OpticalFunction optical = make_optical_function(function, 2.0);
  ASSERT_EQ(optical.points.size(), 2u);
  EXPECT_DOUBLE_EQ(optical.points[0].extinction, std::log(2.0) / 2.0);
  EXPECT_DOUBLE_EQ(optical.points[1].extinction, std::log(2.0) / 2.0);
}

TEST(MakeOpticalFunction, PrefersTheFunctionsOwnUnitDistance) {
  auto function = make_function(Absorption::kOpacity, {{0, {}, 0.5}});
  function.unit_distance = 4.0;
  EXPECT_DOUBLE_EQ(make_optical_function(function, 1.0).points[0].extinction, std::log(2.0) / 4.0);
}

TEST(MakeOpticalFunction, TakesOpacityOneAsAlmostOne) {
  const auto function = make_function(Absorption::kOpacity, {{0, {}, 1.0}});
  EXPECT_NEAR(make_optical_function(function, 1.0).points[0].extinction, -std::log(1e-6), 1e-9);
}

TEST(MakeOpticalFunction, KeepsEveryControlPointAndStep) {
  const auto function = make_function(
      Absorption::kOpacity, {{0, {0, 0, 0}, 0.1}, {1, {1, 0, 0}, 0.9}, {1, {0, 1, 0}, 0.0}, {3, {0, 0, 1}, 1.0}});
  const OpticalFunction optical = make_optical_function(function, 1.0);
  std::size_t at_step = 0;
  for (const OpticalPoint& point : optical.points) at_step += point.value == 1.0;
  EXPECT_EQ(at_step, 2u);
  EXPECT_EQ(optical.points.front().value, 0.0);
  EXPECT_EQ(optical.points.back().value, 3.0);
  EXPECT_TRUE(std::is_sorted(optical.points.begin(), optical.points.end(),
                             [](const auto& a, const auto& b) { return a.value < b.value; }));
}

TEST(MakeOpticalFunction, StaysWithinItsToleranceFromClearToSolid) {
  for (const double tolerance : {1e-1, 1e-2, 1e-3, 1e-4})
    for (const double unit_distance : {1e-6, 1.0, 1e6}) {
      const auto rising = make_function(Absorption::kOpacity, {{-1, {}, 0.0}, {1, {}, 1.0}});
      const auto falling = make_function(Absorption::kOpacity, {{-1, {}, 1.0}, {1, {}, 0.0}});
      EXPECT_LE(worst_error_ratio(rising, unit_distance, tolerance), 1.0001) << tolerance << " " << unit_distance;
      EXPECT_LE(worst_error_ratio(falling, unit_distance, tolerance), 1.0001) << tolerance << " " << unit_distance;
    }
}

TEST(MakeOpticalFunction, StaysWithinItsToleranceForRandomFunctions) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  for (int round = 0; round < 50; ++round) {
    std::vector<ControlPoint> points;
    double value = -3.0;
    for (int i = 0; i < 12; ++i) {
      value += 0.01 + uniform(random);
      points.push_back({value, {uniform(random), uniform(random), uniform(random)}, std::pow(uniform(random), 0.2)});
    }
    EXPECT_LE(worst_error_ratio(make_function(Absorption::kOpacity, points), 0.3, 1e-3), 1.0001);
  }
}

TEST(MakeOpticalFunction, IsSparing) {
  const auto function = make_function(Absorption::kOpacity, {{0, {}, 0.0}, {1, {}, 1.0}});
  EXPECT_LT(make_optical_function(function, 1.0).points.size(), 200u);
  const auto faint = make_function(Absorption::kOpacity, {{0, {}, 0.0}, {1, {}, 0.02}});
  EXPECT_EQ(make_optical_function(faint, 1.0).points.size(), 2u);
}

TEST(MakeOpticalFunction, KeepsColorsLinearInValueWhereItRefines) {
  const auto function = make_function(Absorption::kOpacity, {{2, {0, 1, 0.5}, 0.0}, {6, {1, 0, 0.5}, 1.0}});
  for (const OpticalPoint& point : make_optical_function(function, 1.0).points) {
    EXPECT_NEAR(point.color[0], (point.value - 2) / 4, 1e-12);
    EXPECT_NEAR(point.color[1], 1 - (point.value - 2) / 4, 1e-12);
    EXPECT_EQ(point.color[2], 0.5);
  }
}

TEST(MakeOpticalFunction, SurvivesTinyAndHugeRanges) {
  const double huge = std::numeric_limits<double>::max(), tiny = std::numeric_limits<double>::denorm_min();
  for (const auto& [a, b] : {std::pair{-huge, huge}, {0.0, tiny}, {1e15, std::nextafter(1e15, 2e15)}, {-tiny, tiny}}) {
    const auto optical =
        make_optical_function(make_function(Absorption::kOpacity, {{a, {}, 0.0}, {b, {1, 1, 1}, 1.0}}), 1.0);
    for (std::size_t i = 1; i < optical.points.size(); ++i)
      EXPECT_GE(optical.points[i].value, optical.points[i - 1].value);
    for (const OpticalPoint& point : optical.points) EXPECT_TRUE(std::isfinite(point.value + point.extinction));
    for (const double value : {a, b, 0.5 * a + 0.5 * b})
      EXPECT_TRUE(std::isfinite(eval_optical_function(optical, value).extinction));
  }
}

TEST(MakeOpticalFunction, NamesThePointThatIsWrong) {
  const double nan = std::numeric_limits<double>::quiet_NaN(), infinity = std::numeric_limits<double>::infinity();
  const auto expect = [](Absorption absorption, std::vector<ControlPoint> points, const char* where, const char* what) {
    expect_error(
        ErrorCode::kInvalidArgument, [&] { make_optical_function(make_function(absorption, points), 1.0); }, where,
        what);
  };
  expect(Absorption::kExtinction, {}, "without points", "at least one");
  expect(Absorption::kExtinction, {{1, {}, 0}, {0, {}, 0}}, "point 1", "ascend");
  expect(Absorption::kExtinction, {{nan, {}, 0}}, "point 0", "not finite");
  expect(Absorption::kExtinction, {{infinity, {}, 0}}, "point 0", "not finite");
  expect(Absorption::kExtinction, {{0, {0, 1.5, 0}, 0}}, "point 0", "[0, 1]");
  expect(Absorption::kExtinction, {{0, {0, nan, 0}, 0}}, "point 0", "[0, 1]");
  expect(Absorption::kExtinction, {{0, {}, 0}, {1, {}, -1}}, "point 1", "not negative");
  expect(Absorption::kExtinction, {{0, {}, infinity}}, "point 0", "finite");
  expect(Absorption::kOpacity, {{0, {}, 1.01}}, "point 0", "opacity");
  expect(Absorption::kOpacity, {{0, {}, nan}}, "point 0", "opacity");
}

TEST(MakeOpticalFunction, RefusesUnitDistancesThatMakeNoSense) {
  auto function = make_function(Absorption::kOpacity, {{0, {}, 0.5}});
  for (const double distance : {0.0, -1.0, std::nan(""), 1e-320}) {
    expect_error(
        ErrorCode::kInvalidArgument, [&] { make_optical_function(function, distance); }, "unit_distance");
    function.unit_distance = distance;
    expect_error(
        ErrorCode::kInvalidArgument, [&] { make_optical_function(function, 1.0); }, "unit_distance");
    function.unit_distance.reset();
  }
}

TEST(EvalOpticalFunction, InterpolatesClampsAndTakesStepsFromAbove) {
  OpticalFunction function;
  function.points = {{0, 1, {0, 0, 0}}, {2, 3, {1, 0, 0}}, {2, 5, {0, 1, 0}}, {2, 7, {0, 0, 1}}, {4, 9, {1, 1, 1}}};
  EXPECT_EQ(eval_optical_function(function, -1).extinction, 1.0);
  EXPECT_EQ(eval_optical_function(function, 0).extinction, 1.0);
  EXPECT_EQ(eval_optical_function(function, 1).extinction, 2.0);
  EXPECT_EQ(eval_optical_function(function, 1).color, (Color{0.5, 0, 0}));
  EXPECT_EQ(eval_optical_function(function, 2).extinction, 7.0);
  EXPECT_EQ(eval_optical_function(function, 3).extinction, 8.0);
  EXPECT_EQ(eval_optical_function(function, 4).extinction, 9.0);
  EXPECT_EQ(eval_optical_function(function, 1e300).extinction, 9.0);
  EXPECT_EQ(eval_optical_function(function, std::nan("")).extinction, 0.0);
  expect_error(
      ErrorCode::kInvalidArgument, [] { eval_optical_function({}, 0.0); }, "without points");
}

}  // namespace
}  // namespace tetravox
