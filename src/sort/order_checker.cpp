/// Checks orders by brute force.

#include "src/mesh/cell_vertices.h"
#include "src/sort/cell_interval.h"
#include "src/sort/view_point.h"
#include "src/support/threads.h"
#include "tetravox/error.h"
#include "tetravox/visibility.h"

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_sort.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

namespace tetravox {
namespace {

using mesh::CellVertices;
using sort::Interval;
using sort::PixelRays;
using sort::operator+, sort::operator-, sort::operator*;

constexpr std::size_t kGrain = 1 << 12;
constexpr std::size_t kPixelsAtATime = 1 << 15;
constexpr double kThin = 1e-9;   // local lengths: segments of rounding
constexpr double kTouch = 1e-6;  // cells that overlap less follow each other: vertices are floats
constexpr double kNearestDepth = 1e-9;

/// A cell on a ray.
struct Segment {
  std::uint32_t pixel = 0;
  std::uint32_t place = 0;  ///< of the cell in the order, counted from the back
  Interval interval;

  bool operator<(const Segment& other) const {
    if (pixel != other.pixel) return pixel < other.pixel;
    if (interval.begin != other.interval.begin) return interval.begin < other.interval.begin;
    return place < other.place;
  }
};

/// Pixels [first, last] along an axis.
struct PixelRange {
  int first = 0, last = -1;
};

bool is_known(const CellVertices& cell) { return cell[0] != kNoCell; }

std::array<Vector3, 4> corners_of(const PreparedMesh& mesh, const CellVertices& cell) {
  std::array<Vector3, 4> corners;
  for (std::size_t i = 0; i < 4; ++i) corners[i] = sort::position_of(mesh.vertices[cell[i]]);
  return corners;
}

/// Place of each cell, counted from the back; empty where the order is no permutation.
std::vector<std::uint32_t> find_places(std::span<const std::uint32_t> order, std::size_t cells,
                                       SortDirection direction) {
  if (order.size() != cells) return {};
  std::vector<std::uint32_t> places(cells, kNoCell);
  for (std::size_t i = 0; i < cells; ++i) {
    if (order[i] >= cells || places[order[i]] != kNoCell) return {};
    places[order[i]] = static_cast<std::uint32_t>(direction == SortDirection::kBackToFront ? i : cells - 1 - i);
  }
  return places;
}

/// The side of the plane of a, b, c that a place lies on, +1 or -1; 0 where vertices, which are rounded to float, leave
/// it open. `arm`: from a to the place, a vertex as well.
int find_side(const Vector3& a, const Vector3& b, const Vector3& c, const Vector3& arm) {
  constexpr double kFloatRounding = 4.0 * 6e-8;  // of differences of coordinates up to 1, twice
  const Vector3 u = b - a, v = c - a;
  const double lengths[] = {sort::norm(u), sort::norm(v), sort::norm(arm)};
  const double volume = sort::dot(sort::cross(u, v), arm);
  const double bound = kFloatRounding * (lengths[0] * lengths[1] + lengths[0] * lengths[2] + lengths[1] * lengths[2]);
  return volume > bound ? 1 : volume < -bound ? -1 : 0;
}

/// The same of the eye, 0 where it sees the face edge-on: whichever vertex one looks from, to within rounding to
/// double.
int find_side_of_eye(const Vector3& a, const Vector3& b, const Vector3& c, const sort::ViewPoint& view) {
  constexpr double kRounding = 4e-14;
  double longest = 0.0, farthest = 0.0;
  for (const Vector3& edge : {b - a, c - a, c - b}) longest = std::max(longest, sort::norm(edge));
  for (const Vector3& corner : {a, b, c}) farthest = std::max(farthest, sort::norm(view.towards_eye(corner)));
  const double volume = sort::dot(sort::cross(b - a, c - a), view.towards_eye(a));
  const double bound = kRounding * longest * longest * farthest;
  return volume > bound ? 1 : volume < -bound ? -1 : 0;
}

/// Of a cell and the neighbour across its face of a rank: the one in front, `kNoCell` where that is not certain.
std::uint32_t find_front(const PreparedMesh& mesh, std::span<const CellVertices> cells, std::uint32_t cell,
                         std::size_t rank, const sort::ViewPoint& view) {
  const CellVertices& ids = cells[cell];
  const std::uint32_t neighbour = mesh.cells[cell].neighbours[rank];
  const std::array<std::uint32_t, 3> face{ids[(rank + 1) & 3], ids[(rank + 2) & 3], ids[(rank + 3) & 3]};
  const std::uint32_t opposite = mesh.cells[neighbour].vertex_xor ^ face[0] ^ face[1] ^ face[2];
  const auto at = [&](std::uint32_t id) { return sort::position_of(mesh.vertices[id]); };
  const Vector3 a = at(face[0]), b = at(face[1]), c = at(face[2]);
  const int own = find_side(a, b, c, at(ids[rank]) - a), other = find_side(a, b, c, at(opposite) - a);
  const int eye = find_side_of_eye(a, b, c, view);
  if (own * other >= 0 || eye == 0) return kNoCell;
  return eye == own ? cell : neighbour;
}

void check_faces(const PreparedMesh& mesh, std::span<const CellVertices> cells, const sort::ViewPoint& view,
                 std::span<const std::uint32_t> places, OrderReport& report) {
  struct Count {
    std::uint64_t pairs = 0, violations = 0;
  };
  tbb::enumerable_thread_specific<Count> counts;
  support::parallel_chunks(cells.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    Count& count = counts.local();
    for (std::size_t i = begin; i < end; ++i) {
      const auto cell = static_cast<std::uint32_t>(i);
      for (std::size_t rank = 0; rank < 4 && is_known(cells[cell]); ++rank) {
        const std::uint32_t neighbour = mesh.cells[cell].neighbours[rank];
        if (neighbour == kNoCell || neighbour < cell) continue;
        const std::uint32_t front = find_front(mesh, cells, cell, rank, view);
        if (front == kNoCell) continue;
        ++count.pairs;
        count.violations += places[front] < places[front == cell ? neighbour : cell];
      }
    }
  });
  for (const Count& count : counts) {
    report.face_pairs += count.pairs;
    report.face_violations += count.violations;
  }
}

/// Finds the cells on the rays of some rows.
class SegmentFinder {
 public:
  SegmentFinder(const PreparedMesh& mesh, std::span<const CellVertices> cells, std::span<const std::uint32_t> places,
                const PixelRays& rays, int first_row, int last_row)
      : mesh_(mesh), cells_(cells), places_(places), rays_(rays), first_row_(first_row), last_row_(last_row) {}

