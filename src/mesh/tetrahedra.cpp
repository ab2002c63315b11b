#include "src/mesh/tetrahedra.h"

#include "src/mesh/decompose.h"
#include "src/support/threads.h"
#include "tetravox/error.h"
#include "tetravox/mesh.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <string>
#include <tuple>
#include <utility>

namespace tetravox::mesh {
namespace {

constexpr std::size_t kTetrahedraPerChunk = 1 << 16;
constexpr std::size_t kVerticesPerChunk = 1 << 13;

/// A counter that many threads increase; returns the value before.
std::uint32_t increase(std::uint32_t& counter) {
  return std::atomic_ref<std::uint32_t>(counter).fetch_add(1, std::memory_order_relaxed);
}

/// Six times the signed volume of four points, in units of 1 / length_scale^3.
double signed_volume(const MeshData& mesh, const std::array<std::uint32_t, 4>& points, double length_scale) {
  std::array<std::array<double, 3>, 4> p;
  for (int i = 0; i < 4; ++i)
    for (std::size_t axis = 0; axis < 3; ++axis)
      p[i][axis] = mesh.points[3 * std::size_t{points[i]} + axis] * length_scale;
  std::array<std::array<double, 3>, 3> e;
  for (int i = 0; i < 3; ++i)
    for (int axis = 0; axis < 3; ++axis) e[i][axis] = p[i + 1][axis] - p[0][axis];
  return (e[0][1] * e[1][2] - e[0][2] * e[1][1]) * e[2][0] + (e[0][2] * e[1][0] - e[0][0] * e[1][2]) * e[2][1] +
         (e[0][0] * e[1][1] - e[0][1] * e[1][0]) * e[2][2];
}

/// Unsorted tetrahedra, packed within regions.
struct Regions {
  Buffer<Tetrahedron> tetrahedra;
  std::vector<std::uint64_t> begin, end;  ///< [chunks of input cells]
};

/// Turns the tetrahedra of one chunk of input cells into their stored form.
class Emitter {
 public:
  Emitter(const MeshData& mesh, const Weld& weld, double length_scale)
      : mesh_(mesh), weld_(weld), length_scale_(length_scale) {}

  /// Writes the tetrahedra of the input cells [begin, end) at `out`, counts them in `counts` by lowest vertex.
  /// Returns the end of what was written.
  Tetrahedron* emit_cells(std::size_t begin, std::size_t end, Tetrahedron* out, std::vector<std::uint32_t>& counts) {
    const auto canonical = [this](std::uint32_t point) { return weld_.targets[point].canonical; };
    for (std::size_t cell = begin; cell < end; ++cell) {
      if (!is_kept(cell)) continue;
      const auto emit = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) {
        std::array<std::uint32_t, 4> v;
        if (!orient({a, b, c, d}, v)) {
          ++degenerate;
          return;
        }
        *out++ = {v, static_cast<std::uint32_t>(cell)};
        increase(counts[v[0]]);
      };
      decompose(mesh_.cell_types[cell], cell_entry(mesh_, cell), canonical, emit);
    }
    return out;
  }

  std::uint64_t degenerate = 0;

 private:
  /// Point data: points without a value were given no vertex.
  bool is_kept(std::size_t cell) const {
    if (mesh_.association == Association::kCell) return std::isfinite(mesh_.scalars[cell]);
    bool has_values = true;
    for_each_point(mesh_.cell_types[cell], cell_entry(mesh_, cell),
                   [&](std::uint32_t point) { has_values &= std::isfinite(mesh_.scalars[point]); });
    return has_values;
  }

