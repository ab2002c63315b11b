// What is drawn beside emission and absorption: light, iso-surfaces, weights, depths; the same for every source and
// every integrator.

#if defined(TETRAVOX_CPU_EFFECTS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef TETRAVOX_CPU_EFFECTS_INL
#undef TETRAVOX_CPU_EFFECTS_INL
#else
#define TETRAVOX_CPU_EFFECTS_INL
#endif

#include "src/cpu/kernels/effects.h"
#include "src/cpu/kernels/followed_light-inl.h"
#include "src/cpu/kernels/kernels.h"
#include "src/cpu/kernels/lit_places-inl.h"
#include "src/cpu/kernels/segments-inl.h"
#include "src/cpu/kernels/shading-inl.h"
#include "src/cpu/kernels/stretches-inl.h"
#include "src/cpu/kernels/vector_math-inl.h"
#include "src/cpu/kernels/volume_pieces-inl.h"

#include <limits>
#include <type_traits>

HWY_BEFORE_NAMESPACE();
namespace tetravox::cpu {
namespace HWY_NAMESPACE {

/// Wraps an integrator: cuts stretches at surfaces, lights what it returns, weighs extinction.
template <class Base>
class EffectIntegrator {
 public:
  using Front = typename Base::Front;
  /// Whether the integrator asks stretches for more than the scalar (domain-inl.h).
  static constexpr bool kIsOfDomain = PieceIntegrator<Base>::kIsOfDomain;

  explicit EffectIntegrator(const IntegratorTables& tables)
      : pieces_(tables),
        effects_(*tables.effects),
        is_light_cut_(effects_.longest_lit > 0.0f || effects_.largest_lit > 0.0f),
        wants_faces_(kIsOfDomain || effects_.shading || effects_.weight_by_gradient > 0.0f),
        is_plain_(!kIsOfDomain && !is_light_cut_ && !pieces_.is_weighted() && !effects_.depth && !effects_.record),
        is_light_all_(is_plain_ && effects_.shading),
        is_lit_from_eye_(effects_.shading && is_lit_from_eye(*effects_.shading)) {}

  HWY_INLINE Front front_at(Float scalar) const { return base().front_at(scalar); }
  static HWY_INLINE void replace_front(Mask mask, const Front& from, Front& to) { Base::replace_front(mask, from, to); }

  /// Whether stretches are asked for more than the scalar along them.
  HWY_INLINE bool wants_faces() const { return wants_faces_; }

  /// Whether a linear stretch is all volume, and unlit: then `integrate_volume_segment` serves.
  HWY_INLINE bool is_volume_all(const Segments& segment) const {
    return is_plain_ && !effects_.shading && !meets_surface(effects_, segment);
  }

  /// A whole linear stretch, to the bit what `integrate_stretch` finds.
  HWY_INLINE void integrate_volume_segment(const Segments& segment, Front& front, Accumulated& sum) const {
    if constexpr (!kIsOfDomain) base().integrate(segment, front, sum);
  }

  /// Whether linear stretches without surfaces need light, and nothing else: then `integrate_lit_segment` serves.
  HWY_INLINE bool is_light_all(const Segments& segment) const {
    return is_light_all_ && (HWY_LIKELY(effects_.surfaces.empty()) || !meets_surface(effects_, segment));
  }

  /// Whether `integrate_followed_segment` serves where `is_light_all` says that light is all.
  /// A vector with other segments among them would be lit as a whole in another way: there must be none in the frame,
  /// or pictures would depend on the instruction set.
  HWY_INLINE bool is_light_followed() const { return is_light_all_ && is_lit_from_eye_ && effects_.is_whole; }

