#include "src/optics/transfer_function_json.h"

#include "src/optics/color_maps.h"
#include "src/optics/color_spaces.h"
#include "src/optics/refine.h"
#include "src/optics/validate.h"
#include "src/optics/value_map.h"
#include "tetravox/error.h"

#include <algorithm>
#include <cmath>

namespace tetravox {
namespace {

using optics::ColorSpace;
using optics::JsonPlace;

struct ColorNode {
  double value = 0.0;
  Color color{};
};

/// A node of VTK's vtkPiecewiseFunction; midpoint and sharpness shape the piece that begins here.
struct OpacityNode {
  double value = 0.0;
  double opacity = 0.0;
  double midpoint = 0.5;
  double sharpness = 0.0;
};

struct Preset {
  std::vector<ColorNode> colors;
  std::vector<OpacityNode> opacities;
  ColorSpace space = ColorSpace::kRgb;
};

/// A number that ought to be in [0, 1]; a rounding error outside is forgiven.
double unit_number(const JsonPlace& place, const char* what) {
  const double number = place.number();
  if (!(number >= -1e-3 && number <= 1.0 + 1e-3)) place.fail(std::string(what) + " must be in [0, 1]");
  return std::clamp(number, 0.0, 1.0);
}

std::size_t count_of(const JsonPlace& place, std::size_t stride, const char* what) {
  const std::size_t size = place.size();
  if (size == 0 || size % stride != 0) place.fail(std::string("expected ") + what + " for each point");
  if (size / stride > optics::kLargestPointCount) place.fail("more than 100000 points");
  return size / stride;
}

std::vector<ColorNode> read_colors(const JsonPlace& place) {
  std::vector<ColorNode> nodes(count_of(place, 4, "four numbers (value, red, green, blue)"));
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    nodes[i].value = place.at(4 * i).number();
    for (std::size_t c = 0; c < 3; ++c) nodes[i].color[c] = unit_number(place.at(4 * i + 1 + c), "a colour");
  }
  std::stable_sort(nodes.begin(), nodes.end(), [](const auto& a, const auto& b) { return a.value < b.value; });
  return nodes;
}

std::vector<OpacityNode> read_opacities(const JsonPlace& place) {
  std::vector<OpacityNode> nodes(count_of(place, 4, "four numbers (value, opacity, midpoint, sharpness)"));
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    nodes[i].value = place.at(4 * i).number();
    nodes[i].opacity = unit_number(place.at(4 * i + 1), "an opacity");
    nodes[i].midpoint = std::clamp(unit_number(place.at(4 * i + 2), "a midpoint"), 1e-5, 1.0 - 1e-5);
    nodes[i].sharpness = unit_number(place.at(4 * i + 3), "a sharpness");
  }
  std::stable_sort(nodes.begin(), nodes.end(), [](const auto& a, const auto& b) { return a.value < b.value; });
  return nodes;
}

Preset read_paraview_preset(const JsonPlace& place) {
  Preset preset;
  if (place.find("IndexedColors") && !place.find("RGBPoints"))
    place.fail("a categorical preset (IndexedColors) has no function of the value; use one with RGBPoints");
  preset.colors = read_colors(place.at("RGBPoints"));
  if (const auto points = place.find("Points"); points && !points->value().is_null())
    preset.opacities = read_opacities(*points);
  else  // as the opacity preset "linear"
    preset.opacities = {{preset.colors.front().value, 0.0}, {preset.colors.back().value, optics::kLinearOpacity}};
  if (const auto name = place.find("ColorSpace")) {
    const auto space = optics::color_space_from_name(name->string());
    if (!space)
      name->fail("unknown colour space '" + optics::printable(name->string()) +
                 "'; known are RGB, HSV, Lab, CIELAB, Lab/CIEDE2000, Diverging, Step");
    preset.space = *space;
  }
  if (const auto wrap = place.find("HSVWrap"); wrap && preset.space == ColorSpace::kHsv) {
    const bool use_wrap = wrap->value().is_boolean() ? wrap->boolean() : wrap->number() != 0.0;
    if (use_wrap) preset.space = ColorSpace::kHsvWrapped;
  }
  return preset;
}

