#include "src/optics/color_maps.h"
#include "src/optics/json_reader.h"
#include "src/optics/refine.h"
#include "src/optics/value_map.h"
#include "tetravox/error.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <limits>

namespace tetravox {
namespace optics {

void require_range(const ValueRange& range, bool logarithmic) {
  if (!std::isfinite(range.min) || !std::isfinite(range.max) || range.min > range.max)
    throw Error(ErrorCode::kInvalidArgument, "the range must be two finite numbers, the smaller first");
  if (logarithmic && !(range.min > 0.0))
    throw Error(ErrorCode::kInvalidArgument, "a logarithmic range must begin above 0; give another range");
}

ValueMap::ValueMap(ValueRange range, bool logarithmic) : range_(range), logarithmic_(logarithmic) {
  require_range(range, logarithmic);
  if (range.min == range.max) {
    const double half = range.min == 0.0 ? 0.5 : 1e-3 * std::abs(range.min);
    range_ = {std::max(range.min - half, std::numeric_limits<double>::lowest()),
              std::min(range.max + half, std::numeric_limits<double>::max())};
    logarithmic_ = false;
  }
}

double ValueMap::value(double t) const {
  if (!(t > 0.0)) return range_.min;
  if (!(t < 1.0)) return range_.max;
  if (!logarithmic_) return std::lerp(range_.min, range_.max, t);
  return std::clamp(std::exp(std::lerp(std::log(range_.min), std::log(range_.max), t)), range_.min, range_.max);
}

}  // namespace optics

namespace {

using optics::ColorMapPoint;

// Opacities are for a hundredth of the diagonal: a ray across a cube is 58 of them long.
constexpr double kRampOpacity = 0.3;
constexpr double kPeakOpacity = 0.3;
constexpr double kConstantOpacity = 0.02;
constexpr double kRandomOpacity = 0.15;
constexpr int kDefaultPeakCount = 5;
constexpr int kLargestPeakCount = 100;
constexpr int kRandomPointCount = 64;

struct OpacityPoint {
  double t = 0.0;
  double opacity = 0.0;
};

[[noreturn]] void fail_preset(const std::string& name, const std::string& what) {
  std::string known;
  for (const auto& [preset, description] : preset_names()) known += (known.empty() ? "" : ", ") + preset;
  throw Error(ErrorCode::kInvalidArgument,
              "transfer function '" + optics::printable(name) + "': " + what + "; there are: " + known);
}

/// "peaks=5" -> "peaks" and "5".
std::pair<std::string, std::optional<std::string>> split_argument(const std::string& word) {
  const std::size_t equals = word.find('=');
  if (equals == std::string::npos) return {word, std::nullopt};
  return {word.substr(0, equals), word.substr(equals + 1)};
}

template <class Number>
std::optional<Number> parse_number(const std::string& text) {
  Number number{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return number;
}

std::vector<OpacityPoint> make_peaks(int count) {
  const double half_width = std::min(0.02, 0.25 / count);
  std::vector<OpacityPoint> points{{0.0, 0.0}};
  for (int i = 0; i < count; ++i) {
    const double middle = (i + 0.5) / count;
    points.push_back({middle - half_width, 0.0});
    points.push_back({middle, kPeakOpacity});
    points.push_back({middle + half_width, 0.0});
  }
  points.push_back({1.0, 0.0});
  return points;
}

/// Transparent for low values, solid for high ones: the square of t.
std::vector<OpacityPoint> make_ramp() {
  constexpr int kPieces = 16;
  std::vector<OpacityPoint> points;
  for (int i = 0; i <= kPieces; ++i) {
    const double t = static_cast<double>(i) / kPieces;
    points.push_back({t, kRampOpacity * t * t});
  }
  return points;
}

std::vector<OpacityPoint> make_opacity(const std::string& name, const std::string& word) {
  const auto [kind, argument] = split_argument(word);
  if (kind == "peaks") {
    const auto count = argument ? parse_number<int>(*argument) : kDefaultPeakCount;
    if (!count || *count < 1 || *count > kLargestPeakCount) fail_preset(name, "peaks takes a number from 1 to 100");
    return make_peaks(*count);
  }
  if (kind == "constant") {
    const auto opacity = argument ? parse_number<double>(*argument) : kConstantOpacity;
    if (!opacity || !(*opacity >= 0.0 && *opacity <= 1.0)) fail_preset(name, "constant takes an opacity in [0, 1]");
    return {{0.0, *opacity}, {1.0, *opacity}};
  }
  if (argument) fail_preset(name, "'" + optics::printable(kind) + "' takes no argument");
  if (kind == "linear") return {{0.0, 0.0}, {1.0, optics::kLinearOpacity}};
  if (kind == "ramp") return make_ramp();
  fail_preset(name, "unknown opacity '" + optics::printable(kind) + "'");
}

/// Numbers in [0, 1) that are the same on every platform (splitmix64: Steele, Lea, Flood 2014).
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed) {}
  double next() {
    state_ += 0x9e3779b97f4a7c15u;
    std::uint64_t z = state_;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return static_cast<double>((z ^ (z >> 31)) >> 11) * 0x1p-53;
  }

