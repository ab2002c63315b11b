#include "src/cpu/entries.h"

#include "src/support/threads.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>

namespace tetravox::cpu {
namespace {

constexpr std::size_t kTilePixels = static_cast<std::size_t>(kTileSize) * kTileSize;
/// Pixels by which bounds are widened, for rounding.
constexpr double kMargin = 0.01;

struct PlacedFace {
  std::uint32_t tile = 0;
  BinnedFace face;
};

/// The extent of a face in the picture, in pixels.
struct Extent {
  double column_min = std::numeric_limits<double>::infinity(), column_max = -column_min;
  double row_min = column_min, row_max = -column_min;

  void add(double column, double row) {
    column_min = std::min(column_min, column);
    column_max = std::max(column_max, column);
    row_min = std::min(row_min, row);
    row_max = std::max(row_max, row);
  }
};

Vector3 vertex_position(const FrameMesh& mesh, std::uint32_t id) {
  const float* v = mesh.vertices + 4 * static_cast<std::size_t>(id);
  return {v[0], v[1], v[2]};
}

/// Whether a face is certainly seen from its inner side: the eye lies clearly behind its plane.
bool is_turned_away(const std::array<Vector3, 3>& p, const scene::CameraFrame& frame) {
  Vector3 u{}, v{}, to_eye{};
  for (int i = 0; i < 3; ++i) {
    u[i] = p[1][i] - p[0][i];
    v[i] = p[2][i] - p[0][i];
    to_eye[i] = frame.eye[i] - p[0][i];
  }
  if (frame.is_orthographic) to_eye = {0.0, 0.0, -1.0};
  const Vector3 terms{(u[1] * v[2] - u[2] * v[1]) * to_eye[0], (u[2] * v[0] - u[0] * v[2]) * to_eye[1],
                      (u[0] * v[1] - u[1] * v[0]) * to_eye[2]};
  // x right, y up, z forward is a left-handed frame: the outward normal is -(u x v).
  const double side = -(terms[0] + terms[1] + terms[2]);
  const double size =
      std::hypot(u[0], u[1], u[2]) * std::hypot(v[0], v[1], v[2]) * std::hypot(to_eye[0], to_eye[1], to_eye[2]);
  return side < -1e-5 * size;
}

/// The part of a face in front of the eye, projected.
Extent project_face(const std::array<Vector3, 3>& p, const scene::CameraFrame& frame) {
  Extent extent;
  const auto add = [&](const Vector3& q) {
    const double scale = frame.is_orthographic ? 1.0 : 1.0 / (q[2] - frame.eye[2]);
    extent.add((q[0] - frame.eye[0]) * scale / frame.pixel_step + 0.5 * frame.width,
               0.5 * frame.height - (q[1] - frame.eye[1]) * scale / frame.pixel_step);
  };
  if (frame.is_orthographic) {
    for (const Vector3& q : p) add(q);
    return extent;
  }
  // Cut the triangle at a plane just in front of the eye.
  const double z_cut = frame.eye[2] + 1e-6;
  for (int i = 0; i < 3; ++i) {
    const Vector3& a = p[i];
    const Vector3& b = p[(i + 1) % 3];
    if (a[2] >= z_cut) add(a);
    if ((a[2] < z_cut) != (b[2] < z_cut)) {
      const double t = (z_cut - a[2]) / (b[2] - a[2]);
      add({a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1]), z_cut});
    }
  }
  return extent;
}

/// Pixels whose centre may lie in the extent.
TileBounds pixels_of(const Extent& extent, const scene::CameraFrame& frame) {
  const auto first = [](double low, int count) {
    return static_cast<int>(std::clamp(std::ceil(low - 0.5 - kMargin), 0.0, count * 1.0));
  };
  const auto last = [](double high, int count) {
    return static_cast<int>(std::clamp(std::floor(high - 0.5 + kMargin) + 1.0, 0.0, count * 1.0));
  };
  return {first(extent.column_min, frame.width), last(extent.column_max, frame.width),
          first(extent.row_min, frame.height), last(extent.row_max, frame.height)};
}

void place_in_tiles(std::uint32_t face, const TileBounds& bounds, int tile_columns, std::vector<PlacedFace>& placed) {
  if (bounds.column_begin >= bounds.column_end || bounds.row_begin >= bounds.row_end) return;
  for (int row = bounds.row_begin / kTileSize; row <= (bounds.row_end - 1) / kTileSize; ++row)
    for (int column = bounds.column_begin / kTileSize; column <= (bounds.column_end - 1) / kTileSize; ++column) {
      const TileBounds inside{
          std::max(bounds.column_begin, column * kTileSize), std::min(bounds.column_end, (column + 1) * kTileSize),
          std::max(bounds.row_begin, row * kTileSize), std::min(bounds.row_end, (row + 1) * kTileSize)};
      placed.push_back({static_cast<std::uint32_t>(row * tile_columns + column), {face, inside}});
    }
}

