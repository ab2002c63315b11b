// Where rays enter: faces against the pixels of a tile.

#if defined(TETRAVOX_CPU_RASTERIZE_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef TETRAVOX_CPU_RASTERIZE_INL
#undef TETRAVOX_CPU_RASTERIZE_INL
#else
#define TETRAVOX_CPU_RASTERIZE_INL
#endif

#include "src/cpu/kernels/kernels.h"
#include "src/cpu/kernels/vector_math-inl.h"

#include <vector>

HWY_BEFORE_NAMESPACE();
namespace tetravox::cpu {
namespace HWY_NAMESPACE {

/// Sheared position of a face's vertex for a row of rays, and its coordinates in the camera frame.
struct ShearedVertex {
  Float x, y, z;
};

HWY_INLINE ShearedVertex shear_vertex(const float* vertex, Float x_offset, Float x_slope, float y_offset,
                                      float y_slope) {
  const Float z = constant(vertex[2]);
  return {hn::Sub(hn::Sub(constant(vertex[0]), hn::Mul(x_slope, z)), x_offset),
          constant(vertex[1] - y_slope * vertex[2] - y_offset), z};
}

/// Whether a ray that meets the edge from (ax, ay) to (bx, by) exactly counts as passing on its inner (left) side.
///
/// As if the ray were moved by an infinitesimal (e, e^2), e > 0, so that it belongs to exactly one of the faces at an
/// edge or a vertex (Edelsbrunner, Muecke 1990, "Simulation of Simplicity").
HWY_INLINE Mask passes_tie(Float ax, Float ay, Float bx, Float by) {
  return hn::Or(hn::Lt(by, ay), hn::And(hn::Eq(by, ay), hn::Gt(bx, ax)));
}

/// The product a x b, not negative, and whether the ray passes on the inner side of the edge.
HWY_INLINE Float edge_product(const ShearedVertex& a, const ShearedVertex& b, Mask& inside) {
  const Float product = hn::Sub(hn::Mul(a.x, b.y), hn::Mul(a.y, b.x));
  const Mask tie = hn::And(hn::Eq(product, constant(0.0f)), passes_tie(a.x, a.y, b.x, b.y));
  inside = hn::And(inside, hn::Or(hn::Gt(product, constant(0.0f)), tie));
  return hn::Max(product, constant(0.0f));
}

inline void rasterize_face(const FrameMesh& mesh, const scene::RayGrid& rays, const BinnedFace& face, int tile_column,
                           int tile_row, std::vector<FaceHit>& hits) {
  const BoundaryFace& entry = mesh.faces[face.face];
  const float* vertex[3];
  for (int k = 0; k < 3; ++k) vertex[k] = mesh.vertices + 4 * static_cast<std::size_t>(entry.vertices[k]);
  const TileBounds& bounds = face.bounds;
  for (int row = bounds.row_begin; row < bounds.row_end; ++row) {
    const float y_offset = rays.row_offset[row], y_slope = rays.row_slope[row];
    for (int column = bounds.column_begin; column < bounds.column_end; column += static_cast<int>(kLanes)) {
      const Float x_offset = hn::LoadU(kFloat, rays.column_offset + column);
      const Float x_slope = hn::LoadU(kFloat, rays.column_slope + column);
      const ShearedVertex a = shear_vertex(vertex[0], x_offset, x_slope, y_offset, y_slope);
      const ShearedVertex b = shear_vertex(vertex[1], x_offset, x_slope, y_offset, y_slope);
      const ShearedVertex c = shear_vertex(vertex[2], x_offset, x_slope, y_offset, y_slope);
      Mask inside = hn::FirstN(kFloat, static_cast<std::size_t>(bounds.column_end - column));
      const Float weight_c = edge_product(a, b, inside);
      const Float weight_a = edge_product(b, c, inside);
      const Float weight_b = edge_product(c, a, inside);
      if (hn::AllFalse(kFloat, inside)) continue;
      const Float total = hn::Add(hn::Add(weight_a, weight_b), weight_c);
      const Float sum = multiply_add(weight_c, c.z, multiply_add(weight_b, b.z, hn::Mul(weight_a, a.z)));
      const Float depth = hn::IfThenElse(hn::Gt(total, constant(0.0f)), hn::Div(sum, total), a.z);

      HWY_ALIGN float depths[kLanes];
      HWY_ALIGN std::uint32_t found[kLanes];
      hn::Store(depth, kFloat, depths);
      hn::Store(hn::IfThenElseZero(uint_mask(inside), hn::Set(kUint, 1)), kUint, found);
      for (std::size_t lane = 0; lane < kLanes; ++lane) {
        if (!found[lane]) continue;
        const int pixel = (row - tile_row) * kTileSize + column + static_cast<int>(lane) - tile_column;
        hits.push_back({static_cast<std::uint32_t>(pixel), {face.face, depths[lane]}});
      }
    }
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace tetravox::cpu
HWY_AFTER_NAMESPACE();

#endif
