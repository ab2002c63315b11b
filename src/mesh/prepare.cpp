#include "src/mesh/adjacency.h"
#include "src/mesh/local_frame.h"
#include "src/mesh/progress_meter.h"
#include "src/mesh/survey.h"
#include "src/mesh/tetrahedra.h"
#include "src/mesh/weld.h"
#include "src/support/memory.h"
#include "tetravox/error.h"
#include "tetravox/mesh.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

namespace tetravox {
namespace {

/// Power of two that brings lengths of up to `half_extent` near 1.
double choose_length_scale(double half_extent) {
  return half_extent > 0.0 ? std::ldexp(1.0, -std::clamp(std::ilogb(half_extent), -1000, 1000)) : 1.0;
}

[[noreturn]] void fail_empty(const PrepareReport& report) {
  const std::string cells = std::to_string(report.input_cells);
  std::string reason;
  if (report.input_cells == 0)
    reason = "the mesh has no cells";
  else if (report.missing_value_cells == report.input_cells)
    reason = "all " + cells + " cells have missing values, choose another array";
  else if (report.missing_value_cells > 0)
    reason = std::to_string(report.missing_value_cells) + " of " + cells +
             " cells have missing values and the others have no volume, choose another array";
  else
    reason = "all " + cells + " cells have no volume (is the mesh flat?)";
  throw Error(ErrorCode::kNothingToDraw, "nothing to draw: " + reason);
}

}  // namespace

MemoryEstimate estimate_prepare_memory(const MeshData& mesh) {
  const std::uint64_t points = mesh.point_count();
  const std::uint64_t tetrahedra = mesh::count_max_tetrahedra(mesh);
  // A vertex needs a point that a cell names.
  const std::uint64_t vertices = std::min<std::uint64_t>(points, mesh.connectivity.size());
  // A conforming mesh has about 6 cells a vertex; however many of them are left out, fewer than 12 faces a vertex are
  // boundary then. Worse meshes are met when their boundary is known, see `prepare_mesh`.
  const std::uint64_t boundary = std::min(4 * tetrahedra, 12 * vertices);
  const std::uint64_t cell_scalars = mesh.association == Association::kCell ? sizeof(float) * tetrahedra : 0;
  const std::uint64_t list = sizeof(mesh::Tetrahedron) * tetrahedra;
  const std::uint64_t links = sizeof(TetrahedronLinks) * tetrahedra;

  constexpr std::uint64_t kFixed = 8 << 20;  // threads' stacks and working memory, the allocator's slack
  const std::uint64_t weld = (1 + sizeof(mesh::PointTarget)) * points + (16 + 4) * vertices;
  const std::uint64_t sort = (1 + sizeof(mesh::PointTarget)) * points + 8 * vertices + 2 * list;
  const std::uint64_t match = 12 * vertices + list + links + 4 * tetrahedra;
  const std::uint64_t others =
      sizeof(float) * mesh.others.size() * (mesh.association == Association::kCell ? tetrahedra : vertices);
  const std::uint64_t result =
      links + cell_scalars + others + sizeof(Vertex) * vertices + sizeof(BoundaryFace) * boundary;
  MemoryEstimate estimate;
  estimate.resident = result;
  estimate.peak = std::max({weld, sort, match, result + list + 8 * vertices}) + kFixed;
  return estimate;
}

PreparedMesh prepare_mesh(const MeshData& mesh, const Progress& progress) {
  mesh::ProgressMeter meter(progress);
  mesh::validate_sizes(mesh);
  support::require_memory(estimate_prepare_memory(mesh).peak,
                          "preparing " + std::to_string(mesh.cell_count()) + " cells");
  PreparedMesh prepared;
  PrepareReport& report = prepared.report;
  report.input_cells = mesh.cell_count();

  // Look at every cell, then make vertices of the points that are needed.
  meter.begin_step(0.1, mesh.cell_count());
  mesh::Survey survey = mesh::survey_cells(mesh, meter);
  report.missing_value_cells = survey.missing_value_cells;
  if (report.missing_value_cells == report.input_cells) fail_empty(report);
  const auto input_bounds = mesh::bounds_of_used_points(mesh, survey.is_used);
  meter.begin_step(0.25, 2 * mesh.point_count());
  mesh::Weld weld = mesh::weld_points(mesh, survey.is_used, input_bounds, meter);
  survey.is_used.release();
  report.merged_points = weld.merged_points;

  // Split cells into sorted tetrahedra.
  meter.begin_step(0.65, 3 * mesh.cell_count());
  const double length_scale = choose_length_scale(mesh::half_extent(input_bounds));
  mesh::TetrahedronList list = mesh::collect_tetrahedra(mesh, survey, std::move(weld), length_scale, meter);
  report.tetrahedra = list.count;
  report.degenerate = list.degenerate;
  report.duplicated = list.duplicated;
  if (list.count == 0) fail_empty(report);

  // Connect them. Only now is the boundary's size known: it can be large where hardly any two cells share a face.
  meter.begin_step(0.95, list.count);
  mesh::Adjacency adjacency = mesh::find_neighbours(list, meter);
  report.boundary_faces = adjacency.boundary_faces;
  report.overlapping_faces = adjacency.overlapping_faces;
  prepared.cells = std::move(adjacency.cells);
  support::require_memory(sizeof(BoundaryFace) * report.boundary_faces,
                          "a boundary of " + std::to_string(report.boundary_faces) + " faces");
  meter.begin_step(1.0, 1);
  prepared.boundary = mesh::collect_boundary(list, prepared.cells, report.boundary_faces);
  mesh::write_vertices(mesh, list, prepared);
  meter.advance(1);
  return prepared;
}

}  // namespace tetravox
