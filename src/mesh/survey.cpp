#include "src/mesh/survey.h"

#include "src/mesh/decompose.h"
#include "src/support/threads.h"
#include "tetravox/error.h"
#include "tetravox/mesh.h"

#include <tbb/parallel_reduce.h>

#include <atomic>
#include <cmath>
#include <functional>
#include <limits>
#include <string>

namespace tetravox::mesh {
namespace {

constexpr std::uint64_t kNone = std::numeric_limits<std::uint64_t>::max();

[[noreturn]] void fail(const std::string& message) {
  throw Error(ErrorCode::kBadFile, message + ": the mesh is damaged, write it again");
}

bool has_valid_offsets(const MeshData& mesh, std::size_t cell) {
  return mesh.cell_offsets[cell] <= mesh.cell_offsets[cell + 1] &&
         mesh.cell_offsets[cell + 1] <= mesh.connectivity.size();
}

CellProblem problem_of(const MeshData& mesh, std::size_t cell) {
  if (!has_valid_offsets(mesh, cell)) return CellProblem::kTooShort;
  return check_cell(mesh.cell_types[cell], cell_entry(mesh, cell), mesh.point_count());
}

/// Throws what is to say about the first bad cell.
[[noreturn]] void fail_cell(const MeshData& mesh, std::size_t cell) {
  const CellType type = mesh.cell_types[cell];
  const std::string type_name = cell_type_name(static_cast<std::uint8_t>(type));
  const std::string where = "cell " + std::to_string(cell) + " (" + type_name + ")";
  if (!has_valid_offsets(mesh, cell))
    fail(where + " has its points at " + std::to_string(mesh.cell_offsets[cell]) + " to " +
         std::to_string(mesh.cell_offsets[cell + 1]) + " of a connectivity of " +
         std::to_string(mesh.connectivity.size()) + " entries");
  const std::span<const std::uint32_t> entry = cell_entry(mesh, cell);
  switch (check_cell(type, entry, mesh.point_count())) {
    case CellProblem::kUnknownType:
      throw Error(ErrorCode::kUnsupported, where + " is not a volume cell that can be drawn: leave it out");
    case CellProblem::kTooShort:
      fail(where + " has " + std::to_string(entry.size()) + " points where " +
           std::to_string(cell_table(type).node_count) + " are needed");
    case CellProblem::kFaceStream:
      fail(where + " has a face stream that contradicts its length of " + std::to_string(entry.size()));
    default:
      break;
  }
  std::string id;
  for_each_point(type, entry, [&](std::uint32_t point) {
    if (id.empty() && point >= mesh.point_count()) id = std::to_string(point);
  });
  fail(where + " uses point " + id + " of " + std::to_string(mesh.point_count()) + " points");
}

/// Whether all fields have a value at this point, or in this cell.
bool has_values(const MeshData& mesh, std::size_t i) {
  bool are_finite = std::isfinite(mesh.scalars[i]);
  for (const OtherField& other : mesh.others) are_finite &= std::isfinite(other.scalars[i]);
  return are_finite;
}

/// Marks the points of a valid cell unless a value is missing; returns whether the cell is kept.
bool mark_points(const MeshData& mesh, std::size_t cell, Buffer<std::uint8_t>& is_used) {
  const CellType type = mesh.cell_types[cell];
  const std::span<const std::uint32_t> entry = cell_entry(mesh, cell);
  bool is_kept = true;
  if (mesh.association == Association::kCell)
    is_kept = has_values(mesh, cell);
  else
    for_each_point(type, entry, [&](std::uint32_t point) { is_kept &= has_values(mesh, point); });
  if (!is_kept) return false;
  for_each_point(type, entry, [&](std::uint32_t point) {
    std::atomic_ref<std::uint8_t> flag(is_used[point]);
    if (flag.load(std::memory_order_relaxed) == 0) flag.store(1, std::memory_order_relaxed);
  });
  return true;
}

}  // namespace

void validate_sizes(const MeshData& mesh) {
  const std::size_t cells = mesh.cell_count();
  if (mesh.points.size() % 3 != 0)
    fail("points have " + std::to_string(mesh.points.size()) + " coordinates, not 3 each");
  if (mesh.point_count() >= kNoCell || cells >= kNoCell)
    throw Error(ErrorCode::kUnsupported, "the mesh has " + std::to_string(mesh.point_count()) + " points and " +
                                             std::to_string(cells) +
                                             " cells, more than the 4294967294 that can be drawn: split it");
  if (mesh.cell_offsets.size() != cells + 1 && !(cells == 0 && mesh.cell_offsets.empty()))
    fail("there are " + std::to_string(mesh.cell_offsets.size()) + " cell offsets for " + std::to_string(cells) +
         " cells, not one more");
  const std::size_t values = mesh.association == Association::kPoint ? mesh.point_count() : cells;
  const auto validate_size = [&](const std::string& name, std::size_t size) {
    if (size != values)
      fail("array '" + name + "' has " + std::to_string(size) + " values for " + std::to_string(values) +
           (mesh.association == Association::kPoint ? " points" : " cells"));
  };
  validate_size(mesh.array_name, mesh.scalars.size());
  for (const OtherField& other : mesh.others) validate_size(other.array_name, other.scalars.size());
}

Survey survey_cells(const MeshData& mesh, ProgressMeter& meter) {
  Survey survey;
  const std::size_t cells = mesh.cell_count();
  const std::size_t chunks = (cells + kCellsPerChunk - 1) / kCellsPerChunk;
  survey.max_tetrahedra.assign(chunks, 0);
  survey.is_used = Buffer<std::uint8_t>(mesh.point_count());
  support::parallel_chunks(mesh.point_count(), 1 << 20, [&](std::size_t begin, std::size_t end) {
    std::fill(survey.is_used.begin() + begin, survey.is_used.begin() + end, std::uint8_t{0});
  });
  std::atomic<std::uint64_t> first_bad{kNone}, missing{0};
  support::parallel_chunks(chunks, 1, [&](std::size_t chunk, std::size_t chunk_end) {
    for (; chunk < chunk_end; ++chunk) {
      const std::size_t begin = chunk * kCellsPerChunk, end = std::min(cells, begin + kCellsPerChunk);
      std::uint64_t chunk_missing = 0, chunk_max = 0;
      for (std::size_t cell = begin; cell < end; ++cell) {
        if (problem_of(mesh, cell) != CellProblem::kNone) {
          // Keep the lowest bad cell, so that the message is the same for any number of threads.
          std::uint64_t seen = first_bad;
          while (cell < seen && !first_bad.compare_exchange_weak(seen, cell)) {
          }
          break;
        }
        if (mark_points(mesh, cell, survey.is_used))
          chunk_max += max_tetrahedra(mesh.cell_types[cell], cell_entry(mesh, cell));
        else
          ++chunk_missing;
      }
      survey.max_tetrahedra[chunk] = chunk_max;
      missing += chunk_missing;
      meter.advance(end - begin);
    }
  });
  if (first_bad != kNone) fail_cell(mesh, first_bad);
  survey.missing_value_cells = missing;
  return survey;
}

std::uint64_t count_max_tetrahedra(const MeshData& mesh) {
  const std::size_t cells = mesh.cell_offsets.empty() ? 0 : std::min(mesh.cell_count(), mesh.cell_offsets.size() - 1);
  return tbb::parallel_reduce(
      tbb::blocked_range<std::size_t>(0, cells, kCellsPerChunk), std::uint64_t{0},
      [&](const tbb::blocked_range<std::size_t>& range, std::uint64_t count) {
        for (std::size_t cell = range.begin(); cell < range.end(); ++cell)
          if (has_valid_offsets(mesh, cell)) count += max_tetrahedra(mesh.cell_types[cell], cell_entry(mesh, cell));
        return count;
      },
      std::plus<>());
}

}  // namespace tetravox::mesh