/// Opacity on the way from `a` to `b`, `s` in [0, 1] with 0.5 at the midpoint: vtkPiecewiseFunction's curve, a
/// Hermite spline of a power.
double mix_opacity(const OpacityNode& a, const OpacityNode& b, double s, bool is_first_half) {
  if (a.sharpness > 0.99) return is_first_half ? a.opacity : b.opacity;
  if (a.sharpness < 0.01) return std::lerp(a.opacity, b.opacity, s);
  const double power = 1.0 + 10.0 * a.sharpness;
  s = s < 0.5 ? 0.5 * std::pow(2.0 * s, power) : 1.0 - 0.5 * std::pow(2.0 - 2.0 * s, power);
  const double rise = s * s * (3.0 - 2.0 * s);
  const double slope = (1.0 - a.sharpness) * (b.opacity - a.opacity);
  const double opacity = std::lerp(a.opacity, b.opacity, rise) + slope * s * (1.0 - s) * (1.0 - 2.0 * s);
  return std::clamp(opacity, std::min(a.opacity, b.opacity), std::max(a.opacity, b.opacity));
}

double midpoint_value(const OpacityNode& a, const OpacityNode& b) { return std::lerp(a.value, b.value, a.midpoint); }

/// The index of the last node at or below `value`, 0 where there is none.
template <class Node>
std::size_t node_below(const std::vector<Node>& nodes, double value) {
  const auto above =
      std::upper_bound(nodes.begin(), nodes.end(), value, [](double v, const Node& node) { return v < node.value; });
  return above == nodes.begin() ? 0 : static_cast<std::size_t>(above - nodes.begin()) - 1;
}

/// A function whose pieces lie between neighbouring breakpoints of its colours and of its opacities.
class MergedCurve {
 public:
  explicit MergedCurve(Preset preset) : preset_(std::move(preset)) {
    for (const ColorNode& node : preset_.colors) breaks_.push_back(node.value);
    for (std::size_t i = 0; i < preset_.opacities.size(); ++i) {
      breaks_.push_back(preset_.opacities[i].value);
      if (i > 0) breaks_.push_back(midpoint_value(preset_.opacities[i - 1], preset_.opacities[i]));
    }
    std::sort(breaks_.begin(), breaks_.end());
    breaks_.erase(std::unique(breaks_.begin(), breaks_.end()), breaks_.end());
  }

  ControlPoint below() const { return {0.0, preset_.colors.front().color, preset_.opacities.front().opacity}; }
  ControlPoint above() const { return {0.0, preset_.colors.back().color, preset_.opacities.back().opacity}; }
  std::size_t piece_count() const { return std::max<std::size_t>(breaks_.size(), 2) - 1; }

  /// `u` runs along the piece; the value is still the preset's own.
  ControlPoint eval(std::size_t piece, double u) const {
    const double begin = breaks_[piece], end = breaks_[std::min(piece + 1, breaks_.size() - 1)];
    const double value = std::lerp(begin, end, u);
    return {value, color_at(begin, value), opacity_at(begin, value)};
  }

 private:
  Color color_at(double begin, double value) const {
    const std::size_t i = node_below(preset_.colors, begin);
    const ColorNode& a = preset_.colors[i];
    if (i + 1 == preset_.colors.size() || value < a.value) return a.color;
    const ColorNode& b = preset_.colors[i + 1];
    return optics::mix_colors(preset_.space, a.color, b.color, fraction(a.value, b.value, value));
  }

