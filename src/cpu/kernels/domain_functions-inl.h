// Functions over a domain, and the straight ways through it.
//
// A function offers kCount (of axes), kIsContinuous, coordinate(axis, scalar); is_occupied(low, high) and
// find_steepness_of(axis, low, high) of what lies between coordinates; the box of the
// domain that a path starts in, in which it is a polynomial, where it leaves that along each axis, and the next one;
// load(box), and eval(path, what was loaded, u).

#if defined(TETRAVOX_CPU_DOMAIN_FUNCTIONS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef TETRAVOX_CPU_DOMAIN_FUNCTIONS_INL
#undef TETRAVOX_CPU_DOMAIN_FUNCTIONS_INL
#else
#define TETRAVOX_CPU_DOMAIN_FUNCTIONS_INL
#endif

#include "src/cpu/kernels/domain.h"
#include "src/cpu/kernels/kernels.h"
#include "src/cpu/kernels/march-inl.h"
#include "src/cpu/kernels/segments-inl.h"
#include "src/cpu/kernels/vector_math-inl.h"

HWY_BEFORE_NAMESPACE();
namespace tetravox::cpu {
namespace HWY_NAMESPACE {

/// The straight way of a vector of rays through the domain, u from 0 to 1.
template <int kCount>
struct DomainPath {
  Float begin[kCount], span[kCount], inverse[kCount];

  HWY_INLINE void set(int axis, Float from, Float to) {
    begin[axis] = from;
    span[axis] = hn::Sub(to, from);
    inverse[axis] = hn::Div(constant(1.0f), hn::IfThenElse(is_level(axis), constant(1.0f), span[axis]));
  }
  HWY_INLINE Mask is_level(int axis) const { return hn::Le(hn::Abs(span[axis]), constant(1e-20f)); }
  HWY_INLINE Float at(int axis, Float u) const { return multiply_add(u, span[axis], begin[axis]); }
  /// Where it meets `value`; never where it does not move.
  HWY_INLINE Float meets(int axis, Float value) const {
    const Float u = hn::Mul(hn::Sub(value, begin[axis]), inverse[axis]);
    return hn::IfThenElse(is_level(axis), constant(2.0f), u);
  }
};

/// Extinction and colour of a table, multilinear between its entries. Paths are in entries.
template <int kVariables>
class TableFunction {
 public:
  static constexpr int kCount = kVariables;
  static constexpr bool kIsContinuous = true;
  using Path = DomainPath<kCount>;

  explicit TableFunction(const IntegratorTables& tables) : domain_(*tables.domain) {
    std::int32_t stride = 1;
    for (int axis = 0; axis < kCount; ++axis) {
      strides_[axis] = stride;
      stride *= domain_.axes[axis].last + 1;
    }
  }

  HWY_INLINE Float coordinate(int axis, Float scalar) const {
    const DomainAxis& a = domain_.axes[axis];
    return hn::Mul(hn::Sub(scalar, constant(a.first)), constant(a.entries_per_scalar));
  }

  /// Whether anything absorbs between two coordinates on each axis.
  HWY_INLINE Mask is_occupied(const Float low[kCount], const Float high[kCount]) const {
    Int begin[kCount], end[kCount];
    for (int axis = 0; axis < kCount; ++axis) {
      // A hair more on either side stands for rounding.
      const Float hair = constant(1e-3f), zero = constant(0.0f);
      const Float from = hn::Floor(hn::Sub(hn::Min(low[axis], last(axis)), hair));
      const Float to = hn::Ceil(hn::Add(hn::Max(high[axis], zero), hair));
      begin[axis] = hn::ConvertTo(kInt, hn::Max(from, zero));
      end[axis] = hn::ConvertTo(kInt, hn::Add(hn::Min(to, last(axis)), constant(1.0f)));
    }
    // Inclusion and exclusion.
    Int sum = hn::Zero(kInt);
    for (int corner = 0; corner < 1 << kCount; ++corner) {
      Int index = hn::Zero(kInt);
      bool is_added = true;
      std::int32_t stride = 1;
      for (int axis = 0; axis < kCount; ++axis) {
        const bool is_lower = (corner >> axis & 1) != 0;
        index = hn::Add(index, hn::Mul(is_lower ? begin[axis] : end[axis], hn::Set(kInt, stride)));
        stride *= domain_.axes[axis].last + 2;
        is_added ^= is_lower;
      }
      const Int count = hn::GatherIndex(kInt, domain_.occupied, index);
      sum = is_added ? hn::Add(sum, count) : hn::Sub(sum, count);
    }
    return hn::RebindMask(kFloat, hn::Ne(sum, hn::Zero(kInt)));
  }

