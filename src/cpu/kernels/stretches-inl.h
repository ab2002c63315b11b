// Stretches of rays: what effects are asked for.
//
// A source hands over stretches: what a vector of rays passes in its cells, u from 0 at the front to 1 at the back.
// A stretch offers
// - Float scalar_front, scalar_back, z_front, z_back, length: length in world units, 0 where a ray takes no part;
// - Float scalar(Float u): strictly inside;
// - Triple gradient(Float u); static constexpr bool kHasLinearGradient, and where it is: void end_gradients(Triple[2]);
// - static constexpr bool kIsLinear, and where it is not: void find_extrema(Float extrema[2]), Float bend(),
// - Float slope(Float u), Float count_pieces(from, to, transmittance): linear pieces that the tolerance asks for;
// - for functions of several variables: Float other(int axis, Float u), the scalar of another array, and where it is
//   not linear: Float other_bend(int axis).

#if defined(TETRAVOX_CPU_STRETCHES_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef TETRAVOX_CPU_STRETCHES_INL
#undef TETRAVOX_CPU_STRETCHES_INL
#else
#define TETRAVOX_CPU_STRETCHES_INL
#endif

#include "src/cpu/kernels/effects.h"
#include "src/cpu/kernels/segments-inl.h"
#include "src/cpu/kernels/shading-inl.h"
#include "src/cpu/kernels/vector_math-inl.h"

#include <cmath>
#include <limits>

HWY_BEFORE_NAMESPACE();
namespace tetravox::cpu {
namespace HWY_NAMESPACE {

/// A vector of rays in the camera frame (see scene::RayGrid), and the pixels they belong to.
struct RayView {
  Float x_offset, x_slope, y_offset, y_slope;
  const std::int32_t* pixels = nullptr;  ///< [kLanes] row * width + column

