/// What can be wrong with functions of several variables.

#include "tetravox/error.h"
#include "tetravox/multidimensional.h"

#include <cmath>
#include <string>

namespace tetravox {
namespace {

constexpr int kFewestEntries = 16, kMostEntries = 1024, kMostEntriesOfThree = 128;

[[noreturn]] void fail(const std::string& message) { throw Error(ErrorCode::kInvalidArgument, message); }

bool are_same(const Variable& a, const Variable& b) {
  if (a.kind != b.kind) return false;
  return a.kind != VariableKind::kArray || (a.array.name == b.array.name && a.array.component == b.array.component &&
                                            a.array.association == b.array.association);
}

bool is_valid(const ValueRange& range) {
  return std::isfinite(range.min) && std::isfinite(range.max) && range.min < range.max;
}

/// `needs_names`: whether arrays are to be told apart by name; in a table, the renderer is told which they are.
void validate_variables(const std::vector<Variable>& variables, bool needs_names) {
  if (variables.size() < 2 || variables.size() > 3)
    fail("a function of several variables has two or three of them, not " + std::to_string(variables.size()));
  for (std::size_t i = 0; i < variables.size(); ++i) {
    const std::string name = "variable " + std::to_string(i);
    if (variables[i].range && !is_valid(*variables[i].range))
      fail(name + ": its range must be two finite numbers, the smaller one first");
    const bool is_array = variables[i].kind == VariableKind::kArray;
    for (std::size_t k = 0; k < i && (needs_names || !is_array); ++k)
      if (are_same(variables[i], variables[k]))
        fail(name + " is the same as variable " + std::to_string(k) + ": choose another");
  }
}

void validate_widget(const Widget& widget, std::size_t index, std::size_t variables) {
  const std::string name = "widget " + std::to_string(index) + ": ";
  for (std::size_t axis = 0; axis < variables; ++axis) {
    if (!std::isfinite(widget.center[axis])) fail(name + "its centre is not finite");
    if (!(std::isfinite(widget.radius[axis]) && widget.radius[axis] > 0.0)) fail(name + "its radius must be above 0");
  }
  for (const double channel : widget.color)
    if (!(channel >= 0.0 && channel <= 1.0)) fail(name + "colours are three numbers in [0, 1]");
  if (!(widget.opacity >= 0.0 && widget.opacity <= 1.0)) fail(name + "opacity must be in [0, 1]");
}

}  // namespace

void validate_multidimensional(const MultidimensionalFunction& function) {
  validate_variables(function.variables, true);
  const std::size_t count = function.variables.size();
  const int most = count == 3 ? kMostEntriesOfThree : kMostEntries;
  if (function.resolution < kFewestEntries || function.resolution > most)
    fail("a function of " + std::to_string(count) + " variables has a resolution between " +
         std::to_string(kFewestEntries) + " and " + std::to_string(most) + " entries an axis");
  if (!function.widgets.empty() && !function.table_file.empty())
    fail("a function of several variables has widgets or a table, not both");
  if (function.unit_distance && !(std::isfinite(*function.unit_distance) && *function.unit_distance > 0.0))
    fail("the unit distance must be a finite number above 0");
  for (std::size_t i = 0; i < function.widgets.size(); ++i) validate_widget(function.widgets[i], i, count);
}

void validate_optical_table(const OpticalTable& table) {
  validate_variables(table.variables, false);
  if (table.sizes.size() != table.variables.size())
    fail("a table of " + std::to_string(table.variables.size()) + " variables has " +
         std::to_string(table.sizes.size()) + " axes");
  std::size_t size = 1;
  const auto most = static_cast<std::size_t>(table.sizes.size() == 3 ? kMostEntriesOfThree : kMostEntries);
  for (std::size_t axis = 0; axis < table.sizes.size(); ++axis) {
    if (!table.variables[axis].range) fail("variable " + std::to_string(axis) + " of the table has no range");
    if (table.sizes[axis] < 2 || table.sizes[axis] > most)
      fail("axis " + std::to_string(axis) + " of the table has " + std::to_string(table.sizes[axis]) +
           " entries; there must be between 2 and " + std::to_string(most));
    size *= table.sizes[axis];
  }
  if (table.entries.size() != size)
    fail("the table has " + std::to_string(table.entries.size()) + " entries where its axes ask for " +
         std::to_string(size));
  for (std::size_t i = 0; i < size; ++i) {
    const OpticalPoint& entry = table.entries[i];
    if (!(entry.extinction >= 0.0 && std::isfinite(entry.extinction)))
      fail("entry " + std::to_string(i) + " of the table: the extinction is negative or not finite");
    for (const double channel : entry.color)
      if (!(channel >= 0.0 && channel <= 1.0))
        fail("entry " + std::to_string(i) + " of the table: colours lie in [0, 1]");
  }
}

}  // namespace tetravox
