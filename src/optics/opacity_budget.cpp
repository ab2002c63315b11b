#include "src/optics/opacity_budget.h"

#include "src/optics/color_maps.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace tetravox::optics {
namespace {

// A ray across a cube is 58 hundredths of the diagonal long; most objects are a little thinner.
constexpr double kRayLength = 50.0;
constexpr double kOpticalDepth = 2.0;     // of a ray through everything
constexpr double kSolidExtinction = 0.6;  // of rare values, in a hundredth of the diagonal
constexpr double kThinnestBody = 0.005;   // of the most frequent values, where rare ones are to be seen
constexpr double kLeastDepth = 0.9;       // of a ray, if need be with a thicker body

}  // namespace

double opacity_from_extinction(double extinction) { return -std::expm1(-extinction); }

Color color_at(double u, bool invert) {
  static const std::vector<ColorMapPoint> points = color_map_points("turbo");
  return eval_color_map(points, std::lerp(0.09, 0.93, invert ? 1.0 - u : u));
}

std::vector<double> smoothed(const std::vector<double>& shares, double sigma) {
  const int radius = std::max(1, static_cast<int>(std::ceil(3.0 * sigma))), count = static_cast<int>(shares.size());
  std::vector<double> result(shares.size());
  for (int i = 0; i < count; ++i) {
    double sum = 0.0, weights = 0.0;
    for (int j = std::max(0, i - radius); j <= std::min(count - 1, i + radius); ++j) {
      const double weight = std::exp(-0.5 * (i - j) * (i - j) / (sigma * sigma));
      sum += weight * shares[static_cast<std::size_t>(j)];
      weights += weight;
    }
    result[static_cast<std::size_t>(i)] = sum / weights;
  }
  return result;
}

std::vector<double> positions(const std::vector<double>& shares, double part_by_value) {
  std::vector<double> u(shares.size());
  double total = 0.0;
  for (const double share : shares) total += std::sqrt(share);
  double below = 0.0;
  for (std::size_t i = 0; i < shares.size(); ++i) {
    const double root = std::sqrt(shares[i]);
    const double by_value = (static_cast<double>(i) + 0.5) / static_cast<double>(shares.size());
    u[i] = by_value;
    if (total > 0.0) u[i] = part_by_value * by_value + (1.0 - part_by_value) * (below + 0.5 * root) / total;
    below += root;
  }
  return u;
}

double mean_depth(const std::vector<double>& shares, const std::vector<double>& extinctions) {
  double mean = 0.0;
  for (std::size_t i = 0; i < shares.size(); ++i) mean += shares[i] * extinctions[i];
  return kRayLength * mean;
}

std::vector<double> widened(const std::vector<double>& shares) {
  std::vector<double> result = shares;
  for (std::size_t i = 0; i + 1 < shares.size(); ++i) {
    result[i] = std::max(result[i], shares[i + 1]);
    result[i + 1] = std::max(result[i + 1], shares[i]);
  }
  return result;
}

std::vector<double> fit_budget(const std::vector<double>& shares, const std::vector<double>& crowds,
                               const std::vector<double>& extinctions) {
  std::vector<double> fitted;
  for (double body = kThinnestBody; body <= kBodyExtinction; body *= 1.25) {
    fitted = extinctions;
    for (int pass = 0; pass < 8; ++pass) {
      const double depth = mean_depth(shares, fitted);
      if (!(depth > 0.0)) break;
      for (std::size_t i = 0; i < shares.size(); ++i) {
        const double density = crowds[i] * static_cast<double>(crowds.size());
        fitted[i] = std::min(fitted[i] * kOpticalDepth / depth, body + kSolidExtinction / std::max(1.0, density));
      }
    }
    if (mean_depth(shares, fitted) > kLeastDepth) break;
  }
  return fitted;
}

std::vector<double> scale_to_budget(const std::vector<double>& shares, const std::vector<double>& extinctions) {
  const double depth = mean_depth(shares, extinctions);
  const double largest = *std::max_element(extinctions.begin(), extinctions.end());
  if (!(depth > 0.0) || !(largest > 0.0)) return extinctions;
  std::vector<double> scaled;
  for (const double extinction : extinctions)
    scaled.push_back(extinction * std::min(kOpticalDepth / depth, kSolidExtinction / largest));
  return scaled;
}

}  // namespace tetravox::optics
