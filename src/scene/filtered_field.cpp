#include "src/scene/filtered_field.h"

#include "src/grid/summaries.h"
#include "src/support/threads.h"
#include "tetravox/error.h"

#include <algorithm>
#include <cstdlib>
#include <limits>
#include <span>
#include <string>

namespace tetravox::scene {
namespace {

/// The values of cell data as points at the middles of the cells.
GridData points_at_middles(const GridData& cells) {
  GridData points = cells;
  points.association = Association::kPoint;
  for (int axis = 0; axis < 3; ++axis) {
    --points.shape.dimensions[axis];
    const std::vector<double>& from = cells.shape.coordinates[axis];
    std::vector<double>& to = points.shape.coordinates[axis];
    to.clear();
    for (std::size_t i = 0; i + 1 < from.size(); ++i) to.push_back(0.5 * from[i] + 0.5 * from[i + 1]);
    if (!from.empty()) continue;
    for (int row = 0; row < 3; ++row)
      points.shape.origin[row] += 0.5 * cells.shape.spacing[axis] * cells.shape.direction[3 * row + axis];
  }
  return points;
}

/// Values with a margin of mirrored places, as coefficients of the spline through them.
std::vector<float> make_coefficients(const PreparedGrid& grid, const grid::BlockReader& reader) {
  const auto dimensions = grid.data.value_dimensions();
  grid::Block whole;
  for (int axis = 0; axis < 3; ++axis) whole.count[axis] = static_cast<std::int64_t>(dimensions[axis]);
  std::vector<float> inside(static_cast<std::size_t>(whole.size()));
  reader.read(whole, inside.data());
  grid::prefilter_bspline(dimensions, inside);
  constexpr std::int64_t kMargin = FilteredField::kMargin;
  const auto mirrored = [&](std::int64_t i, int axis) {
    const std::int64_t last = whole.count[axis] - 1;
    i = std::abs(i - kMargin);
    return std::clamp(i > last ? 2 * last - i : i, std::int64_t{0}, last);
  };
  std::vector<float> coefficients;
  coefficients.reserve(static_cast<std::size_t>((whole.count[0] + 2 * kMargin) * (whole.count[1] + 2 * kMargin) *
                                                (whole.count[2] + 2 * kMargin)));
  for (std::int64_t k = 0; k < whole.count[2] + 2 * kMargin; ++k)
    for (std::int64_t j = 0; j < whole.count[1] + 2 * kMargin; ++j)
      for (std::int64_t i = 0; i < whole.count[0] + 2 * kMargin; ++i)
        coefficients.push_back(inside[static_cast<std::size_t>(
            (mirrored(k, 2) * whole.count[1] + mirrored(j, 1)) * whole.count[0] + mirrored(i, 0))]);
  return coefficients;
}

/// Kernels take cell data as points at the middles of the cells: between them there must be something.
void require_middles(const GridData& grid, const Filter& filter) {
  if (grid.association != Association::kCell) return;
  for (const std::uint32_t points : grid.shape.dimensions)
    if (points < 3)
      throw Error(
          ErrorCode::kInvalidArgument,
          "filter '" + name_of(filter) + "' needs two cells or more along each axis: choose 'linear' or 'nearest'");
}

/// Range of the filtered field in each brick: of the values in reach, widened by what the kernel may overshoot.
void bound_filtered_field(const PreparedGrid& drawn, FilteredField& field) {
  const std::size_t count = drawn.bricks.count();
  const auto& counts = drawn.bricks.counts;
  const int radius = field.kernel->radius();
  const auto overshoot = static_cast<float>(grid::overshoot_of(*field.kernel));
  field.min.resize(count);
  field.max.resize(count);
  support::parallel_chunks(count, 64, [&](std::size_t begin, std::size_t end) {
    std::vector<float> values;
    for (std::size_t i = begin; i < end; ++i) {
      const grid::BrickBox box =
          grid::box_of_brick(drawn.data.shape, {static_cast<std::uint32_t>(i % counts[0]),
                                                static_cast<std::uint32_t>(i / counts[0] % counts[1]),
                                                static_cast<std::uint32_t>(i / counts[0] / counts[1])});
      const std::int64_t padding = field.coefficients.empty() ? 0 : FilteredField::kMargin;
      grid::Block block;
      for (int axis = 0; axis < 3; ++axis) {
        block.first[axis] = box.first[axis] - radius + 1 + padding;
        block.count[axis] = box.count[axis] + 2 * radius;
      }
      values.resize(static_cast<std::size_t>(block.size()));
      field.reader->read(block, values.data());
      float min = std::numeric_limits<float>::infinity(), max = -min;
      for (const float value : values) {
        min = value < min ? value : min;
        max = value > max ? value : max;
      }
      const float middle = 0.5f * min + 0.5f * max, half = (0.5f * max - 0.5f * min) * overshoot;
      field.min[i] = min <= max ? middle - half : min;
      field.max[i] = min <= max ? middle + half : max;
    }
  });
}

}  // namespace

bool wants_kernel(const Filter& filter) {
  return filter.kind != FilterKind::kLinear && filter.kind != FilterKind::kNearest;
}

FilteredField make_filtered_field(const PreparedGrid& grid, const Filter& filter) {
  FilteredField field;
  if (!wants_kernel(filter)) return field;
  field.filter = filter;
  require_middles(grid.data, filter);
  if (grid.data.association == Association::kCell)
    field.middles = std::make_shared<const PreparedGrid>(prepare_grid(points_at_middles(grid.data)));
  const PreparedGrid& drawn = field.middles ? *field.middles : grid;
  field.kernel = grid::make_kernel(filter);
  field.reader =
      std::make_unique<grid::BlockReader>(drawn.data, grid::ScalarFrame{grid.scalar_offset, grid.scalar_scale});
  if (field.kernel->wants_prefilter()) {
    field.coefficients = make_coefficients(drawn, *field.reader);
    GridData padded;
    padded.type = ScalarType::kFloat32;
    for (int axis = 0; axis < 3; ++axis)
      padded.shape.dimensions[axis] =
          drawn.data.shape.dimensions[axis] + static_cast<std::uint32_t>(2 * FilteredField::kMargin);
    padded.values = std::as_bytes(std::span<const float>(field.coefficients));
    field.reader = std::make_unique<grid::BlockReader>(padded, grid::ScalarFrame{});
  }
  bound_filtered_field(drawn, field);
  return field;
}

}  // namespace tetravox::scene
