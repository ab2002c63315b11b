// Light on packets of rays at a fixed rate: a step is lit where its emission lies.
//
// Few steps are bright enough for a normal. Those of a run are put side by side, so that vectors are full.

#if defined(TETRAVOX_CPU_PACKET_LIGHT_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef TETRAVOX_CPU_PACKET_LIGHT_INL
#undef TETRAVOX_CPU_PACKET_LIGHT_INL
#else
#define TETRAVOX_CPU_PACKET_LIGHT_INL
#endif

#include "src/cpu/kernels/kernels.h"
#include "src/cpu/kernels/segments-inl.h"
#include "src/cpu/kernels/shading-inl.h"
#include "src/cpu/kernels/stretches-inl.h"
#include "src/cpu/kernels/value_sampler-inl.h"
#include "src/cpu/kernels/vector_math-inl.h"

#include <cstddef>
#include <cstdint>

HWY_BEFORE_NAMESPACE();
namespace tetravox::cpu {
namespace HWY_NAMESPACE {

/// Where a vector of rays goes.
struct RayCourse {
  Float origin[3], direction[3];  // index coordinates of the values; for one unit of depth
  RayView view;                   // camera frame
  Float per_square;               // 1 / square of the direction there
};

/// Up to `kSteps` steps of a vector of rays, and the light on them.
template <class T, class Integrator, int kSteps>
class LitSteps {
 public:
  LitSteps(const PacketJob& job, const Integrator& integrator, const ValueSampler<T>& sampler)
      : job_(job),
        integrator_(integrator),
        sampler_(sampler),
        effects_(*job.tables->effects),
        is_lit_from_eye_(is_lit_from_eye(*effects_.shading)) {}

  void begin_run() { count_ = waiting_ = 0; }

  /// Adds the next step: between two depths, `part` what it adds to the rays, whose transmittance was `before`.
  HWY_INLINE void add(const Segments& segment, Float z_front, Float z_back, const Accumulated& part, Float before) {
    const Float absorbed = hn::Sub(before, part.transmittance), faintly = constant(effects_.usual_light);
    const Mask is_bright = hn::Gt(absorbed, constant(job_.faint));
    const std::size_t slot = count_ * kLanes;
    hn::Store(hn::Mul(part.red, faintly), kFloat, lit_[0] + slot);
    hn::Store(hn::Mul(part.green, faintly), kFloat, lit_[1] + slot);
    hn::Store(hn::Mul(part.blue, faintly), kFloat, lit_[2] + slot);
    ++count_;
    if (hn::AllFalse(kFloat, is_bright)) return;
    const Int slots = hn::Iota(kInt, static_cast<std::int32_t>(slot));
    hn::StoreU(hn::Compress(slots, int_mask(is_bright)), kInt, slots_ + waiting_);
    const auto keep = [&](Value which, Float value) {
      hn::StoreU(hn::Compress(value, is_bright), kFloat, waiting_values_[which] + waiting_);
    };
    keep(kFront, segment.scalar_front);
    keep(kBack, segment.scalar_back);
    keep(kZFront, z_front);
    keep(kZBack, z_back);
    keep(kRed, part.red);
    keep(kGreen, part.green);
    keep(kBlue, part.blue);
    if constexpr (!kKnowsCenters) keep(kBefore, before);
    keep(kAbsorbed, absorbed);
    waiting_ += hn::CountTrue(kFloat, is_bright);
  }

  /// Adds the steps, lit, to the colours of `sum`.
  HWY_INLINE void composite(const RayCourse& course, Accumulated& sum) {
    for (std::size_t first = 0; first < waiting_; first += kLanes) light(course, first);
    for (std::size_t i = 0; i < waiting_; ++i)
      for (int color = 0; color < 3; ++color) lit_[color][slots_[i]] = waiting_values_[kRed + color][i];
    for (std::size_t slot = 0; slot < count_ * kLanes; slot += kLanes) {
      sum.red = hn::Add(sum.red, hn::Load(kFloat, lit_[0] + slot));
      sum.green = hn::Add(sum.green, hn::Load(kFloat, lit_[1] + slot));
      sum.blue = hn::Add(sum.blue, hn::Load(kFloat, lit_[2] + slot));
    }
  }

