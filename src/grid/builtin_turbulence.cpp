/// Turbulence as a sum of octaves of wavelet noise (Cook and DeRose 2005): random coefficients of quadratic B-splines
/// on a lattice, less their projection onto splines of twice the width, hold one octave of frequencies and hardly any
/// other. We project exactly, by the inverse of the splines' inner products (Unser, Aldroubi, Eden 1993), instead of
/// by a filter of 32 taps; and as a spline is also one on a lattice twice as fine, all octaves are summed as
/// coefficients on the finest lattice, so that a value costs the same however many octaves there are.
///
/// Only sums, products, quotients and whole numbers: the same bits everywhere.

#include "src/grid/builtin.h"
#include "src/support/threads.h"

#include <algorithm>
#include <array>
#include <limits>
#include <memory>
#include <mutex>
#include <vector>

namespace tetravox::grid {
namespace {

constexpr std::size_t kTile = 128;      // coefficients of noise along each axis, periodic
constexpr std::size_t kFirstCells = 4;  // of the widest octave's lattice, along each axis
constexpr std::size_t kMostCells = 256;
constexpr std::size_t kPointsOfCell = 4;  // at least, of the finest octave

/// A number that looks random (Steele, Lea, Flood 2014: SplitMix64).
std::uint64_t mix(std::uint64_t x) {
  x += 0x9e3779b97f4a7c15u;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
  return x ^ (x >> 31);
}

/// In [-1, 1).
double uniform(std::uint64_t seed, std::uint64_t index) {
  return static_cast<double>(mix(mix(seed) + index) >> 11) * 0x1p-52 - 1.0;
}

using Line = std::array<double, kTile>;
using HalfLine = std::array<double, kTile / 2>;

/// Solves for the coefficients of splines whose inner products with the basis are `line`: the inverse of the filter
/// (1, 26, 66, 26, 1) / 120, a quintic B-spline's samples, by recursions over its two poles. Periodic.
void divide_by_inner_products(HalfLine& line) {
  constexpr std::array kPoles{-0.43057534709997825, -0.04309628820326465};
  for (const double pole : kPoles) {
    const double gain = (1.0 - pole) * (1.0 - 1.0 / pole);
    double last = 0.0;
    // The first round finds out what the second one, which counts, begins with.
    for (int round = 0; round < 2; ++round)
      for (std::size_t i = 0; i < line.size(); ++i) {
        last = line[i] + pole * last;
        if (round == 1) line[i] = last;
      }
    last = 0.0;
    for (int round = 0; round < 2; ++round)
      for (std::size_t i = line.size(); i-- > 0;) {
        last = pole * (last - line[i]);
        if (round == 1) line[i] = last;
      }
    for (double& value : line) value *= gain;
  }
}

/// Coefficient m of the same spline on a lattice twice as fine lies beside the coarse one (m + 1) / 2, and nearer to it
/// than to its other neighbour (Chaikin 1974).
struct Parents {
  std::size_t near = 0, far = 0;
};
Parents parents_of(std::size_t m) {
  const std::size_t near = (m + 1) / 2;
  return {near, m % 2 == 1 ? near - 1 : near + 1};
}
constexpr double kNearWeight = 0.75, kFarWeight = 0.25;

/// The splines of twice the width that come closest to `line`, as splines of its own width.
void project_to_coarser(Line& line) {
  // Inner products of a spline of width 1, moved by -4 ... 3, with one of width 2.
  constexpr std::array<double, 8> kProducts{1.0 / 480,   29.0 / 480,  147.0 / 480, 303.0 / 480,
                                            303.0 / 480, 147.0 / 480, 29.0 / 480,  1.0 / 480};
  HalfLine coarse;
  for (std::size_t j = 0; j < coarse.size(); ++j) {
    double sum = 0.0;
    for (std::size_t tap = 0; tap < kProducts.size(); ++tap)
      sum += kProducts[tap] * line[(2 * j + tap + kTile - 4) % kTile];
    coarse[j] = 0.5 * sum;
  }
  divide_by_inner_products(coarse);
  for (std::size_t m = 0; m < kTile; ++m) {
    const Parents parents = parents_of(m + kTile);
    line[m] = kNearWeight * coarse[parents.near % coarse.size()] + kFarWeight * coarse[parents.far % coarse.size()];
  }
}

/// Projects along all lines of one axis; `stride` is that of the axis.
void project_tile(std::vector<float>& tile, std::size_t stride) {
  support::parallel_chunks(kTile * kTile, kTile, [&](std::size_t begin, std::size_t end) {
    Line line;
    for (std::size_t n = begin; n < end; ++n) {
      float* first = tile.data() + n / stride * stride * kTile + n % stride;
      for (std::size_t i = 0; i < kTile; ++i) line[i] = static_cast<double>(first[i * stride]);
      project_to_coarser(line);
      for (std::size_t i = 0; i < kTile; ++i) first[i * stride] = static_cast<float>(line[i]);
    }
  });
}

/// Coefficients of noise, [kTile][kTile][kTile].
std::vector<float> make_noise_tile(std::uint64_t seed) {
  std::vector<float> noise(kTile * kTile * kTile);
  for (std::size_t i = 0; i < noise.size(); ++i) noise[i] = static_cast<float>(uniform(seed, i));
  std::vector<float> coarse = noise;
  for (const std::size_t stride : {std::size_t{1}, kTile, kTile * kTile}) project_tile(coarse, stride);
  for (std::size_t i = 0; i < noise.size(); ++i) noise[i] -= coarse[i];
  return noise;
}

/// A spline on a lattice of cells^3: coefficients [cells + 2]^3, of which cell c uses c, c + 1 and c + 2.
struct Spline {
  std::size_t cells = 0;
  std::vector<float> coefficients;