  /// A whole linear stretch, with the light of the eye at its faces. `pass()` finds them, `lose()` says that nobody
  /// did.
  template <class Pass, class Lose, class MakeStretch, class MakeRay>
  HWY_INLINE void integrate_followed_segment(const Segments& segment, const Pass& pass, const Lose& lose,
                                             const MakeStretch& make_stretch, const MakeRay& make_ray, Front& front,
                                             Accumulated& sum) const {
    if constexpr (!kIsOfDomain) {
      const Float zero = constant(0.0f), half = constant(0.5f);
      Accumulated part{zero, zero, zero, sum.transmittance};
      base().integrate(segment, front, part);
      const Float absorbed = hn::Sub(sum.transmittance, part.transmittance);
      const Mask bright = hn::Gt(absorbed, constant(effects_.faint));
      if (hn::AllFalse(kFloat, bright)) {
        lose();
        add_in_light(part, effects_.usual_light, sum);  // too faint for a normal
        return;
      }
      const FollowedLight& followed = pass();
      const LitFace &near = followed.front(), &far = followed.back();
      const Mask uneven = hn::AndNot(is_light_even(effects_, near, far, absorbed), bright);
      const EyeLight mean{hn::Mul(half, hn::Add(near.light.diffuse, far.light.diffuse)),
                          hn::Mul(half, hn::Add(near.light.shine, far.light.shine))};
      Accumulated lit = sum;
      add_lit(effects_, colored(*effects_.shading, mean), bright, part, lit);
      if (HWY_UNLIKELY(!hn::AllFalse(kFloat, uneven)))
        light_uneven(segment, make_stretch(), make_ray(), uneven, part, sum, lit);
      sum = lit;
    }
  }

  /// A whole linear stretch. It is only made where it needs light.
  template <class MakeStretch, class MakeRay>
  HWY_INLINE void integrate_lit_segment(const Segments& segment, const MakeStretch& make_stretch,
                                        const MakeRay& make_ray, Front& front, Accumulated& sum) const {
    if constexpr (!kIsOfDomain) {
      const Float zero = constant(0.0f);
      Accumulated part{zero, zero, zero, sum.transmittance};
      base().integrate(segment, front, part);
      const Float absorbed = hn::Sub(sum.transmittance, part.transmittance);
      const Mask bright = hn::Gt(absorbed, constant(effects_.faint));
      if (hn::AllFalse(kFloat, bright)) {
        add_in_light(part, effects_.usual_light, sum);  // too faint for a normal
        return;
      }
      const auto stretch = make_stretch();
      const RayView ray = make_ray();
      Float unused = constant(0.0f);
      const Walk<Front, std::remove_const_t<decltype(stretch)>> walk{stretch, ray, front, sum, unused};
      const Cut begin{zero, segment.scalar_front}, end{constant(1.0f), segment.scalar_back};
      // To the bit what `gather` finds: a ray must not depend on those beside it, which may be cut.
      Emission emission{zero, zero, zero, zero};
      note_emission(effects_, segment, begin, end, sum.transmittance, part.transmittance, emission);
      light(walk, begin, end, emission.spread(absorbed), bright, part);
    }
  }

  /// The part of a stretch from `from` to `to`. `front`: at `from`; becomes that at `to`. `depth`: see
  /// `Effects::depth`.
  template <class Stretch>
  HWY_NOINLINE void integrate_stretch(const Stretch& stretch, const RayView& ray, Float from, Float to, Front& front,
                                      Accumulated& sum, Float& depth) const {
    const Cut begin = cut_at(stretch, from), end = cut_at(stretch, to);
    const Walk<Front, Stretch> walk{stretch, ray, front, sum, depth};
    if (HWY_UNLIKELY(meets_surface(effects_, stretch, begin, end)))
      pass_surfaces(walk, begin, end);
    else
      integrate_volume(walk, begin, end);
  }

 private:
  // ---- surfaces ----

