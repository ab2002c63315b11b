// The trilinear field of a whole grid, from its values as they lie in memory.

#if defined(TETRAVOX_CPU_VALUE_SAMPLER_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef TETRAVOX_CPU_VALUE_SAMPLER_INL
#undef TETRAVOX_CPU_VALUE_SAMPLER_INL
#else
#define TETRAVOX_CPU_VALUE_SAMPLER_INL
#endif

#include "src/cpu/kernels/kernels.h"
#include "src/cpu/kernels/triples-inl.h"
#include "src/cpu/kernels/vector_math-inl.h"

#include <cstddef>
#include <cstdint>
#include <cstring>

HWY_BEFORE_NAMESPACE();
namespace tetravox::cpu {
namespace HWY_NAMESPACE {

/// Two values side by side along a row, of each lane.
struct Pair {
  Float first, second;
};

/// Where the pairs of a vector of rays begin: bytes from the first value.
struct PairOffsets {
  HWY_ALIGN std::uint32_t lane[kLanes];

  explicit PairOffsets(Uint offset) { hn::Store(offset, kUint, lane); }
};

template <class T>
HWY_INLINE T read_as(const std::byte* from) {
  T value;
  std::memcpy(&value, from, sizeof value);
  return value;
}

/// The four bytes at `from + offset` of each lane. Where we know how, they are put into registers one by one: what is
/// stored in parts and loaded as a whole keeps a processor waiting, and hardware gathers take longer.
HWY_INLINE Uint load_words(const std::byte* from, const PairOffsets& offset) {
  const auto read = [&](std::size_t i) { return read_as<std::uint32_t>(from + offset.lane[i]); };
#if HWY_TARGET == HWY_SCALAR
  return hn::Set(kUint, read(0));
#elif HWY_ARCH_X86
  const auto block = [&](std::size_t i) {
    const auto at = [&](std::size_t lane) { return static_cast<int>(read(i + lane)); };
    return Block{_mm_castsi128_ps(_mm_set_epi32(at(3), at(2), at(1), at(0)))};
  };
  return hn::BitCast(kUint, load_blocks(kFloat, block, 0));
#else
  HWY_ALIGN std::uint32_t words[kLanes];
  for (std::size_t i = 0; i < kLanes; ++i) words[i] = read(i);
  return hn::Load(kUint, words);
#endif
}

/// Pairs of integers without sign in the slice `from` of two, after the bits `flip` have been turned over. Pairs of
/// bytes begin a word of the lower slice and end one of the upper slice, so that no word lies beyond the values.
template <class T, bool kIsUpper>
HWY_INLINE Pair load_integers(const std::byte* from, const PairOffsets& offset, Uint flip) {
  const auto number = [](Uint bits) { return hn::ConvertTo(kFloat, hn::BitCast(kInt, bits)); };
  const Uint mask = hn::Set(kUint, sizeof(T) == 1 ? 0xFFu : 0xFFFFu);
  if constexpr (sizeof(T) == 2) {
    const Uint words = hn::Xor(load_words(from, offset), flip);
    return {number(hn::And(words, mask)), number(hn::ShiftRight<16>(words))};
  } else if constexpr (kIsUpper) {
    const Uint words = hn::Xor(load_words(from - 2, offset), flip);
    return {number(hn::And(hn::ShiftRight<16>(words), mask)), number(hn::ShiftRight<24>(words))};
  } else {
    const Uint words = hn::Xor(load_words(from, offset), flip);
    return {number(hn::And(words, mask)), number(hn::And(hn::ShiftRight<8>(words), mask))};
  }
}

/// Pairs of floats and those `row` bytes further, of each lane.
HWY_INLINE Record load_float_squares(const std::byte* from, std::ptrdiff_t row, const PairOffsets& offset) {
#if HWY_TARGET == HWY_SCALAR
  const auto at = [&](std::ptrdiff_t bytes) { return constant(read_as<float>(from + bytes + offset.lane[0])); };
  return {at(0), at(4), at(row), at(row + 4)};
#else
  return transpose_blocks([&](std::size_t i) {
    const hn::Full64<float> pair;
    const auto at = [&](const std::byte* place) { return hn::LoadU(pair, reinterpret_cast<const float*>(place)); };
    return hn::Combine(hn::Full128<float>(), at(from + row + offset.lane[i]), at(from + offset.lane[i]));
  });
#endif
}

/// Four values in a row from `from` on, of each lane.
template <class T>
HWY_INLINE Record load_quads(const std::byte* from, const PairOffsets& offset, Uint flip) {
  if constexpr (sizeof(T) == 4) {
    return transpose_records([&](std::size_t i) { return reinterpret_cast<const float*>(from + offset.lane[i]); });
  } else if constexpr (sizeof(T) == 2) {
    const Pair a = load_integers<T, false>(from, offset, flip), b = load_integers<T, false>(from + 4, offset, flip);
    return {a.first, a.second, b.first, b.second};
  } else {
    const Uint words = hn::Xor(load_words(from, offset), flip), mask = hn::Set(kUint, 0xFFu);
    const auto number = [](Uint bits) { return hn::ConvertTo(kFloat, hn::BitCast(kInt, bits)); };
    return {number(hn::And(words, mask)), number(hn::And(hn::ShiftRight<8>(words), mask)),
            number(hn::And(hn::ShiftRight<16>(words), mask)), number(hn::ShiftRight<24>(words))};
  }
}

/// Weighs pairs of values in whole numbers: b of each pair (a, b) with `weight`, a with what `kMost` leaves of that.
#if HWY_TARGET != HWY_SCALAR && HWY_ARCH_X86
using Bytes = hn::Vec<hn::Repartition<std::uint8_t, UintTag>>;
using Shorts = hn::Vec<hn::Repartition<std::int16_t, UintTag>>;

/// The bytes `which` of each 16, `flip` turned over.
HWY_INLINE Bytes repeat_bytes(Uint from, const std::uint8_t which[16], std::uint32_t flip) {
  const hn::Repartition<std::uint8_t, UintTag> tag;
  const Bytes repeated = hn::TableLookupBytes(hn::BitCast(tag, from), hn::LoadDup128(tag, which));
  return hn::Xor(repeated, hn::BitCast(tag, hn::Set(kUint, flip)));
}

/// Two pairs of bytes a lane.
class BytePairs {
 public:
  static constexpr int kMost = 255;

