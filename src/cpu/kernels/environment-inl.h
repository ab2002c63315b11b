// Light from the surroundings at places that rays pass: look-ups in reflection maps by normal and by reflected view.

#if defined(TETRAVOX_CPU_ENVIRONMENT_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef TETRAVOX_CPU_ENVIRONMENT_INL
#undef TETRAVOX_CPU_ENVIRONMENT_INL
#else
#define TETRAVOX_CPU_ENVIRONMENT_INL
#endif

#include "src/cpu/kernels/effects.h"
#include "src/cpu/kernels/triples-inl.h"
#include "src/cpu/kernels/vector_math-inl.h"

HWY_BEFORE_NAMESPACE();
namespace tetravox::cpu {
namespace HWY_NAMESPACE {

/// Where directions meet the cube of a map (see optics/environment_filter.h).
struct CubePlace {
  Int first_node;     ///< of the face
  Triple in_lattice;  ///< column, row, 0
};

/// `direction`: of any length; of length 0 it is as good as any.
HWY_INLINE CubePlace find_cube_place(const DirectionMap& map, const Triple& direction) {
  const Float x = hn::Abs(direction.x), y = hn::Abs(direction.y), z = hn::Abs(direction.z);
  const Mask is_x = hn::And(hn::Ge(x, y), hn::Ge(x, z)), is_y = hn::AndNot(is_x, hn::Ge(y, z));
  const auto choose = [&](Float of_x, Float of_y, Float of_z) {
    return hn::IfThenElse(is_x, of_x, hn::IfThenElse(is_y, of_y, of_z));
  };
  const Float major = choose(direction.x, direction.y, direction.z);
  const Float inverse = hn::Div(constant(1.0f), hn::Max(hn::Abs(major), constant(1e-30f)));
  const Float half = constant(0.5f * static_cast<float>(map.size - 1));
  const auto node_of = [&](Float component) { return multiply_add(hn::Mul(component, inverse), half, half); };
  const Float side = hn::IfThenElseZero(hn::Lt(major, constant(0.0f)), constant(1.0f));
  const Float face = hn::Add(choose(constant(0.0f), constant(2.0f), constant(4.0f)), side);
  return {hn::Mul(hn::ConvertTo(kInt, face), hn::Set(kInt, map.size * map.size)),
          {node_of(choose(direction.y, direction.z, direction.x)),
           node_of(choose(direction.z, direction.x, direction.y)), constant(0.0f)}};
}

/// The map's colour in a direction, bilinear: continuous over the edges of the cube.
HWY_NOINLINE inline Triple look_up_direction(const DirectionMap& map, const Triple& direction) {
  const CubePlace cube = find_cube_place(map, direction);
  const std::int32_t sizes[3] = {map.size, map.size, 1};
  const LatticePlace at(sizes, cube.in_lattice);
  const Int corner = hn::Add(cube.first_node, at.node);
  const auto load = [&](Int node) {
    const Record record = load_table_records(map.colors, hn::BitCast(kUint, node));
    return Triple{record.x, record.y, record.z};
  };
  const auto edge = [&](Int node) { return mix(at.t[0], load(node), load(hn::Add(node, at.step[0]))); };
  return mix(at.t[1], edge(corner), edge(hn::Add(corner, at.step[1])));
}

/// What surroundings give to a place: light to be reflected diffusely, and as it is mirrored towards the eye.
struct Surroundings {
  Triple diffuse, specular;
};

/// `normal`, `to_eye`: unit vectors of the camera frame. `strength`: 0 for light that needs no normal, 1 for all that
/// does.
HWY_INLINE Surroundings find_surroundings(const EnvironmentMaps& maps, const Triple& normal, const Triple& to_eye,
                                          Float strength) {
  const auto look_up = [&](const DirectionMap& map, const Triple& direction) {
    return look_up_direction(map, transform(maps.map_from_camera, 3, direction));
  };
  const Float along = dot(normal, to_eye);
  const Triple mirrored = sum_of(scaled(normal, hn::Add(along, along)), scaled(to_eye, constant(-1.0f)));
  const Float intensity = constant(maps.intensity);
  return {scaled(mix(strength, constant_triple(maps.mean), look_up(maps.diffuse, normal)), intensity),
          scaled(look_up(maps.specular, mirrored), hn::Mul(intensity, strength))};
}

}  // namespace HWY_NAMESPACE
}  // namespace tetravox::cpu
HWY_AFTER_NAMESPACE();

#endif