  double opacity_at(double begin, double value) const {
    const std::size_t i = node_below(preset_.opacities, begin);
    const OpacityNode& a = preset_.opacities[i];
    if (i + 1 == preset_.opacities.size() || value < a.value) return a.opacity;
    const OpacityNode& b = preset_.opacities[i + 1];
    const double middle = midpoint_value(a, b);
    if (begin < middle) return mix_opacity(a, b, 0.5 * fraction(a.value, middle, value), true);
    return mix_opacity(a, b, 0.5 + 0.5 * fraction(middle, b.value, value), false);
  }

  static double fraction(double a, double b, double value) {
    const double width = 0.5 * b - 0.5 * a;
    return width > 0.0 ? std::clamp((0.5 * value - 0.5 * a) / width, 0.0, 1.0) : 0.0;
  }

  Preset preset_;
  std::vector<double> breaks_;
};

/// Maps values linearly to [0, 1].
template <class Node>
void normalize(std::vector<Node>& nodes) {
  const double first = nodes.front().value, last = nodes.back().value, width = 0.5 * last - 0.5 * first;
  for (Node& node : nodes)
    node.value = width > 0.0 ? std::clamp((0.5 * node.value - 0.5 * first) / width, 0.0, 1.0) : 0.0;
}

/// Colours the other way round, within their own range.
void invert_colors(std::vector<ColorNode>& nodes) {
  const double first = nodes.front().value, last = nodes.back().value;
  std::reverse(nodes.begin(), nodes.end());
  for (ColorNode& node : nodes) node.value = std::clamp(first + (last - node.value), first, last);
}

/// Writes ColorSpace "Step" as two colours at one value.
void expand_steps(Preset& preset) {
  if (preset.space != ColorSpace::kStep) return;
  std::vector<ColorNode> steps{preset.colors.front()};
  for (std::size_t i = 1; i < preset.colors.size(); ++i) {
    steps.push_back({preset.colors[i - 1].value, preset.colors[i].color});
    steps.push_back(preset.colors[i]);
  }
  preset.colors = std::move(steps);
  preset.space = ColorSpace::kRgb;
}

/// The curve's points, with `value_of` applied to their values.
template <class ValueOf>
std::vector<ControlPoint> refine_merged(const MergedCurve& merged, const ValueOf& value_of,
                                        double absorption_tolerance) {
  optics::Curve curve;
  curve.piece_count = merged.piece_count();
  curve.absorption_tolerance = absorption_tolerance;
  curve.eval = [&](std::size_t piece, double u) {
    ControlPoint point = merged.eval(piece, u);
    point.value = value_of(point.value);
    return point;
  };
  std::vector<ControlPoint> points = optics::refine(curve);

  // A step at either end shows only beyond it.
  const auto is_same = [](const ControlPoint& a, const ControlPoint& b) {
    return a.color == b.color && a.absorption == b.absorption;
  };
  const ControlPoint below = merged.below(), above = merged.above();
  if (!is_same(below, points.front()))
    points.insert(points.begin(), {points.front().value, below.color, below.absorption});
  if (!is_same(above, points.back())) points.push_back({points.back().value, above.color, above.absorption});
  return points;
}

TransferFunction function_from_preset(Preset preset, const PresetOptions& options, bool rescale) {
  expand_steps(preset);
  if (options.invert) invert_colors(preset.colors);
  std::optional<optics::ValueMap> map;
  if (rescale) {
    normalize(preset.colors);
    normalize(preset.opacities);
    map.emplace(options.range, options.logarithmic);
  }
  TransferFunction function;
  function.absorption = Absorption::kOpacity;
  function.points = refine_merged(
      MergedCurve(std::move(preset)), [&](double value) { return map ? map->value(value) : value; },
      optics::kOpacityTolerance);
  return function;
}

