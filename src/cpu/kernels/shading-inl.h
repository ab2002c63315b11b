// Light at places that rays pass: Blinn-Phong (Blinn 1977) as in Engel and Ertl 2002, shadows, occlusion, environments.

#if defined(TETRAVOX_CPU_SHADING_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef TETRAVOX_CPU_SHADING_INL
#undef TETRAVOX_CPU_SHADING_INL
#else
#define TETRAVOX_CPU_SHADING_INL
#endif

#include "src/cpu/kernels/effects.h"
#include "src/cpu/kernels/environment-inl.h"
#include "src/cpu/kernels/triples-inl.h"
#include "src/cpu/kernels/vector_math-inl.h"

HWY_BEFORE_NAMESPACE();
namespace tetravox::cpu {
namespace HWY_NAMESPACE {

/// log2(x) for normal x > 0, to 3e-7: exponent, and the series of atanh for a mantissa in [sqrt(1/2), sqrt(2)).
HWY_INLINE Float log2_positive(Float x) {
  const Int bits = hn::BitCast(kInt, x);
  const Int shifted = hn::Sub(bits, hn::Set(kInt, 0x3F3504F3));
  const Int exponent = hn::ShiftRight<23>(shifted);
  const Float mantissa = hn::BitCast(kFloat, hn::Sub(bits, hn::ShiftLeft<23>(exponent)));
  const Float one = constant(1.0f);
  const Float t = hn::Div(hn::Sub(mantissa, one), hn::Add(mantissa, one)), square = hn::Mul(t, t);
  Float sum = constant(1.0f / 9.0f);
  for (const float coefficient : {1.0f / 7.0f, 1.0f / 5.0f, 1.0f / 3.0f, 1.0f})
    sum = multiply_add(sum, square, constant(coefficient));
  return multiply_add(hn::Mul(t, sum), constant(2.88539008f), hn::ConvertTo(kFloat, exponent));
}

/// x^exponent for x in [0, 1], exponent >= 1.
HWY_INLINE Float power(Float x, float exponent) {
  const Float log = log2_positive(hn::Max(x, constant(1e-20f)));
  return exp_negative(hn::Mul(hn::Min(log, constant(0.0f)), constant(-0.69314718f * exponent)));
}

/// cosine^exponent. Whole exponents, as most are, are products.
HWY_INLINE Float power_of_cosine(Float cosine, Float square, float exponent) {
  constexpr float kMostFactors = 256.0f;
  if (!(exponent <= kMostFactors) || exponent != static_cast<float>(static_cast<int>(exponent)))
    return power(square, 0.5f * exponent);
  const int whole = static_cast<int>(exponent);
  Float product = whole & 1 ? cosine : constant(1.0f), factor = square;
  for (int left = whole >> 1;;) {
    if (left & 1) product = hn::Mul(product, factor);
    left >>= 1;
    if (left == 0) return product;
    factor = hn::Mul(factor, factor);
  }
}

/// What comes through from a light: optical depth linear along the light, transmittance linear across it, so that both
/// a homogeneous medium and the edge of a shadow are smooth (percentage closer filtering; Reeves, Salesin, Cook 1987).
HWY_INLINE Float look_up_transmittance(const float* depths, const std::int32_t sizes[3], const Triple& place) {
  const LatticePlace at(sizes, place);
  const auto through = [&](Int i) {
    const Float near = hn::GatherIndex(kFloat, depths, i),
                far = hn::GatherIndex(kFloat, depths, hn::Add(i, at.step[2]));
    return exp_negative(hn::Max(mix(at.t[2], near, far), constant(0.0f)));
  };
  const auto edge = [&](Int i) { return mix(at.t[0], through(i), through(hn::Add(i, at.step[0]))); };
  return mix(at.t[1], edge(at.node), edge(hn::Add(at.node, at.step[1])));
}

/// Four floats at each point of a lattice, trilinear in between, clamped outside.
HWY_INLINE Record look_up_records(const float* records, const std::int32_t sizes[3], const Triple& place) {
  const LatticePlace at(sizes, place);
  const auto mixed = [](Float f, const Record& a, const Record& b) {
    return Record{mix(f, a.x, b.x), mix(f, a.y, b.y), mix(f, a.z, b.z), mix(f, a.w, b.w)};
  };
  const auto load = [&](Int i) { return load_table_records(records, hn::BitCast(kUint, i)); };
  const auto edge = [&](Int i) { return mixed(at.t[0], load(i), load(hn::Add(i, at.step[0]))); };
  const auto square = [&](Int i) { return mixed(at.t[1], edge(i), edge(hn::Add(i, at.step[1]))); };
  return mixed(at.t[2], square(at.node), square(hn::Add(at.node, at.step[2])));
}

/// What a place is lit with: the colour that is emitted there is multiplied by `diffuse`, and `specular` is added to
/// it.
struct Illumination {
  Triple diffuse, specular;
};

/// A place that is to be lit. Camera frame.
struct ShadedPlace {
  Triple position;
  Triple gradient;  ///< stored scalars a local length
  Triple to_eye;    ///< unit vector
  Mask lanes;       ///< those that want light
  bool is_surface;  ///< lit in full strength, and moved off itself before shadows are looked up
};

/// What rays from a light find that end at places, one by one.
HWY_NOINLINE inline Float trace_rays(const LightSource& light, const Triple& place, Mask lanes) {
  HWY_ALIGN float x[kLanes], y[kLanes], z[kLanes], wanted[kLanes], through[kLanes];
  hn::Store(place.x, kFloat, x);
  hn::Store(place.y, kFloat, y);
  hn::Store(place.z, kFloat, z);
  hn::Store(hn::IfThenElseZero(lanes, constant(1.0f)), kFloat, wanted);
  for (std::size_t i = 0; i < kLanes; ++i) {
    const float at[3] = {x[i], y[i], z[i]};
    through[i] = wanted[i] != 0.0f ? light.trace_ray(light.ray_context, at) : 1.0f;
  }
  return hn::Load(kFloat, through);
}

/// Part of the light of a source that reaches a place. `lanes`: where it matters.
HWY_INLINE Float find_visibility(const Shading& shading, const LightSource& light, const ShadedPlace& place,
                                 const Triple& normal, const Triple& to_light, Mask lanes) {
  Triple from = place.position;
  if (place.is_surface) {
    // Off the surface, to the side that the light comes from.
    const Float bias = constant(light.trace_ray ? shading.ray_bias : shading.shadow_bias);
    const Float side = hn::CopySign(bias, dot(normal, to_light));
    from = sum_of(from, sum_of(scaled(normal, side), scaled(to_light, bias)));
  }
  if (light.trace_ray) return trace_rays(light, from, lanes);
  Float through = constant(1.0f);
  for (const ShadowMap& map : light.shadows) {
    Triple q = transform(map.light_from_camera, 4, from);
    Mask here = lanes;
    if (map.is_perspective) {
      // The face of the cube that the place is seen through.
      const Float reach = hn::Max(hn::Abs(q.x), hn::Abs(q.y));
      here = hn::And(hn::Gt(q.z, constant(0.0f)), hn::Ge(q.z, reach));
      const Float inverse = hn::Div(constant(1.0f), hn::Max(q.z, constant(1e-20f)));
      q.x = hn::Mul(q.x, inverse);
      q.y = hn::Mul(q.y, inverse);
    }
    if (hn::AllFalse(kFloat, here)) continue;
    const Triple at{multiply_add(q.x, constant(map.scale[0]), constant(map.offset[0])),
                    multiply_add(q.y, constant(map.scale[1]), constant(map.offset[1])),
                    multiply_add(q.z, constant(map.scale[2]), constant(map.offset[2]))};
    through = hn::IfThenElse(here, look_up_transmittance(map.depths, map.sizes, at), through);
  }
  return through;
}

/// Part of the surroundings that lights the side that `normal` points to: mean and first moments over all directions,
/// weighted by the cosine (the first two bands of spherical harmonics; Ramamoorthi and Hanrahan 2001).
HWY_INLINE Float find_openness(const OcclusionMap& map, const Triple& position, const Triple& normal, Float strength) {
  const Record seen = look_up_records(map.visibility, map.sizes, transform(map.lattice_from_camera, 4, position));
  const Float towards = dot({seen.x, seen.y, seen.z}, transform(map.world_from_camera, 3, normal));
  const Float open = multiply_add(hn::Mul(constant(2.0f), strength), towards, seen.w);
  return hn::Min(hn::Max(open, constant(0.0f)), constant(1.0f));
}

/// Whether the light comes from the eye alone, so that `illuminate_from_eye` serves.
inline bool is_lit_from_eye(const Shading& shading) {
  return shading.lights.size() == 1 && shading.lights[0].kind == LightSource::Kind::kHeadlight &&
         shading.is_two_sided && !shading.occlusion && !shading.environment && !shading.lights[0].has_shadows();
}

/// How the eye's own light falls on a place, whatever its colour: diffuse, from 0 to 1; and specular.
struct EyeLight {
  Float diffuse, shine;
};

/// `square`: of the gradient; `along_square`: of its part along the view.
HWY_INLINE EyeLight light_from_eye(const Shading& shading, Float square, Float along_square) {
  const Float one = constant(1.0f), tiny = constant(1e-30f);
  const Float cosine_square = hn::Min(hn::Div(along_square, hn::Max(square, tiny)), one);
  const Float strength = hn::Div(square, hn::Max(hn::Add(square, constant(shading.half_strength)), tiny));
  const Float cosine = hn::Sqrt(cosine_square);
  const Float shine = power_of_cosine(cosine, cosine_square, shading.shininess);
  return {multiply_add(strength, hn::Sub(cosine, one), one),
          hn::Mul(hn::Mul(strength, constant(shading.specular)), shine)};
}

HWY_INLINE Illumination colored(const Shading& shading, const EyeLight& light) {
  const Float ambient = constant(shading.ambient), diffuse = hn::Mul(constant(shading.diffuse), light.diffuse);
  const float* color = shading.lights[0].color;
  const auto lit = [&](int i) { return multiply_add(constant(color[i]), diffuse, ambient); };
  const auto shines = [&](int i) { return hn::Mul(constant(color[i]), light.shine); };
  return {{lit(0), lit(1), lit(2)}, {shines(0), shines(1), shines(2)}};
}

/// `illuminate` for that: normal, view and light meet in one cosine, and nothing need be normalised.
HWY_INLINE Illumination illuminate_from_eye(const Shading& shading, const Triple& gradient, const Triple& direction) {
  const Float along = dot(gradient, direction);
  const Float along_square = hn::Div(hn::Mul(along, along), dot(direction, direction));
  return colored(shading, light_from_eye(shading, dot(gradient, gradient), along_square));
}

/// The light at a place. Where the gradient is weak, what needs no normal takes the place of what does.
HWY_NOINLINE inline Illumination illuminate(const Shading& shading, const ShadedPlace& place) {
  const Float zero = constant(0.0f), one = constant(1.0f);
  // The normal points to where the field falls; of the two sides, to the eye's.
  const Float square = dot(place.gradient, place.gradient);
  const Float inverse = hn::Neg(hn::Div(one, hn::Sqrt(hn::Max(square, constant(1e-30f)))));
  const Triple outward = scaled(place.gradient, inverse);
  const Mask turned = hn::Lt(dot(outward, place.to_eye), zero);
  const Triple normal = scaled(outward, shading.is_two_sided ? hn::IfThenElse(turned, constant(-1.0f), one) : one);
  Float strength = hn::Div(square, hn::Max(hn::Add(square, constant(shading.half_strength)), constant(1e-30f)));
  if (place.is_surface) strength = hn::IfThenElseZero(hn::Gt(square, constant(1e-30f)), one);
  const Float weakness = hn::Sub(one, strength);

  Float openness = one;
  if (shading.occlusion) {
    const Float off = constant(place.is_surface ? shading.shadow_bias : 0.0f);
    openness = find_openness(*shading.occlusion, sum_of(place.position, scaled(normal, off)), normal, strength);
  }
  const Float ambient = hn::Mul(constant(shading.ambient), openness);
  Illumination light{{ambient, ambient, ambient}, {zero, zero, zero}};
  for (const LightSource& source : shading.lights) {
    Triple to_light = place.to_eye;
    if (source.kind == LightSource::Kind::kDirectional) to_light = constant_triple(source.vector);
    if (source.kind == LightSource::Kind::kPoint)
      to_light = normalized(sum_of(constant_triple(source.vector), scaled(place.position, constant(-1.0f))));
    const bool is_headlight = source.kind == LightSource::Kind::kHeadlight;
    const Triple half = is_headlight ? to_light : normalized(sum_of(to_light, place.to_eye));
    const auto facing = [&](Float cosine) { return shading.is_two_sided ? hn::Abs(cosine) : hn::Max(cosine, zero); };
    const Float cosine = dot(normal, to_light);
    const Float diffuse = multiply_add(strength, facing(cosine), weakness);
    const Float shine = power(hn::Min(facing(dot(normal, half)), one), shading.shininess);
    Float specular = hn::Mul(strength, hn::Mul(constant(shading.specular), shine));
    if (!shading.is_two_sided) specular = hn::IfThenElseZero(hn::Gt(cosine, zero), specular);
    Float reaching = one;
    if (source.has_shadows()) {
      const Mask lit = hn::Or(hn::Gt(diffuse, zero), hn::Gt(specular, zero));
      reaching = find_visibility(shading, source, place, normal, to_light, hn::And(place.lanes, lit));
    }
    const Triple color = scaled(constant_triple(source.color), reaching);
    light.diffuse = sum_of(light.diffuse, scaled(color, hn::Mul(constant(shading.diffuse), diffuse)));
    light.specular = sum_of(light.specular, scaled(color, specular));
  }
  if (shading.environment) {
    const Surroundings around = find_surroundings(*shading.environment, normal, place.to_eye, strength);
    Float specular = constant(shading.specular);
    if (!shading.is_two_sided) specular = hn::IfThenZeroElse(turned, specular);  // what is seen mirrors nothing
    light.diffuse = sum_of(light.diffuse, scaled(around.diffuse, hn::Mul(constant(shading.diffuse), openness)));
    light.specular = sum_of(light.specular, scaled(around.specular, specular));
  }
  return light;
}

}  // namespace HWY_NAMESPACE
}  // namespace tetravox::cpu
HWY_AFTER_NAMESPACE();

#endif
