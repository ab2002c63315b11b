// The trilinear field of a whole grid, from its values as they lie in memory.

#if defined(TETRAVOX_CPU_VALUE_SAMPLER_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef TETRAVOX_CPU_VALUE_SAMPLER_INL
#undef TETRAVOX_CPU_VALUE_SAMPLER_INL
#else
#define TETRAVOX_CPU_VALUE_SAMPLER_INL
#endif

#include "src/cpu/kernels/kernels.h"
#include "src/cpu/kernels/pair_products-inl.h"
#include "src/cpu/kernels/triples-inl.h"
#include "src/cpu/kernels/value_pairs-inl.h"
#include "src/cpu/kernels/vector_math-inl.h"

#include <cstddef>
#include <cstdint>
#include <type_traits>

HWY_BEFORE_NAMESPACE();
namespace tetravox::cpu {
namespace HWY_NAMESPACE {

/// The trilinear field of a whole grid of values of type T.
template <class T>
class ValueSampler {
 public:
  explicit ValueSampler(const MarchValues& values)
      : values_(values.values),
        row_(values.row_bytes),
        slice_(values.slice_bytes),
        flip_(hn::Set(kUint, values.flip)),
        offset_(constant(values.offset)),
        inverse_scale_(constant(values.inverse_scale)) {
    const std::ptrdiff_t bytes[3] = {sizeof(T), values.row_bytes, values.slice_bytes};
    std::uint32_t origin = 0;
    for (int axis = 0; axis < 3; ++axis) {
      upper_[axis] = constant(static_cast<float>(values.dimensions[axis] - 1));
      last_cell_[axis] = constant(static_cast<float>(values.dimensions[axis] - 2));
      bytes_[axis] = hn::Set(kUint, static_cast<std::uint32_t>(bytes[axis]));
      origin += kIntegerBits * static_cast<std::uint32_t>(bytes[axis]);
    }
    origin_ = hn::Set(kUint, origin);
  }

  /// The scalar of the integrator at a place; of the nearest one inside the grid.
  HWY_INLINE Float eval(const Float at[3]) const {
    const Cell cell = find_cell(at);
    const PairOffsets offset(cell.first);
    const Float low = mix_square(load_lower(offset), cell.t[0], cell.t[1]);
    const Float high = mix_square(load_upper(offset), cell.t[0], cell.t[1]);
    return hn::Mul(hn::Sub(mix(cell.t[2], low, high), offset_), inverse_scale_);
  }

  /// The same of integers, the place between two values rounded: of bytes to parts of 255 along x and of 32767 along z,
  /// of 16 bits to parts of 32767 along x.
  HWY_INLINE Float eval_rounded(const Float at[3]) const {
    static_assert(std::is_integral_v<T>);
    const Cell cell = find_cell(at);
    const PairOffsets offset(cell.first);
    const auto whole = [](Float part, int most) {
      return hn::BitCast(kUint, multiply_add(part, constant(static_cast<float>(most)), constant(kInteger)));
    };
    const auto scalar = [&](Float sum, float parts, float middle) {
      const Float less = hn::Sub(constant(middle), offset_);
      return hn::Mul(multiply_add(sum, constant(1.0f / parts), less), inverse_scale_);
    };
    if constexpr (sizeof(T) == 1) {
      const BytePairs by_x(whole(cell.t[0], BytePairs::kMost));
      const ShortPairs by_z(whole(cell.t[2], ShortPairs::kMost));
      const Uint signs = hn::Xor(flip_, hn::Set(kUint, 0x80808080u));  // less 128
      const auto row = [&](const std::byte* from) {
        const Uint both = join_halves(load_words(from, offset), load_words(from + slice_ - 2, offset));
        return hn::ConvertTo(kFloat, by_z.eval(by_x.eval(hn::Xor(both, signs))));
      };
      return scalar(mix(cell.t[1], row(values_), row(values_ + row_)), 255.0f * 32767.0f, 128.0f);
    } else {
      const ShortPairs by_x(whole(cell.t[0], ShortPairs::kMost));
      const auto row = [&](const std::byte* from) {
        return hn::ConvertTo(kFloat, by_x.eval(hn::Xor(load_words(from, offset), flip_)));
      };
      const Float low = mix(cell.t[1], row(values_), row(values_ + row_));
      const Float high = mix(cell.t[1], row(values_ + slice_), row(values_ + slice_ + row_));
      return scalar(mix(cell.t[2], low, high), 32767.0f, 0.0f);
    }
  }

  /// Its derivatives there, a value's distance each.
  HWY_NOINLINE Triple eval_slope(const Float at[3]) const {
    const Cell cell = find_cell(at);
    const PairOffsets offset(cell.first);
    const Record low = load_lower(offset), high = load_upper(offset);
    const Float x = cell.t[0], y = cell.t[1], z = cell.t[2];
    const auto edge = [](Float t, Float a, Float b, Float c, Float d) { return mix(t, hn::Sub(b, a), hn::Sub(d, c)); };
    const Float near_low = mix(x, low.x, low.y), far_low = mix(x, low.z, low.w);
    const Float near_high = mix(x, high.x, high.y), far_high = mix(x, high.z, high.w);
    return scaled({mix(z, edge(y, low.x, low.y, low.z, low.w), edge(y, high.x, high.y, high.z, high.w)),
                   edge(z, near_low, far_low, near_high, far_high), edge(y, near_low, near_high, far_low, far_high)},
                  inverse_scale_);
  }

