#include "apps/tetravox/options_multidimensional.h"

#include "apps/tetravox/option_adding.h"

#include "tetravox/multidimensional.h"

#include <algorithm>
#include <cstddef>
#include <string>
#include <vector>

namespace tetravox::tool {
namespace {

constexpr const char* kWidgetForm = "SHAPE:x,y:rx,ry:r,g,b:opacity";
constexpr const char* kArrayPrefix = "array:";

/// "A..B" with A < B.
ValueRange parse_span(const std::string& option, const std::string& text) {
  const std::size_t dots = text.find("..");
  if (dots == std::string::npos) throw UsageError(option + ": '" + text + "' is not a range 'a..b'");
  return parse_range(option, text.substr(0, dots) + "," + text.substr(dots + 2));
}

/// "gradient" or "array:NAME[:COMPONENT]", each with "=a..b" behind it.
Variable parse_variable(const std::string& option, std::string text) {
  Variable variable;
  if (const std::size_t equals = text.rfind('='); equals != std::string::npos) {
    variable.range = parse_span(option, text.substr(equals + 1));
    text.erase(equals);
  }
  if (text.starts_with(kArrayPrefix)) {
    variable.kind = VariableKind::kArray;
    variable.array = parse_array(option, text.substr(std::string(kArrayPrefix).size()));
    return variable;
  }
  variable.kind = named(variable_kind_from_name)(option, text);
  if (variable.kind == VariableKind::kArray) throw UsageError(option + ": array names no array: give array:NAME");
  if (variable.kind == VariableKind::kValue)
    throw UsageError(option + ": the value of --array is the first variable already: name the ones beside it");
  return variable;
}

std::vector<Variable> parse_variables(const std::string& option, const std::string& text) {
  if (text == "none") return {};
  std::vector<Variable> variables;
  for (const std::string& part : split(text, ',')) variables.push_back(parse_variable(option, part));
  if (variables.size() > 2) throw UsageError(option + ": '" + text + "' are more than two beside the value");
  return variables;
}

WidgetOption parse_widget(const std::string& option, const std::string& text) {
  const std::vector<std::string> parts = split(text, ':');
  if (parts.size() < 3 || parts.size() > 5)
    throw UsageError(option + ": '" + text + "' is not " + kWidgetForm + " (three numbers each for three variables)");
  WidgetOption result;
  result.widget.shape = named(widget_shape_from_name)(option, parts[0]);
  result.variables = split(parts[1], ',').size();
  if (result.variables < 2 || result.variables > 3)
    throw UsageError(option + ": the centre '" + parts[1] + "' is not two or three numbers, one for each variable");
  const std::string what = "one for each variable";
  const std::vector<double> center = parse_numbers(option, parts[1], result.variables, what);
  const std::vector<double> radius = parse_numbers(option, parts[2], result.variables, what);
  std::copy(center.begin(), center.end(), result.widget.center.begin());
  std::copy(radius.begin(), radius.end(), result.widget.radius.begin());
  if (parts.size() > 3) result.widget.color = parse_color(option, parts[3]);
  if (parts.size() > 4) result.widget.opacity = parse_number(option, parts[4]);
  return result;
}

}  // namespace

void add_multidimensional(CLI::App& app, MultidimensionalOptions& options) {
  begin_group(app, "Function of several variables (tetravox list methods)");
  add(app, "--variables", "NAMES",
      "Beside the value of --array: gradient, array:NAME[:COMPONENT], or two of them with ',' between; =a..b sets a "
      "range; none: of the value alone",
      store(options.variables, parse_variables));
  add_repeatable(app, "--widget", kWidgetForm,
                 "Gaussian, rectangle or triangle over the variables; may be given again (default: from the data)",
                 [&options](const std::string& option, const std::string& text) {
                   options.widgets.push_back(parse_widget(option, text));
                 });
  add(app, "--table", "FILE", "Colours and opacities as .npy, .png or .exr, in place of widgets",
      store_text(options.table));
  add(app, "--table-resolution", "N",
      "Entries an axis that widgets are sampled with (default: 128; of three from the data: 64)",
      store(options.resolution, integer(16, 1024)));

  begin_group(app, "Colour by another array");
  add(app, "--color-array", "NAME[:COMPONENT]",
      "Array that colours follow, opacity that of --array; none: of one array",
      [&options](const std::string& option, const std::string& text) {
        options.color_array = text == "none" ? ArrayRequest{} : parse_array(option, text);
      });
  add(app, "--color-function", "FILE|PRESET", "Its colours (default: viridis)", store_text(options.color_function));
  add(app, "--color-range", "A,B", "Values at the two ends of the colours (default: the array's range)",
      store(options.color_range, parse_range));
}

}  // namespace tetravox::tool
