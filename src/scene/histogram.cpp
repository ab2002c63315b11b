#include "src/scene/cell_samples.h"
#include "src/scene/histogram_limits.h"
#include "src/scene/robust_range.h"
#include "tetravox/scene.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace tetravox {
namespace {

using scene::CellSample;

constexpr std::size_t kLargestSampleCount = 100'000;
constexpr int kStepsAcrossBox = 8;

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
  const double area = boundary_area(mesh);
  if (!(area > 0.0) || !(volume > 0.0)) return std::nullopt;
  return scene::unit_distance_for_chord(4.0 * volume / area * mesh.world_per_local, mesh.bounds);
}

}  // namespace

Histogram make_histogram(const PreparedMesh& mesh, int bins) {
  scene::require_bin_count(bins);
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
  range =
      scene::robust_range(range, [&](const ValueRange& part, int count) { return count_cells(samples, part, count); });
  histogram.counts = count_cells(samples, range, bins);
  histogram.range = {mesh.scalar_offset + range.min * mesh.scalar_scale,
                     mesh.scalar_offset + range.max * mesh.scalar_scale};
  return histogram;
}

}  // namespace tetravox
