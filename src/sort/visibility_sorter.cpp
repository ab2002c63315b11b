#include "src/sort/centroid_order.h"
#include "src/sort/face_sides.h"
#include "src/sort/gap_relations.h"
#include "src/sort/order_repair.h"
#include "src/sort/relations.h"
#include "src/sort/sorted_cells.h"
#include "src/sort/topological_order.h"
#include "src/sort/view_point.h"
#include "src/support/threads.h"
#include "src/support/timer.h"
#include "tetravox/visibility.h"

#include <tbb/parallel_sort.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

namespace tetravox {
namespace {

using sort::CellSides;
using sort::GapRelation;
using sort::SortedCell;
using sort::ViewPoint;
using sort::operator+, sort::operator-, sort::operator*;

/// Largest distance of a vertex from the local origin.
double find_radius(const PreparedMesh& mesh) {
  double square = 0.0;
  for (const Vertex& vertex : mesh.vertices) {
    const Vector3 p = sort::position_of(vertex);
    square = std::max(square, sort::dot(p, p));
  }
  return std::sqrt(square);
}

/// Cells with a boundary face that looks at the eye, by the distance of the face's centroid, the farthest first.
std::vector<std::uint32_t> find_roots(const PreparedMesh& mesh, const ViewPoint& view) {
  std::vector<std::pair<double, std::uint32_t>> faces;
  for (std::uint32_t i = 0; i < mesh.boundary.size(); ++i) {
    const auto& v = mesh.boundary[i].vertices;
    const Vector3 a = sort::position_of(mesh.vertices[v[0]]), b = sort::position_of(mesh.vertices[v[1]]),
                  c = sort::position_of(mesh.vertices[v[2]]);
    if (sort::dot(sort::cross(b - a, c - a), view.towards_eye(a)) <= 0.0) continue;
    faces.emplace_back(-view.depth_key((a + b + c) * (1.0 / 3.0)), i);
  }
  tbb::parallel_sort(faces.begin(), faces.end());
  std::vector<std::uint32_t> roots;
  roots.reserve(faces.size());
  for (const auto& face : faces) roots.push_back(mesh.boundary[face.second].cell);
  return roots;
}

}  // namespace

struct VisibilitySorter::State {
  const PreparedMesh& mesh;
  std::vector<SortedCell> cells;
  double radius = 0.0;

  std::vector<CellSides> sides, last_sides;
  std::vector<GapRelation> gaps, last_gaps;
  std::vector<std::uint32_t> roots, last_roots;
  sort::TopologicalBuffers topological;
  sort::CentroidBuffers centroid;
  sort::RepairBuffers repair;

  // The last order, and what it was made for.
  std::vector<std::uint32_t> order;
  std::optional<SortMethod> last_method;
  SortDirection last_direction = SortDirection::kBackToFront;
  ViewPoint last_view;
  sort::CycleReport last_cycles;

  explicit State(const PreparedMesh& prepared)
      : mesh(prepared), cells(sort::find_sorted_cells(prepared)), radius(find_radius(prepared)) {}