  HWY_INLINE Triple position(Float z) const {
    return {multiply_add(x_slope, z, x_offset), multiply_add(y_slope, z, y_offset), z};
  }
  HWY_INLINE Triple direction() const { return {x_slope, y_slope, constant(1.0f)}; }
  HWY_INLINE Triple to_eye() const {
    const Float minus = constant(-1.0f);
    return normalized({hn::Mul(x_slope, minus), hn::Mul(y_slope, minus), minus});
  }
};

/// Pixels of a vector of rays.
struct RayPixels {
  Int column, row;
};

/// Of rays by their numbers in the tile that has its corner there. Those beyond the picture are at its border.
HWY_INLINE RayPixels pixels_of_tile(const scene::RayGrid& grid, int column, int row, Int ray) {
  static_assert(kTileSize == 32);
  const Int x = hn::Add(hn::And(ray, hn::Set(kInt, kTileSize - 1)), hn::Set(kInt, column));
  const Int y = hn::Add(hn::ShiftRight<5>(ray), hn::Set(kInt, row));
  return {hn::Min(x, hn::Set(kInt, grid.width - 1)), hn::Min(y, hn::Set(kInt, grid.height - 1))};
}

HWY_INLINE RayView view_of(const scene::RayGrid& grid, const RayPixels& at) {
  return {hn::GatherIndex(kFloat, grid.column_offset, at.column), hn::GatherIndex(kFloat, grid.column_slope, at.column),
          hn::GatherIndex(kFloat, grid.row_offset, at.row), hn::GatherIndex(kFloat, grid.row_slope, at.row)};
}

/// A place on a stretch.
struct Cut {
  Float u, scalar;
};

template <class Stretch>
HWY_INLINE Cut cut_at(const Stretch& stretch, Float u) {
  const Float inside = stretch.scalar(u);
  const Float after = hn::IfThenElse(hn::Ge(u, constant(1.0f)), stretch.scalar_back, inside);
  return {u, hn::IfThenElse(hn::Le(u, constant(0.0f)), stretch.scalar_front, after)};
}

template <class Stretch>
HWY_INLINE Float depth_at(const Stretch& stretch, Float u) {
  return multiply_add(u, hn::Sub(stretch.z_back, stretch.z_front), stretch.z_front);
}

/// Adds a part of a ray, emission times `light`.
HWY_INLINE void add_in_light(const Accumulated& part, float light, Accumulated& sum) {
  sum.red = multiply_add(part.red, constant(light), sum.red);
  sum.green = multiply_add(part.green, constant(light), sum.green);
  sum.blue = multiply_add(part.blue, constant(light), sum.blue);
  sum.transmittance = part.transmittance;
}

/// Where transmittance passes one half, from 0 where it is `before` to 1 where it is `after`.
HWY_INLINE Float find_half(Float before, Float after) {
  const auto log = [](Float x) { return log2_positive(hn::Max(x, constant(1e-30f))); };
  const Float span = hn::Max(hn::Sub(log(before), log(after)), constant(1e-12f));
  return hn::Min(hn::Div(hn::Add(log(before), constant(1.0f)), span), constant(1.0f));
}

/// Beside missing values a gradient may be no number: then there is none.
HWY_INLINE Triple numbers_of(const Triple& gradient) {
  const Float sum = hn::Add(hn::Add(gradient.x, gradient.y), gradient.z);
  const Mask is_number = hn::Eq(sum, sum);
  return {hn::IfThenElseZero(is_number, gradient.x), hn::IfThenElseZero(is_number, gradient.y),
          hn::IfThenElseZero(is_number, gradient.z)};
}

/// Camera frame, stored scalars a local length.
template <class Stretch>
HWY_INLINE Triple gradient_at(const Effects& effects, const Stretch& stretch, Float u) {
  return numbers_of(transform(effects.camera_from_gradient, 3, stretch.gradient(u)));
}

template <class Stretch>
HWY_INLINE Float magnitude_at(const Effects& effects, const Stretch& stretch, Float u) {
  const Triple gradient = gradient_at(effects, stretch, u);
  return hn::Sqrt(dot(gradient, gradient));
}

/// Writes down where opacity passes one half between two cuts, with these transmittances there, if that is not known
/// yet.
template <class Stretch>
HWY_INLINE void note_depth(const Stretch& stretch, const Cut& a, const Cut& b, Float before, Float after,
                           Float& depth) {
  const Float half = constant(0.5f);
  const Mask open = hn::Eq(depth, constant(std::numeric_limits<float>::infinity()));
  const Mask passes = hn::And(open, hn::And(hn::Ge(before, half), hn::Lt(after, half)));
  if (HWY_LIKELY(hn::AllFalse(kFloat, passes))) return;
  const Float u = multiply_add(find_half(before, after), hn::Sub(b.u, a.u), a.u);
  depth = hn::IfThenElse(passes, depth_at(stretch, u), depth);
}

/// Parts of a stretch that are no longer than `longest`, local length.
template <class Stretch>
HWY_INLINE Float count_by_length(const Stretch& stretch, const RayView& ray, const Cut& begin, const Cut& end,
                                 float longest) {
  const Triple direction = ray.direction();
  const Float depth = hn::Sub(depth_at(stretch, end.u), depth_at(stretch, begin.u));
  const Float length = hn::Mul(depth, hn::Sqrt(dot(direction, direction)));
  return hn::Ceil(hn::Mul(length, constant(1.0f / longest)));
}

/// Parts of equal length of which the first, where the ray is brightest, absorbs no more than `largest`; transmittance
/// goes from `before` to `after` in all. What is darker than a hundredth of the beginning adds nothing to speak of.
HWY_INLINE Float count_by_opacity(Float before, Float after, float largest) {
  const Float left = hn::Div(after, hn::Max(before, constant(1e-30f)));
  const Float optical_depth = hn::Mul(log2_positive(hn::Max(left, constant(0.01f))), constant(-0.69314718f));
  return hn::Ceil(hn::Mul(hn::Mul(before, optical_depth), constant(1.0f / largest)));
}

/// Writes down optical depths at the slices between two depths.
HWY_NOINLINE inline void record_depths(const DepthRecord& record, const std::int32_t* pixels, const Float z[2],
                                       const Float transmittance[2]) {
  HWY_ALIGN float places[2][kLanes], depths[2][kLanes];
  for (int end = 0; end < 2; ++end) {
    const Float slice = hn::Mul(hn::Sub(z[end], constant(record.z_first)), constant(record.slices_per_z));
    hn::Store(slice, kFloat, places[end]);
    const Float log = log2_positive(hn::Max(transmittance[end], constant(1e-30f)));
    hn::Store(hn::Mul(log, constant(-0.69314718f)), kFloat, depths[end]);
  }
  const std::size_t slice_size = static_cast<std::size_t>(record.width) * record.height;
  for (std::size_t i = 0; i < kLanes; ++i) {
    const float begin = places[0][i], end = std::fmin(places[1][i], static_cast<float>(record.slices - 1));
    if (!(end > begin)) continue;
    float* depth = record.depths + pixels[i];
    float slice = std::fmax(std::floor(begin) + 1.0f, 0.0f);
    for (; slice <= end; slice += 1.0f) {
      const float t = (slice - begin) / (places[1][i] - begin);
      depth[static_cast<std::size_t>(slice) * slice_size] = depths[0][i] + t * (depths[1][i] - depths[0][i]);
    }
    // What is behind has this depth, unless the ray goes on.
    if (slice < static_cast<float>(record.slices)) depth[static_cast<std::size_t>(slice) * slice_size] = depths[1][i];
  }
}

/// Where in a segment or a stretch something lies, from 0 to 1, by how much its colour changes, and how far it is from
/// linear along it (0: linear; 1: in peaks).
struct Spread {
  Float center, variance, tint, unevenness;
};

/// Where the extinction of a segment lies.
HWY_INLINE Spread find_extinction(const CentroidView& table, const Segments& segment) {
  const Float half = constant(0.5f), one = constant(1.0f), zero = constant(0.0f), even = constant(1.0f / 12.0f);
  if (table.last_node == 0) return {half, even, zero, zero};
  const float last = static_cast<float>(table.last_node);
  const auto node_of = [&](Float scalar) {
    const Float at = hn::Mul(hn::Sub(scalar, constant(table.first)), constant(table.nodes_per_scalar));
    return hn::NearestInt(hn::Min(hn::Max(at, zero), constant(last)));
  };
  const Int front = node_of(segment.scalar_front), back = node_of(segment.scalar_back);
  const Record before = load_table_records(table.sums, hn::BitCast(kUint, front));
  const Record after = load_table_records(table.sums, hn::BitCast(kUint, back));
  const auto difference = [](Float a, Float b) {
    return hn::ConvertTo(kFloat, hn::Sub(hn::BitCast(kInt, b), hn::BitCast(kInt, a)));
  };
  const Float total = difference(before.x, after.x), nodes = hn::ConvertTo(kFloat, hn::Sub(back, front));
  const Mask empty = hn::Or(hn::Eq(total, zero), hn::Eq(nodes, zero));
  // One division for both: 1 / total and 1 / nodes.
  const Float total_or_one = hn::IfThenElse(empty, one, total), nodes_or_one = hn::IfThenElse(empty, one, nodes);
  const Float both = hn::Div(one, hn::Mul(total_or_one, nodes_or_one));
  const Float share = hn::Mul(both, nodes_or_one), inverse = hn::Mul(both, total_or_one);
  const Float mean = hn::Mul(hn::Mul(difference(before.y, after.y), share), constant(last));
  const Float square = hn::Mul(hn::Mul(difference(before.z, after.z), share), constant(last * last));
  const Float center = hn::Mul(hn::Sub(mean, hn::ConvertTo(kFloat, front)), inverse);
  const Float inside = hn::Min(hn::Max(center, zero), one);
  const Float variance = hn::Mul(hn::Sub(square, hn::Mul(mean, mean)), hn::Mul(inverse, inverse));
  const Float widest = hn::Mul(inside, hn::Sub(one, inside));  // of all that have this centre
  // Of a narrow range float cannot tell the variance; the extinction is about even there.
  const Mask narrow = hn::Lt(hn::Abs(nodes), constant(last * (1.0f / 256.0f)));
  const Float spread = hn::IfThenElse(hn::Or(empty, narrow), even, hn::Min(hn::Max(variance, zero), widest));
  const Float middle = hn::IfThenElse(empty, half, inside), off = hn::Abs(hn::Sub(middle, half));
  // What is linear has its centre within a sixth of the middle, and 1/12 - off^2 for a variance.
  const Float odd = hn::Max(hn::Sub(hn::Mul(constant(6.0f), off), one), zero);
  const Float bulge = hn::Abs(hn::Sub(multiply_add(off, off, spread), even));
  const Float unevenness = hn::Min(multiply_add(constant(12.0f), bulge, odd), one);
  return {middle, spread, hn::Min(hn::AbsDiff(after.w, before.w), one), hn::IfThenZeroElse(narrow, unevenness)};
}

/// What is seen of a segment of this opacity: its front part hides its back part, all the more the wider its extinction
/// is spread. In a homogeneous segment u is seen with a weight of exp(-t u), t its optical depth.
HWY_INLINE Spread find_emission(const CentroidView& table, const Segments& segment, Float opacity) {
  Spread seen = find_extinction(table, segment);
  const Float one = constant(1.0f), zero = constant(0.0f), twelve = constant(12.0f);
  const Mask is_thin = hn::Lt(opacity, constant(0.1f));  // where rounding would show
  Float shift = hn::Mul(opacity, constant(1.0f / 12.0f)), narrowing = one;
  if (!hn::AllTrue(kFloat, is_thin)) {
    const Float through = hn::Max(hn::Sub(one, opacity), constant(1e-6f));
    const Float odds = hn::Div(through, hn::Sub(one, through));
    const Float inverse = hn::Div(one, hn::Mul(log2_positive(through), constant(-0.69314718f)));
    const Float mean = hn::Sub(inverse, odds);
    const Float variance = hn::Sub(hn::Mul(inverse, inverse), multiply_add(odds, odds, odds));
    shift = hn::IfThenElse(is_thin, shift, hn::Sub(constant(0.5f), mean));
    narrowing = hn::IfThenElse(is_thin, one, hn::Mul(twelve, hn::Max(variance, zero)));
  }
  seen.center = hn::Max(hn::Sub(seen.center, hn::Mul(hn::Mul(twelve, seen.variance), shift)), zero);
  seen.variance = hn::Mul(seen.variance, narrowing);
  // How an uneven one hides itself its moments do not tell: that counts like a change of colour.
  seen.tint = hn::Min(multiply_add(seen.unevenness, opacity, seen.tint), one);
  return seen;
}

/// The gradient along a stretch, in the camera frame.
template <class Stretch>
class GradientCourse {
 public:
  HWY_INLINE GradientCourse(const Stretch& stretch, const float camera_from_gradient[9])
      : stretch_(stretch), camera_from_gradient_(camera_from_gradient) {
    if constexpr (Stretch::kHasLinearGradient) {
      stretch.end_gradients(ends_);
      for (Triple& end : ends_) end = transform(camera_from_gradient, 3, end);
    }
  }

