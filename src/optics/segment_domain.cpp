#include "src/optics/segment_domain.h"

#include "src/optics/segment_integral.h"

#include <algorithm>
#include <cmath>

namespace tetravox::optics {

ValueRange find_table_range(const PreintegrationSource& source) {
  const ValueRange& range = source.range;
  if (range.max > range.min) return range;
  const double width = source.function.points.back().value - source.function.points.front().value;
  const double size = std::max(std::abs(range.min), width), half = size > 0.0 ? 1e-6 * size : 1.0;
  return {range.min - half, range.min + half};
}

SegmentDomain make_segment_domain(const PreintegrationSource& source) {
  const ValueRange range = find_table_range(source);
  SegmentDomain domain;
  domain.first = source.map.stored_from_value(range.min);
  const double width = (range.max - range.min) / source.map.scale;
  domain.per_scalar = static_cast<float>(1.0 / width);
  domain.longest = static_cast<float>(source.longest);
  domain.largest_extinction = static_cast<float>(SegmentIntegral(source.function, range).largest_extinction());
  return domain;
}

float eval_scalar_place(const SegmentDomain& domain, float stored) {
  return std::min(std::max((stored - domain.first) * domain.per_scalar, 0.0f), 1.0f);
}

float eval_absorbed_ratio(float depth) {
  return depth > 0.0f ? static_cast<float>(-std::expm1(-static_cast<double>(depth)) / static_cast<double>(depth))
                      : 1.0f;
}

float eval_opacity_bound(const SegmentDomain& domain, float length) {
  const float depth = domain.largest_extinction * std::min(length, domain.longest);
  return depth * eval_absorbed_ratio(depth);
}

float eval_length_place(LengthSpacing spacing, float share) {
  if (spacing == LengthSpacing::kUniform) return share;
  return std::log2(1.0f + kLogarithmicRange * share) * (1.0f / kOctaves);
}

double share_of_length_place(LengthSpacing spacing, double place) {
  if (spacing == LengthSpacing::kUniform) return place;
  return std::min(std::expm1(place * static_cast<double>(kOctaves) * std::log(2.0)) / kLogarithmicRange, 1.0);
}

}  // namespace tetravox::optics
