#include "src/mesh/weld.h"

#include "src/support/threads.h"
#include "tetravox/error.h"
#include "tetravox/mesh.h"

#include <tbb/parallel_reduce.h>
#include <tbb/parallel_sort.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

namespace tetravox::mesh {
namespace {

constexpr std::size_t kPointsPerChunk = 1 << 16;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// A used point on its way to its place along the curve.
struct CurvePoint {
  std::uint64_t key;
  std::uint32_t point;
};

struct BoundsResult {
  std::array<ValueRange, 3> bounds{{{kInfinity, -kInfinity}, {kInfinity, -kInfinity}, {kInfinity, -kInfinity}}};
  std::size_t first_bad = std::numeric_limits<std::size_t>::max();
};

/// Order of points at one place of the curve: by position, then the values of all fields, then id.
class PointOrder {
 public:
  explicit PointOrder(const MeshData& mesh) : mesh_(mesh), with_values_(mesh.association == Association::kPoint) {}

  bool operator()(const CurvePoint& a, const CurvePoint& b) const {
    const double* p = position(a);
    const double* q = position(b);
    for (int axis = 0; axis < 3; ++axis)
      if (p[axis] != q[axis]) return p[axis] < q[axis];
    if (with_values_) {
      if (mesh_.scalars[a.point] != mesh_.scalars[b.point]) return mesh_.scalars[a.point] < mesh_.scalars[b.point];
      for (const OtherField& other : mesh_.others)
        if (other.scalars[a.point] != other.scalars[b.point]) return other.scalars[a.point] < other.scalars[b.point];
    }
    return a.point < b.point;
  }
  bool is_same_position(const CurvePoint& a, const CurvePoint& b) const {
    const double* p = position(a);
    const double* q = position(b);
    return p[0] == q[0] && p[1] == q[1] && p[2] == q[2];
  }
  /// Values of used points are finite, so that == is an equivalence.
  bool are_values_same(const CurvePoint& a, const CurvePoint& b) const {
    if (!with_values_) return true;
    bool are_same = mesh_.scalars[a.point] == mesh_.scalars[b.point];
    for (const OtherField& other : mesh_.others) are_same &= other.scalars[a.point] == other.scalars[b.point];
    return are_same;
  }

 private:
  const double* position(const CurvePoint& p) const { return mesh_.points.data() + 3 * std::size_t{p.point}; }

