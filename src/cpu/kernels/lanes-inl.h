// The rays of a vector, in memory and in registers.

#if defined(TETRAVOX_CPU_LANES_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef TETRAVOX_CPU_LANES_INL
#undef TETRAVOX_CPU_LANES_INL
#else
#define TETRAVOX_CPU_LANES_INL
#endif

#include "src/cpu/kernels/segments-inl.h"
#include "src/cpu/kernels/vector_math-inl.h"

HWY_BEFORE_NAMESPACE();
namespace tetravox::cpu {
namespace HWY_NAMESPACE {

/// The rays of a vector between two rounds of filling, in memory.
///
/// The triangle (a, b, c) is the face that the ray is about to enter through; its vertices are sheared so that the
/// ray is the z axis: x' = x - slope * z - offset. Seen along the ray it runs counter-clockwise: the products
/// a' x b', b' x c', c' x a' are not negative, and are the (unscaled) barycentric weights of c, a, b.
struct Lanes {
  HWY_ALIGN std::uint32_t id[3][kLanes];
  HWY_ALIGN float x[3][kLanes], y[3][kLanes], z[3][kLanes], scalar[3][kLanes];
  HWY_ALIGN float weight[3][kLanes];
  HWY_ALIGN std::uint32_t cell[kLanes];
  HWY_ALIGN float z_front[kLanes], scalar_front[kLanes];
  HWY_ALIGN float red[kLanes], green[kLanes], blue[kLanes], transmittance[kLanes];
  HWY_ALIGN float x_offset[kLanes], x_slope[kLanes], y_offset[kLanes], y_slope[kLanes];
  HWY_ALIGN float world_per_z[kLanes];    ///< length of the ray for one unit of z
  HWY_ALIGN float z_checked[kLanes];      ///< z_front when progress was last checked
  HWY_ALIGN std::uint32_t alive[kLanes];  ///< all bits set while the ray is in a cell
  std::uint32_t ray[kLanes];              ///< index into TileRays::rays, or kNoRay
  std::uint32_t next_entry[kLanes];
  HWY_ALIGN float z_near[kLanes], z_far[kLanes];  ///< what is drawn of the ray: from the eye, or a clip interval
  std::uint32_t next_clip[kLanes];
  HWY_ALIGN float depth[kLanes];  ///< see Effects::depth
  HWY_ALIGN std::int32_t pixel[kLanes];
};

constexpr std::uint32_t kNoRay = 0xFFFFFFFFu;

/// The same, in registers.
template <class Integrator>
struct State {
  Uint id[3];
  Float x[3], y[3], z[3], scalar[3], weight[3];
  Uint cell;
  Float z_front, scalar_front;
  Accumulated sum;
  typename Integrator::Front front;
  Mask alive;
};

}  // namespace HWY_NAMESPACE
}  // namespace tetravox::cpu
HWY_AFTER_NAMESPACE();

#endif