/// Pixels of a tile in Morton order.
const std::array<std::uint16_t, kTilePixels>& pixel_order() {
  static const auto order = [] {
    std::array<std::uint16_t, kTilePixels> made{};
    for (std::size_t i = 0; i < kTilePixels; ++i) {
      std::size_t column = 0, row = 0;
      for (int bit = 0; bit < 8; ++bit) {
        column |= ((i >> (2 * bit)) & 1) << bit;
        row |= ((i >> (2 * bit + 1)) & 1) << bit;
      }
      made[i] = static_cast<std::uint16_t>(row * kTileSize + column);
    }
    return made;
  }();
  return order;
}

}  // namespace

TileBins bin_faces(const FrameMesh& mesh, std::size_t face_count, std::size_t first_eye_face,
                   const scene::CameraFrame& frame) {
  TileBins bins;
  bins.columns = (frame.width + kTileSize - 1) / kTileSize;
  bins.rows = (frame.height + kTileSize - 1) / kTileSize;

  constexpr std::size_t kChunk = 1 << 12;
  const std::size_t chunk_count = (face_count + kChunk - 1) / kChunk;
  std::vector<std::vector<PlacedFace>> chunks(chunk_count);
  support::parallel_chunks(chunk_count, 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t chunk = begin; chunk < end; ++chunk)
      for (std::size_t i = chunk * kChunk; i < std::min(face_count, (chunk + 1) * kChunk); ++i) {
        const auto face = static_cast<std::uint32_t>(i);
        if (i >= first_eye_face) {
          place_in_tiles(face, {0, frame.width, 0, frame.height}, bins.columns, chunks[chunk]);
          continue;
        }
        std::array<Vector3, 3> p{};
        for (int k = 0; k < 3; ++k) p[k] = vertex_position(mesh, mesh.faces[i].vertices[k]);
        if (is_turned_away(p, frame)) continue;
        place_in_tiles(face, pixels_of(project_face(p, frame), frame), bins.columns, chunks[chunk]);
      }
  });

  // Sort by tile: count, then place.
  bins.begin.assign(bins.tile_count() + 1, 0);
  for (const auto& chunk : chunks)
    for (const PlacedFace& placed : chunk) ++bins.begin[placed.tile + 1];
  std::partial_sum(bins.begin.begin(), bins.begin.end(), bins.begin.begin());
  bins.faces.resize(bins.begin.back());
  std::vector<std::uint32_t> next(bins.begin.begin(), bins.begin.end() - 1);
  for (const auto& chunk : chunks)
    for (const PlacedFace& placed : chunk) bins.faces[next[placed.tile]++] = placed.face;
  return bins;
}

void collect_rays(const Kernels& kernels, const FrameMesh& mesh, const scene::RayGrid& grid, const TileBins& bins,
                  std::size_t tile, std::size_t first_eye_face, bool is_orthographic, TileScratch& scratch) {
  const int tile_column = static_cast<int>(tile % bins.columns) * kTileSize;
  const int tile_row = static_cast<int>(tile / bins.columns) * kTileSize;
  scratch.hits.clear();
  for (const BinnedFace& face : bins.faces_of(tile))
    kernels.rasterize_face(mesh, grid, face, tile_column, tile_row, scratch.hits);

  // Rays of a perspective start at the eye; what they met before is of no concern, unless the eye is in that very cell.
  if (!is_orthographic)
    std::erase_if(scratch.hits,
                  [&](const FaceHit& hit) { return hit.entry.face < first_eye_face && hit.entry.depth < grid.z_near; });

  // Sort by pixel, then by depth; the faces around the eye come first.
  TileRays& rays = scratch.rays;
  rays.rays.clear();
  rays.entries.resize(scratch.hits.size());
  scratch.first.assign(kTilePixels + 1, 0);
  for (const FaceHit& hit : scratch.hits) ++scratch.first[hit.pixel + 1];
  std::partial_sum(scratch.first.begin(), scratch.first.end(), scratch.first.begin());
  for (const FaceHit& hit : scratch.hits) rays.entries[scratch.first[hit.pixel]++] = hit.entry;  // first becomes last
  for (const std::uint16_t pixel : pixel_order()) {
    const std::uint32_t begin = pixel == 0 ? 0 : scratch.first[pixel - 1];
    const std::uint32_t end = scratch.first[pixel];
    if (begin == end) continue;
    std::sort(rays.entries.begin() + begin, rays.entries.begin() + end, [&](const Entry& a, const Entry& b) {
      const bool a_eye = a.face >= first_eye_face, b_eye = b.face >= first_eye_face;
      if (a_eye != b_eye) return a_eye;
      return a.depth != b.depth ? a.depth < b.depth : a.face < b.face;
    });
    rays.rays.push_back({tile_column + pixel % kTileSize, tile_row + pixel / kTileSize, begin, end, 0, 0});
  }
}

}  // namespace tetravox::cpu
