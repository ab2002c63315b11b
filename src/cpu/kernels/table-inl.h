// Integrators that look whole ray integrals up: full, polynomial and cylindrical pre-integration. The formulas are
// those of `eval_*` in src/optics, which tests hold them to.

#if defined(TETRAVOX_CPU_TABLE_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef TETRAVOX_CPU_TABLE_INL
#undef TETRAVOX_CPU_TABLE_INL
#else
#define TETRAVOX_CPU_TABLE_INL
#endif

#include "src/cpu/kernels/integrators-inl.h"
#include "src/cpu/kernels/kernels.h"
#include "src/cpu/kernels/segments-inl.h"
#include "src/cpu/kernels/vector_math-inl.h"
#include "src/optics/cylindrical_atlas.h"
#include "src/optics/polynomial_table.h"
#include "src/optics/preintegration_table.h"

#include <cstddef>
#include <cstdint>

HWY_BEFORE_NAMESPACE();
namespace tetravox::cpu {
namespace HWY_NAMESPACE {

/// log2(x) for x >= 1, to 2e-7.
HWY_INLINE Float log2_above_one(Float x) {
  const Int bits = hn::BitCast(kInt, x);
  const Int fraction = hn::Or(hn::And(bits, hn::Set(kInt, 0x7FFFFF)), hn::Set(kInt, 0x3F800000));
  const Float mantissa = hn::BitCast(kFloat, fraction);
  const Float exponent = hn::ConvertTo(kFloat, hn::Sub(hn::ShiftRight<23>(bits), hn::Set(kInt, 127)));
  // z = (m - 1) / (m + 1) for m in [1/sqrt(2), sqrt(2)], of which log m = 2 (z + z^3 / 3 + ...).
  const Mask upper = hn::Gt(mantissa, constant(1.41421356f));
  const Float m = hn::IfThenElse(upper, hn::Mul(mantissa, constant(0.5f)), mantissa);
  const Float whole = hn::Add(exponent, hn::IfThenElseZero(upper, constant(1.0f)));
  const Float z = hn::Div(hn::Sub(m, constant(1.0f)), hn::Add(m, constant(1.0f))), square = hn::Mul(z, z);
  Float sum = constant(1.0f / 9.0f);
  for (const float term : {1.0f / 7.0f, 1.0f / 5.0f, 1.0f / 3.0f, 1.0f})
    sum = multiply_add(sum, square, constant(term));
  return multiply_add(hn::Mul(constant(2.88539008f), z), sum, whole);
}

/// Between entry `index` of a table and the next.
struct TableNode {
  Int index;
  Float part;
};

/// `place` in [0, 1] among `count` entries; whatever it is, the entries exist.
HWY_INLINE TableNode find_table_node(Float place, int count) {
  const Float at = hn::Mul(place, constant(static_cast<float>(count - 1)));
  const Int index = hn::Min(hn::Max(hn::ConvertTo(kInt, at), hn::Zero(kInt)), hn::Set(kInt, count - 2));
  return {index, hn::Sub(at, hn::ConvertTo(kFloat, index))};
}

HWY_INLINE Record mix_records(Float t, const Record& a, const Record& b) {
  const auto channel = [&](Float from, Float to) { return multiply_add(t, hn::Sub(to, from), from); };
  return {channel(a.x, b.x), channel(a.y, b.y), channel(a.z, b.z), channel(a.w, b.w)};
}

/// Bilinear among records `first`, `first + 1`, `first + row`, `first + row + 1`.
HWY_INLINE Record mix_table_square(const float* records, Int first, std::ptrdiff_t row, Float x, Float y) {
  const Uint index = hn::BitCast(kUint, first);
  const auto edge = [&](const float* from) {
    return mix_records(x, load_table_records(from, index), load_table_records(from + 4, index));
  };
  const Record low = edge(records);
  return mix_records(y, low, edge(records + 4 * row));
}

/// Where segments lie in a table.
struct TablePlace {
  Float front, back, inside, share;  ///< scalars in [0, 1]; world length, at most the longest, and its part of that

