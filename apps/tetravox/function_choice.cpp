#include "apps/tetravox/function_choice.h"

#include "apps/tetravox/text.h"

#include "tetravox/analysis.h"
#include "tetravox/error.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <utility>
#include <variant>

namespace tetravox::tool {
namespace {

constexpr int kBins = 512;
constexpr int kFineBins = 8192;  // from which those of another range are collected
constexpr int kLogarithmPieces = 16;
constexpr std::uintmax_t kLargestFile = std::uintmax_t{64} << 20;  // bytes

/// The range asked for, or the data's. @throws UsageError where it has no logarithm.
ValueRange range_of(const FunctionOptions& options, const ValueRange& all) {
  const ValueRange range = options.range.value_or(all);
  if (options.use_logarithm && !(range.min > 0.0))
    throw UsageError("--log: the range " + format_range(range) +
                     " does not lie above 0: give --range a,b with a above 0");
  return range;
}

bool is_file(const std::string& name) {
  std::error_code ignored;
  return std::filesystem::is_regular_file(name, ignored) || ending_of(name) == ".json" ||
         name.find('/') != std::string::npos;
}

std::string read_file(const std::string& path) {
  std::error_code error;
  const std::uintmax_t size = std::filesystem::file_size(path, error);
  std::ifstream file(path, std::ios::binary);
  if (error || !file)
    throw Error(ErrorCode::kFileNotFound, "cannot open the transfer function '" + path +
                                              "': no such file, or it may not be read; presets: tetravox list presets");
  if (size > kLargestFile) throw Error(ErrorCode::kBadFile, "'" + path + "' is too large for a transfer function");
  std::ostringstream text;
  text << file.rdbuf();
  return std::move(text).str();
}

/// A file's function. ParaView's are for the data's range, as there; our own mean the values that they say, unless a
/// range is given.
TransferFunction read_function(const FunctionOptions& options, const ValueRange& all) {
  const std::string text = read_file(options.function);
  const bool is_paraview = text.find("\"RGBPoints\"") != std::string::npos;
  PresetOptions preset;
  preset.invert = options.invert;
  if (!is_paraview) {
    TransferFunction function = parse_transfer_function(text, options.function, options.preset_name, preset, false);
    if (!options.range && !options.use_logarithm) return function;
    return stretch_function(function, range_of(options, all), options.use_logarithm);
  }
  preset.range = range_of(options, all);
  preset.logarithmic = options.use_logarithm;
  return parse_transfer_function(text, options.function, options.preset_name, preset, true);
}

/// "auto:boundaries" or "auto:boundaries=T": made from the data.
TransferFunction make_automatic_function(const FunctionOptions& options, const Body& body) {
  if (!options.preset_name.empty())
    throw UsageError("--preset-name: picks from a file, and '" + options.function + "' is none: leave it out");
  const std::string name = options.function.substr(0, options.function.find('='));
  if (name != "auto:boundaries")
    throw UsageError("--transfer-function: '" + options.function + "' is not known; there is: auto:boundaries=T");
  if (options.use_logarithm) throw UsageError("--log: auto:boundaries follows the values themselves: leave it out");
  BoundaryOptions boundaries;
  if (name.size() < options.function.size())
    boundaries.thickness =
        parse_positive_number("--transfer-function auto:boundaries", options.function.substr(name.size() + 1));
  boundaries.range = options.range;
  boundaries.invert = options.invert;
  return std::visit([&](const auto& prepared) { return make_boundary_transfer_function(prepared, boundaries); }, body);
}

TransferFunction make_named_function(const FunctionOptions& options, const ValueRange& all) {
  if (!options.preset_name.empty())
    throw UsageError("--preset-name: picks from a file, and '" + options.function + "' is a preset: leave it out");
  PresetOptions preset;
  preset.range = range_of(options, all);
  preset.logarithmic = options.use_logarithm;
  preset.invert = options.invert;
  return make_preset(options.function, preset);
}

/// Collects the bins of a fine histogram in equal bins over `range`, of the value or of its logarithm.
Histogram collect_bins(const Histogram& fine, const ValueRange& range, bool use_logarithm) {
  const auto position = [&](double value) {
    if (!use_logarithm) return (value - range.min) / (range.max - range.min);
    return value > 0.0 ? std::log(value / range.min) / std::log(range.max / range.min) : -1.0;
  };
  Histogram result{range, std::vector<double>(kBins, 0.0), fine.unit_distance, fine.background};
  if (use_logarithm && fine.background)
    result.background = ValueRange{std::clamp(position(fine.background->min), 0.0, 1.0),
                                   std::clamp(position(fine.background->max), 0.0, 1.0)};
  const double width = (fine.range.max - fine.range.min) / static_cast<double>(fine.counts.size());
  for (std::size_t i = 0; i < fine.counts.size(); ++i) {
    // Spread each count evenly over the bins that it touches.
    const double low = position(fine.range.min + static_cast<double>(i) * width) * kBins;
    const double high = position(fine.range.min + static_cast<double>(i + 1) * width) * kBins;
    if (!(high > 0.0) || !(low < kBins) || fine.counts[i] <= 0.0) continue;
    const int first = std::max(0, static_cast<int>(std::floor(std::max(low, 0.0))));
    const int last = std::min(kBins - 1, static_cast<int>(std::ceil(std::min<double>(high, kBins))));
    for (int bin = first; bin <= last; ++bin) {
      const double overlap = std::min<double>(high, bin + 1) - std::max<double>(low, bin);
      if (overlap > 0.0) result.counts[static_cast<std::size_t>(bin)] += fine.counts[i] * overlap / (high - low);
    }
  }
  return result;
}

/// The default function, for other values than all of the data's.
TransferFunction make_default_function(const FunctionOptions& options, const Body& body) {
  const ValueRange range = range_of(options, scalar_range_of(body));
  if (!options.range && !options.use_logarithm)
    return make_default_transfer_function(make_histogram(body, kBins), options.invert);
  const Histogram fine = make_histogram(body, kFineBins);
  if (!(range.min < range.max))
    return make_default_transfer_function({range, {1.0}, fine.unit_distance}, options.invert);
  Histogram histogram = collect_bins(fine, range, options.use_logarithm);
  if (!options.use_logarithm) return make_default_transfer_function(histogram, options.invert);
  // Equal bins of the logarithm: the function is made along it, then stretched over the values.
  histogram.range = {0.0, 1.0};
  return stretch_function(make_default_transfer_function(histogram, options.invert), range, true);
}

}  // namespace

TransferFunction stretch_function(const TransferFunction& function, const ValueRange& range, bool use_logarithm) {
  TransferFunction result = function;
  if (function.points.size() < 2 || !(function.points.front().value < function.points.back().value)) return result;
  const double first = function.points.front().value, last = function.points.back().value;
  const auto stretch = [&](double value) {
    const double t = (value - first) / (last - first);
    if (t <= 0.0) return range.min;
    if (t >= 1.0) return range.max;
    return use_logarithm ? range.min * std::pow(range.max / range.min, t) : std::lerp(range.min, range.max, t);
  };
  result.points.clear();
  for (std::size_t i = 0; i < function.points.size(); ++i) {
    const ControlPoint& b = function.points[i];
    // Along a logarithm, follow the curve between two points by linear pieces.
    const bool is_curved = use_logarithm && i > 0 && function.points[i - 1].value < b.value;
    for (int piece = 1; is_curved && piece < kLogarithmPieces; ++piece) {
      const ControlPoint& a = function.points[i - 1];
      const double t = static_cast<double>(piece) / kLogarithmPieces;
      ControlPoint point;
      point.value = stretch(std::lerp(a.value, b.value, t));
      for (std::size_t c = 0; c < 3; ++c) point.color[c] = std::lerp(a.color[c], b.color[c], t);
      point.absorption = std::lerp(a.absorption, b.absorption, t);
      result.points.push_back(point);
    }
    result.points.push_back(b);
    result.points.back().value = stretch(b.value);
  }
  return result;
}

TransferFunction make_given_function(const FunctionOptions& options, const ValueRange& all) {
  return is_file(options.function) ? read_function(options, all) : make_named_function(options, all);
}

void choose_function(const FunctionOptions& options, const Body& body, Scene& scene) {
  if (!options.preset_name.empty() && options.function.empty())
    throw UsageError("--preset-name: needs a --transfer-function file to pick from");
  if (!options.function.empty()) {
    scene.transfer_function = options.function.starts_with("auto:")
                                  ? make_automatic_function(options, body)
                                  : make_given_function(options, scalar_range_of(body));
  } else if (options.changes_values() && !scene.transfer_function) {
    scene.transfer_function = make_default_function(options, body);
  } else if (options.changes_values()) {
    PresetOptions preset;
    preset.invert = true;
    if (options.invert)
      scene.transfer_function = parse_transfer_function(format_scene(scene), "the scene", "", preset, false);
    if (options.range || options.use_logarithm)
      scene.transfer_function =
          stretch_function(*scene.transfer_function, range_of(options, scalar_range_of(body)), options.use_logarithm);
  }
  if (!options.unit_distance) return;
  if (!scene.transfer_function) scene.transfer_function = complete_scene(scene, body).transfer_function;
  if (scene.transfer_function->absorption == Absorption::kExtinction)
    throw UsageError("--unit-distance: this transfer function gives extinctions, which need none: leave it out");
  scene.transfer_function->unit_distance = options.unit_distance;
}

}  // namespace tetravox::tool