  HWY_INLINE Triple at(Float u) const {
    if constexpr (Stretch::kHasLinearGradient)
      return mix(u, ends_[0], ends_[1]);
    else
      return numbers_of(transform(camera_from_gradient_, 3, stretch_.gradient(u)));
  }

 private:
  const Stretch& stretch_;
  const float* camera_from_gradient_;
  Triple ends_[2];
};

/// Where a stretch that is monotone between `a` and `b` takes `value`, as exactly as float can tell.
template <class Stretch>
HWY_INLINE Float find_crossing(const Stretch& stretch, const Cut& a, const Cut& b, Float value) {
  const Float rise = hn::Sub(b.scalar, a.scalar);
  const Mask level = hn::Eq(rise, constant(0.0f));
  const Float t = hn::Div(hn::Sub(value, a.scalar), hn::IfThenElse(level, constant(1.0f), rise));
  const Float chord = multiply_add(hn::Min(hn::Max(t, constant(0.0f)), constant(1.0f)), hn::Sub(b.u, a.u), a.u);
  if constexpr (Stretch::kIsLinear) {
    return chord;
  } else {
    // Newton's method, in a bracket that shrinks: a step that leaves it becomes a bisection.
    constexpr int kSteps = 8;
    const Mask rising = hn::Gt(rise, constant(0.0f));
    Float low = a.u, high = b.u, at = chord;
    for (int i = 0; i < kSteps; ++i) {
      const Float error = hn::Sub(stretch.scalar(at), value);
      const Mask is_beyond = hn::Xor(hn::Lt(error, constant(0.0f)), rising);
      high = hn::IfThenElse(is_beyond, at, high);
      low = hn::IfThenElse(is_beyond, low, at);
      const Float slope = stretch.slope(at);
      const Mask flat = hn::Eq(slope, constant(0.0f));
      const Float next = hn::Sub(at, hn::Div(error, hn::IfThenElse(flat, constant(1.0f), slope)));
      const Mask inside = hn::AndNot(flat, hn::And(hn::Ge(next, low), hn::Le(next, high)));
      at = hn::IfThenElse(inside, next, hn::Mul(constant(0.5f), hn::Add(low, high)));
    }
    return at;
  }
}

/// Whether a surface is met on a linear segment.
HWY_INLINE bool meets_surface(const Effects& effects, const Segments& segment) {
  Mask met = hn::FirstN(kFloat, 0);
  for (const SurfaceSheet& sheet : effects.surfaces) {
    const Float value = constant(sheet.value);
    met = hn::Or(met, hn::Xor(hn::Lt(segment.scalar_front, value), hn::Lt(segment.scalar_back, value)));
  }
  return !hn::AllFalse(kFloat, hn::And(met, hn::Gt(segment.length, constant(0.0f))));
}

/// Whether a surface may be met anywhere between two cuts.
template <class Stretch>
HWY_INLINE bool meets_surface(const Effects& effects, const Stretch& stretch, const Cut& begin, const Cut& end) {
  if (effects.surfaces.empty()) return false;
  Float low = hn::Min(begin.scalar, end.scalar), high = hn::Max(begin.scalar, end.scalar);
  if constexpr (!Stretch::kIsLinear) {
    const Float bend = hn::Mul(constant(1.5f), stretch.bend());
    low = hn::Sub(low, bend);
    high = hn::Add(high, bend);
  }
  const Mask lanes = hn::Gt(stretch.length, constant(0.0f));
  Mask met = hn::FirstN(kFloat, 0);
  for (const SurfaceSheet& sheet : effects.surfaces) {
    const Float value = constant(sheet.value);
    met = hn::Or(met, hn::And(hn::Le(low, value), hn::Ge(high, value)));
  }
  return !hn::AllFalse(kFloat, hn::And(met, lanes));
}

/// Extinction falls with what changes little: a shorter segment has the same effect.
template <class Stretch>
HWY_NOINLINE void weigh(const Effects& effects, const Stretch& stretch, const Cut& a, const Cut& b, Segments& segment) {
  const Float one = constant(1.0f);
  Float weight = one;
  if (effects.weight_by_change > 0.0f) {
    const Float change = hn::Abs(hn::Sub(b.scalar, a.scalar));
    const Float rate = hn::Div(change, hn::Max(segment.length, constant(1e-30f)));
    weight = hn::Min(one, hn::Mul(rate, constant(effects.weight_by_change)));
  }
  if (effects.weight_by_gradient > 0.0f) {
    // The mean along the piece, by Simpson's rule.
    const auto weight_at = [&](Float u) {
      return hn::Min(one, hn::Mul(magnitude_at(effects, stretch, u), constant(effects.weight_by_gradient)));
    };
    const Float middle = weight_at(hn::Mul(constant(0.5f), hn::Add(a.u, b.u)));
    const Float ends = hn::Add(weight_at(a.u), weight_at(b.u));
    weight = hn::Mul(weight, hn::Mul(constant(1.0f / 6.0f), multiply_add(constant(4.0f), middle, ends)));
  }
  segment.length = hn::Mul(segment.length, weight);
}

}  // namespace HWY_NAMESPACE
}  // namespace tetravox::cpu
HWY_AFTER_NAMESPACE();

#endif
