#include "tests/unit/optics/expect_error.h"
#include "tetravox/transfer_function.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace tetravox {
namespace {

using testing::expect_error;

/// Optical depth of a path of 58 unit distances on which values are as frequent as in the histogram.
double mean_optical_depth(const Histogram& histogram, const TransferFunction& function) {
  const OpticalFunction optical = make_optical_function(function, 1.0);
  double sum = 0.0, total = 0.0;
  for (std::size_t i = 0; i < histogram.counts.size(); ++i) {
    const double t = (static_cast<double>(i) + 0.5) / static_cast<double>(histogram.counts.size());
    const double value = std::lerp(histogram.range.min, histogram.range.max, t);
    sum += histogram.counts[i] * eval_optical_function(optical, value).extinction;
    total += histogram.counts[i];
  }
  return 58.0 * sum / total;
}

Histogram make_histogram(ValueRange range, std::size_t bins, double (*density)(double)) {
  Histogram histogram{range, std::vector<double>(bins)};
  for (std::size_t i = 0; i < bins; ++i)
    histogram.counts[i] = density((static_cast<double>(i) + 0.5) / static_cast<double>(bins));
  return histogram;
}

const std::pair<const char*, double (*)(double)> kDensities[] = {
    {"uniform", [](double) { return 1.0; }},
    {"bell", [](double t) { return std::exp(-50 * (t - 0.5) * (t - 0.5)); }},
    {"narrow band", [](double t) { return std::abs(t - 0.2) < 0.01 ? 1000.0 : 0.1; }},
    {"exponential", [](double t) { return std::exp(-20 * t); }},
    {"two humps",
     [](double t) { return std::exp(-500 * (t - 0.2) * (t - 0.2)) + std::exp(-500 * (t - 0.8) * (t - 0.8)); }},
    {"mostly background", [](double t) { return t < 0.02 ? 1e6 : 1.0; }},
    {"one bin", [](double t) { return t > 0.5 && t < 0.516 ? 1.0 : 0.0; }}};

TEST(DefaultFunction, IsNeitherFogNorInvisible) {
  for (const auto& [name, density] : kDensities)
    for (const std::size_t bins : {64u, 256u, 512u}) {
      const Histogram histogram = make_histogram({-3, 7}, bins, density);
      const TransferFunction function = make_default_transfer_function(histogram);
      const double depth = mean_optical_depth(histogram, function);
      EXPECT_GT(depth, 0.5) << name << " " << bins;
      EXPECT_LT(depth, 3.0) << name << " " << bins;
    }
}

TEST(DefaultFunction, IsThinForFrequentValuesAndStandsOutForRareOnes) {
  const Histogram histogram = make_histogram({0, 1}, 512, kDensities[5].second);
  const OpticalFunction optical = make_optical_function(make_default_transfer_function(histogram), 1.0);
  double rare = 0.0;
  for (int i = 100; i < 512; ++i) rare = std::max(rare, eval_optical_function(optical, i / 512.0).extinction);
  EXPECT_GT(rare, 10.0 * eval_optical_function(optical, 0.005).extinction);
}

TEST(DefaultFunction, KeepsABackgroundThinWhereverItLiesInItsBin) {
  Histogram histogram{{0, 1}, std::vector<double>(512, 1e-4)};
  histogram.counts[200] = 1.0;
  const OpticalFunction optical = make_optical_function(make_default_transfer_function(histogram), 1.0);
  for (int i = 0; i <= 16; ++i) EXPECT_LT(58 * eval_optical_function(optical, (200 + i / 16.0) / 512).extinction, 1.8);
}

TEST(DefaultFunction, DrawsAConstantField) {
  const Histogram histogram{{5, 5}, {0, 3, 0}};
  const TransferFunction function = make_default_transfer_function(histogram);
  const OpticalPoint point = eval_optical_function(make_optical_function(function, 1.0), 5.0);
  EXPECT_GT(58 * point.extinction, 0.5);
  EXPECT_LT(58 * point.extinction, 3.0);
}

TEST(DefaultFunction, GivesLabelsTheirOwnFlatColors) {
  Histogram histogram{{0, 3}, std::vector<double>(256)};
  histogram.counts[0] = 1000;
  histogram.counts[85] = 10;
  histogram.counts[170] = 20;
  histogram.counts[255] = 100;
  const OpticalFunction optical = make_optical_function(make_default_transfer_function(histogram), 1.0);
  const OpticalPoint labels[] = {eval_optical_function(optical, 0), eval_optical_function(optical, 1),
                                 eval_optical_function(optical, 2), eval_optical_function(optical, 3)};
  for (int i = 0; i < 4; ++i) {
    EXPECT_EQ(eval_optical_function(optical, i + (i < 3 ? 0.2 : -0.2)).color, labels[i].color);
    EXPECT_GT(labels[i].extinction, 0.0);
    for (int k = 0; k < i; ++k) EXPECT_NE(labels[i].color, labels[k].color);
  }
  EXPECT_GT(labels[1].extinction, labels[0].extinction);
}

TEST(DefaultFunction, InvertTurnsColors) {
  const Histogram histogram = make_histogram({0, 1}, 256, kDensities[0].second);
  const auto plain = make_optical_function(make_default_transfer_function(histogram), 1.0);
  const auto inverted = make_optical_function(make_default_transfer_function(histogram, true), 1.0);
  for (int c = 0; c < 3; ++c)
    EXPECT_NEAR(eval_optical_function(plain, 0.1).color[c], eval_optical_function(inverted, 0.9).color[c], 0.02);
  EXPECT_EQ(eval_optical_function(plain, 0.3).extinction, eval_optical_function(inverted, 0.3).extinction);
}

TEST(DefaultFunction, SurvivesOddHistograms) {
  const double huge = std::numeric_limits<double>::max(), tiny = std::numeric_limits<double>::denorm_min();
  const double nan = std::nan("");
  for (const ValueRange& range : {ValueRange{0, 1}, {-huge, huge}, {0, tiny}, {1e15, 1e15 + 0.125}, {0, 0}})
    for (const std::vector<double>& counts : {std::vector<double>{1},
                                              {0},
                                              {0, 0, 0},
                                              {1, 2},
                                              {nan, 1, 2, 3},
                                              {-1, 5, 5, 5},
                                              {huge, huge, huge, huge},
                                              {HUGE_VAL, 1, 1, 1},
                                              std::vector<double>(100000, 1.0),
                                              {tiny, tiny, tiny, tiny}})
      EXPECT_NO_THROW(make_optical_function(make_default_transfer_function({range, counts}), 1.0))
          << range.min << " " << counts.size() << " " << counts[0];
  expect_error(
      ErrorCode::kInvalidArgument,
      [] {
        make_default_transfer_function({{0, 1}, {}});
      },
      "bins");
  expect_error(
      ErrorCode::kInvalidArgument,
      [&] {
        make_default_transfer_function({{nan, 1}, {1}});
      },
      "range");
}

}  // namespace
}  // namespace tetravox