  /// All segments, by pixel and then by depth.
  std::vector<Segment> find(std::uint64_t& thin) const {
    tbb::enumerable_thread_specific<std::vector<Segment>> found;
    tbb::enumerable_thread_specific<std::uint64_t> thin_counts(std::uint64_t{0});
    support::parallel_chunks(cells_.size(), kGrain, [&](std::size_t begin, std::size_t end) {
      for (std::size_t cell = begin; cell < end; ++cell)
        if (is_known(cells_[cell])) find_in(cell, found.local(), thin_counts.local());
    });
    std::vector<Segment> segments;
    for (const auto& part : found) segments.insert(segments.end(), part.begin(), part.end());
    for (const std::uint64_t count : thin_counts) thin += count;
    tbb::parallel_sort(segments.begin(), segments.end());
    return segments;
  }

 private:
  void find_in(std::size_t cell, std::vector<Segment>& found, std::uint64_t& thin) const {
    const auto corners = corners_of(mesh_, cells_[cell]);
    PixelRange columns, rows;
    find_pixels(corners, columns, rows);
    const double least = rays_.is_orthographic ? -std::numeric_limits<double>::max() : 0.0;
    for (int row = std::max(rows.first, first_row_); row <= std::min(rows.last, last_row_ - 1); ++row)
      for (int column = columns.first; column <= columns.last; ++column) {
        const Interval interval = sort::intersect_cell(corners, rays_.origin(column, row), rays_.direction(column, row),
                                                       least, std::numeric_limits<double>::max());
        if (!(interval.length() > 0.0)) continue;
        if (interval.length() < kThin || goes_along_face(corners, column, row))
          ++thin;
        else
          found.push_back({static_cast<std::uint32_t>(row) * static_cast<std::uint32_t>(rays_.width) +
                               static_cast<std::uint32_t>(column),
                           places_[cell], interval});
      }
  }