 private:
  /// Whether the integrator knows where a step is seen, from 0 in front to 1 behind.
  static constexpr bool kKnowsCenters = requires(const Integrator& integrator, Float scalar) {
    integrator.find_center(scalar, scalar);
  };
  enum Value { kFront, kBack, kZFront, kZBack, kRed, kGreen, kBlue, kBefore, kAbsorbed, kValues };
  static constexpr std::size_t kMost = kSteps * kLanes;

  /// Those that wait from number `first` on, as many as a vector holds.
  HWY_NOINLINE void light(const RayCourse& course, std::size_t first) {
    const auto value = [&](Value which) { return hn::LoadU(kFloat, waiting_values_[which] + first); };
    const Mask wanted = hn::FirstN(kFloat, waiting_ - first);
    const Int lane = hn::And(hn::LoadU(kInt, slots_ + first), hn::Set(kInt, static_cast<std::int32_t>(kLanes) - 1));
    const auto ray = hn::IndicesFromVec(kFloat, lane);
    const auto of_ray = [&](Float values) { return hn::TableLookupLanes(values, ray); };

    const Float absorbed = value(kAbsorbed);
    Float center;
    if constexpr (kKnowsCenters) {
      center = integrator_.find_center(value(kFront), value(kBack));
    } else {
      const Float opacity = hn::Div(absorbed, hn::Max(value(kBefore), constant(1e-30f)));
      center = find_emission(effects_.centroid, {value(kFront), value(kBack), constant(0.0f)}, opacity).center;
    }
    const Float depth = mix(center, value(kZFront), value(kZBack));
    Float at[3];
    for (int axis = 0; axis < 3; ++axis)
      at[axis] = multiply_add(of_ray(course.direction[axis]), depth, of_ray(course.origin[axis]));
    const Triple gradient = transform(effects_.camera_from_gradient, 3, find_gradient(at));
    const RayView view{of_ray(course.view.x_offset), of_ray(course.view.x_slope), of_ray(course.view.y_offset),
                       of_ray(course.view.y_slope)};
    Illumination light;
    if (is_lit_from_eye_) {
      const Float along = dot(gradient, view.direction());
      const Float along_square = hn::Mul(hn::Mul(along, along), of_ray(course.per_square));
      light = colored(*effects_.shading, light_from_eye(*effects_.shading, dot(gradient, gradient), along_square));
    } else {
      light = illuminate(*effects_.shading, {view.position(depth), gradient, view.to_eye(), wanted, false});
    }
    const auto store_lit = [&](Value color, Float diffuse, Float specular) {
      const Float lit = multiply_add(absorbed, specular, hn::Mul(value(color), diffuse));
      hn::StoreU(lit, kFloat, waiting_values_[color] + first);
    };
    store_lit(kRed, light.diffuse.x, light.specular.x);
    store_lit(kGreen, light.diffuse.y, light.specular.y);
    store_lit(kBlue, light.diffuse.z, light.specular.z);
  }

  /// Stored scalars a value's distance.
  HWY_INLINE Triple find_gradient(const Float at[3]) const {
    const Triple gradient =
        job_.has_central_gradients ? sampler_.eval_central_differences(at) : sampler_.eval_slope(at);
    return scaled(gradient, constant(job_.stored_per_scalar));
  }

  const PacketJob& job_;
  const Integrator& integrator_;
  const ValueSampler<T>& sampler_;
  const Effects& effects_;
  bool is_lit_from_eye_;
  std::size_t count_ = 0, waiting_ = 0;
  HWY_ALIGN float lit_[3][kMost];  // colours, [step][lane]
  // Steps bright enough for a normal, one after the other: where in `lit_` they belong, and what is known of them; once
  // they are lit, their colours. Vectors may be stored beyond the last one.
  HWY_ALIGN std::int32_t slots_[kMost + kLanes] = {};
  HWY_ALIGN float waiting_values_[kValues][kMost + kLanes] = {};
};

}  // namespace HWY_NAMESPACE
}  // namespace tetravox::cpu
HWY_AFTER_NAMESPACE();

#endif