  std::size_t row() const { return cells + 2; }
};

/// The same spline on a lattice twice as fine (of nothing: on the first lattice), and `octave` of the noise added.
Spline add_octave(const Spline& coarse, const std::vector<float>& tile, std::uint64_t seed, int octave) {
  Spline fine;
  fine.cells = octave == 0 ? kFirstCells : 2 * coarse.cells;
  const std::size_t row = fine.row(), old_row = coarse.row();
  fine.coefficients.resize(row * row * row);
  const std::uint64_t shift = mix(seed ^ mix(static_cast<std::uint64_t>(octave) + 1));
  const float amplitude = 1.0f / static_cast<float>(1 << octave);
  support::parallel_chunks(row, 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t n = begin * row; n < end * row; ++n) {
      const std::size_t j = n % row, k = n / row;
      const float* noise = tile.data() + ((k + (shift >> 40)) % kTile * kTile + (j + (shift >> 20)) % kTile) * kTile;
      float* out = fine.coefficients.data() + n * row;
      for (std::size_t i = 0; i < row; ++i) out[i] = amplitude * noise[(i + shift) % kTile];
      if (octave == 0) continue;
      const Parents pj = parents_of(j), pk = parents_of(k);
      for (const auto& [ck, wk] : {std::pair{pk.near, kNearWeight}, std::pair{pk.far, kFarWeight}})
        for (const auto& [cj, wj] : {std::pair{pj.near, kNearWeight}, std::pair{pj.far, kFarWeight}}) {
          const float* from = coarse.coefficients.data() + (ck * old_row + cj) * old_row;
          const auto near = static_cast<float>(wk * wj * kNearWeight), far = static_cast<float>(wk * wj * kFarWeight);
          for (std::size_t i = 0; i < row; ++i) {
            const Parents pi = parents_of(i);
            out[i] += near * from[pi.near] + far * from[pi.far];
          }
        }
    }
  });
  return fine;
}

Spline make_turbulence_spline(std::uint32_t size, std::uint64_t seed) {
  const std::vector<float> tile = make_noise_tile(seed);
  Spline spline;
  for (int octave = 0; octave == 0 || 2 * spline.cells <= std::min<std::size_t>(kMostCells, size / kPointsOfCell);
       ++octave)
    spline = add_octave(spline, tile, seed, octave);
  return spline;
}

