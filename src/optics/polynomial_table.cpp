#include "src/optics/polynomial_table.h"

#include "src/optics/pair_integrals.h"
#include "src/optics/record_mix.h"
#include "src/support/memory.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

namespace tetravox::optics {
namespace {

/// Lengths that a polynomial is fitted to: denser where short, since most segments are.
std::vector<double> make_fit_places(int degree) {
  const int count = degree == 0 ? 0 : 2 * degree + 1;
  std::vector<double> places;
  for (int k = 1; k <= count; ++k) places.push_back(std::pow(static_cast<double>(k) / count, 2));
  return places;
}

/// Row i: weights of the values at the places in the coefficient of t^(i + 1), by least squares; the polynomial is 0 at
/// t = 0.
std::vector<std::vector<double>> make_fit_weights(int degree, const std::vector<double>& places) {
  const auto n = static_cast<std::size_t>(degree);
  // Normal equations, with the weights of all places as right-hand sides at once; solved by elimination.
  std::vector<std::vector<double>> rows(n, std::vector<double>(n + places.size()));
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t k = 0; k < places.size(); ++k) rows[i][n + k] = std::pow(places[k], static_cast<double>(i + 1));
    for (std::size_t j = 0; j < n; ++j)
      for (const double t : places) rows[i][j] += std::pow(t, static_cast<double>(i + j + 2));
  }
  for (std::size_t i = 0; i < n; ++i) {
    const auto larger = [&](const auto& a, const auto& b) { return std::abs(a[i]) < std::abs(b[i]); };
    std::swap(rows[i], *std::max_element(rows.begin() + static_cast<std::ptrdiff_t>(i), rows.end(), larger));
    const double pivot = rows[i][i];
    for (double& number : rows[i]) number /= pivot;
    for (std::size_t j = 0; j < n; ++j) {
      if (j == i) continue;
      const double factor = rows[j][i];
      for (std::size_t column = 0; column < rows[j].size(); ++column) rows[j][column] -= factor * rows[i][column];
    }
  }
  for (auto& row : rows) row.erase(row.begin(), row.begin() + static_cast<std::ptrdiff_t>(n));
  return rows;
}

OpticalFunction make_opaque_everywhere(const OpticalFunction& function) {
  OpticalFunction opaque = function;
  for (OpticalPoint& point : opaque.points) point.extinction = 1.0;
  return opaque;
}

/// Colours of segments so thin that they do not attenuate themselves; also of those that nothing is seen of, so that
/// visible neighbours are not mixed with black.
class ThinColors {
 public:
  ThinColors(const PreintegrationSource& source, const SegmentIntegral& function)
      : function_(function),
        colors_(make_opaque_everywhere(source.function), find_table_range(source)),
        least_(1e-9 / source.longest) {}

  std::array<double, 3> eval(double a, double b) const {
    const OpticalDensity density = function_.mean(a, b), mean = density[0] > least_ ? density : colors_.mean(a, b);
    return {mean[1] / mean[0], mean[2] / mean[0], mean[3] / mean[0]};
  }

 private:
  const SegmentIntegral& function_;
  SegmentIntegral colors_;
  double least_;
};

}  // namespace

PolynomialFit make_polynomial_fit(int degree) {
  std::vector<double> places = make_fit_places(degree);
  std::vector<std::vector<double>> weights = make_fit_weights(degree, places);
  return {std::move(places), std::move(weights)};
}

std::vector<float> make_absorbed_ratios(int bits) {
  std::vector<float> ratios;
  for (int i = 0; i < PolynomialTable::kDepths; ++i) {
    const float depth = PolynomialTable::kDeepest * static_cast<float>(i) / (PolynomialTable::kDepths - 1);
    ratios.push_back(store_in_bits(eval_absorbed_ratio(depth), bits < 32 ? 16 : 32));
  }
  return ratios;
}

void store_maps_in_bits(int bits, double largest_extinction, int scalars, std::span<float> maps) {
  if (bits >= 32) return;
  const std::size_t size = 4 * static_cast<std::size_t>(scalars) * static_cast<std::size_t>(scalars);
  for (; maps.size() >= size; maps = maps.subspan(size)) {
    float least = std::numeric_limits<float>::max(), largest = -least;
    for (std::size_t i = 0; i < size; ++i)
      if (i % 4 != 3) {
        least = std::min(least, maps[i]);
        largest = std::max(largest, maps[i]);
      }
    const double width = std::max(static_cast<double>(largest) - static_cast<double>(least), 1e-30);
    const double most = std::max(largest_extinction, 1e-300);
    for (std::size_t i = 0; i < size; ++i)
      maps[i] = i % 4 == 3 ? static_cast<float>(store_in_bits(maps[i] / most, bits) * most)
                           : static_cast<float>(store_in_bits((maps[i] - least) / width, bits) * width + least);
  }
}

