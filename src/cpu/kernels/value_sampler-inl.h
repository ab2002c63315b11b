// The trilinear field of a whole grid, from its values as they lie in memory.

#if defined(TETRAVOX_CPU_VALUE_SAMPLER_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef TETRAVOX_CPU_VALUE_SAMPLER_INL
#undef TETRAVOX_CPU_VALUE_SAMPLER_INL
#else
#define TETRAVOX_CPU_VALUE_SAMPLER_INL
#endif

#include "src/cpu/kernels/kernels.h"
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

/// Pairs of floats and those one row further, of each lane.
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
    Float t[3];
    Uint first = hn::Zero(kUint);
    for (int axis = 0; axis < 3; ++axis) {
      const Float inside = hn::Min(hn::Max(at[axis], constant(0.0f)), upper_[axis]);
      const Float cell = hn::Floor(hn::Min(inside, last_cell_[axis]));
      t[axis] = hn::Sub(inside, cell);
      const Uint bits = hn::BitCast(kUint, hn::Add(cell, constant(kInteger)));
      first = hn::Add(first, hn::Mul(bits, bytes_[axis]));
    }
    const PairOffsets offset(hn::Sub(first, origin_));
    const Float low = eval_square<false>(values_, offset, t), high = eval_square<true>(values_ + slice_, offset, t);
    return hn::Mul(hn::Sub(mix(t[2], low, high), offset_), inverse_scale_);
  }

 private:
  // The lowest bits of a number to which 2^23 has been added are those of an integer.
  static constexpr float kInteger = 8388608.0f;
  static constexpr std::uint32_t kIntegerBits = 0x4B000000u;

  template <bool kIsUpper>
  HWY_INLINE Float eval_square(const std::byte* from, const PairOffsets& offset, const Float t[3]) const {
    if constexpr (sizeof(T) == 4) {
      return mix_square(load_float_squares(from, row_, offset), t[0], t[1]);
    } else {
      const Pair a = load_integers<T, kIsUpper>(from, offset, flip_);
      const Pair b = load_integers<T, kIsUpper>(from + row_, offset, flip_);
      return mix_square({a.first, a.second, b.first, b.second}, t[0], t[1]);
    }
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
