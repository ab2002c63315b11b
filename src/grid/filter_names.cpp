/// Names of filters, for command lines and scene files.

#include "tetravox/error.h"
#include "tetravox/grid.h"

#include <array>
#include <charconv>
#include <string_view>

namespace tetravox {
namespace {

struct FilterEntry {
  FilterKind kind;
  std::string_view name;
  std::string_view description;
};

constexpr std::array<FilterEntry, 7> kFilters{
    {{FilterKind::kLinear, "linear", "trilinear (default)"},
     {FilterKind::kNearest, "nearest", "constant around each value"},
     {FilterKind::kBspline, "bspline", "cubic B-spline: smooth, blurs"},
     {FilterKind::kInterpolatingBspline, "bspline-interpolating",
      "cubic B-spline through the values (Unser, Aldroubi, Eden 1991)"},
     {FilterKind::kCatmullRom, "catmull-rom", "cubic through the values (Catmull and Rom 1974)"},
     {FilterKind::kMitchell, "mitchell", "cubic, between sharp and smooth (Mitchell and Netravali 1988)"},
     {FilterKind::kLanczos, "lanczos", "windowed sinc of radius N: lanczos=N, 2 to 8 (default 3; Duchon 1979)"}}};

constexpr int kSmallestRadius = 2, kLargestRadius = 8;

int parse_radius(std::string_view text, const std::string& name) {
  int radius = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), radius);
  if (error != std::errc() || end != text.data() + text.size() || radius < kSmallestRadius || radius > kLargestRadius)
    throw Error(ErrorCode::kInvalidArgument, "filter '" + name + "': expected lanczos=N with N from " +
                                                 std::to_string(kSmallestRadius) + " to " +
                                                 std::to_string(kLargestRadius));
  return radius;
}

}  // namespace

std::string name_of(const Filter& filter) {
  for (const FilterEntry& entry : kFilters)
    if (entry.kind == filter.kind) {
      std::string name(entry.name);
      if (filter.kind == FilterKind::kLanczos) name.append("=").append(std::to_string(filter.radius));
      return name;
    }
  throw Error(ErrorCode::kInvalidArgument, "a filter without a name");
}

Filter filter_from_name(const std::string& name) {
  const std::string_view whole = name, stem = whole.substr(0, whole.find('='));
  std::string known;
  for (const FilterEntry& entry : kFilters) {
    const bool has_radius = entry.kind == FilterKind::kLanczos;
    if (stem == entry.name && (has_radius || stem == whole)) {
      Filter filter{entry.kind};
      if (has_radius && stem != whole) filter.radius = parse_radius(whole.substr(stem.size() + 1), name);
      return filter;
    }
    known.append(known.empty() ? "" : ", ").append(entry.name).append(has_radius ? "=N" : "");
  }
  throw Error(ErrorCode::kInvalidArgument, "there is no filter '" + name + "'; there is: " + known);
}

std::vector<std::pair<std::string, std::string>> filter_names() {
  std::vector<std::pair<std::string, std::string>> names;
  for (const FilterEntry& entry : kFilters) names.emplace_back(entry.name, entry.description);
  return names;
}

}  // namespace tetravox