  /// Draws what lies between two cuts, surfaces and volume in turns. Between its extrema the scalar is monotone, so
  /// that a ray meets surfaces in the order of their values.
  template <class Stretch>
  HWY_NOINLINE void pass_surfaces(const Walk<Front, Stretch>& walk, const Cut& begin, const Cut& end) const {
    const Stretch& stretch = walk.stretch;
    constexpr int kParts = Stretch::kIsLinear ? 1 : 3;
    Cut borders[kParts + 1];
    borders[0] = begin;
    borders[kParts] = end;
    if constexpr (!Stretch::kIsLinear) {
      Float extrema[2];
      stretch.find_extrema(extrema);
      for (int i = 0; i < 2; ++i) borders[i + 1] = cut_at(stretch, hn::Min(hn::Max(extrema[i], begin.u), end.u));
      // A cut at an end is that end, to the bit: both sides of a face must agree on what is met.
      for (int i = 1; i < kParts; ++i) {
        const Mask is_begin = hn::Le(borders[i].u, begin.u), is_end = hn::Ge(borders[i].u, end.u);
        borders[i].scalar =
            hn::IfThenElse(is_begin, begin.scalar, hn::IfThenElse(is_end, end.scalar, borders[i].scalar));
      }
    }
    Cut at = begin;
    const std::size_t count = effects_.surfaces.size();
    for (int part = 0; part < kParts; ++part) {
      const Cut &a = borders[part], &b = borders[part + 1];
      const Mask rising = hn::Ge(b.scalar, a.scalar);
      for (std::size_t i = 0; i < count; ++i) {
        const SurfaceSheet &up = effects_.surfaces[i], &down = effects_.surfaces[count - 1 - i];
        const Float value = hn::IfThenElse(rising, constant(up.value), constant(down.value));
        const Mask before = hn::Lt(a.scalar, value), after = hn::Lt(b.scalar, value);
        const Mask met = hn::And(hn::Xor(before, after), hn::Gt(stretch.length, constant(0.0f)));
        if (hn::AllFalse(kFloat, met)) continue;
        const Float u = hn::Max(find_crossing(stretch, a, b, value), at.u);
        const Cut here{hn::IfThenElse(met, u, at.u), hn::IfThenElse(met, value, at.scalar)};
        integrate_volume(walk, at, here);
        composite_surface(walk, here, met, rising, up, down);
        at = here;
      }
    }
    integrate_volume(walk, at, end);
  }

  /// Lays a sheet over what has been gathered, on the lanes of `met`: `up` where the scalar rises along the ray, `down`
  /// where it falls.
  template <class Stretch>
  HWY_INLINE void composite_surface(const Walk<Front, Stretch>& walk, const Cut& here, Mask met, Mask rising,
                                    const SurfaceSheet& up, const SurfaceSheet& down) const {
    const auto opacity_of = [](const SurfaceSheet& sheet, bool is_front) {
      return constant(is_front || sheet.is_two_sided ? sheet.opacity : 0.0f);
    };
    const Float opacity = hn::IfThenElse(rising, opacity_of(up, true), opacity_of(down, false));
    const auto channel = [&](int i) {
      return hn::IfThenElse(rising, constant(up.front_color[i]), constant(down.back_color[i]));
    };
    Triple color{channel(0), channel(1), channel(2)};
    const Mask seen = hn::And(met, hn::Gt(opacity, constant(0.0f)));
    Accumulated& sum = walk.sum;
    if (effects_.shading) {
      const Illumination light = light_at(walk, here.u, hn::And(seen, hn::Gt(sum.transmittance, constant(0.0f))), true);
      color = {multiply_add(color.x, light.diffuse.x, light.specular.x),
               multiply_add(color.y, light.diffuse.y, light.specular.y),
               multiply_add(color.z, light.diffuse.z, light.specular.z)};
    }
    const Float covered = hn::IfThenElseZero(seen, hn::Mul(sum.transmittance, opacity));
    sum.red = multiply_add(covered, color.x, sum.red);
    sum.green = multiply_add(covered, color.y, sum.green);
    sum.blue = multiply_add(covered, color.z, sum.blue);
    sum.transmittance = hn::Sub(sum.transmittance, covered);
    const Mask first = hn::And(seen, hn::Eq(walk.depth, constant(std::numeric_limits<float>::infinity())));
    walk.depth = hn::IfThenElse(first, depth_at(walk.stretch, here.u), walk.depth);
  }

