#include "tests/common/grid_builder.h"
#include "tests/unit/optics/expect_error.h"
#include "tetravox/scene.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace tetravox {
namespace {

using testing::expect_error;
using tests::GridOptions;

PreparedGrid prepare(const GridOptions& options, const tests::Field& field) {
  return prepare_grid(tests::make_grid(options, field));
}

GridOptions options_of(std::uint32_t points, ScalarType type = ScalarType::kFloat32) {
  GridOptions options;
  options.dimensions = {points, points, points};
  options.type = type;
  return options;
}

double total(const Histogram& histogram) {
  return std::accumulate(histogram.counts.begin(), histogram.counts.end(), 0.0);
}

/// A ball of 1 to 2 in air of `air` with a little noise.
double ball_in_air(const Vector3& p, double air) {
  const double r = std::hypot(p[0], p[1], p[2]);
  if (r < 0.5) return 2.0 - 2.0 * r;
  return air + 0.004 * (std::sin(131.0 * p[0]) + std::sin(157.0 * p[1]) + std::sin(191.0 * p[2]));
}

TEST(GridHistogram, OfALinearFieldIsFlatAndHoldsTheCells) {
  const Histogram histogram = make_histogram(prepare(options_of(65), [](const Vector3& p) { return p[2]; }), 16);
  EXPECT_FALSE(histogram.background);
  EXPECT_NEAR(total(histogram), 64.0 * 64.0 * 64.0, 1.0);
  for (std::size_t i = 1; i + 1 < histogram.counts.size(); ++i)
    EXPECT_NEAR(histogram.counts[i] * 16 / total(histogram), 1.0, 0.05) << i;
}

TEST(GridHistogram, WeighsByTheWidthsOfUnevenCells) {
  GridOptions options = options_of(33);
  options.association = Association::kCell;
  options.fractions[0] = tests::growing_fractions(33, 50.0);
  const Histogram histogram =
      make_histogram(prepare(options, [](const Vector3& p) { return 0.24 * p[1] + (p[0] > 0 ? 0.75 : 0.25); }), 4);
  EXPECT_NEAR((histogram.counts[2] + histogram.counts[3]) / total(histogram), 0.5, 0.06);
}

TEST(GridHistogram, IsTheSameOnEveryRun) {
  const PreparedGrid grid = prepare(options_of(40), [](const Vector3& p) { return std::sin(9 * p[0]) * p[1]; });
  const Histogram first = make_histogram(grid, 256);
  for (int run = 0; run < 3; ++run) EXPECT_EQ(make_histogram(grid, 256).counts, first.counts);
  for (const int bins : {0, 2'000'000})
    expect_error(
        ErrorCode::kInvalidArgument, [&] { make_histogram(grid, bins); }, "bins");
}

TEST(GridHistogram, WholeNumbersLeaveNoGaps) {
  const PreparedGrid grid = prepare(options_of(64, ScalarType::kUint8),
                                    [](const Vector3& p) { return 63.5 * p[0] + 40.0 * p[1] + 23.5 * p[2] + 127.0; });
  const Histogram histogram = make_histogram(grid, 512);
  EXPECT_EQ(std::count(histogram.counts.begin(), histogram.counts.end(), 0.0), 0);
}

TEST(GridHistogram, FindsTheBackgroundAtEitherEndAndBetween) {
  for (const double air : {0.0, 1.45, 3.0}) {
    const PreparedGrid grid = prepare(options_of(48), [&](const Vector3& p) { return ball_in_air(p, air); });
    const Histogram histogram = make_histogram(grid, 512);
    ASSERT_TRUE(histogram.background) << air;
    EXPECT_LE(histogram.background->min, air) << air;
    EXPECT_GE(histogram.background->max, air) << air;
    EXPECT_LT(histogram.background->max - histogram.background->min, 0.5) << air;
    // Air is transparent, and the ball is not.
    Scene scene;
    const OpticalFunction function = complete_scene(scene, grid).optical_function;
    EXPECT_EQ(eval_optical_function(function, air).extinction, 0.0) << air;
    EXPECT_GT(eval_optical_function(function, air > 2 ? 1.9 : 1.95).extinction, 0.0) << air;
  }
}

TEST(GridHistogram, AFieldThatFillsItsBoxHasNoBackground) {
  const PreparedGrid grid = prepare(options_of(48), [](const Vector3& p) { return tests::marschner_lobb(p); });
  EXPECT_FALSE(make_histogram(grid, 512).background);
}

TEST(CompleteGridScene, TheViewIsFittedToWhatIsShown) {
  const auto draw_distance = [](double radius) {
    const PreparedGrid grid = prepare(options_of(64), [&](const Vector3& p) {
      return std::max(0.0, radius - std::hypot(p[0], p[1], p[2])) / radius;
    });
    const Camera camera = complete_scene({}, grid).camera;
    return std::hypot(camera.position[0], camera.position[1], camera.position[2]);
  };
  EXPECT_LT(draw_distance(0.3), 0.6 * draw_distance(0.9));
}

TEST(CompleteGridScene, KeepsWhatTheSceneSays) {
  const PreparedGrid grid = prepare(options_of(8), [](const Vector3& p) { return p[0]; });
  Scene scene;
  scene.transfer_function = TransferFunction{{{0.0, {1, 0, 0}, 0.5}}, Absorption::kOpacity, std::nullopt};
  scene.camera = Camera{};
  const CompletedScene given = complete_scene(scene, grid);
  EXPECT_EQ(given.camera.position, Camera{}.position);
  EXPECT_NEAR(given.optical_function.points[0].extinction, std::log(2.0) / (2.0 * std::sqrt(3.0) / 100.0), 1e-6);
}

TEST(CompleteGridScene, DrawsAConstantGrid) {
  const PreparedGrid grid = prepare(options_of(8), [](const Vector3&) { return 3.0; });
  const CompletedScene completed = complete_scene({}, grid);
  EXPECT_GT(eval_optical_function(completed.optical_function, 3.0).extinction, 0.0);
  EXPECT_NO_THROW(validate_camera(completed.camera));
}

}  // namespace
}  // namespace tetravox