  const MeshData& mesh_;
  bool with_values_;
};

Buffer<CurvePoint> sort_along_curve(const MeshData& mesh, const Buffer<std::uint8_t>& is_used,
                                    const CurveDomain& domain) {
  // Find where each chunk of points writes, so that the used points end up packed and in order of their ids.
  const std::size_t points = mesh.point_count();
  const std::size_t chunks = (points + kPointsPerChunk - 1) / kPointsPerChunk;
  std::vector<std::size_t> begin(chunks + 1, 0);
  support::parallel_chunks(chunks, 1, [&](std::size_t chunk, std::size_t chunk_end) {
    for (; chunk < chunk_end; ++chunk) {
      const std::uint8_t* first = is_used.begin() + chunk * kPointsPerChunk;
      const std::uint8_t* last = is_used.begin() + std::min(points, (chunk + 1) * kPointsPerChunk);
      begin[chunk + 1] = static_cast<std::size_t>(std::count(first, last, std::uint8_t{1}));
    }
  });
  for (std::size_t chunk = 0; chunk < chunks; ++chunk) begin[chunk + 1] += begin[chunk];
  Buffer<CurvePoint> order(begin[chunks]);
  support::parallel_chunks(chunks, 1, [&](std::size_t chunk, std::size_t chunk_end) {
    for (; chunk < chunk_end; ++chunk) {
      std::size_t at = begin[chunk];
      for (std::size_t p = chunk * kPointsPerChunk; p < std::min(points, (chunk + 1) * kPointsPerChunk); ++p)
        if (is_used[p])
          order[at++] = {hilbert_index(mesh.points.data() + 3 * p, domain), static_cast<std::uint32_t>(p)};
    }
  });
  tbb::parallel_sort(order.begin(), order.end(), [](const CurvePoint& a, const CurvePoint& b) {
    return a.key != b.key ? a.key < b.key : a.point < b.point;
  });
  return order;
}

/// Borders of chunks of `order` that do not cut through points with one key.
std::vector<std::size_t> chunk_borders(const Buffer<CurvePoint>& order) {
  std::vector<std::size_t> borders = {0};
  while (borders.back() < order.size()) {
    std::size_t border = std::min(order.size(), borders.back() + kPointsPerChunk);
    while (border < order.size() && order[border].key == order[border - 1].key) ++border;
    borders.push_back(border);
  }
  return borders;
}

/// Sorts points with one key by position and values, writes their canonical ids, and leaves in `key` whether a point
/// begins a new vertex. Returns how many do.
std::size_t group_run(CurvePoint* first, CurvePoint* last, const PointOrder& is_before, Buffer<PointTarget>& targets) {
  constexpr std::ptrdiff_t kLongRun = 1 << 16;
  if (last - first > kLongRun)
    tbb::parallel_sort(first, last, is_before);
  else if (last - first > 1)
    std::sort(first, last, is_before);
  std::size_t vertices = 0;
  for (CurvePoint* place = first; place != last;) {
    CurvePoint* place_end = place;
    std::uint32_t canonical = place->point;
    for (; place_end != last && is_before.is_same_position(*place, *place_end); ++place_end)
      canonical = std::min(canonical, place_end->point);
    for (CurvePoint* p = place; p != place_end; ++p) {
      const bool begins_vertex = p == place || !is_before.are_values_same(p[-1], *p);
      targets[p->point].canonical = canonical;
      p->key = begins_vertex;
      vertices += begins_vertex;
    }
    place = place_end;
  }
  return vertices;
}

}  // namespace

std::array<ValueRange, 3> bounds_of_used_points(const MeshData& mesh, const Buffer<std::uint8_t>& is_used) {
  const BoundsResult result = tbb::parallel_reduce(
      tbb::blocked_range<std::size_t>(0, mesh.point_count(), kPointsPerChunk), BoundsResult{},
      [&](const tbb::blocked_range<std::size_t>& range, BoundsResult part) {
        for (std::size_t p = range.begin(); p < range.end(); ++p) {
          if (!is_used[p]) continue;
          for (std::size_t axis = 0; axis < 3; ++axis) {
            const double x = mesh.points[3 * p + axis] + 0.0;  // + 0 turns -0 into 0
            if (!std::isfinite(x)) part.first_bad = std::min(part.first_bad, p);
            part.bounds[axis].min = std::min(part.bounds[axis].min, x);
            part.bounds[axis].max = std::max(part.bounds[axis].max, x);
          }
        }
        return part;
      },
      [](BoundsResult a, const BoundsResult& b) {
        for (int axis = 0; axis < 3; ++axis) {
          a.bounds[axis].min = std::min(a.bounds[axis].min, b.bounds[axis].min);
          a.bounds[axis].max = std::max(a.bounds[axis].max, b.bounds[axis].max);
        }
        a.first_bad = std::min(a.first_bad, b.first_bad);
        return a;
      });
  if (result.first_bad != std::numeric_limits<std::size_t>::max())
    throw Error(ErrorCode::kBadFile, "point " + std::to_string(result.first_bad) +
                                         " has a coordinate that is not finite: the mesh is damaged, write it again");
  return result.bounds;
}

Weld weld_points(const MeshData& mesh, const Buffer<std::uint8_t>& is_used, const std::array<ValueRange, 3>& bounds,
                 ProgressMeter& meter) {
  CurveDomain domain;
  for (int axis = 0; axis < 3; ++axis) {
    domain.half_min[axis] = bounds[axis].min * 0.5;
    domain.half_extent = std::max(domain.half_extent, bounds[axis].max * 0.5 - bounds[axis].min * 0.5);
  }
  Weld weld;
  weld.targets = Buffer<PointTarget>(mesh.point_count());
  support::parallel_chunks(mesh.point_count(), 1 << 20, [&](std::size_t begin, std::size_t end) {
    std::fill(weld.targets.begin() + begin, weld.targets.begin() + end, PointTarget{kNoCell, kNoCell});
  });
  Buffer<CurvePoint> order = sort_along_curve(mesh, is_used, domain);
  meter.advance(order.size());

  // Group what coincides. Coincident points have equal keys, so that a chunk needs to know nothing of others.
  const std::vector<std::size_t> borders = chunk_borders(order);
  const std::size_t chunks = borders.size() - 1;
  std::vector<std::size_t> first_vertex(chunks + 1, 0);
  const PointOrder is_before(mesh);
  support::parallel_chunks(chunks, 1, [&](std::size_t chunk, std::size_t chunk_end) {
    for (; chunk < chunk_end; ++chunk)
      for (CurvePoint* run = order.begin() + borders[chunk]; run != order.begin() + borders[chunk + 1];) {
        CurvePoint* run_end = run + 1;
        while (run_end != order.begin() + borders[chunk + 1] && run_end->key == run->key) ++run_end;
        first_vertex[chunk + 1] += group_run(run, run_end, is_before, weld.targets);
        run = run_end;
      }
  });
  for (std::size_t chunk = 0; chunk < chunks; ++chunk) first_vertex[chunk + 1] += first_vertex[chunk];

  // Number the vertices along the curve.
  weld.point_of_vertex.resize(first_vertex[chunks]);
  weld.merged_points = order.size() - weld.point_of_vertex.size();
  support::parallel_chunks(chunks, 1, [&](std::size_t chunk, std::size_t chunk_end) {
    for (; chunk < chunk_end; ++chunk) {
      std::size_t next = first_vertex[chunk];
      for (std::size_t i = borders[chunk]; i < borders[chunk + 1]; ++i) {
        if (order[i].key) weld.point_of_vertex[next++] = order[i].point;
        weld.targets[order[i].point].vertex = static_cast<std::uint32_t>(next - 1);
      }
    }
  });
  meter.advance(order.size());
  return weld;
}

}  // namespace tetravox::mesh
