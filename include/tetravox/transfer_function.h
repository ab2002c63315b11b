#pragma once

/// Transfer functions: from the scalar to colour and extinction.
///
/// A function is a list of control points, linear in between, clamped outside; two points at one value make a step.
/// Colours are as displayed, in [0, 1], never linearised. Optics: docs/conventions.md.

#include "tetravox/dataset.h"

#include <array>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace tetravox {

using Color = std::array<double, 3>;

/// Whether the control points give extinctions (per world length, >= 0) or opacities (in [0, 1], for `unit_distance`).
enum class Absorption { kExtinction, kOpacity };

struct ControlPoint {
  double value = 0.0;
  Color color{};
  double absorption = 0.0;  ///< extinction or opacity, by TransferFunction::absorption
};

struct TransferFunction {
  std::vector<ControlPoint> points;  ///< ascending values; at least one
  Absorption absorption = Absorption::kExtinction;
  /// World length for which opacities hold: extinction = -ln(1 - opacity) / unit_distance at every value,
  /// opacity itself linear between points. Empty: diagonal of the bounds / 100. Ignored for extinctions.
  std::optional<double> unit_distance;
};

/// A function as the integrators take it: extinction and colour linear between points, clamped outside.
struct OpticalPoint {
  double value = 0.0;
  double extinction = 0.0;  ///< per world length
  Color color{};
};
struct OpticalFunction {
  std::vector<OpticalPoint> points;  ///< ascending values, one or more; equal values make a step
};

/// The largest opacity; 1 is taken as this.
inline constexpr double kLargestOpacity = 1.0 - 1e-6;

/// The function with opacities turned into extinctions, refined into linear pieces of extinction whose error in
/// extinction stays below `tolerance` times the local extinction plus `tolerance` / unit_distance.
/// @throws Error (kInvalidArgument) for no points, values that descend or are not finite, colours outside [0, 1],
///         negative extinction, opacity outside [0, 1], unit_distance <= 0; names the point's index.
OpticalFunction make_optical_function(const TransferFunction& function, double default_unit_distance,
                                      double tolerance = 1e-3);

/// Extinction and colour at one value (at a step: the limit from above).
OpticalPoint eval_optical_function(const OpticalFunction& function, double value);

/// What the presets are asked with.
struct PresetOptions {
  ValueRange range;          ///< values at the two ends
  bool logarithmic = false;  ///< equal steps of log(value); needs range.min > 0
  bool invert = false;       ///< colours the other way round
};

/// A preset by name: a colour map, optionally with an opacity: "viridis", "viridis:ramp", "coolwarm:peaks=5",
/// "random=7". Colour maps: viridis plasma inferno magma cividis turbo coolwarm grayscale rainbow jet. Opacities:
/// linear ramp peaks=N constant (default: linear). `random=SEED`: many peaks of random colours, every iso-surface at
/// once.
/// @throws Error (kInvalidArgument) that lists what there is.
TransferFunction make_preset(const std::string& name, const PresetOptions& options);

/// Names and one-line descriptions, colour maps first, then opacities.
std::vector<std::pair<std::string, std::string>> preset_names();

/// Reads transfer functions from text: a scene file's object, or ParaView's presets (an array of objects with Name,
/// ColorSpace, RGBPoints, Points, NanColor). `preset` picks one by name where there are several. ParaView's colours and
/// opacities are rescaled from their own range to `options.range` where `rescale` is set.
/// @throws Error (kBadFile) that names `source_name`, the place and what is wrong.
TransferFunction parse_transfer_function(const std::string& text, const std::string& source_name,
                                         const std::string& preset, const PresetOptions& options, bool rescale);

/// A histogram of a field over the cells drawn. Equal bins over `range`.
struct Histogram {
  ValueRange range;
  std::vector<double> counts;
  /// World length that suits the shape: the default function's unit distance. Empty: diagonal of the bounds / 100.
  std::optional<double> unit_distance = std::nullopt;
  /// Values of what surrounds the objects (air), not counted: the default function makes them transparent.
  std::optional<ValueRange> background = std::nullopt;
};

/// The function drawn when nobody asked for one: follows the histogram, so that frequent values (the background) are
/// thin and rare ones stand out, with structure visible in front and inside.
TransferFunction make_default_transfer_function(const Histogram& histogram, bool invert = false);

}  // namespace tetravox