  /// Whether the ray lies in the plane of a face, to within rounding: such a ray is in both cells of the face at a
  /// time.
  bool goes_along_face(const std::array<Vector3, 4>& corners, int column, int row) const {
    constexpr double kRounding = 1e-11;
    const Vector3 origin = rays_.origin(column, row), direction = rays_.direction(column, row);
    for (std::size_t rank = 0; rank < 4; ++rank) {
      const Vector3& a = corners[(rank + 1) & 3];
      const Vector3 normal = sort::cross(corners[(rank + 2) & 3] - a, corners[(rank + 3) & 3] - a);
      const double length = sort::norm(normal);
      if (std::abs(sort::dot(normal, direction)) <= kRounding * length * sort::norm(direction) &&
          std::abs(sort::dot(normal, origin - a)) <= kRounding * length * (1.0 + sort::norm(origin)))
        return true;
    }
    return false;
  }

  /// Pixels whose rays may meet the cell.
  void find_pixels(const std::array<Vector3, 4>& corners, PixelRange& columns, PixelRange& rows) const {
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    std::array<double, 2> lower{kInfinity, kInfinity}, upper{-kInfinity, -kInfinity};
    const auto add = [&](const Vector3& p) {
      const double scale = rays_.is_orthographic ? rays_.step : rays_.step * p[2];
      for (int axis = 0; axis < 2; ++axis) {
        lower[axis] = std::min(lower[axis], p[axis] / scale);
        upper[axis] = std::max(upper[axis], p[axis] / scale);
      }
    };
    std::array<Vector3, 4> seen;
    for (std::size_t i = 0; i < 4; ++i) {
      const Vector3 arm = corners[i] - rays_.eye;
      seen[i] = {sort::dot(arm, rays_.right), sort::dot(arm, rays_.up), sort::dot(arm, rays_.forward)};
      if (rays_.is_orthographic || seen[i][2] >= kNearestDepth) add(seen[i]);
    }
    if (!rays_.is_orthographic) add_cuts(seen, add);
    const double half_width = 0.5 * rays_.width - 0.5, half_height = 0.5 * rays_.height - 0.5;
    columns = clamp_range(lower[0] + half_width, upper[0] + half_width, rays_.width);
    rows = clamp_range(half_height - upper[1], half_height - lower[1], rays_.height);
  }

  /// Where edges cross the plane just before the eye.
  template <class Add>
  static void add_cuts(const std::array<Vector3, 4>& seen, const Add& add) {
    for (std::size_t i = 0; i < 4; ++i)
      for (std::size_t k = i + 1; k < 4; ++k)
        if ((seen[i][2] < kNearestDepth) != (seen[k][2] < kNearestDepth)) {
          Vector3 cut = seen[i] + (seen[k] - seen[i]) * ((kNearestDepth - seen[i][2]) / (seen[k][2] - seen[i][2]));
          cut[2] = kNearestDepth;
          add(cut);
        }
  }

  static PixelRange clamp_range(double first, double last, int count) {
    constexpr double kSlack = 1e-6;
    if (!(first <= last)) return {};
    return {static_cast<int>(std::ceil(std::clamp(first - kSlack, 0.0, static_cast<double>(count)))),
            static_cast<int>(std::floor(std::clamp(last + kSlack, -1.0, static_cast<double>(count - 1))))};
  }