  explicit BytePairs(Uint weight) {
    alignas(16) static constexpr std::uint8_t kByte[16] = {0, 0, 0, 0, 4, 4, 4, 4, 8, 8, 8, 8, 12, 12, 12, 12};
    weights_ = repeat_bytes(weight, kByte, 0x00FF00FFu);
  }
  /// A pair of 16 bits a lane.
  HWY_INLINE Uint eval(Uint pairs) const {
#if HWY_TARGET == HWY_SSE4
    return Uint{_mm_maddubs_epi16(weights_.raw, pairs.raw)};
#elif HWY_TARGET == HWY_AVX2
    return Uint{_mm256_maddubs_epi16(weights_.raw, pairs.raw)};
#else
    return Uint{_mm512_maddubs_epi16(weights_.raw, pairs.raw)};
#endif
  }

 private:
  Bytes weights_;
};

/// A pair of 16 bits a lane.
class ShortPairs {
 public:
  static constexpr int kMost = 32767;

  explicit ShortPairs(Uint weight) {
    alignas(16) static constexpr std::uint8_t kShort[16] = {0, 1, 0, 1, 4, 5, 4, 5, 8, 9, 8, 9, 12, 13, 12, 13};
    weights_ = hn::BitCast(hn::Repartition<std::int16_t, UintTag>(), repeat_bytes(weight, kShort, 0x00007FFFu));
  }
  HWY_INLINE Int eval(Uint pairs) const {
#if HWY_TARGET == HWY_SSE4
    return Int{_mm_madd_epi16(weights_.raw, pairs.raw)};
#elif HWY_TARGET == HWY_AVX2
    return Int{_mm256_madd_epi16(weights_.raw, pairs.raw)};
#else
    return Int{_mm512_madd_epi16(weights_.raw, pairs.raw)};
#endif
  }