  /// Largest change of density for one unit of stored scalar of an axis, between coordinates.
  HWY_INLINE Float find_steepness_of(int axis, const Float*, const Float*) const {
    return constant(domain_.axes[axis].steepness);
  }

  /// The box between entries that a path is in: the number of its lower entry along each axis, -1 below the table, the
  /// last one above it.
  struct Box {
    Float number[kCount];
  };
  HWY_INLINE Box start(const Path& path) const {
    Box box;
    for (int axis = 0; axis < kCount; ++axis) {
      const Float at = hn::Min(hn::Max(path.begin[axis], constant(-1.0f)), last(axis)), floor = hn::Floor(at);
      // A path that falls from an entry is in the box below.
      const Mask falls = hn::And(hn::Lt(path.span[axis], constant(0.0f)), hn::Eq(floor, path.begin[axis]));
      box.number[axis] = hn::IfThenElse(falls, hn::Sub(floor, constant(1.0f)), floor);
    }
    return box;
  }
  /// Where the path leaves its box along an axis.
  HWY_INLINE Float border(const Path& path, const Box& box, int axis) const {
    const Mask rising = hn::Gt(path.span[axis], constant(0.0f));
    const Float value = hn::IfThenElse(rising, hn::Add(box.number[axis], constant(1.0f)), box.number[axis]);
    const Mask outside = hn::Or(hn::Lt(value, constant(0.0f)), hn::Gt(value, last(axis)));
    return hn::IfThenElse(outside, constant(2.0f), path.meets(axis, value));
  }
  HWY_INLINE void cross(const Path& path, Mask lanes, int axis, Box& box) const {
    const Float step = hn::CopySign(constant(1.0f), path.span[axis]);
    box.number[axis] = hn::Add(box.number[axis], hn::IfThenElseZero(lanes, step));
  }

  /// What is to be known of a box to evaluate the function in it.
  struct Corners {
    Float number[kCount];
    Record entries[1 << kCount];
  };
  HWY_INLINE Corners load(const Box& box) const {
    Corners corners;
    Float node = constant(0.0f);
    for (int axis = 0; axis < kCount; ++axis) {
      corners.number[axis] = hn::Min(hn::Max(box.number[axis], constant(0.0f)), hn::Sub(last(axis), constant(1.0f)));
      node = multiply_add(corners.number[axis], constant(static_cast<float>(strides_[axis])), node);
    }
    const Uint index = hn::BitCast(kUint, hn::ConvertTo(kInt, node));
    for (int corner = 0; corner < 1 << kCount; ++corner) {
      std::int32_t offset = 0;
      for (int axis = 0; axis < kCount; ++axis) offset += (corner >> axis & 1) * strides_[axis];
      corners.entries[corner] =
          load_table_records(domain_.entries, hn::Add(index, hn::Set(kUint, static_cast<std::uint32_t>(offset))));
    }
    return corners;
  }
  HWY_INLINE Record eval(const Path& path, const Corners& corners, Float u) const {
    Record mixed[1 << (kCount - 1)];
    for (int axis = 0; axis < kCount; ++axis) {
      const Float off = hn::Sub(path.at(axis, u), corners.number[axis]);
      const Float t = hn::Min(hn::Max(off, constant(0.0f)), constant(1.0f));
      const Record* from = axis == 0 ? corners.entries : mixed;
      for (int i = 0; i < 1 << (kCount - 1 - axis); ++i) mixed[i] = mix_records(t, from[2 * i], from[2 * i + 1]);
    }
    return mixed[0];
  }