/// The object that is meant: the only one, or the one called `preset`.
JsonPlace choose_preset(const JsonPlace& list, const std::string& preset) {
  const std::size_t count = list.size();
  if (count == 0) list.fail("an empty list of presets");
  if (count == 1 && preset.empty()) return list.at(std::size_t{0});
  std::string names;
  for (std::size_t i = 0; i < count; ++i) {
    const auto name = list.at(i).find("Name");
    if (!name) continue;
    if (!preset.empty() && name->string() == preset) return list.at(i);
    if (names.size() < 400) names += (names.empty() ? "" : ", ") + optics::printable(name->string());
  }
  if (preset.empty()) list.fail("holds " + std::to_string(count) + " presets; name one of: " + names);
  list.fail("no preset is called '" + optics::printable(preset) + "'; there are: " + names);
}

/// The function with its colours mirrored about the middle of its values; absorption stays where it is.
TransferFunction invert_function(const TransferFunction& function) {
  Preset preset;
  double largest = 0.0;
  for (const ControlPoint& point : function.points) {
    preset.colors.push_back({point.value, point.color});
    preset.opacities.push_back({point.value, point.absorption});
    largest = std::max(largest, point.absorption);
  }
  invert_colors(preset.colors);
  TransferFunction inverted = function;
  inverted.points = refine_merged(
      MergedCurve(std::move(preset)), [](double value) { return value; }, 1e-6 * largest);
  return inverted;
}

}  // namespace

namespace optics {

TransferFunction read_scene_function(const JsonPlace& place) {
  place.require_keys({"points", "unit_distance"});
  TransferFunction function;
  const JsonPlace points = place.at("points");
  const std::size_t count = count_of(points, 1, "one object");
  function.points.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    const JsonPlace point = points.at(i);
    point.require_keys({"value", "color", "extinction", "opacity"});
    function.points[i].value = point.at("value").number();
    point.at("color").numbers(function.points[i].color.data(), 3);
    const auto extinction = point.find("extinction"), opacity = point.find("opacity");
    if (extinction.has_value() == opacity.has_value()) point.fail("give either 'extinction' or 'opacity'");
    const Absorption absorption = extinction ? Absorption::kExtinction : Absorption::kOpacity;
    if (i > 0 && absorption != function.absorption)
      point.fail("extinctions and opacities in one function; use the same key for every point");
    function.absorption = absorption;
    function.points[i].absorption = (extinction ? extinction : opacity)->number();
  }
  if (const auto distance = place.find("unit_distance")) function.unit_distance = distance->number();
  try {
    validate_transfer_function(function);
  } catch (const Error& error) {
    place.fail(error.what());
  }
  return function;
}

nlohmann::ordered_json write_scene_function(const TransferFunction& function) {
  const bool is_opacity = function.absorption == Absorption::kOpacity;
  nlohmann::ordered_json json, points = nlohmann::ordered_json::array();
  for (const ControlPoint& point : function.points)
    points.push_back(
        {{"value", point.value}, {"color", point.color}, {is_opacity ? "opacity" : "extinction", point.absorption}});
  json["points"] = std::move(points);
  if (function.unit_distance) json["unit_distance"] = *function.unit_distance;
  return json;
}

}  // namespace optics

TransferFunction parse_transfer_function(const std::string& text, const std::string& source_name,
                                         const std::string& preset, const PresetOptions& options, bool rescale) {
  const nlohmann::json json = optics::parse_json(text, source_name);
  const JsonPlace root(json, source_name);
  if (json.is_object() && !json.contains("RGBPoints") && !json.contains("IndexedColors")) {
    // A whole scene is as good as its function.
    const auto nested = root.find("transfer_function");
    const TransferFunction function = optics::read_scene_function(nested ? *nested : root);
    return options.invert ? invert_function(function) : function;
  }
  if (rescale) optics::require_range(options.range, options.logarithmic);
  if (!json.is_object() && !json.is_array())
    root.fail("expected a transfer function: an object with 'points', or ParaView's list of presets");
  const JsonPlace place = json.is_array() ? choose_preset(root, preset) : root;
  return function_from_preset(read_paraview_preset(place), options, rescale);
}

}  // namespace tetravox