 private:
  Shorts weights_;
};

/// The first two bytes of `low`, the last two of `high`.
HWY_INLINE Uint join_halves(Uint low, Uint high) {
  const hn::Repartition<std::int16_t, UintTag> shorts;
  return hn::BitCast(kUint, hn::OddEven(hn::BitCast(shorts, high), hn::BitCast(shorts, low)));
}
#else
template <class T, class Sum, int kLargest>
class WholePairs {
 public:
  static constexpr int kMost = kLargest;

  explicit WholePairs(Uint weight) { hn::Store(hn::And(weight, hn::Set(kUint, kMost)), kUint, weights_); }

  HWY_INLINE hn::Vec<hn::Rebind<Sum, UintTag>> eval(Uint pairs) const {
    constexpr int kBits = 8 * sizeof(T), kSumBits = 2 * kBits;
    HWY_ALIGN std::uint32_t lanes[kLanes];
    hn::Store(pairs, kUint, lanes);
    for (std::size_t i = 0; i < kLanes; ++i) {
      const auto weight = static_cast<std::int32_t>(weights_[i]);
      std::uint32_t sums = 0;
      for (int bit = 0; bit < 32; bit += kSumBits) {
        const auto a = static_cast<T>(lanes[i] >> bit), b = static_cast<T>(lanes[i] >> (bit + kBits));
        const auto sum = static_cast<std::uint32_t>((kMost - weight) * a + weight * b);
        sums |= (kSumBits == 32 ? sum : sum & 0xFFFFu) << bit;
      }
      lanes[i] = sums;
    }
    return hn::BitCast(hn::Rebind<Sum, UintTag>(), hn::Load(kUint, lanes));
  }

 private:
  HWY_ALIGN std::uint32_t weights_[kLanes];
};
using BytePairs = WholePairs<std::int8_t, std::uint32_t, 255>;
using ShortPairs = WholePairs<std::int16_t, std::int32_t, 32767>;

HWY_INLINE Uint join_halves(Uint low, Uint high) {
  return hn::Or(hn::And(low, hn::Set(kUint, 0xFFFFu)), hn::And(high, hn::Set(kUint, 0xFFFF0000u)));
}
#endif

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
    const Cell cell = find_cell(at);
    const PairOffsets offset(cell.first);
    const auto whole = [](Float part, int most) {
      return hn::BitCast(kUint, multiply_add(part, constant(static_cast<float>(most)), constant(kInteger)));
    };
    const auto scalar = [&](Float sum, float parts, float middle) {
      const Float value = multiply_add(sum, constant(1.0f / parts), constant(middle));
      return hn::Mul(hn::Sub(value, offset_), inverse_scale_);
    };
    if constexpr (sizeof(T) == 1) {
      const BytePairs by_x(whole(cell.t[0], BytePairs::kMost));
      const ShortPairs by_z(whole(cell.t[2], ShortPairs::kMost));
      const Uint sign = hn::Xor(flip_, hn::Set(kUint, 0x80808080u));
      const auto row = [&](const std::byte* from) {
        const Uint both = join_halves(load_words(from, offset), load_words(from + slice_ - 2, offset));
        return hn::ConvertTo(kFloat, by_z.eval(by_x.eval(hn::Xor(both, sign))));
      };
      return scalar(mix(cell.t[1], row(values_), row(values_ + row_)), 255.0f * 32767.0f, 128.0f);
    } else {
      const ShortPairs by_x(whole(cell.t[0], ShortPairs::kMost));
      const Uint sign = hn::Xor(flip_, hn::Set(kUint, 0x80008000u));
      const auto row = [&](const std::byte* from) {
        return hn::ConvertTo(kFloat, by_x.eval(hn::Xor(load_words(from, offset), sign)));
      };
      const Float low = mix(cell.t[1], row(values_), row(values_ + row_));
      const Float high = mix(cell.t[1], row(values_ + slice_), row(values_ + slice_ + row_));
      return scalar(mix(cell.t[2], low, high), 32767.0f, 32768.0f);
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