std::uint64_t polynomial_table_bytes(int scalars, int degree) {
  return (static_cast<std::uint64_t>(degree + 1) * static_cast<std::uint64_t>(scalars) *
              static_cast<std::uint64_t>(scalars) * 4 +
          PolynomialTable::kDepths) *
         sizeof(float);
}

void build_polynomial_table(const PreintegrationSource& source, const PreintegrationSettings& settings,
                            PolynomialTable& table) {
  const int scalars = settings.scalars, degree = settings.degree;
  const std::uint64_t bytes = polynomial_table_bytes(scalars, degree);
  if (bytes > table.bytes())
    support::require_memory(bytes - table.bytes(), "tables of " + std::to_string(degree + 1) + " x " +
                                                       std::to_string(scalars) + " x " + std::to_string(scalars) +
                                                       " coefficients");
  const SegmentIntegral function(source.function, find_table_range(source));
  const ThinColors thin(source, function);
  table.domain = make_segment_domain(source);
  table.scalars = scalars;
  table.degree = degree;
  table.opacity = settings.opacity;
  table.absorbed_ratios = make_absorbed_ratios(settings.bits);
  table.maps.resize(bytes / sizeof(float) - PolynomialTable::kDepths);

  const auto [places, weights] = make_polynomial_fit(degree);
  std::vector<double> lengths;
  for (const double place : places) lengths.push_back(place * source.longest);
  const std::size_t size = 4 * static_cast<std::size_t>(scalars) * static_cast<std::size_t>(scalars);
  const auto store = [&](int front, int back, std::span<const Slab> by_length) {
    const double a = static_cast<double>(front) / (scalars - 1), b = static_cast<double>(back) / (scalars - 1);
    const std::array<double, 3> color = thin.eval(a, b);
    float* entry = table.maps.data() + 4 * (static_cast<std::size_t>(back) * scalars + front);
    for (std::size_t channel = 0; channel < 3; ++channel) entry[channel] = static_cast<float>(color[channel]);
    entry[3] = static_cast<float>(function.mean(a, b)[0]);
    for (const std::vector<double>& row : weights) {
      entry += size;
      std::array<double, 3> sum{};
      for (std::size_t k = 0; k < by_length.size(); ++k)
        for (std::size_t channel = 0; channel < 3; ++channel)
          if (by_length[k].opacity > 1e-9)
            sum[channel] += row[k] * (by_length[k].color[channel] / by_length[k].opacity - color[channel]);
      for (std::size_t channel = 0; channel < 3; ++channel) entry[channel] = static_cast<float>(sum[channel]);
      entry[3] = 0.0f;
    }
  };
  integrate_pairs(function, {scalars, lengths, settings.steps, &source.progress}, settings.use_incremental, store);
  store_maps_in_bits(settings.bits, function.largest_extinction(), scalars, table.maps);
}

SegmentColor eval_polynomial_table(const PolynomialTable& table, float scalar_front, float scalar_back, float length) {
  const SegmentDomain& domain = table.domain;
  const float inside = std::min(length, domain.longest), t = inside / domain.longest;
  const Node x = find_node(eval_scalar_place(domain, scalar_front), table.scalars);
  const Node y = find_node(eval_scalar_place(domain, scalar_back), table.scalars);
  const std::size_t row = static_cast<std::size_t>(table.scalars), first = y.index * row + x.index;
  const auto look_up = [&](int map) {
    return mix_square(table.maps.data() + 4 * static_cast<std::size_t>(map) * row * row, first, row, x.part, y.part);
  };
  FloatRecord sum = look_up(table.degree);
  for (int map = table.degree - 1; map >= 0; --map) {
    const FloatRecord coefficient = look_up(map);
    for (std::size_t i = 0; i < 3; ++i) sum[i] = sum[i] * t + coefficient[i];
    sum[3] = coefficient[3];
  }
  const float depth = sum[3] * inside;
  float opacity = std::min(depth, 1.0f);
  if (table.opacity == OpacityModel::kExponential) {
    const Node node = find_node(std::min(depth * (1.0f / PolynomialTable::kDeepest), 1.0f), PolynomialTable::kDepths);
    const float* ratios = table.absorbed_ratios.data() + node.index;
    opacity = depth < PolynomialTable::kDeepest ? depth * (node.part * (ratios[1] - ratios[0]) + ratios[0]) : 1.0f;
  }
  const auto channel = [&](float color) { return std::min(std::max(color, 0.0f), 1.0f) * opacity; };
  return {channel(sum[0]), channel(sum[1]), channel(sum[2]), opacity};
}

}  // namespace tetravox::optics
