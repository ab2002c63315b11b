// Between two integers, in whole numbers: b of a pair (a, b) counts as much as a weight says, a as much as is left of
// `kMost`.

#if defined(TETRAVOX_CPU_PAIR_PRODUCTS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef TETRAVOX_CPU_PAIR_PRODUCTS_INL
#undef TETRAVOX_CPU_PAIR_PRODUCTS_INL
#else
#define TETRAVOX_CPU_PAIR_PRODUCTS_INL
#endif

#include "src/cpu/kernels/vector_math-inl.h"

#include <cstdint>

HWY_BEFORE_NAMESPACE();
namespace tetravox::cpu {
namespace HWY_NAMESPACE {

#if HWY_ARCH_X86 && HWY_TARGET <= HWY_SSSE3
/// Sums of two products each: bytes without sign and bytes, as 16 bits; 16 bits, as 32 bits.
HWY_INLINE __m128i add_byte_products(__m128i a, __m128i b) { return _mm_maddubs_epi16(a, b); }
HWY_INLINE __m128i add_short_products(__m128i a, __m128i b) { return _mm_madd_epi16(a, b); }
#if HWY_TARGET <= HWY_AVX2
HWY_INLINE __m256i add_byte_products(__m256i a, __m256i b) { return _mm256_maddubs_epi16(a, b); }
HWY_INLINE __m256i add_short_products(__m256i a, __m256i b) { return _mm256_madd_epi16(a, b); }
#endif
#if HWY_TARGET <= HWY_AVX3
HWY_INLINE __m512i add_byte_products(__m512i a, __m512i b) { return _mm512_maddubs_epi16(a, b); }
HWY_INLINE __m512i add_short_products(__m512i a, __m512i b) { return _mm512_madd_epi16(a, b); }
#endif

/// The bytes `which` of each 16, `flip` turned over.
HWY_INLINE Uint repeat_bytes(Uint from, const std::uint8_t which[16], std::uint32_t flip) {
  const hn::Repartition<std::uint8_t, UintTag> bytes;
  const auto repeated = hn::TableLookupBytes(hn::BitCast(bytes, from), hn::LoadDup128(bytes, which));
  return hn::Xor(hn::BitCast(kUint, repeated), hn::Set(kUint, flip));
}

/// Two pairs of bytes a lane.
class BytePairs {
 public:
  static constexpr int kMost = 255;

  /// `weight`: from 0 to `kMost`, in the lowest bits.
  explicit BytePairs(Uint weight) {
    alignas(16) static constexpr std::uint8_t kByte[16] = {0, 0, 0, 0, 4, 4, 4, 4, 8, 8, 8, 8, 12, 12, 12, 12};
    weights_ = repeat_bytes(weight, kByte, 0x00FF00FFu);
  }
  /// Two integers of 16 bits a lane.
  HWY_INLINE Uint eval(Uint pairs) const { return Uint{add_byte_products(weights_.raw, pairs.raw)}; }

 private:
  Uint weights_;
};

/// One pair of 16 bits a lane.
class ShortPairs {
 public:
  static constexpr int kMost = 32767;

  explicit ShortPairs(Uint weight) {
    alignas(16) static constexpr std::uint8_t kShort[16] = {0, 1, 0, 1, 4, 5, 4, 5, 8, 9, 8, 9, 12, 13, 12, 13};
    weights_ = repeat_bytes(weight, kShort, 0x00007FFFu);
  }
  HWY_INLINE Int eval(Uint pairs) const { return Int{add_short_products(weights_.raw, pairs.raw)}; }

 private:
  Uint weights_;
};

/// The first two bytes of `low`, the last two of `high`.
HWY_INLINE Uint join_halves(Uint low, Uint high) {
  const hn::Repartition<std::int16_t, UintTag> shorts;
  return hn::BitCast(kUint, hn::OddEven(hn::BitCast(shorts, high), hn::BitCast(shorts, low)));
}
#else
/// The same lane by lane: integers of type T, sums as lanes of type Sum.
template <class T, class Sum, int kLargest>
class WholePairs {
 public:
  static constexpr int kMost = kLargest;

  explicit WholePairs(Uint weight) { hn::Store(hn::And(weight, hn::Set(kUint, kMost)), kUint, weights_); }

  HWY_INLINE hn::Vec<hn::Rebind<Sum, UintTag> > eval(Uint pairs) const {
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

}  // namespace HWY_NAMESPACE
}  // namespace tetravox::cpu
HWY_AFTER_NAMESPACE();

#endif