  // ---- volume ----

  template <class Stretch>
  HWY_INLINE void integrate_volume(const Walk<Front, Stretch>& walk, const Cut& begin, const Cut& end) const {
    if (!effects_.shading)
      pieces_.integrate(walk, begin, end, walk.sum, nullptr);
    else if (is_light_cut_)
      integrate_lit_parts(walk, begin, end);
    else
      integrate_lit(walk, begin, end);
  }

  /// In parts so short that the light that reaches them is about the same all along.
  template <class Stretch>
  HWY_NOINLINE void integrate_lit_parts(const Walk<Front, Stretch>& walk, const Cut& begin, const Cut& end) const {
    constexpr float kMostParts = 256.0f;
    const Float one = constant(1.0f), span = hn::Sub(end.u, begin.u);
    Float wanted = one;
    if (effects_.longest_lit > 0.0f) wanted = count_by_length(walk.stretch, walk.ray, begin, end, effects_.longest_lit);
    if (effects_.largest_lit > 0.0f)
      wanted = hn::Max(
          wanted, count_by_opacity(walk.sum.transmittance, pieces_.pass_unlit(walk, begin, end), effects_.largest_lit));
    const Float parts = hn::IfThenElse(hn::Gt(walk.stretch.length, constant(0.0f)),
                                       hn::Min(hn::Max(wanted, one), constant(kMostParts)), one);
    Cut at = begin;
    for (Float number = one;; number = hn::Add(number, one)) {
      const Mask last = hn::Ge(number, parts);
      Cut next = cut_at(walk.stretch, multiply_add(hn::Div(number, parts), span, begin.u));
      next = {hn::IfThenElse(last, end.u, next.u), hn::IfThenElse(last, end.scalar, next.scalar)};
      integrate_lit(walk, at, next);
      if (hn::AllTrue(kFloat, last)) return;
      at = next;
    }
  }

  // ---- light ----

  /// Replaces what is lit on the lanes of `uneven` by what two places and, where normals turn, parts give.
  template <class Stretch>
  HWY_NOINLINE void light_uneven(const Segments& segment, const Stretch& stretch, const RayView& ray, Mask uneven,
                                 const Accumulated& part, const Accumulated& before, Accumulated& lit) const {
    const Float zero = constant(0.0f);
    Accumulated sum = before;
    Front front = base().front_at(segment.scalar_front);
    Float unused = zero;
    const Walk<Front, Stretch> walk{stretch, ray, front, sum, unused};
    const Cut begin{zero, segment.scalar_front}, end{constant(1.0f), segment.scalar_back};
    Emission emission{zero, zero, zero, zero};
    note_emission(effects_, segment, begin, end, sum.transmittance, part.transmittance, emission);
    light(walk, begin, end, emission.spread(hn::Sub(before.transmittance, part.transmittance)), uneven, part);
    lit.red = hn::IfThenElse(uneven, sum.red, lit.red);
    lit.green = hn::IfThenElse(uneven, sum.green, lit.green);
    lit.blue = hn::IfThenElse(uneven, sum.blue, lit.blue);
  }

  template <class Stretch>
  HWY_INLINE Illumination light_at(const Walk<Front, Stretch>& walk, Float u, Mask lanes, bool is_surface) const {
    const ShadedPlace place{walk.ray.position(depth_at(walk.stretch, u)), gradient_at(effects_, walk.stretch, u),
                            walk.ray.to_eye(), lanes, is_surface};
    return illuminate(*effects_.shading, place);
  }

  /// Adds the volume between two cuts, in the light that falls where its emission is.
  template <class Stretch>
  HWY_NOINLINE void integrate_lit(const Walk<Front, Stretch>& walk, const Cut& begin, const Cut& end) const {
    const Gathered gathered = pieces_.gather(walk, begin, end);
    if (hn::AllFalse(kFloat, gathered.bright))
      add_in_light(gathered.part, effects_.usual_light, walk.sum);
    else
      light(walk, begin, end, gathered.emission.spread(gathered.absorbed), gathered.bright, gathered.part);
  }