 private:
  static HWY_INLINE Record mix_records(Float t, const Record& a, const Record& b) {
    const auto channel = [&](Float p, Float q) { return multiply_add(t, hn::Sub(q, p), p); };
    return {channel(a.x, b.x), channel(a.y, b.y), channel(a.z, b.z), channel(a.w, b.w)};
  }
  HWY_INLINE Float last(int axis) const { return constant(static_cast<float>(domain_.axes[axis].last)); }

  const DomainFunction& domain_;
  std::int32_t strides_[kCount];
};

/// Extinction by the scalar, colour by another: both linear between their control points. Paths are in stored scalars.
class SeparateFunction {
 public:
  static constexpr int kCount = 2;
  static constexpr bool kIsContinuous = false;
  using Path = DomainPath<kCount>;

  explicit SeparateFunction(const IntegratorTables& tables)
      : domain_(*tables.domain),
        table_(*domain_.extinctions),
        points_{ControlPoints(*tables.control_points), ControlPoints(*domain_.colors)} {}

  HWY_INLINE Float coordinate(int, Float scalar) const { return scalar; }
  HWY_INLINE Mask is_occupied(const Float low[kCount], const Float high[kCount]) const {
    return hn::Gt(find_largest(table_, table_.extinction, low[0], high[0]), constant(domain_.haze));
  }
  HWY_INLINE Float find_steepness_of(int axis, const Float low[kCount], const Float high[kCount]) const {
    if (axis == 0) return find_steepness(table_, low[0], high[0]);
    return hn::Mul(find_largest(table_, table_.extinction, low[0], high[0]), constant(domain_.axes[1].steepness));
  }

  /// The intervals between control points that a path is in.
  struct Box {
    Int interval[kCount];
  };
  using Corners = Box;
  HWY_INLINE Box start(const Path& path) const {
    Box box;
    for (int axis = 0; axis < kCount; ++axis)
      box.interval[axis] = points_[axis].find_front_interval(path.begin[axis], hn::Ge(path.span[axis], constant(0.0f)));
    return box;
  }
  HWY_INLINE Float border(const Path& path, const Box& box, int axis) const {
    const Mask rising = hn::Ge(path.span[axis], constant(0.0f));
    const Int side = hn::IfThenElseZero(int_mask(rising), hn::Set(kInt, 1));
    return path.meets(axis, points_[axis].start_of(hn::Add(box.interval[axis], side)));
  }
  HWY_INLINE void cross(const Path& path, Mask lanes, int axis, Box& box) const {
    const Mask rising = hn::Ge(path.span[axis], constant(0.0f));
    const Int step = hn::IfThenElse(int_mask(rising), hn::Set(kInt, 1), hn::Set(kInt, -1));
    box.interval[axis] = hn::Add(box.interval[axis], hn::IfThenElseZero(int_mask(lanes), step));
  }
  HWY_INLINE Corners load(const Box& box) const { return box; }
  HWY_INLINE Record eval(const Path& path, const Corners& box, Float u) const {
    const Float extinction = points_[0].eval(box.interval[0], path.at(0, u)).x;
    const Record color = points_[1].eval(box.interval[1], path.at(1, u));
    return {extinction, color.y, color.z, color.w};
  }

 private:
  const DomainFunction& domain_;
  const optics::SteepnessTable& table_;
  ControlPoints points_[kCount];
};

}  // namespace HWY_NAMESPACE
}  // namespace tetravox::cpu
HWY_AFTER_NAMESPACE();

#endif
