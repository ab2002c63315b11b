#include "src/grid/frame.h"
#include "src/grid/values.h"
#include "src/scene/differential_samples.h"
#include "src/scene/grid_samples.h"
#include "src/support/threads.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

namespace tetravox::scene {
namespace {

constexpr std::size_t kRowGrain = 16;

using Vector = std::array<double, 3>;
using Matrix = std::array<double, 9>;

/// Weights of a value and its two neighbours along an axis, for derivatives by the grid coordinate.
struct Stencil {
  Vector first{}, second{};
};

/// Grid coordinates of the values along an axis.
std::vector<double> places_along(const grid::GridFrame& frame, const GridData& grid, int axis) {
  std::vector<double> places(grid.value_dimensions()[static_cast<std::size_t>(axis)]);
  for (std::size_t i = 0; i < places.size(); ++i) {
    const auto index = static_cast<std::int64_t>(i);
    places[i] = frame.plane(axis, index);
    if (grid.association == Association::kCell) places[i] = 0.5 * (places[i] + frame.plane(axis, index + 1));
  }
  return places;
}

/// Three-point differences; at the ends of the axis one-sided ones, without curvature.
std::vector<Stencil> make_stencils(const std::vector<double>& places) {
  std::vector<Stencil> stencils(places.size());
  const std::size_t last = places.size() - 1;
  for (std::size_t i = 0; last > 0 && i <= last; ++i) {
    const double below = i > 0 ? places[i] - places[i - 1] : 0.0, above = i < last ? places[i + 1] - places[i] : 0.0;
    if (i == 0) {
      stencils[i].first = {0.0, -1.0 / above, 1.0 / above};
    } else if (i == last) {
      stencils[i].first = {-1.0 / below, 1.0 / below, 0.0};
    } else {
      const double both = below + above;
      stencils[i].first = {-above / (below * both), (above - below) / (below * above), below / (above * both)};
      stencils[i].second = {2.0 / (below * both), -2.0 / (below * above), 2.0 / (above * both)};
    }
  }
  return stencils;
}

double dot(const Vector& a, const Vector& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

/// Nine rows of values around the row of a sample, one value longer at either end: [k][j][i].
struct Neighbourhood {
  const float* values;
  std::size_t row;

  /// Three neighbours along i around value i, in row (j, k) of the nine.
  Vector along(std::size_t i, std::size_t j, std::size_t k) const {
    const float* at = values + (3 * k + j) * row + i;
    return {at[0], at[1], at[2]};
  }
};

/// Derivatives by grid coordinates at one value.
struct Derivatives {
  Vector gradient{};
  double xx = 0.0, yy = 0.0, zz = 0.0, xy = 0.0, xz = 0.0, yz = 0.0;
};

Derivatives differentiate(const Neighbourhood& near, std::size_t i, const Stencil& x, const Stencil& y,
                          const Stencil& z) {
  Derivatives d;
  const Vector middle = near.along(i, 1, 1);
  Vector by_y{}, by_z{}, slope_by_y{}, slope_by_z{};
  for (std::size_t n = 0; n < 3; ++n) {
    const Vector in_y = near.along(i, n, 1), in_z = near.along(i, 1, n);
    by_y[n] = in_y[1];
    by_z[n] = in_z[1];
    slope_by_y[n] = dot(x.first, in_y);
    slope_by_z[n] = dot(x.first, in_z);
    d.yz += z.first[n] * dot(y.first, {near.along(i, 0, n)[1], near.along(i, 1, n)[1], near.along(i, 2, n)[1]});
  }
  d.gradient = {dot(x.first, middle), dot(y.first, by_y), dot(z.first, by_z)};
  d.xx = dot(x.second, middle);
  d.yy = dot(y.second, by_y);
  d.zz = dot(z.second, by_z);
  d.xy = dot(y.first, slope_by_y);
  d.xz = dot(z.first, slope_by_z);
  return d;
}

/// Gradient magnitude and second derivative along the gradient, in the world. `grid_from_world` for unit lengths.
void set_derivatives(const Derivatives& d, const Matrix& grid_from_world, DifferentialSample& sample) {
  Vector world{}, along{};
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (std::size_t a = 0; a < 3; ++a) world[axis] += grid_from_world[3 * a + axis] * d.gradient[a];
  const double magnitude = std::sqrt(dot(world, world));
  sample.gradient = static_cast<float>(magnitude);
  if (!(magnitude > 0.0)) return;
  for (std::size_t a = 0; a < 3; ++a)
    for (std::size_t axis = 0; axis < 3; ++axis) along[a] += grid_from_world[3 * a + axis] * world[axis] / magnitude;
  sample.second =
      static_cast<float>(along[0] * along[0] * d.xx + along[1] * along[1] * d.yy + along[2] * along[2] * d.zz +
                         2.0 * (along[0] * along[1] * d.xy + along[0] * along[2] * d.xz + along[1] * along[2] * d.yz));
}

/// The side of a cube with the volume of a mean cell.
double side_of_cell(const Matrix& m) {
  const double volume =
      m[0] * (m[4] * m[8] - m[5] * m[7]) - m[1] * (m[3] * m[8] - m[5] * m[6]) + m[2] * (m[3] * m[7] - m[4] * m[6]);
  const double side = std::cbrt(std::abs(volume));
  return side > 0.0 && std::isfinite(side) ? side : 1.0;
}

/// Takes the samples of whole rows.
class RowSampler {
 public:
  explicit RowSampler(const PreparedGrid& grid)
      : reader_(grid.data, {grid.scalar_offset, grid.scalar_scale}), counts_(grid.data.value_dimensions()) {
    const grid::GridFrame frame = grid::make_grid_frame(grid.data.shape);
    unit_length = side_of_cell(frame.world_from_grid);
    for (std::size_t n = 0; n < 9; ++n) grid_from_world_[n] = frame.grid_from_world[n] * unit_length;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      stencils_[axis] = make_stencils(places_along(frame, grid.data, static_cast<int>(axis)));
      widths_[axis] = widths_along(grid.data, axis);
    }
  }

  /// Writes one sample for each value of row `index` to `out`; `rows` is working memory.
  void sample(std::size_t index, std::vector<float>& rows, DifferentialSample* out) const {
    const std::size_t j = index % counts_[1], k = index / counts_[1], length = counts_[0] + 2;
    rows.resize(9 * length);
    reader_.read({{-1, static_cast<std::int64_t>(j) - 1, static_cast<std::int64_t>(k) - 1},
                  {static_cast<std::int64_t>(length), 3, 3}},
                 rows.data());
    const Neighbourhood near{rows.data(), length};
    for (std::size_t i = 0; i < counts_[0]; ++i) {
      DifferentialSample sample;
      sample.value = static_cast<float>(near.along(i, 1, 1)[1]);
      set_derivatives(differentiate(near, i, stencils_[0][i], stencils_[1][j], stencils_[2][k]), grid_from_world_,
                      sample);
      const bool is_known =
          std::isfinite(sample.value) && std::isfinite(sample.gradient) && std::isfinite(sample.second);
      sample.volume = static_cast<float>(widths_[0][i] * widths_[1][j] * widths_[2][k]);
      out[i] = is_known ? sample : DifferentialSample{};
    }
  }

  double unit_length = 1.0;

 private:
  grid::BlockReader reader_;
  std::array<std::size_t, 3> counts_;
  Matrix grid_from_world_{};
  std::array<std::vector<Stencil>, 3> stencils_;
  std::array<std::vector<double>, 3> widths_;
};

/// Stored scalars of row `index` of a further field; a sample without a value is no place.
void sample_other(const grid::BlockReader& reader, const std::array<std::size_t, 3>& counts, std::size_t index,
                  float* values, DifferentialSample* samples) {
  reader.read({{0, static_cast<std::int64_t>(index % counts[1]), static_cast<std::int64_t>(index / counts[1])},
               {static_cast<std::int64_t>(counts[0]), 1, 1}},
              values);
  for (std::size_t i = 0; i < counts[0]; ++i)
    if (std::isnan(values[i])) samples[i] = {};
}

}  // namespace

DifferentialSamples sample_differentials(const PreparedGrid& grid, std::size_t largest_count) {
  const std::array<std::size_t, 3> counts = grid.data.value_dimensions();
  const std::size_t rows = counts[1] * counts[2];
  const std::vector<std::size_t> chosen =
      choose_rows(rows, std::clamp<std::size_t>(largest_count / counts[0], 1, rows));
  const RowSampler sampler(grid);
  DifferentialSamples result;
  result.unit_length = sampler.unit_length;
  result.samples.resize(chosen.size() * counts[0]);
  result.others.assign(grid.others.size(), std::vector<float>(result.samples.size()));
  std::vector<grid::BlockReader> readers;
  for (const PreparedGrid& other : grid.others)
    readers.emplace_back(other.data, grid::ScalarFrame{other.scalar_offset, other.scalar_scale});
  support::parallel_chunks(chosen.size(), kRowGrain, [&](std::size_t begin, std::size_t end) {
    std::vector<float> working;
    for (std::size_t n = begin; n < end; ++n) {
      DifferentialSample* samples = result.samples.data() + n * counts[0];
      sampler.sample(chosen[n], working, samples);
      for (std::size_t other = 0; other < readers.size(); ++other)
        sample_other(readers[other], counts, chosen[n], result.others[other].data() + n * counts[0], samples);
    }
  });
  return result;
}

}  // namespace tetravox::scene
