#include "apps/tetravox/multidimensional_choice.h"

#include "apps/tetravox/function_choice.h"

#include "tetravox/analysis.h"
#include "tetravox/error.h"
#include "tetravox/io.h"

#include <cmath>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

namespace tetravox::tool {
namespace {

constexpr const char* kDefaultColors = "viridis";

/// Refuses options of functions of one variable.
void refuse_simple(const FunctionOptions& function) {
  const std::string reason =
      ": is for functions of the value alone: leave it out, or draw by the value (--variables none)";
  if (!function.function.empty()) throw UsageError("--transfer-function" + reason);
  if (!function.preset_name.empty()) throw UsageError("--preset-name" + reason);
  if (function.use_logarithm) throw UsageError("--log" + reason);
  if (function.invert) throw UsageError("--invert" + reason);
}

/// The function that `variables` begin; the first variable is the value.
MultidimensionalFunction begin_function(const std::vector<Variable>& variables) {
  MultidimensionalFunction function;
  function.variables.emplace_back();
  function.variables.insert(function.variables.end(), variables.begin(), variables.end());
  return function;
}

void override_shapes(const MultidimensionalOptions& options, MultidimensionalFunction& function) {
  if (!options.widgets.empty() && !options.table.empty()) throw UsageError("give --widget or --table, not both");
  if (!options.widgets.empty() || !options.table.empty()) {
    function.widgets.clear();
    function.table_file = options.table;
  }
  const std::size_t variables = function.variables.size();
  for (const WidgetOption& option : options.widgets) {
    if (option.variables != variables)
      throw UsageError("--widget: a centre of " + std::to_string(option.variables) + " numbers where there are " +
                       std::to_string(variables) + " variables");
    function.widgets.push_back(option.widget);
  }
  function.resolution = options.resolution.value_or(function.resolution);
}

/// Where the value's range is the command line's.
void override_range(const FunctionOptions& options, MultidimensionalFunction& function) {
  for (Variable& variable : function.variables)
    if (variable.kind == VariableKind::kValue && options.range) variable.range = options.range;
}

void override_colors(const MultidimensionalOptions& options, Scene& scene) {
  if (options.color_array) {
    scene.color_by.reset();
    if (!options.color_array->name.empty()) scene.color_by = ColorBy{*options.color_array, {}};
  }
  if (!scene.color_by && (!options.color_function.empty() || options.color_range))
    throw UsageError("--color-function and --color-range need --color-array");
  if (scene.color_by && scene.multidimensional)
    throw UsageError("--color-array: a function of several variables has colours of its own: leave out one of the two");
}

/// World length for which opacities hold where nobody says.
double default_unit_distance(const Body& body) {
  const auto bounds = bounds_of(body);
  const double diagonal =
      std::hypot(bounds[0].max - bounds[0].min, bounds[1].max - bounds[1].min, bounds[2].max - bounds[2].min);
  return diagonal > 0.0 ? diagonal / 100.0 : 1.0;
}

MultidimensionalFunction make_default_function(const std::vector<Variable>& variables, const Body& body) {
  return std::visit([&](const auto& prepared) { return make_default_multidimensional(prepared, variables); }, body);
}

/// Gives every variable a range, where it is wider than one value. Returns the ranges.
std::vector<ValueRange> complete_ranges(const Body& body, std::vector<Variable>& variables) {
  const std::vector<ValueRange> ranges =
      std::visit([&](const auto& prepared) { return make_variable_ranges(prepared, variables); }, body);
  for (std::size_t i = 0; i < variables.size(); ++i)
    if (ranges[i].min < ranges[i].max) variables[i].range = ranges[i];
  return ranges;
}

/// The colours of a file or preset, or those of the map.
TransferFunction make_colors(const MultidimensionalOptions& options, const ValueRange& range) {
  FunctionOptions function;
  function.function = options.color_function.empty() ? kDefaultColors : options.color_function;
  function.range = options.color_range;
  return make_given_function(function, range);
}

}  // namespace

void override_multidimensional(const MultidimensionalOptions& options, const FunctionOptions& function, Scene& scene) {
  if (options.variables) {
    scene.multidimensional.reset();
    if (!options.variables->empty()) scene.multidimensional = begin_function(*options.variables);
    if (scene.multidimensional && !options.color_array) scene.color_by.reset();
  } else if (scene.multidimensional && !function.function.empty()) {
    scene.multidimensional.reset();
  }
  if (!scene.multidimensional && (!options.widgets.empty() || !options.table.empty() || options.resolution))
    throw UsageError("--widget, --table and --table-resolution need --variables");
  override_colors(options, scene);
  if (!scene.multidimensional) return;
  refuse_simple(function);
  scene.transfer_function.reset();
  override_shapes(options, *scene.multidimensional);
  override_range(function, *scene.multidimensional);
  try {
    validate_multidimensional(*scene.multidimensional);
  } catch (const Error& error) {
    const std::string what = error.what();
    throw UsageError((what.starts_with("widget") ? "--widget: " : "--variables: ") + what);
  }
}

std::vector<std::string> check_multidimensional(const MultidimensionalOptions& options, bool shows_volume) {
  if (shows_volume) return {};
  const std::pair<bool, const char*> given[] = {
      {options.variables && !options.variables->empty(), "--variables"},
      {!options.widgets.empty(), "--widget"},
      {!options.table.empty(), "--table"},
      {options.resolution.has_value(), "--table-resolution"},
      {options.color_array && !options.color_array->name.empty(), "--color-array"},
      {!options.color_function.empty(), "--color-function"},
      {options.color_range.has_value(), "--color-range"},
  };
  std::vector<std::string> lines;
  for (const auto& [is_given, option] : given)
    if (is_given)
      lines.push_back(std::string(option) + " changes nothing: --volume off leaves nothing to colour by it");
  return lines;
}

std::optional<OpticalTable> choose_table(const MultidimensionalOptions& options, const FunctionOptions& function,
                                         const Body& body, Scene& scene) {
  if (!scene.multidimensional) return std::nullopt;
  MultidimensionalFunction& chosen = *scene.multidimensional;
  if (chosen.widgets.empty() && chosen.table_file.empty()) {
    chosen = make_default_function(chosen.variables, body);
    chosen.resolution = options.resolution.value_or(chosen.resolution);
  }
  if (function.unit_distance) chosen.unit_distance = function.unit_distance;
  const std::vector<ValueRange> ranges = complete_ranges(body, chosen.variables);
  const double unit_distance = default_unit_distance(body);
  if (chosen.table_file.empty()) return make_optical_table(chosen, ranges, unit_distance);
  const FunctionTable table = read_function_table(chosen.table_file, chosen.variables.size());
  return make_optical_table(chosen, ranges, unit_distance, table.sizes, table.rgba);
}

std::optional<OpticalFunction> choose_colors(const MultidimensionalOptions& options, const Body& body, Scene& scene) {
  if (!scene.color_by) return std::nullopt;
  std::optional<TransferFunction>& function = scene.color_by->function;
  const ValueRange range = other_range_of(body, 0);
  if (!function || !options.color_function.empty())
    function = make_colors(options, range);
  else if (options.color_range)
    function = stretch_function(*function, *options.color_range, false);
  return make_optical_function(*function, default_unit_distance(body));
}

}  // namespace tetravox::tool