  OrderReuse bring_up_to_date(const ViewPoint& view, const SortOptions& options, SortStatistics& statistics,
                              const Progress& progress);
  bool find_relations(const ViewPoint& view, SortMethod method, SortStatistics& statistics, const Progress& progress);
  void turn(SortDirection direction);
};

/// Finds all that the method goes by; true where it came out as in the call before.
bool VisibilitySorter::State::find_relations(const ViewPoint& view, SortMethod method, SortStatistics& statistics,
                                             const Progress& progress) {
  support::Timer timer;
  sides.swap(last_sides);
  gaps.swap(last_gaps);
  roots.swap(last_roots);
  gaps.clear();
  roots.clear();
  sort::find_cell_sides(mesh, cells, view, sides);
  if (method == SortMethod::kMpvonc) roots = find_roots(mesh, view);
  statistics.relation_seconds = timer.seconds();
  support::throw_if_cancelled(progress);
  if (method == SortMethod::kXmpvo) gaps = sort::find_gap_relations(mesh, cells, sides, view, radius, progress);
  statistics.boundary_seconds = timer.seconds() - statistics.relation_seconds;
  return sides == last_sides && gaps == last_gaps && roots == last_roots;
}

OrderReuse VisibilitySorter::State::bring_up_to_date(const ViewPoint& view, const SortOptions& options,
                                                     SortStatistics& statistics, const Progress& progress) {
  const bool is_same_method = options.use_last_order && last_method == options.method;
  if (is_same_method && last_view == view) return OrderReuse::kSameView;
  last_method.reset();  // until all is done
  last_view = view;
  statistics.sorted_cells = cells.size();
  if (options.method == SortMethod::kCentroid) {
    last_cycles = {};
    sort::sort_by_centroids(mesh, cells, view, centroid, order);
    last_direction = SortDirection::kBackToFront;
    return OrderReuse::kNone;
  }
  const bool is_same = find_relations(view, options.method, statistics, progress);
  support::throw_if_cancelled(progress);
  const sort::Relations relations{&mesh, cells, sides, gaps};
  // How cycles are broken depends on distances, too.
  if (is_same_method && last_cycles.cycles == 0) {
    if (is_same) {
      statistics.sorted_cells = 0;
      return OrderReuse::kSameSides;
    }
    turn(SortDirection::kBackToFront);
    // The order of mpvonc follows distances, too: there is nothing to keep.
    if (options.method != SortMethod::kMpvonc)
      if (const auto sorted = sort::repair_order(relations, repair, topological, order)) {
        statistics.sorted_cells = *sorted;
        return OrderReuse::kRepaired;
      }
  }
  last_cycles = options.method == SortMethod::kMpvonc ? sort::sort_depth_first(relations, roots, topological, order)
                                                      : sort::sort_by_counting(relations, view, topological, order);
  last_direction = SortDirection::kBackToFront;
  return OrderReuse::kNone;
}

void VisibilitySorter::State::turn(SortDirection direction) {
  if (direction == last_direction) return;
  last_direction = direction;
  std::reverse(order.begin(), order.end());
}

VisibilitySorter::VisibilitySorter(const PreparedMesh& mesh) : state_(std::make_unique<State>(mesh)) {}
VisibilitySorter::~VisibilitySorter() = default;
VisibilitySorter::VisibilitySorter(VisibilitySorter&&) noexcept = default;
VisibilitySorter& VisibilitySorter::operator=(VisibilitySorter&&) noexcept = default;

std::span<const std::uint32_t> VisibilitySorter::sort(const Camera& camera, const SortOptions& options,
                                                      SortStatistics* statistics, const Progress& progress) {
  const support::Timer timer;
  name_of(options.method);  // throws for what is no method
  const ViewPoint view = sort::make_view_point(state_->mesh, camera);
  SortStatistics measured;
  support::with_threads(options.threads, [&] {
    measured.threads = support::hardware_threads();
    measured.reuse = state_->bring_up_to_date(view, options, measured, progress);
    state_->last_method = options.method;
    state_->turn(options.direction);
  });
  measured.cells = state_->order.size();
  measured.boundary_relations = options.method == SortMethod::kXmpvo ? state_->gaps.size() : 0;
  measured.cycles = state_->last_cycles.cycles;
  measured.cyclic_cells = state_->last_cycles.cyclic_cells;
  measured.broken_relations = state_->last_cycles.broken_relations;
  measured.seconds = timer.seconds();
  if (statistics != nullptr) *statistics = measured;
  return state_->order;
}

std::uint64_t VisibilitySorter::bytes() const {
  const State& s = *state_;
  const auto bytes_of = [](const auto& list) { return list.capacity() * sizeof(list[0]); };
  return bytes_of(s.cells) + bytes_of(s.sides) + bytes_of(s.last_sides) + bytes_of(s.gaps) + bytes_of(s.last_gaps) +
         bytes_of(s.roots) + bytes_of(s.last_roots) + bytes_of(s.order) + s.topological.bytes() + s.centroid.bytes() +
         s.repair.bytes();
}

}  // namespace tetravox
