// Values of a grid as they lie in memory, in pairs along its rows.

#if defined(TETRAVOX_CPU_VALUE_PAIRS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef TETRAVOX_CPU_VALUE_PAIRS_INL
#undef TETRAVOX_CPU_VALUE_PAIRS_INL
#else
#define TETRAVOX_CPU_VALUE_PAIRS_INL
#endif

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

/// The lowest byte of each lane, without sign; the lowest or highest 16 bits, with one.
HWY_INLINE Float low_byte_of(Uint bits) {
  return hn::ConvertTo(kFloat, hn::BitCast(kInt, hn::And(bits, hn::Set(kUint, 0xFFu))));
}
HWY_INLINE Float low_short_of(Uint bits) {
  return hn::ConvertTo(kFloat, hn::ShiftRight<16>(hn::BitCast(kInt, hn::ShiftLeft<16>(bits))));
}
HWY_INLINE Float high_short_of(Uint bits) { return hn::ConvertTo(kFloat, hn::ShiftRight<16>(hn::BitCast(kInt, bits))); }

/// Pairs of integers in the slice `from` of two, after the bits `flip` have been turned over: bytes without sign, 16
/// bits with one. Pairs of bytes begin a word of the lower slice and end one of the upper slice, so that no word lies
/// beyond the values.
template <class T, bool kIsUpper>
HWY_INLINE Pair load_integers(const std::byte* from, const PairOffsets& offset, Uint flip) {
  const Uint words = hn::Xor(load_words(kIsUpper && sizeof(T) == 1 ? from - 2 : from, offset), flip);
  if constexpr (sizeof(T) == 2)
    return {low_short_of(words), high_short_of(words)};
  else if constexpr (kIsUpper)
    return {low_byte_of(hn::ShiftRight<16>(words)), low_byte_of(hn::ShiftRight<24>(words))};
  else
    return {low_byte_of(words), low_byte_of(hn::ShiftRight<8>(words))};
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
    return load_float_squares(from, 8, offset);
  } else if constexpr (sizeof(T) == 2) {
    const Pair a = load_integers<T, false>(from, offset, flip), b = load_integers<T, false>(from + 4, offset, flip);
    return {a.first, a.second, b.first, b.second};
  } else {
    const Uint words = hn::Xor(load_words(from, offset), flip);
    return {low_byte_of(words), low_byte_of(hn::ShiftRight<8>(words)), low_byte_of(hn::ShiftRight<16>(words)),
            low_byte_of(hn::ShiftRight<24>(words))};
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace tetravox::cpu
HWY_AFTER_NAMESPACE();

#endif
