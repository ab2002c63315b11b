#include "src/scene/cell_samples.h"
#include "tetravox/error.h"
#include "tetravox/scene.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace tetravox {
namespace {

using scene::CellSample;

constexpr std::size_t kLargestSampleCount = 100'000;
constexpr int kLargestBinCount = 1 << 20;
constexpr int kStepsAcrossBox = 8;
constexpr double kTail = 1e-3;        // part of the volume at either end that may be an outlier
constexpr double kOutlierRatio = 20;  // outliers are cut off when they make the range this much wider

/// Adds one cell. Four points of equal weight (Keast 1986) stand for its inside; each is spread evenly over a quarter
/// of the cell's range, so that a large cell leaves no gaps.
void add_cell(const CellSample& cell, double min, double max, std::vector<double>& counts) {
  const auto [lowest, highest] = std::minmax_element(cell.scalars.begin(), cell.scalars.end());
  const double low = *lowest, high = *highest, bins_per_value = static_cast<double>(counts.size()) / (max - min);
  const double sum = static_cast<double>(cell.scalars[0]) + cell.scalars[1] + cell.scalars[2] + cell.scalars[3];
  const double half_width = 0.125 * (high - low);
  const int steps = std::clamp(static_cast<int>(std::ceil(2.0 * half_width * bins_per_value)), 1, kStepsAcrossBox);
  const double weight = 0.25 * cell.volume / steps, last = static_cast<double>(counts.size()) - 1.0;
  for (const float scalar : cell.scalars) {
    const double middle = 0.1381966011250105 * sum + 0.4472135954999579 * scalar;
    const double begin = std::max(low, middle - half_width), end = std::min(high, middle + half_width);
    const double first = (begin - min) * bins_per_value, stride = (end - begin) * bins_per_value / steps;
    for (int i = 0; i < steps; ++i)
      counts[static_cast<std::size_t>(std::clamp(first + (i + 0.5) * stride, 0.0, last))] += weight;
  }
}

std::vector<double> count_cells(const std::vector<CellSample>& samples, const ValueRange& range, int bins) {
  std::vector<double> counts(static_cast<std::size_t>(bins));
  for (const CellSample& sample : samples)
    if (sample.volume > 0.0f) add_cell(sample, range.min, range.max, counts);
  return counts;
}

/// The part of `range` that holds all but a tail at either end, in whole bins.
ValueRange without_tails(const ValueRange& range, const std::vector<double>& counts) {
  double total = 0.0;
  for (const double count : counts) total += count;
  std::size_t first = 0, last = counts.size() - 1;
  for (double below = counts[first]; first < last && below <= kTail * total; below += counts[++first]) {
  }
  for (double above = counts[last]; last > first && above <= kTail * total; above += counts[--last]) {
  }
  const double width = (range.max - range.min) / static_cast<double>(counts.size());
  return {range.min + width * static_cast<double>(first), range.min + width * static_cast<double>(last + 1)};
}

/// The range of stored scalars, without a few outliers that would press everything else into one bin.
ValueRange robust_range(const std::vector<CellSample>& samples, ValueRange range) {
  constexpr int kBins = 1024, kLargestZoomCount = 12;
  for (int zoom = 0; zoom < kLargestZoomCount; ++zoom) {
    const ValueRange inner = without_tails(range, count_cells(samples, range, kBins));
    if ((inner.max - inner.min) * kOutlierRatio > range.max - range.min || !(inner.max > inner.min)) break;
    range = inner;
  }
  return range;
}

double boundary_area(const PreparedMesh& mesh) {
  double area = 0.0;
  for (const BoundaryFace& face : mesh.boundary) {
    const Vertex &a = mesh.vertices[face.vertices[0]], &b = mesh.vertices[face.vertices[1]],
                 &c = mesh.vertices[face.vertices[2]];
    const double ux = b.x - a.x, uy = b.y - a.y, uz = b.z - a.z, vx = c.x - a.x, vy = c.y - a.y, vz = c.z - a.z;
    area += 0.5 * std::hypot(uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx);
  }
  return area;
}

/// Unit distance for which the mean chord of the mesh, 4 volume / area (Cauchy 1841), is as many units long as that of
/// a cube of the same diagonal. `volume` is in the local frame.
std::optional<double> suitable_unit_distance(const PreparedMesh& mesh, double volume) {
  constexpr double kChordOfCube = 38.49;  // hundredths of the diagonal: 2 / (3 sqrt(3))
  constexpr double kSmallest = 1.0 / 20, kLargest = 1.5;
  const double unit = std::hypot(mesh.bounds[0].max - mesh.bounds[0].min, mesh.bounds[1].max - mesh.bounds[1].min,
                                 mesh.bounds[2].max - mesh.bounds[2].min) /
                      100.0;
  const double area = boundary_area(mesh);
  if (!(unit > 0.0) || !(area > 0.0) || !(volume > 0.0)) return std::nullopt;
  const double chord = 4.0 * volume / area * mesh.world_per_local;
  return std::clamp(chord / kChordOfCube, kSmallest * unit, kLargest * unit);
}

}  // namespace

Histogram make_histogram(const PreparedMesh& mesh, int bins) {
  if (bins < 1 || bins > kLargestBinCount)
    throw Error(ErrorCode::kInvalidArgument, "a histogram has from 1 to 1048576 bins");
  Histogram histogram;
  histogram.range = mesh.scalar_range;
  histogram.counts.resize(static_cast<std::size_t>(bins));
  const std::vector<CellSample> samples = scene::sample_cells(mesh, kLargestSampleCount);
  double volume = 0.0;
  for (const CellSample& sample : samples) volume += sample.volume;
  const double stride =
      static_cast<double>(mesh.cells.size()) / static_cast<double>(std::max<std::size_t>(1, samples.size()));
  histogram.unit_distance = suitable_unit_distance(mesh, volume * stride);
  ValueRange range{(mesh.scalar_range.min - mesh.scalar_offset) / mesh.scalar_scale,
                   (mesh.scalar_range.max - mesh.scalar_offset) / mesh.scalar_scale};
  if (!(range.max > range.min)) {
    histogram.counts[histogram.counts.size() / 2] = volume > 0.0 ? volume : 1.0;
    return histogram;
  }
  range = robust_range(samples, range);
  histogram.counts = count_cells(samples, range, bins);
  histogram.range = {mesh.scalar_offset + range.min * mesh.scalar_scale,
                     mesh.scalar_offset + range.max * mesh.scalar_scale};
  return histogram;
}

}  // namespace tetravox
