// Where on a stretch light is looked up, and what is lit there.
//
// A stretch that emits with mean m and variance v is lit as at two places that have both: what is quadratic along the
// ray is exact. Where that does not do, it is cut.

#if defined(TETRAVOX_CPU_LIT_PLACES_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef TETRAVOX_CPU_LIT_PLACES_INL
#undef TETRAVOX_CPU_LIT_PLACES_INL
#else
#define TETRAVOX_CPU_LIT_PLACES_INL
#endif

#include "src/cpu/kernels/effects.h"
#include "src/cpu/kernels/segments-inl.h"
#include "src/cpu/kernels/shading-inl.h"
#include "src/cpu/kernels/stretches-inl.h"
#include "src/cpu/kernels/vector_math-inl.h"

HWY_BEFORE_NAMESPACE();
namespace tetravox::cpu {
namespace HWY_NAMESPACE {

/// Where pieces absorb: sums of what they absorb times where that is, and times its square; changes of colour.
struct Emission {
  Float moment, second, tint, unevenness;

  /// The whole of them, of which `absorbed` is the sum.
  HWY_INLINE Spread spread(Float absorbed) const {
    const Float share = hn::Div(constant(1.0f), hn::Max(absorbed, constant(1e-30f)));
    const Float mean = hn::Mul(moment, share);
    const Float variance = hn::Sub(hn::Mul(second, share), hn::Mul(mean, mean));
    return {mean, hn::Max(variance, constant(0.0f)), hn::Min(tint, constant(1.0f)), unevenness};
  }
};

/// Adds what a linear piece between two cuts absorbs to `emission`; transmittance goes from `before` to `after`.
HWY_INLINE void note_emission(const Effects& effects, const Segments& segment, const Cut& a, const Cut& b, Float before,
                              Float after, Emission& emission) {
  const Float part = hn::Max(hn::Sub(b.u, a.u), constant(0.0f)), absorbed = hn::Sub(before, after);
  const Mask is_bright = hn::Gt(absorbed, constant(effects.faint));
  Spread inside{constant(0.5f), constant(1.0f / 12.0f), constant(0.0f), constant(0.0f)};
  if (!hn::AllFalse(kFloat, is_bright)) {
    const Float opacity = hn::Div(absorbed, hn::Max(before, constant(1e-30f)));
    const Spread found = find_emission(effects.centroid, segment, opacity);
    inside = {hn::IfThenElse(is_bright, found.center, inside.center),
              hn::IfThenElse(is_bright, found.variance, inside.variance), hn::IfThenElseZero(is_bright, found.tint),
              hn::IfThenElseZero(is_bright, found.unevenness)};
  }
  const Float place = multiply_add(inside.center, part, a.u), moment = hn::Mul(absorbed, place);
  const Float variance = hn::Mul(inside.variance, hn::Mul(part, part));
  emission.moment = hn::Add(emission.moment, moment);
  emission.second = hn::Add(emission.second, multiply_add(moment, place, hn::Mul(absorbed, variance)));
  emission.tint = hn::Add(emission.tint, inside.tint);
  emission.unevenness = hn::Max(emission.unevenness, inside.unevenness);
}

/// Where light is looked up between two cuts: at two places that, weighted, have mean and variance of the emission,
/// so that what is quadratic along the ray is exact. They are one where that serves.
struct LitPlaces {
  Float near, far, far_weight;
  bool are_one;
};
HWY_INLINE LitPlaces find_lit_places(const Effects& effects, const Cut& begin, const Cut& end, const Spread& emission,
                                     Mask bright, Float absorbed) {
  const Float zero = constant(0.0f), tiny = constant(1e-6f);
  const Float center = hn::Min(hn::Max(emission.center, begin.u), end.u);
  const Mask apart = hn::And(bright, hn::Gt(absorbed, constant(effects.lit_once)));
  if (hn::AllFalse(kFloat, apart)) return {center, center, zero, true};
  // As far apart as the deviation, on either side; where an end is nearer, the other place is farther.
  const Float deviation = hn::IfThenElseZero(apart, hn::Sqrt(emission.variance));
  const Float to_begin = hn::Max(hn::Sub(center, begin.u), tiny), to_end = hn::Max(hn::Sub(end.u, center), tiny);
  Float before = deviation, after = deviation, weight = constant(0.5f);
  const Mask is_near_end = hn::Gt(deviation, hn::Min(to_begin, to_end));
  if (!hn::AllFalse(kFloat, is_near_end)) {
    const Float square = hn::Mul(deviation, deviation);
    const Float shorter = hn::Min(hn::Max(deviation, hn::Div(square, to_end)), to_begin);
    const Float longer = hn::Min(hn::Max(deviation, hn::Div(square, to_begin)), to_end);
    before = hn::IfThenElse(is_near_end, shorter, deviation);
    after = hn::IfThenElse(is_near_end, longer, deviation);
    weight = hn::IfThenElse(is_near_end, hn::Div(before, hn::Max(hn::Add(before, after), tiny)), weight);
  }
  return {hn::Max(hn::Sub(center, before), begin.u), hn::Min(hn::Add(center, after), end.u), weight, false};
}

/// How many parts a stretch is to be lit in that has these gradients at its two places. Light errs in proportion to the
/// fourth power of the angle between the two normals, where emission is uneven to the third, and where the colour
/// changes too to the angle itself. That is no more than the change of the gradient over its least length (where it
/// is weak, light does without it).
HWY_INLINE Float count_lit_parts(const Effects& effects, const Triple& near, const Triple& far, const Spread& emission,
                                 Float absorbed) {
  constexpr float kMostParts = 64.0f;
  const Float one = constant(1.0f), tiny = constant(1e-30f);
  const Triple change{hn::Sub(far.x, near.x), hn::Sub(far.y, near.y), hn::Sub(far.z, near.z)};
  const Float square = dot(change, change);
  const Float nearest = hn::Div(hn::Neg(dot(near, change)), hn::Max(square, tiny));
  // The two places are not the ends: the gradient may be weaker a little beyond them.
  const Triple least = mix(hn::Min(hn::Max(nearest, constant(-0.5f)), constant(1.5f)), near, far);
  const Float weakest = hn::Max(hn::Add(dot(least, least), constant(effects.shading->half_strength)),
                                hn::Max(hn::Mul(constant(1e-3f), square), tiny));
  const Float turned = hn::Div(square, weakest), angle = hn::Sqrt(turned);
  const LightChange& change_of = effects.light_change;
  const Float tinted = hn::Mul(constant(change_of.first), hn::Mul(emission.tint, angle));
  const Float skewed = hn::Mul(constant(change_of.third), hn::Mul(emission.unevenness, hn::Mul(angle, turned)));
  const Float bent = hn::Mul(hn::Mul(absorbed, constant(change_of.fourth)), hn::Mul(turned, turned));
  const Float quadratic = hn::Mul(absorbed, hn::Max(tinted, skewed));
  const Float wanted = hn::Sqrt(hn::Max(quadratic, hn::Sqrt(bent)));
  return hn::Min(hn::Max(hn::Ceil(wanted), one), constant(kMostParts));
}

HWY_INLINE Illumination mix(Float t, const Illumination& a, const Illumination& b) {
  return {mix(t, a.diffuse, b.diffuse), mix(t, a.specular, b.specular)};
}

/// Adds what has been gathered on a part of a stretch in this light.
HWY_INLINE void add_lit(const Effects& effects, const Illumination& light, Mask bright, const Accumulated& part,
                        Accumulated& sum) {
  const Float absorbed = hn::Sub(sum.transmittance, part.transmittance), usual = constant(effects.usual_light);
  const auto lit = [&](Float color, Float by, Float more) {
    return hn::IfThenElse(bright, multiply_add(absorbed, more, hn::Mul(color, by)), hn::Mul(color, usual));
  };
  sum.red = hn::Add(sum.red, lit(part.red, light.diffuse.x, light.specular.x));
  sum.green = hn::Add(sum.green, lit(part.green, light.diffuse.y, light.specular.y));
  sum.blue = hn::Add(sum.blue, lit(part.blue, light.diffuse.z, light.specular.z));
  sum.transmittance = part.transmittance;
}

}  // namespace HWY_NAMESPACE
}  // namespace tetravox::cpu
HWY_AFTER_NAMESPACE();

#endif