  /// Central differences at the corners of the cell, linear in between. Beyond the border of the grid the field goes on
  /// as in its outermost cell, which makes differences one-sided there.
  HWY_NOINLINE Triple eval_central_differences(const Float at[3]) const {
    const Cell cell = find_cell(at);
    Mask is_inner = hn::FirstN(kFloat, kLanes);
    for (int axis = 0; axis < 3; ++axis) {
      const Mask has_before = hn::Gt(cell.index[axis], constant(0.0f));
      is_inner = hn::And(is_inner, hn::And(has_before, hn::Lt(cell.index[axis], last_cell_[axis])));
    }
    const Vicinity v = HWY_LIKELY(hn::AllTrue(kFloat, is_inner)) ? load_vicinity(cell) : load_border(cell);

    const Float x = cell.t[0], y = cell.t[1], z = cell.t[2];
    const auto inside = [&](const Record& row) { return mix(x, row.y, row.z); };
    const auto beside = [&](const Pair& pair) { return mix(x, pair.first, pair.second); };
    // Twice the difference between the middle ones of four values in a row.
    const auto across = [](Float t, Float a, Float b, Float c, Float d) {
      return mix(t, hn::Sub(c, a), hn::Sub(d, b));
    };
    const auto along_x = [&](const Record& row) { return across(x, row.x, row.y, row.z, row.w); };
    const Float near_low = inside(v.near_low), far_low = inside(v.far_low);
    const Float near_high = inside(v.near_high), far_high = inside(v.far_high);

    const Float x_low = mix(y, along_x(v.near_low), along_x(v.far_low));
    const Float x_high = mix(y, along_x(v.near_high), along_x(v.far_high));
    const Float y_low = across(y, beside(v.before_low), near_low, far_low, beside(v.after_low));
    const Float y_high = across(y, beside(v.before_high), near_high, far_high, beside(v.after_high));
    const Float z_near = across(z, beside(v.near_below), near_low, near_high, beside(v.near_above));
    const Float z_far = across(z, beside(v.far_below), far_low, far_high, beside(v.far_above));
    return scaled({mix(z, x_low, x_high), mix(z, y_low, y_high), mix(y, z_near, z_far)},
                  hn::Mul(constant(0.5f), inverse_scale_));
  }

 private:
  // The lowest bits of a number to which 2^23 has been added are those of an integer.
  static constexpr float kInteger = 8388608.0f;
  static constexpr std::uint32_t kIntegerBits = 0x4B000000u;

  /// The cell that a place lies in.
  struct Cell {
    Float index[3], t[3];  // of its lower corner; from there, 0 to 1
    Uint first;            // bytes to its first pair
  };
  HWY_INLINE Cell find_cell(const Float at[3]) const {
    Cell cell;
    Uint first = hn::Zero(kUint);
    for (int axis = 0; axis < 3; ++axis) {
      const Float inside = hn::Min(hn::Max(at[axis], constant(0.0f)), upper_[axis]);
      cell.index[axis] = hn::Floor(hn::Min(inside, last_cell_[axis]));
      cell.t[axis] = hn::Sub(inside, cell.index[axis]);
      const Uint bits = hn::BitCast(kUint, hn::Add(cell.index[axis], constant(kInteger)));
      const bool is_byte = axis == 0 && sizeof(T) == 1;
      first = hn::Add(first, is_byte ? bits : hn::Mul(bits, bytes_[axis]));
    }
    cell.first = hn::Sub(first, origin_);
    return cell;
  }

  /// A cell and what is around it, but for edges and corners: `near` and `far` by y, `low` and `high` by z.
  struct Vicinity {
    Record near_low, far_low, near_high, far_high;  // each from one before the cell along x to one after it
    Pair before_low, after_low, before_high, after_high;
    Pair near_below, far_below, near_above, far_above;
  };
  /// Of cells that are neither first nor last along an axis.
  HWY_INLINE Vicinity load_vicinity(const Cell& cell) const {
    const PairOffsets here(cell.first);
    const std::byte *before = values_ - row_, *far = values_ + row_, *after = far + row_;
    return {load_quad(values_ - sizeof(T), here),
            load_quad(far - sizeof(T), here),
            load_quad(values_ + slice_ - sizeof(T), here),
            load_quad(far + slice_ - sizeof(T), here),
            load_pair<false>(before, here),
            load_pair<false>(after, here),
            load_pair<true>(before + slice_, here),
            load_pair<true>(after + slice_, here),
            load_pair<false>(values_ - slice_, here),
            load_pair<false>(far - slice_, here),
            load_pair<true>(values_ + 2 * slice_, here),
            load_pair<true>(far + 2 * slice_, here)};
  }

  /// Cells one before and one after along an axis; at the border of the grid the cell itself.
  struct Neighbours {
    Mask is_first, is_last;
    PairOffsets before, after;

