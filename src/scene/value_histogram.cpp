#include "src/grid/values.h"
#include "src/mesh/cell_vertices.h"
#include "src/scene/grid_samples.h"
#include "src/scene/volume_bins.h"
#include "src/support/threads.h"
#include "tetravox/analysis.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

namespace tetravox {
namespace {

constexpr int kLargestBinCount = 1 << 16;
constexpr std::size_t kPartCount = 64;  // of cells or rows, each with bins of its own: sums do not depend on threads

/// The share of a tetrahedron in which a linear field is below `value`: the volume that a plane cuts off. `s`: the
/// field at the four vertices, ascending.
double share_below(const std::array<double, 4>& s, double value) {
  if (!(value > s[0])) return 0.0;
  if (!(value < s[3])) return 1.0;
  const auto along = [&](int i, int j) { return (value - s[i]) / (s[j] - s[i]); };
  if (value <= s[1]) return along(0, 1) * along(0, 2) * along(0, 3);
  if (value >= s[2]) return 1.0 - (1.0 - along(0, 3)) * (1.0 - along(1, 3)) * (1.0 - along(2, 3));
  // A wedge between two vertices below and two above: three tetrahedra.
  const double t02 = along(0, 2), t03 = along(0, 3), t12 = along(1, 2), t13 = along(1, 3);
  return t02 * t03 + t02 * t13 * (1.0 - t03) + (1.0 - t02) * t12 * t13;
}

/// Cuts a cell at the ends of the bins that it touches. `scalars`: stored, at its vertices.
void add_cell(const scene::Bins& axis, std::array<double, 4> scalars, double volume, std::vector<double>& counts) {
  std::sort(scalars.begin(), scalars.end());
  if (!(scalars[0] < scalars[3])) {
    if (const auto bin = axis.bin_of(scalars[0])) counts[*bin] += volume;
    return;
  }
  const std::size_t first = axis.nearest_bin(scalars[0]), last = axis.nearest_bin(scalars[3]);
  double below = share_below(scalars, axis.begin_of(first));
  for (std::size_t bin = first; bin <= last; ++bin) {
    const double next = share_below(scalars, axis.begin_of(bin + 1));
    counts[bin] += volume * (next - below);
    below = next;
  }
}

double volume_of(const PreparedMesh& mesh, const mesh::CellVertices& ids) {
  std::array<std::array<double, 3>, 3> e;
  const Vertex& origin = mesh.vertices[ids[0]];
  for (std::size_t i = 0; i < 3; ++i) {
    const Vertex& vertex = mesh.vertices[ids[i + 1]];
    e[i] = {static_cast<double>(vertex.x) - origin.x, static_cast<double>(vertex.y) - origin.y,
            static_cast<double>(vertex.z) - origin.z};
  }
  return std::abs(e[0][0] * (e[1][1] * e[2][2] - e[1][2] * e[2][1]) -
                  e[0][1] * (e[1][0] * e[2][2] - e[1][2] * e[2][0]) +
                  e[0][2] * (e[1][0] * e[2][1] - e[1][1] * e[2][0]));
}

/// Bins filled part by part, with the volume of everything last. `add(begin, end, counts)` returns the volume of its
/// part.
template <class Add>
std::vector<double> sum_parts(std::size_t count, int bins, const Add& add) {
  const std::size_t parts = std::min(count, kPartCount);
  std::vector<std::vector<double>> counts(parts, std::vector<double>(static_cast<std::size_t>(bins)));
  std::vector<double> volumes(parts);
  support::parallel_chunks(parts, 1, [&](std::size_t part, std::size_t end) {
    for (; part < end; ++part) volumes[part] = add(part * count / parts, (part + 1) * count / parts, counts[part]);
  });
  std::vector<double> sum(static_cast<std::size_t>(bins));
  double total = 0.0;
  for (std::size_t part = 0; part < parts; ++part) {
    for (std::size_t bin = 0; bin < sum.size(); ++bin) sum[bin] += counts[part][bin];
    total += volumes[part];
  }
  if (total > 0.0)
    for (double& share : sum) share /= total;
  return sum;
}

}  // namespace

Histogram make_value_histogram(const PreparedMesh& mesh, const HistogramOptions& options) {
  scene::require_bins(options.bins, kLargestBinCount);
  Histogram histogram;
  histogram.range = scene::chosen_range(options.range, mesh.scalar_range);
  const scene::Bins axis(scene::stored_range(mesh, histogram.range), options.bins);
  const std::vector<mesh::CellVertices> cells = mesh::find_cell_vertices(mesh);
  histogram.counts =
      sum_parts(cells.size(), options.bins, [&](std::size_t begin, std::size_t end, std::vector<double>& counts) {
        double total = 0.0;
        for (std::size_t cell = begin; cell < end; ++cell) {
          if (cells[cell][0] == kNoCell) continue;
          const double volume = volume_of(mesh, cells[cell]);
          std::array<double, 4> scalars{};
          for (std::size_t i = 0; i < 4; ++i)
            scalars[i] =
                mesh.association == Association::kCell ? mesh.cell_scalars[cell] : mesh.vertices[cells[cell][i]].scalar;
          add_cell(axis, scalars, volume, counts);
          total += volume;
        }
        return total;
      });
  return histogram;
}

Histogram make_value_histogram(const PreparedGrid& grid, const HistogramOptions& options) {
  scene::require_bins(options.bins, kLargestBinCount);
  Histogram histogram;
  histogram.range = scene::chosen_range(options.range, grid.scalar_range);
  const scene::Bins axis(scene::stored_range(grid, histogram.range), options.bins);
  const grid::BlockReader reader(grid.data, {grid.scalar_offset, grid.scalar_scale});
  const std::array<std::size_t, 3> size = grid.data.value_dimensions();
  const std::array<std::vector<double>, 3> widths{scene::widths_along(grid.data, 0), scene::widths_along(grid.data, 1),
                                                  scene::widths_along(grid.data, 2)};
  histogram.counts =
      sum_parts(size[1] * size[2], options.bins, [&](std::size_t begin, std::size_t end, std::vector<double>& counts) {
        double total = 0.0;
        std::vector<float> values(size[0]);
        for (std::size_t row = begin; row < end; ++row) {
          const std::size_t j = row % size[1], k = row / size[1];
          reader.read({{0, static_cast<std::int64_t>(j), static_cast<std::int64_t>(k)},
                       {static_cast<std::int64_t>(size[0]), 1, 1}},
                      values.data());
          for (std::size_t i = 0; i < size[0]; ++i) {
            if (std::isnan(values[i])) continue;
            const double volume = widths[0][i] * widths[1][j] * widths[2][k];
            if (const auto bin = axis.bin_of(values[i])) counts[*bin] += volume;
            total += volume;
          }
        }
        return total;
      });
  return histogram;
}

}  // namespace tetravox
