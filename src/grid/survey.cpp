#include "src/grid/survey.h"

#include "src/grid/frame.h"
#include "src/grid/visit_type.h"
#include "src/support/threads.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>
#include <tbb/partitioner.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <type_traits>
#include <vector>

namespace tetravox::grid {
namespace {

/// Tuples that are looked at at a time: all components of them stay in the cache.
constexpr std::size_t kGrain = std::size_t{1} << 16;
/// Values that are compared side by side.
constexpr std::size_t kLanes = 32;

constexpr ValueSurvey kNothing{{std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()}, 0};

void add(ValueSurvey& survey, const ValueSurvey& other) {
  survey.range.min = std::min(survey.range.min, other.range.min);
  survey.range.max = std::max(survey.range.max, other.range.max);
  survey.missing += other.missing;
}

/// Of `count` values, one in `stride`. Lanes keep the loop free of dependencies and of branches.
template <class T>
ValueSurvey survey_scalars(const T* values, std::size_t count, std::size_t stride) {
  using Limits = std::numeric_limits<T>;
  constexpr T kHighest = Limits::has_infinity ? Limits::infinity() : Limits::max();
  constexpr T kLowest = Limits::has_infinity ? -Limits::infinity() : Limits::lowest();
  std::array<T, kLanes> low, high;
  std::array<std::uint32_t, kLanes> missing{};
  low.fill(kHighest);
  high.fill(kLowest);
  const auto look = [&](std::size_t lane, T value) {
    bool is_finite = true;
    if constexpr (std::is_floating_point_v<T>) is_finite = value - value == T{0};
    const T for_low = is_finite ? value : kHighest, for_high = is_finite ? value : kLowest;
    low[lane] = for_low < low[lane] ? for_low : low[lane];
    high[lane] = for_high > high[lane] ? for_high : high[lane];
    if constexpr (std::is_floating_point_v<T>) missing[lane] += is_finite ? 0u : 1u;
  };
  std::size_t i = 0;
  if (stride == 1)
    for (; i + kLanes <= count; i += kLanes)
      for (std::size_t lane = 0; lane < kLanes; ++lane) look(lane, values[i + lane]);
  for (; i < count; ++i) look(0, values[i * stride]);
  ValueSurvey survey = kNothing;
  for (const std::uint32_t lane_missing : missing) survey.missing += lane_missing;
  if (survey.missing == count) return survey;
  survey.range.min = static_cast<double>(*std::min_element(low.begin(), low.end()));
  survey.range.max = static_cast<double>(*std::max_element(high.begin(), high.end()));
  return survey;
}

template <class T>
ValueSurvey survey_magnitudes(const T* values, std::size_t count, std::size_t components) {
  ValueSurvey survey = kNothing;
  for (std::size_t i = 0; i < count; ++i) {
    double sum = 0.0;
    for (std::size_t c = 0; c < components; ++c) {
      const auto value = static_cast<double>(values[i * components + c]);
      sum += value * value;
    }
    if (!std::isfinite(sum)) {
      ++survey.missing;
      continue;
    }
    survey.range.min = std::min(survey.range.min, std::sqrt(sum));
    survey.range.max = std::max(survey.range.max, std::sqrt(sum));
  }
  return survey;
}

/// One survey for each of `wanted` (components, or `kMagnitude`), in one pass.
std::vector<ValueSurvey> survey_components(const GridData& grid, const std::vector<int>& wanted,
                                           const Progress& progress) {
  const auto dimensions = grid.value_dimensions();
  const auto components = static_cast<std::size_t>(grid.components);
  return visit_type(grid.type, [&](auto any) {
    using T = decltype(any);
    const T* values = reinterpret_cast<const T*>(grid.values.data());
    return tbb::parallel_reduce(
        tbb::blocked_range<std::size_t>(0, dimensions[0] * dimensions[1] * dimensions[2], kGrain),
        std::vector<ValueSurvey>(wanted.size(), kNothing),
        [&](const tbb::blocked_range<std::size_t>& part, std::vector<ValueSurvey> surveys) {
          support::throw_if_cancelled(progress);
          const T* first = values + part.begin() * components;
          for (std::size_t i = 0; i < wanted.size(); ++i)
            add(surveys[i], wanted[i] == kMagnitude ? survey_magnitudes(first, part.size(), components)
                                                    : survey_scalars(first + wanted[i], part.size(), components));
          return surveys;
        },
        [](std::vector<ValueSurvey> a, const std::vector<ValueSurvey>& b) {
          for (std::size_t i = 0; i < a.size(); ++i) add(a[i], b[i]);
          return a;
        },
        tbb::simple_partitioner{});
  });
}

}  // namespace

ValueSurvey survey_values(const GridData& grid) { return survey_components(grid, {grid.component}, {}).front(); }

ArrayInfo describe_values(const GridData& grid, const Progress& progress) {
  ArrayInfo info;
  info.name = grid.array_name;
  info.association = grid.association;
  info.components = grid.components;
  info.type = scalar_type_name(grid.type);
  std::vector<int> wanted;
  for (int component = 0; component < grid.components; ++component) wanted.push_back(component);
  if (grid.components > 1) wanted.push_back(kMagnitude);
  const auto range_of = [](const ValueSurvey& survey) {
    return survey.range.min <= survey.range.max ? survey.range : ValueRange{};
  };
  const std::vector<ValueSurvey> surveys = survey_components(grid, wanted, progress);
  for (int component = 0; component < grid.components; ++component)
    info.component_ranges.push_back(range_of(surveys[static_cast<std::size_t>(component)]));
  info.magnitude_range = range_of(surveys.back());
  info.nan_count = surveys.back().missing;
  return info;
}

void describe_grid(const GridData& grid, DatasetInfo& info, const Progress& progress) {
  info.grid = grid.shape;
  info.point_count = info.cell_count = 1;
  for (const std::uint32_t points : grid.shape.dimensions) {
    info.point_count *= points;
    info.cell_count *= points - 1;
  }
  info.bounds = bounds_of(grid.shape);
  info.arrays = {describe_values(grid, progress)};
}

}  // namespace tetravox::grid