    /// What goes before two values in a row, and after them; a, d: what is there but for the border.
    HWY_INLINE Float value_before(Float a, Float b, Float c) const {
      return hn::IfThenElse(is_first, hn::Sub(hn::Add(b, b), c), a);
    }
    HWY_INLINE Float value_after(Float b, Float c, Float d) const {
      return hn::IfThenElse(is_last, hn::Sub(hn::Add(c, c), b), d);
    }
    HWY_INLINE Pair pair_before(const Pair& a, const Pair& b, const Pair& c) const {
      return {value_before(a.first, b.first, c.first), value_before(a.second, b.second, c.second)};
    }
    HWY_INLINE Pair pair_after(const Pair& b, const Pair& c, const Pair& d) const {
      return {value_after(b.first, c.first, d.first), value_after(b.second, c.second, d.second)};
    }
  };
  HWY_INLINE Neighbours find_neighbours(const Cell& cell, int axis) const {
    const Mask is_first = hn::Eq(cell.index[axis], constant(0.0f));
    const Mask is_last = hn::Eq(cell.index[axis], last_cell_[axis]);
    const Uint before = hn::IfThenZeroElse(uint_mask(is_first), bytes_[axis]);
    const Uint after = hn::IfThenZeroElse(uint_mask(is_last), bytes_[axis]);
    return {is_first, is_last, PairOffsets(hn::Sub(cell.first, before)), PairOffsets(hn::Add(cell.first, after))};
  }
  /// Of any cells.
  HWY_NOINLINE Vicinity load_border(const Cell& cell) const {
    const PairOffsets here(cell.first);
    const Neighbours by_x = find_neighbours(cell, 0), by_y = find_neighbours(cell, 1), by_z = find_neighbours(cell, 2);
    const Record low = load_lower(here), high = load_upper(here);
    const Pair near_low{low.x, low.y}, far_low{low.z, low.w}, near_high{high.x, high.y}, far_high{high.z, high.w};
    const Record low_before = load_lower(by_x.before), low_after = load_lower(by_x.after);
    const Record high_before = load_upper(by_x.before), high_after = load_upper(by_x.after);
    const auto row = [&](Float a, const Pair& pair, Float d) {
      return Record{by_x.value_before(a, pair.first, pair.second), pair.first, pair.second,
                    by_x.value_after(pair.first, pair.second, d)};
    };
    const Record below = load_lower(by_z.before), above = load_upper(by_z.after);
    const std::byte* upper = values_ + slice_;
    return {row(low_before.x, near_low, low_after.y),
            row(low_before.z, far_low, low_after.w),
            row(high_before.x, near_high, high_after.y),
            row(high_before.z, far_high, high_after.w),
            by_y.pair_before(load_pair<false>(values_, by_y.before), near_low, far_low),
            by_y.pair_after(near_low, far_low, load_pair<false>(values_ + row_, by_y.after)),
            by_y.pair_before(load_pair<true>(upper, by_y.before), near_high, far_high),
            by_y.pair_after(near_high, far_high, load_pair<true>(upper + row_, by_y.after)),
            by_z.pair_before({below.x, below.y}, near_low, near_high),
            by_z.pair_before({below.z, below.w}, far_low, far_high),
            by_z.pair_after(near_low, near_high, {above.x, above.y}),
            by_z.pair_after(far_low, far_high, {above.z, above.w})};
  }

  /// The corners of a cell in its lower and in its upper slice.
  HWY_INLINE Record load_lower(const PairOffsets& offset) const { return load_square<false>(values_, offset); }
  HWY_INLINE Record load_upper(const PairOffsets& offset) const { return load_square<true>(values_ + slice_, offset); }
  template <bool kIsUpper>
  HWY_INLINE Record load_square(const std::byte* from, const PairOffsets& offset) const {
    if constexpr (sizeof(T) == 4) {
      return load_float_squares(from, row_, offset);
    } else {
      const Pair a = load_integers<T, kIsUpper>(from, offset, flip_);
      const Pair b = load_integers<T, kIsUpper>(from + row_, offset, flip_);
      return {a.first, a.second, b.first, b.second};
    }
  }
  template <bool kIsUpper>
  HWY_INLINE Pair load_pair(const std::byte* from, const PairOffsets& offset) const {
    if constexpr (sizeof(T) == 4) {
      const Record twice = load_float_squares(from, 0, offset);
      return {twice.x, twice.y};
    } else {
      return load_integers<T, kIsUpper>(from, offset, flip_);
    }
  }

  HWY_INLINE Record load_quad(const std::byte* from, const PairOffsets& offset) const {
    return load_quads<T>(from, offset, flip_);
  }

  const std::byte* values_;
  std::ptrdiff_t row_, slice_;
  Uint flip_;
  Float offset_, inverse_scale_, upper_[3], last_cell_[3];
  Uint bytes_[3];  // from cell to cell
  Uint origin_;    // what the bits of 2^23 add
};

}  // namespace HWY_NAMESPACE
}  // namespace tetravox::cpu
HWY_AFTER_NAMESPACE();

#endif
