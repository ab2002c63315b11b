#include "src/grid/frame.h"
#include "src/grid/summaries.h"
#include "src/grid/survey.h"
#include "src/grid/values.h"
#include "src/support/memory.h"
#include "tetravox/error.h"
#include "tetravox/grid.h"

namespace tetravox {
namespace {

constexpr std::uint64_t kBytesOfBrick = 6 * sizeof(float) + 1;

std::uint64_t count_bricks(const GridShape& shape) {
  std::uint64_t count = 1;
  for (const std::uint32_t points : shape.dimensions) count *= (points - 1 + kBrickCells - 1) / kBrickCells;
  return count;
}

}  // namespace

PreparedGrid prepare_grid(const GridData& grid, const Progress& progress) {
  grid::validate_grid(grid);
  support::require_memory(estimate_prepare_memory(grid).peak, "preparing this grid");
  PreparedGrid prepared;
  prepared.data = grid;
  prepared.bounds = grid::bounds_of(grid.shape);
  const grid::ValueSurvey survey = grid::survey_values(grid);
  if (!(survey.range.min <= survey.range.max))
    throw Error(ErrorCode::kNothingToDraw, "no value of '" + grid.array_name + "' is finite: choose another array");
  prepared.scalar_range = survey.range;
  prepared.missing_values = survey.missing;
  const grid::ScalarFrame frame = grid::choose_scalar_frame(survey.range);
  prepared.scalar_offset = frame.offset;
  prepared.scalar_scale = frame.scale;
  prepared.bricks = grid::summarize_bricks(grid, frame, progress);
  return prepared;
}

PreparedGrid prepare_grid(const GridData& grid, const std::vector<GridData>& others, const Progress& progress) {
  for (const GridData& other : others)
    if (other.shape != grid.shape || other.association != grid.association)
      throw Error(ErrorCode::kInvalidArgument, "'" + other.array_name + "' does not lie on the points or cells of '" +
                                                   grid.array_name + "': give arrays of one grid");
  PreparedGrid prepared = prepare_grid(grid, progress);
  for (const GridData& other : others) prepared.others.push_back(prepare_grid(other, progress));
  return prepared;
}

MemoryEstimate estimate_prepare_memory(const GridData& grid) {
  const std::uint64_t bytes = count_bricks(grid.shape) * kBytesOfBrick + (1u << 20);
  return {bytes, bytes};
}

}  // namespace tetravox