  const PreparedMesh& mesh_;
  std::span<const CellVertices> cells_;
  std::span<const std::uint32_t> places_;
  const PixelRays& rays_;
  int first_row_, last_row_;
};

/// Whether `front`, which begins first, also ends before `behind` begins, but for rounding.
bool is_in_front(const Segment& front, const Segment& behind) {
  const double overlap = front.interval.end - behind.interval.begin;
  return overlap <= std::min(kTouch, 0.25 * std::min(front.interval.length(), behind.interval.length()));
}

/// Compares the cells along one ray, which come by depth.
void check_ray(std::span<const Segment> segments, OrderReport& report) {
  // Of the segments so far: the greatest end, and the place farthest back.
  std::vector<double> greatest_end(segments.size());
  std::vector<std::uint32_t> least_place(segments.size());
  std::uint64_t wrong = 0, intersections = 0;
  for (std::size_t k = 0; k < segments.size(); ++k) {
    const Segment& segment = segments[k];
    bool is_wrong = false;
    for (std::size_t i = k; i > 0 && !is_wrong; --i) {
      if (greatest_end[i - 1] <= segment.interval.begin) {
        is_wrong = least_place[i - 1] < segment.place;
        break;
      }
      is_wrong = is_in_front(segments[i - 1], segment) && segments[i - 1].place < segment.place;
    }
    intersections += k > 0 && !is_in_front(segments[k - 1], segment);
    wrong += is_wrong;
    greatest_end[k] = k > 0 ? std::max(greatest_end[k - 1], segment.interval.end) : segment.interval.end;
    least_place[k] = k > 0 ? std::min(least_place[k - 1], segment.place) : segment.place;
  }
  ++report.rays;
  report.segments += segments.size();
  report.wrong_segments += wrong;
  report.wrong_rays += wrong > 0;
  report.intersections += intersections;
  report.intersecting_rays += intersections > 0;
}

void check_rays(const PreparedMesh& mesh, std::span<const CellVertices> cells, std::span<const std::uint32_t> places,
                const PixelRays& rays, OrderReport& report) {
  const int rows_at_a_time = std::max(1, static_cast<int>(kPixelsAtATime / static_cast<std::size_t>(rays.width)));
  for (int row = 0; row < rays.height; row += rows_at_a_time) {
    const SegmentFinder finder(mesh, cells, places, rays, row, std::min(rays.height, row + rows_at_a_time));
    const std::vector<Segment> segments = finder.find(report.thin_segments);
    for (std::size_t begin = 0; begin < segments.size();) {
      std::size_t end = begin + 1;
      while (end < segments.size() && segments[end].pixel == segments[begin].pixel) ++end;
      check_ray(std::span(segments).subspan(begin, end - begin), report);
      begin = end;
    }
  }
}

}  // namespace

OrderReport check_order(const PreparedMesh& mesh, const Camera& camera, std::span<const std::uint32_t> order,
                        const OrderCheckOptions& options) {
  if (options.width < 0 || options.height < 0)
    throw Error(ErrorCode::kInvalidArgument, "the size of a check must not be negative");
  const sort::ViewPoint view = sort::make_view_point(mesh, camera);
  OrderReport report;
  support::with_threads(options.threads, [&] {
    const std::vector<std::uint32_t> places = find_places(order, mesh.cells.size(), options.direction);
    report.is_permutation = places.size() == order.size() && order.size() == mesh.cells.size();
    if (!report.is_permutation) return;
    const std::vector<CellVertices> cells = mesh::find_cell_vertices(mesh);
    check_faces(mesh, cells, view, places, report);
    if (options.width == 0 || options.height == 0) return;
    check_rays(mesh, cells, places, sort::make_pixel_rays(mesh, camera, options.width, options.height), report);
  });
  return report;
}

}  // namespace tetravox