/// The cell in which each point lies along an axis, and the weights there of the three coefficients it uses.
struct AxisWeights {
  std::vector<std::uint32_t> cell;
  std::array<std::vector<float>, 3> weight;
};
AxisWeights make_axis_weights(std::uint32_t size, std::size_t cells) {
  AxisWeights axis;
  for (std::size_t i = 0; i < size; ++i) {
    const double place = static_cast<double>(i * cells) / (size - 1.0);
    const auto cell = std::min(static_cast<std::uint32_t>(place), static_cast<std::uint32_t>(cells - 1));
    const double t = place - cell;
    axis.cell.push_back(cell);
    axis.weight[0].push_back(static_cast<float>(0.5 * (1.0 - t) * (1.0 - t)));
    axis.weight[1].push_back(static_cast<float>(0.75 - (t - 0.5) * (t - 0.5)));
    axis.weight[2].push_back(static_cast<float>(0.5 * t * t));
  }
  return axis;
}

/// Three rows of `count` coefficients, `stride` apart, as one, for point `i` of an axis.
void combine(const float* from, std::size_t stride, std::size_t count, const AxisWeights& axis, std::size_t i,
             float* out) {
  const float* first = from + axis.cell[i] * stride;
  const float a = axis.weight[0][i], b = axis.weight[1][i], c = axis.weight[2][i];
  for (std::size_t n = 0; n < count; ++n) out[n] = a * first[n] + b * first[n + stride] + c * first[n + 2 * stride];
}

/// Calls `write` with the spline's values in each row of slice k.
template <class Write>
void eval_slice(const Spline& spline, const AxisWeights& axis, std::size_t k, const Write& write) {
  const std::size_t row = spline.row(), size = axis.cell.size();
  std::vector<float> plane(row * row), line(row), values(size);
  combine(spline.coefficients.data(), row * row, row * row, axis, k, plane.data());
  for (std::size_t j = 0; j < size; ++j) {
    combine(plane.data(), row, row, axis, j, line.data());
    for (std::size_t i = 0; i < size; ++i) {
      const float* c = line.data() + axis.cell[i];
      values[i] = axis.weight[0][i] * c[0] + axis.weight[1][i] * c[1] + axis.weight[2][i] * c[2];
    }
    write(values);
  }
}

ValueRange range_of(const Spline& spline, const AxisWeights& axis) {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  float low = kInfinity, high = -kInfinity;
  std::mutex mutex;
  support::parallel_chunks(axis.cell.size(), 1, [&](std::size_t begin, std::size_t end) {
    float part_low = kInfinity, part_high = -kInfinity;
    for (std::size_t k = begin; k < end; ++k)
      eval_slice(spline, axis, k, [&](const std::vector<float>& values) {
        for (const float value : values) {
          part_low = std::min(part_low, value);
          part_high = std::max(part_high, value);
        }
      });
    const std::lock_guard lock(mutex);
    low = std::min(low, part_low);
    high = std::max(high, part_high);
  });
  return {static_cast<double>(low), static_cast<double>(high)};
}

}  // namespace

BuiltinField make_turbulence_field(std::uint32_t size, std::uint64_t seed) {
  BuiltinField field;
  field.array_name = "turbulence";
  field.extent = {0.0, 1.0};
  const auto spline = std::make_shared<const Spline>(make_turbulence_spline(size, seed));
  const AxisWeights axis = make_axis_weights(size, spline->cells);
  const ValueRange range = range_of(*spline, axis);
  field.visit_slice = [spline, axis, range](std::size_t k, const auto& write) {
    std::vector<double> row(axis.cell.size());
    eval_slice(*spline, axis, k, [&](const std::vector<float>& values) {
      for (std::size_t i = 0; i < row.size(); ++i)
        row[i] = (static_cast<double>(values[i]) - range.min) / (range.max - range.min);
      write(row);
    });
  };
  return field;
}

}  // namespace tetravox::grid