  /// The light at a place of a stretch that has this gradient.
  template <class Stretch>
  HWY_INLINE Illumination light_of(const Walk<Front, Stretch>& walk, Float u, const Triple& gradient,
                                   Mask bright) const {
    const RayView& ray = walk.ray;
    if (is_lit_from_eye_) return illuminate_from_eye(*effects_.shading, gradient, ray.direction());
    const Triple place = ray.position(depth_at(walk.stretch, u));
    return illuminate(*effects_.shading, {place, gradient, ray.to_eye(), bright, false});
  }

  /// Adds `part`, what has been gathered between two cuts; or, where normals turn too much for two places, gathers it
  /// again in shorter parts.
  template <class Stretch>
  HWY_INLINE void light(const Walk<Front, Stretch>& walk, const Cut& begin, const Cut& end, const Spread& emission,
                        Mask bright, const Accumulated& part) const {
    const Float one = constant(1.0f), absorbed = hn::Sub(walk.sum.transmittance, part.transmittance);
    const GradientCourse<Stretch> gradients(walk.stretch, effects_.camera_from_gradient);
    const LitPlaces places = find_lit_places(effects_, begin, end, emission, bright, absorbed);
    const Triple near = gradients.at(places.near);
    if (places.are_one) return add_lit(effects_, light_of(walk, places.near, near, bright), bright, part, walk.sum);
    const Triple far = gradients.at(places.far);
    const Float count = hn::IfThenElse(bright, count_lit_parts(effects_, near, far, emission, absorbed), one);
    if (!hn::AllTrue(kFloat, hn::Le(count, one))) return integrate_turning(walk, gradients, begin, end, count);
    const Illumination light =
        mix(places.far_weight, light_of(walk, places.near, near, bright), light_of(walk, places.far, far, bright));
    add_lit(effects_, light, bright, part, walk.sum);
  }

  /// Gathers and lights a stretch in `count` equal parts.
  template <class Stretch>
  HWY_NOINLINE void integrate_turning(const Walk<Front, Stretch>& walk, const GradientCourse<Stretch>& gradients,
                                      const Cut& begin, const Cut& end, Float count) const {
    const Float one = constant(1.0f), share = hn::Div(hn::Sub(end.u, begin.u), count);
    walk.front = base().front_at(begin.scalar);
    Cut at = begin;
    for (Float number = one;; number = hn::Add(number, one)) {
      const Mask last = hn::Ge(number, count);
      Cut next = cut_at(walk.stretch, multiply_add(number, share, begin.u));
      next = {hn::IfThenElse(last, end.u, next.u), hn::IfThenElse(last, end.scalar, next.scalar)};
      const Gathered gathered = pieces_.gather(walk, at, next);
      if (hn::AllFalse(kFloat, gathered.bright)) {
        add_in_light(gathered.part, effects_.usual_light, walk.sum);
      } else {
        const Spread emission = gathered.emission.spread(gathered.absorbed);
        const LitPlaces places = find_lit_places(effects_, at, next, emission, gathered.bright, gathered.absorbed);
        Illumination light = light_of(walk, places.near, gradients.at(places.near), gathered.bright);
        if (!places.are_one)
          light = mix(places.far_weight, light, light_of(walk, places.far, gradients.at(places.far), gathered.bright));
        add_lit(effects_, light, gathered.bright, gathered.part, walk.sum);
      }
      if (hn::AllTrue(kFloat, last)) return;
      at = next;
    }
  }

  HWY_INLINE const Base& base() const { return pieces_.base(); }

  PieceIntegrator<Base> pieces_;
  const Effects& effects_;
  bool is_light_cut_, wants_faces_, is_plain_, is_light_all_, is_lit_from_eye_;
};

}  // namespace HWY_NAMESPACE
}  // namespace tetravox::cpu
HWY_AFTER_NAMESPACE();

#endif
