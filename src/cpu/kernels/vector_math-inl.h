// Vector helpers, compiled once for each instruction set: no include guard by design of foreach_target.h.

#if defined(TETRAVOX_CPU_VECTOR_MATH_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef TETRAVOX_CPU_VECTOR_MATH_INL
#undef TETRAVOX_CPU_VECTOR_MATH_INL
#else
#define TETRAVOX_CPU_VECTOR_MATH_INL
#endif

#include <hwy/highway.h>

#include <cstddef>
#include <cstdint>

HWY_BEFORE_NAMESPACE();
namespace tetravox::cpu {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

/// At most sixteen rays travel together.
using FloatTag = hn::CappedTag<float, 16>;
using IntTag = hn::RebindToSigned<FloatTag>;
using UintTag = hn::RebindToUnsigned<FloatTag>;
using Float = hn::Vec<FloatTag>;
using Int = hn::Vec<IntTag>;
using Uint = hn::Vec<UintTag>;
using Mask = hn::Mask<FloatTag>;

constexpr FloatTag kFloat;
constexpr IntTag kInt;
constexpr UintTag kUint;
constexpr std::size_t kLanes = hn::MaxLanes(FloatTag());

/// One 16-byte record a lane, as four vectors.
struct Record {
  Float x, y, z, w;
};

HWY_INLINE Float constant(float value) { return hn::Set(kFloat, value); }

/// Multiply, then add, each rounded: never fused, so that all instruction sets agree to the bit.
HWY_INLINE Float multiply_add(Float a, Float b, Float c) { return hn::Add(hn::Mul(a, b), c); }

/// From a to b.
HWY_INLINE Float mix(Float t, Float a, Float b) { return multiply_add(t, hn::Sub(b, a), a); }

/// Between the corners (0, 0), (1, 0), (0, 1), (1, 1) of a square.
HWY_INLINE Float mix_square(const Record& corners, Float x, Float y) {
  return mix(y, mix(x, corners.x, corners.y), mix(x, corners.z, corners.w));
}

/// The integer nearest to 0 <= x < 2^22, ties to even: the lowest bits of a sum. `hn::NearestInt` looks after larger
/// numbers, too, in twice the instructions.
HWY_INLINE Int round_small(Float x) {
  constexpr float kUnit = 8388608.0f;  // 2^23, of which the unit is the last place
  return hn::Sub(hn::BitCast(kInt, hn::Add(x, constant(kUnit))), hn::BitCast(kInt, constant(kUnit)));
}

HWY_INLINE Mask float_mask(hn::Mask<UintTag> mask) { return hn::RebindMask(kFloat, mask); }
HWY_INLINE hn::Mask<UintTag> uint_mask(Mask mask) { return hn::RebindMask(kUint, mask); }
HWY_INLINE hn::Mask<IntTag> int_mask(Mask mask) { return hn::RebindMask(kInt, mask); }

#if HWY_TARGET != HWY_SCALAR
/// Four floats: a record.
using Block = hn::Vec128<float>;

/// `load(lane)` of lanes i, i + 4, i + 8, ..., one in each 128-bit block.
template <class Tag, class LoadBlock>
HWY_INLINE hn::Vec<Tag> load_blocks(Tag tag, const LoadBlock& load, std::size_t i) {
  if constexpr (hn::MaxLanes(Tag()) == 4) {
    return load(i);
  } else {
    const hn::Half<Tag> half;
    return hn::Combine(tag, load_blocks(half, load, i + hn::MaxLanes(Tag()) / 2), load_blocks(half, load, i));
  }
}

/// The records `load(lane)` of all lanes.
template <class LoadBlock>
HWY_INLINE Record transpose_blocks(const LoadBlock& load) {
  Float row[4];
  for (std::size_t i = 0; i < 4; ++i) row[i] = load_blocks(kFloat, load, i);
  const Float xy_even = hn::InterleaveLower(kFloat, row[0], row[2]);
  const Float xy_odd = hn::InterleaveLower(kFloat, row[1], row[3]);
  const Float zw_even = hn::InterleaveUpper(kFloat, row[0], row[2]);
  const Float zw_odd = hn::InterleaveUpper(kFloat, row[1], row[3]);
  return {hn::InterleaveLower(kFloat, xy_even, xy_odd), hn::InterleaveUpper(kFloat, xy_even, xy_odd),
          hn::InterleaveLower(kFloat, zw_even, zw_odd), hn::InterleaveUpper(kFloat, zw_even, zw_odd)};
}
#endif

/// The 16-byte records `record(lane)` of all lanes. Sixteen-byte loads and a transposition beat hardware gathers.
template <class FindRecord>
HWY_INLINE Record transpose_records(const FindRecord& record) {
#if HWY_TARGET == HWY_SCALAR
  const float* r = record(0);
  return {constant(r[0]), constant(r[1]), constant(r[2]), constant(r[3])};
#else
  return transpose_blocks([&](std::size_t i) { return hn::LoadU(hn::Full128<float>(), record(i)); });
#endif
}

/// `records[index]` of each lane.
HWY_INLINE Record load_records(const void* records, Uint index) {
  HWY_ALIGN std::uint32_t lane[kLanes];
  hn::Store(index, kUint, lane);
  const float* base = static_cast<const float*>(records);
  return transpose_records([&](std::size_t i) { return base + 4 * static_cast<std::size_t>(lane[i]); });
}

/// The same for tables of fewer than 2^28 records: their byte offsets are found for all lanes at once.
HWY_INLINE Record load_table_records(const void* records, Uint index) {
  HWY_ALIGN std::uint32_t offset[kLanes];
  hn::Store(hn::ShiftLeft<4>(index), kUint, offset);
  const char* base = static_cast<const char*>(records);
  return transpose_records([&](std::size_t i) { return reinterpret_cast<const float*>(base + offset[i]); });
}

/// (1 - exp(-x)) / x for 0 <= x <= 1/4, to 2e-6: the series.
HWY_INLINE Float absorbed_ratio_series(Float x) {
  Float sum = constant(1.0f / 120.0f);
  sum = multiply_add(sum, x, constant(-1.0f / 24.0f));
  sum = multiply_add(sum, x, constant(1.0f / 6.0f));
  sum = multiply_add(sum, x, constant(-0.5f));
  return multiply_add(sum, x, constant(1.0f));
}

/// exp(-x) for x >= 0, relative error below 1e-6; 0 beyond 87.
HWY_INLINE Float exp_negative(Float x) {
  const Float y = hn::Mul(hn::Min(x, constant(87.0f)), constant(-1.44269504f));
  const Int exponent = hn::NearestInt(y);
  const Float r = hn::Mul(hn::Sub(y, hn::ConvertTo(kFloat, exponent)), constant(0.69314718f));
  Float sum = constant(1.0f / 720.0f);
  sum = multiply_add(sum, r, constant(1.0f / 120.0f));
  sum = multiply_add(sum, r, constant(1.0f / 24.0f));
  sum = multiply_add(sum, r, constant(1.0f / 6.0f));
  sum = multiply_add(sum, r, constant(0.5f));
  sum = multiply_add(sum, r, constant(1.0f));
  sum = multiply_add(sum, r, constant(1.0f));
  const Int biased = hn::ShiftLeft<23>(hn::Add(exponent, hn::Set(kInt, 127)));
  return hn::IfThenZeroElse(hn::Ge(x, constant(87.0f)), hn::Mul(sum, hn::BitCast(kFloat, biased)));
}

/// (1 - exp(-x)) / x for any x >= 0.
HWY_INLINE Float absorbed_ratio(Float x) {
  const Float exact = hn::Div(hn::Sub(constant(1.0f), exp_negative(x)), hn::Max(x, constant(0.25f)));
  return hn::IfThenElse(hn::Le(x, constant(0.25f)), absorbed_ratio_series(x), exact);
}

}  // namespace HWY_NAMESPACE
}  // namespace tetravox::cpu
HWY_AFTER_NAMESPACE();

#endif