  HWY_INLINE TablePlace(const optics::SegmentDomain& domain, const Segments& segment) {
    const auto place = [&](Float scalar) {
      const Float at = hn::Mul(hn::Sub(scalar, constant(domain.first)), constant(domain.per_scalar));
      return hn::Min(hn::Max(at, constant(0.0f)), constant(1.0f));
    };
    front = place(segment.scalar_front);
    back = place(segment.scalar_back);
    inside = hn::Min(segment.length, constant(domain.longest));
    share = hn::Div(inside, constant(domain.longest));
  }

  /// What a table holds, times the opacity bound.
  HWY_INLINE Record unfold(const optics::SegmentDomain& domain, const Record& quotient) const {
    const Float depth = hn::Mul(constant(domain.largest_extinction), inside);
    const Float bound = hn::Mul(depth, absorbed_ratio(depth));
    return {hn::Mul(quotient.x, bound), hn::Mul(quotient.y, bound), hn::Mul(quotient.z, bound),
            hn::Mul(quotient.w, bound)};
  }
};

/// See `optics::eval_preintegration_table`.
HWY_NOINLINE inline Record look_up_table(const optics::PreintegrationTable& table, const Segments& segment) {
  const TablePlace place(table.domain, segment);
  Float along = place.share;
  if (table.spacing == LengthSpacing::kLogarithmic)
    along = hn::Mul(log2_above_one(hn::Add(constant(1.0f), hn::Mul(constant(optics::kLogarithmicRange), place.share))),
                    constant(1.0f / optics::kOctaves));
  const TableNode x = find_table_node(place.front, table.scalars), y = find_table_node(place.back, table.scalars);
  const TableNode z = find_table_node(along, table.lengths);
  const Int scalars = hn::Set(kInt, table.scalars);
  const Int first = hn::Add(hn::Mul(hn::Add(hn::Mul(z.index, scalars), y.index), scalars), x.index);
  const std::ptrdiff_t row = table.scalars, layer = row * row;
  const float* entries = table.entries.data();
  const Record near = mix_table_square(entries, first, row, x.part, y.part);
  const Record far = mix_table_square(entries + 4 * layer, first, row, x.part, y.part);
  return place.unfold(table.domain, mix_records(z.part, near, far));
}

/// See `optics::eval_polynomial_table`.
HWY_NOINLINE inline Record look_up_polynomial(const optics::PolynomialTable& table, const Segments& segment) {
  using optics::PolynomialTable;
  const Float zero = constant(0.0f), one = constant(1.0f);
  const TablePlace place(table.domain, segment);
  const TableNode x = find_table_node(place.front, table.scalars), y = find_table_node(place.back, table.scalars);
  const std::ptrdiff_t row = table.scalars;
  const Int first = hn::Add(hn::Mul(y.index, hn::Set(kInt, table.scalars)), x.index);
  const auto look_up = [&](int map) {
    return mix_table_square(table.maps.data() + 4 * map * row * row, first, row, x.part, y.part);
  };
  Record sum = look_up(table.degree);
  for (int map = table.degree - 1; map >= 0; --map) {
    const Record coefficient = look_up(map);
    sum = {multiply_add(sum.x, place.share, coefficient.x), multiply_add(sum.y, place.share, coefficient.y),
           multiply_add(sum.z, place.share, coefficient.z), coefficient.w};
  }
  const Float depth = hn::Mul(sum.w, place.inside);
  Float opacity = hn::Min(depth, one);
  if (table.opacity == OpacityModel::kExponential) {
    const Float at = hn::Min(hn::Mul(depth, constant(1.0f / PolynomialTable::kDeepest)), one);
    const TableNode node = find_table_node(at, PolynomialTable::kDepths);
    const float* ratios = table.absorbed_ratios.data();
    const Float low = hn::GatherIndex(kFloat, ratios, node.index);
    const Float high = hn::GatherIndex(kFloat, ratios + 1, node.index);
    const Float ratio = multiply_add(node.part, hn::Sub(high, low), low);
    opacity = hn::IfThenElse(hn::Lt(depth, constant(PolynomialTable::kDeepest)), hn::Mul(depth, ratio), one);
  }
  const auto channel = [&](Float color) { return hn::Mul(hn::Min(hn::Max(color, zero), one), opacity); };
  return {channel(sum.x), channel(sum.y), channel(sum.z), opacity};
}

/// See `optics::eval_cylindrical_atlas`.
HWY_NOINLINE inline Record look_up_atlas(const optics::CylindricalAtlas& atlas, const Segments& segment) {
  const Float one = constant(1.0f);
  const TablePlace place(atlas.domain, segment);
  const Float difference = hn::Sub(place.back, place.front), slant = hn::Abs(difference);
  const Float radius = hn::Max(slant, place.share), divisor = hn::Max(radius, constant(1e-30f));
  const Float steep = hn::Sub(constant(2.0f), hn::Div(place.share, divisor)), flat = hn::Div(slant, divisor);
  const Float size = hn::IfThenElse(hn::Gt(slant, place.share), steep, flat);
  const Float turn = hn::IfThenElse(hn::Lt(difference, constant(0.0f)), hn::Neg(size), size);
  const Float width = hn::Max(hn::Sub(one, slant), constant(1e-6f));
  const Float along = hn::Min(hn::Div(hn::Min(place.front, place.back), width), one);

  const Float plane_place = hn::Mul(hn::Add(turn, constant(2.0f)), constant(0.25f));
  const TableNode plane = find_table_node(plane_place, atlas.planes);
  const TableNode x = find_table_node(along, atlas.tile), y = find_table_node(radius, atlas.tile);
  const std::ptrdiff_t row = static_cast<std::ptrdiff_t>(atlas.columns) * atlas.tile;
  const Int tile = hn::Set(kInt, atlas.tile), wide = hn::Set(kInt, static_cast<std::int32_t>(row));
  const auto look_up = [&](Int index) {
    // Planes are so few that floats divide them exactly, half a plane away from whole numbers.
    const Float quotient = hn::Mul(hn::Add(hn::ConvertTo(kFloat, index), constant(0.5f)),
                                   constant(1.0f / static_cast<float>(atlas.columns)));
    const Int tile_row = hn::ConvertTo(kInt, quotient);
    const Int tile_column = hn::Sub(index, hn::Mul(tile_row, hn::Set(kInt, atlas.columns)));
    const Int line = hn::Add(hn::Mul(tile_row, tile), y.index);
    const Int first = hn::Add(hn::Mul(line, wide), hn::Add(hn::Mul(tile_column, tile), x.index));
    return mix_table_square(atlas.texels.data(), first, row, x.part, y.part);
  };
  const Record near = look_up(plane.index), far = look_up(hn::Add(plane.index, hn::Set(kInt, 1)));
  return place.unfold(atlas.domain, mix_records(plane.part, near, far));
}

/// The integral of each segment by the table at hand. One class for all of them, so that sources and effects are
/// compiled once.
class TableIntegrator : public WithoutFront {
 public:
  explicit TableIntegrator(const IntegratorTables& tables)
      : table_(tables.preintegration), polynomial_(tables.polynomial), atlas_(tables.atlas) {}