 private:
  std::uint64_t state_;
};

void make_random(std::uint64_t seed, std::vector<ColorMapPoint>& colors, std::vector<OpacityPoint>& opacities) {
  Random random(seed);
  for (int i = 0; i < kRandomPointCount; ++i) {
    const double t = static_cast<double>(i) / (kRandomPointCount - 1);
    const double r = random.next(), g = random.next(), b = random.next(), u = random.next();
    colors.push_back({t, {r, g, b}});
    opacities.push_back({t, kRandomOpacity * u * u * u});
  }
}

double eval(const std::vector<OpacityPoint>& points, double t) {
  const auto above = std::upper_bound(points.begin(), points.end(), t, [](double v, const auto& p) { return v < p.t; });
  if (above == points.begin()) return points.front().opacity;
  if (above == points.end()) return points.back().opacity;
  const OpacityPoint &a = *(above - 1), &b = *above;
  return std::lerp(a.opacity, b.opacity, (t - a.t) / (b.t - a.t));
}

/// Joins both at the union of their points; along a logarithm refined into linear pieces.
std::vector<ControlPoint> merge(const std::vector<ColorMapPoint>& colors, const std::vector<OpacityPoint>& opacities,
                                const PresetOptions& options) {
  const optics::ValueMap map(options.range, options.logarithmic);
  std::vector<double> breaks;
  for (const ColorMapPoint& point : colors) breaks.push_back(point.t);
  for (const OpacityPoint& point : opacities) breaks.push_back(point.t);
  std::sort(breaks.begin(), breaks.end());
  breaks.erase(std::unique(breaks.begin(), breaks.end()), breaks.end());
  optics::Curve curve;
  curve.piece_count = breaks.size() - 1;
  curve.eval = [&](std::size_t piece, double u) {
    const double t = std::lerp(breaks[piece], breaks[piece + 1], u);
    return ControlPoint{map.value(t), optics::eval_color_map(colors, t), eval(opacities, t)};
  };
  return optics::refine(curve);
}

}  // namespace

TransferFunction make_preset(const std::string& name, const PresetOptions& options) {
  if (name.size() > 256) fail_preset(name, "not a name of a preset");
  std::vector<ColorMapPoint> colors;
  std::vector<OpacityPoint> opacities;
  const std::size_t colon = name.find(':');
  const auto [map_name, argument] = split_argument(name.substr(0, colon));
  if (map_name == "random") {
    const auto seed = argument ? parse_number<std::uint64_t>(*argument) : std::uint64_t{1};
    if (!seed) fail_preset(name, "random takes a whole number");
    make_random(*seed, colors, opacities);
    if (colon != std::string::npos) opacities = make_opacity(name, name.substr(colon + 1));
  } else {
    colors = optics::color_map_points(map_name);
    if (colors.empty() || argument) fail_preset(name, "unknown colour map");
    opacities = make_opacity(name, colon == std::string::npos ? "linear" : name.substr(colon + 1));
  }
  if (options.invert) {
    std::reverse(colors.begin(), colors.end());
    for (ColorMapPoint& point : colors) point.t = 1.0 - point.t;
  }
  TransferFunction function;
  function.absorption = Absorption::kOpacity;
  function.points = merge(colors, opacities, options);
  return function;
}

std::vector<std::pair<std::string, std::string>> preset_names() {
  std::vector<std::pair<std::string, std::string>> names;
  for (const optics::ColorMapEntry& map : optics::color_maps()) names.emplace_back(map.name, map.description);
  names.emplace_back("random=SEED", "64 random colours and opacities: every iso-surface at once");
  names.emplace_back(":linear", "opacity rises with the value (the default)");
  names.emplace_back(":ramp", "opacity rises with the value's square: high values solid, low ones clear");
  names.emplace_back(":peaks=N", "N thin shells at equal steps of the value");
  names.emplace_back(":constant=A", "the same opacity A everywhere");
  return names;
}

}  // namespace tetravox
