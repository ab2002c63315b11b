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
    const Float x = cell.t[0], y = cell.t[1], z = cell.t[2];
    const Rows rows = load_rows(cell);
    const auto across = [&](const Record& row) {  // twice the difference along x
      return mix(x, hn::Sub(row.z, row.x), hn::Sub(row.w, row.y));
    };
    const auto inside = [&](const Record& row) { return mix(x, row.y, row.z); };
    const Float near_low = inside(rows.near_low), far_low = inside(rows.far_low);
    const Float near_high = inside(rows.near_high), far_high = inside(rows.far_high);

    const Neighbours by_y = find_neighbours(cell, 1), by_z = find_neighbours(cell, 2);
    const auto pair = [&](Pair values) { return mix(x, values.first, values.second); };
    const Float low_y = by_y.difference(y, pair(load_pair<false>(values_, by_y.before)), near_low, far_low,
                                        pair(load_pair<false>(values_ + row_, by_y.after)));
    const Float high_y = by_y.difference(y, pair(load_pair<true>(values_ + slice_, by_y.before)), near_high, far_high,
                                         pair(load_pair<true>(values_ + slice_ + row_, by_y.after)));
    const Record below = load_lower(by_z.before), above = load_upper(by_z.after);
    const Float near_z = by_z.difference(z, mix(x, below.x, below.y), near_low, near_high, mix(x, above.x, above.y));
    const Float far_z = by_z.difference(z, mix(x, below.z, below.w), far_low, far_high, mix(x, above.z, above.w));
    const Float x_low = mix(y, across(rows.near_low), across(rows.far_low));
    const Float x_high = mix(y, across(rows.near_high), across(rows.far_high));
    return scaled({mix(z, x_low, x_high), mix(z, low_y, high_y), mix(y, near_z, far_z)},
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

  /// Cells one before and one after along an axis; at the border of the grid the cell itself.
  struct Neighbours {
    Mask is_first, is_last;
    PairOffsets before, after;

    /// What goes before two values in a row, and after them.
    HWY_INLINE Float value_before(Float a, Float b, Float c) const {
      return hn::IfThenElse(is_first, hn::Sub(hn::Add(b, b), c), a);
    }
    HWY_INLINE Float value_after(Float b, Float c, Float d) const {
      return hn::IfThenElse(is_last, hn::Sub(hn::Add(c, c), b), d);
    }
    /// Twice the central difference between the middle ones of four values in a row.
    HWY_INLINE Float difference(Float t, Float a, Float b, Float c, Float d) const {
      return mix(t, hn::Sub(c, value_before(a, b, c)), hn::Sub(value_after(b, c, d), b));
    }
  };
  HWY_INLINE Neighbours find_neighbours(const Cell& cell, int axis) const {
    const Mask is_first = hn::Eq(cell.index[axis], constant(0.0f));
    const Mask is_last = hn::Eq(cell.index[axis], last_cell_[axis]);
    const Uint before = hn::IfThenZeroElse(uint_mask(is_first), bytes_[axis]);
    const Uint after = hn::IfThenZeroElse(uint_mask(is_last), bytes_[axis]);
    return {is_first, is_last, PairOffsets(hn::Sub(cell.first, before)), PairOffsets(hn::Add(cell.first, after))};
  }

  /// The four rows along x through the corners of a cell, each with the value before and the value after.
  struct Rows {
    Record near_low, far_low, near_high, far_high;  // by y and z
  };
  HWY_INLINE Rows load_rows(const Cell& cell) const {
    const PairOffsets here(cell.first);
    const Mask is_inner = hn::And(hn::Gt(cell.index[0], constant(0.0f)), hn::Lt(cell.index[0], last_cell_[0]));
    if (HWY_LIKELY(hn::AllTrue(kFloat, is_inner))) {
      const std::byte* from = values_ - sizeof(T);
      return {load_quad(from, here), load_quad(from + row_, here), load_quad(from + slice_, here),
              load_quad(from + slice_ + row_, here)};
    }
    const Neighbours by_x = find_neighbours(cell, 0);
    const Record low = load_lower(here), high = load_upper(here);
    const Record low_before = load_lower(by_x.before), low_after = load_lower(by_x.after);
    const Record high_before = load_upper(by_x.before), high_after = load_upper(by_x.after);
    const auto row = [&](Float a, Float b, Float c, Float d) {
      return Record{by_x.value_before(a, b, c), b, c, by_x.value_after(b, c, d)};
    };
    return {row(low_before.x, low.x, low.y, low_after.y), row(low_before.z, low.z, low.w, low_after.w),
            row(high_before.x, high.x, high.y, high_after.y), row(high_before.z, high.z, high.w, high_after.w)};
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