  /// Vertices of four points in stored order; false without volume. The sign is computed in ascending order of the
  /// vertices: it does not depend on where the tetrahedron came from.
  bool orient(std::array<std::uint32_t, 4> points, std::array<std::uint32_t, 4>& v) const {
    std::array<PointTarget, 4> targets;
    for (int i = 0; i < 4; ++i) targets[i] = weld_.targets[points[i]];
    const auto order = [&](int i, int j) {
      if (targets[j].vertex >= targets[i].vertex) return;
      std::swap(targets[i], targets[j]);
      std::swap(points[i], points[j]);
    };
    order(0, 1);
    order(2, 3);
    order(0, 2);
    order(1, 3);
    order(1, 2);
    for (int i = 0; i < 4; ++i)
      for (int j = i + 1; j < 4; ++j)
        if (targets[i].canonical == targets[j].canonical) return false;
    const double volume = signed_volume(mesh_, points, length_scale_);
    if (volume == 0.0) return false;
    for (int i = 0; i < 4; ++i) v[i] = targets[i].vertex;
    if (volume < 0.0) std::swap(v[2], v[3]);
    return true;
  }

  const MeshData& mesh_;
  const Weld& weld_;
  double length_scale_;
};

/// Splits and orients. `counts` becomes the number of tetrahedra for each lowest vertex.
Regions emit_tetrahedra(const MeshData& mesh, const Survey& survey, const Weld& weld, double length_scale,
                        std::vector<std::uint32_t>& counts, std::uint64_t& degenerate, ProgressMeter& meter) {
  Regions regions;
  const std::size_t chunks = survey.max_tetrahedra.size();
  regions.begin.assign(chunks, 0);
  regions.end.assign(chunks, 0);
  std::uint64_t total = 0;
  for (std::size_t chunk = 0; chunk < chunks; ++chunk) {
    regions.begin[chunk] = total;
    total += survey.max_tetrahedra[chunk];
  }
  regions.tetrahedra = Buffer<Tetrahedron>(total);
  std::atomic<std::uint64_t> all_degenerate{0};
  support::parallel_chunks(chunks, 1, [&](std::size_t chunk, std::size_t chunk_end) {
    for (; chunk < chunk_end; ++chunk) {
      const std::size_t begin = chunk * kCellsPerChunk, end = std::min(mesh.cell_count(), begin + kCellsPerChunk);
      Emitter emitter(mesh, weld, length_scale);
      const Tetrahedron* last =
          emitter.emit_cells(begin, end, regions.tetrahedra.begin() + regions.begin[chunk], counts);
      regions.end[chunk] = static_cast<std::uint64_t>(last - regions.tetrahedra.begin());
      all_degenerate += emitter.degenerate;
      meter.advance(end - begin);
    }
  });
  degenerate = all_degenerate;
  return regions;
}

bool is_before(const Tetrahedron& a, const Tetrahedron& b) {
  if (a.v[1] != b.v[1]) return a.v[1] < b.v[1];
  if (a.third() != b.third()) return a.third() < b.third();
  if (a.fourth() != b.fourth()) return a.fourth() < b.fourth();
  return a.source < b.source;
}

/// Brings the tetrahedra into buckets by lowest vertex and sorts each bucket.
void sort_tetrahedra(Regions&& regions, TetrahedronList& list, ProgressMeter& meter) {
  // Turn counts into the places where buckets begin; writing moves each place to where its bucket ends.
  std::uint32_t begin = 0;
  for (std::uint32_t& count : list.bucket_end) begin += std::exchange(count, begin);
  list.tetrahedra = Buffer<Tetrahedron>(list.count);
  support::parallel_chunks(regions.begin.size(), 1, [&](std::size_t chunk, std::size_t chunk_end) {
    for (; chunk < chunk_end; ++chunk) {
      for (std::uint64_t i = regions.begin[chunk]; i < regions.end[chunk]; ++i) {
        const Tetrahedron& tetrahedron = regions.tetrahedra[i];
        list.tetrahedra[increase(list.bucket_end[tetrahedron.v[0]])] = tetrahedron;
      }
      meter.advance(regions.end[chunk] - regions.begin[chunk]);
    }
  });
  regions.tetrahedra.release();
  support::parallel_chunks(list.bucket_end.size(), kVerticesPerChunk, [&](std::size_t first, std::size_t last) {
    for (std::size_t vertex = first; vertex < last; ++vertex)
      std::sort(list.tetrahedra.begin() + list.bucket_begin(vertex), list.tetrahedra.begin() + list.bucket_end[vertex],
                is_before);
    meter.advance(list.bucket_end[last - 1] - list.bucket_begin(first));
  });
}

/// Keeps the first of tetrahedra with the same vertices. Such are rare: looking is parallel, removing is not.
void remove_duplicates(TetrahedronList& list) {
  const auto is_duplicate = [&list](std::size_t i) {
    return i > 0 && list.tetrahedra[i].v == list.tetrahedra[i - 1].v;
  };
  std::atomic<std::uint64_t> duplicated{0};
  support::parallel_chunks(list.count, kTetrahedraPerChunk, [&](std::size_t begin, std::size_t end) {
    std::uint64_t found = 0;
    for (std::size_t i = begin; i < end; ++i) found += is_duplicate(i);
    duplicated += found;
  });
  list.duplicated = duplicated;
  if (list.duplicated == 0) return;
  std::size_t write = 0, read = 0;
  for (std::uint32_t& bucket_end : list.bucket_end) {
    for (; read < bucket_end; ++read) {
      // The last one written has the same vertices as the one read before, kept or not.
      if (write > 0 && list.tetrahedra[write - 1].v == list.tetrahedra[read].v) continue;
      list.tetrahedra[write++] = list.tetrahedra[read];
    }
    bucket_end = static_cast<std::uint32_t>(write);
  }
  list.count = write;
}

/// Renumbers the vertices so that each is used. The order stays, and with it the order of the tetrahedra.
void remove_unused_vertices(TetrahedronList& list) {
  const std::size_t vertices = list.point_of_vertex.size();
  std::vector<std::uint8_t> is_used(vertices, 0);
  support::parallel_chunks(list.count, kTetrahedraPerChunk, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      for (const std::uint32_t vertex : list.tetrahedra[i].v) {
        std::atomic_ref<std::uint8_t> flag(is_used[vertex]);
        if (flag.load(std::memory_order_relaxed) == 0) flag.store(1, std::memory_order_relaxed);
      }
  });
  if (std::find(is_used.begin(), is_used.end(), 0) == is_used.end()) return;
  std::vector<std::uint32_t> new_id(vertices);
  std::uint32_t next = 0;
  for (std::size_t vertex = 0; vertex < vertices; ++vertex) {
    new_id[vertex] = next;
    if (!is_used[vertex]) continue;
    list.bucket_end[next] = list.bucket_end[vertex];
    list.point_of_vertex[next++] = list.point_of_vertex[vertex];
  }
  list.bucket_end.resize(next);
  list.point_of_vertex.resize(next);
  support::parallel_chunks(list.count, kTetrahedraPerChunk, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      for (std::uint32_t& vertex : list.tetrahedra[i].v) vertex = new_id[vertex];
  });
}

}  // namespace

TetrahedronList collect_tetrahedra(const MeshData& mesh, const Survey& survey, Weld&& weld, double length_scale,
                                   ProgressMeter& meter) {
  TetrahedronList list;
  list.point_of_vertex = std::move(weld.point_of_vertex);
  list.bucket_end.assign(list.point_of_vertex.size(), 0);
  Regions regions = emit_tetrahedra(mesh, survey, weld, length_scale, list.bucket_end, list.degenerate, meter);
  weld.targets.release();
  for (std::size_t chunk = 0; chunk < regions.begin.size(); ++chunk)
    list.count += regions.end[chunk] - regions.begin[chunk];
  if (list.count >= kNoCell)
    throw Error(ErrorCode::kUnsupported, "the mesh has " + std::to_string(list.count) +
                                             " tetrahedra, more than the 4294967294 that can be drawn: split it");
  sort_tetrahedra(std::move(regions), list, meter);
  remove_duplicates(list);
  remove_unused_vertices(list);
  return list;
}

}  // namespace tetravox::mesh