  HWY_INLINE void integrate(const Segments& segment, Front&, Accumulated& sum) const {
    const Mask drawn = hn::Gt(segment.length, constant(0.0f));
    const Record found = look_up(segment);
    const auto channel = [&](Float color, Float so_far) {
      return multiply_add(sum.transmittance, hn::IfThenElseZero(drawn, color), so_far);
    };
    sum.red = channel(found.x, sum.red);
    sum.green = channel(found.y, sum.green);
    sum.blue = channel(found.z, sum.blue);
    const Float opacity = hn::IfThenElseZero(drawn, hn::Min(found.w, constant(1.0f)));
    sum.transmittance = hn::Sub(sum.transmittance, hn::Mul(sum.transmittance, opacity));
  }

  HWY_INLINE Record look_up(const Segments& segment) const {
    if (table_) return look_up_table(*table_, segment);
    if (polynomial_) return look_up_polynomial(*polynomial_, segment);
    return look_up_atlas(*atlas_, segment);
  }

 private:
  const optics::PreintegrationTable* table_;
  const optics::PolynomialTable* polynomial_;
  const optics::CylindricalAtlas* atlas_;
};

}  // namespace HWY_NAMESPACE
}  // namespace tetravox::cpu
HWY_AFTER_NAMESPACE();

#endif
