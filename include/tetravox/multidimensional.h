#pragma once

/// Transfer functions of two and three variables, and colour from another array than opacity.
///
/// A variable is the value drawn, the magnitude of its gradient, or the value of another array of the same points. The
/// function is a sum of widgets (Kniss, Kindlmann, Hansen 2002) or a table; both are sampled into an `OpticalTable`,
/// multilinear between its entries, clamped outside.

#include "tetravox/dataset.h"
#include "tetravox/transfer_function.h"

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace tetravox {

enum class VariableKind {
  kValue,     ///< of the array drawn
  kGradient,  ///< its gradient magnitude, value per world length
  kArray      ///< of another array with the same association
};

/// An axis of the domain.
struct Variable {
  VariableKind kind = VariableKind::kValue;
  ArrayRequest array;               ///< of kArray
  std::optional<ValueRange> range;  ///< empty: all that occurs
};

/// Shapes over the domain, 1 at the centre (all over the rectangle), 0 outside.
enum class WidgetShape {
  kRectangle,  ///< centre +- radius along each axis
  kTriangle,   ///< apex at the lower end of the last axis: linear from the centre to a border that widens upwards
  kGaussian    ///< exp(-|(x - centre) / radius|^2)
};

struct Widget {
  WidgetShape shape = WidgetShape::kGaussian;
  std::array<double, 3> center{};  ///< units of the variables
  std::array<double, 3> radius{1, 1, 1};
  Color color{1, 1, 1};
  double opacity = 0.5;  ///< of the shape where it is 1, for the unit distance; in [0, 1]
};

struct MultidimensionalFunction {
  std::vector<Variable> variables;  ///< two or three; two of one kind name different arrays
  std::vector<Widget> widgets;      ///< extinctions add up, colours are their mean weighted by them
  std::string table_file;           ///< instead of widgets: an image (two variables) or an NPY table
  int resolution = 128;  ///< entries an axis that widgets are sampled with, in [16, 1024]; three: at most 128
  std::optional<double> unit_distance;  ///< world length for which opacities hold; empty: diagonal of the bounds / 100
};

/// The function as the renderers take it.
struct OpticalTable {
  std::vector<Variable> variables;    ///< with their ranges
  std::vector<std::size_t> sizes;     ///< entries along each variable, at least 2
  std::vector<OpticalPoint> entries;  ///< first variable fastest; `value` unused
};

/// The widgets of `function`, sampled. Their opacities become extinctions (-ln(1 - opacity) / unit distance), which add
/// up; colours are their mean weighted by these, and where nothing absorbs that of the nearest widget.
///
/// `ranges`: of each variable, for those that have none of their own; one of width 0 is widened.
/// @throws Error (kInvalidArgument) that names the variable or widget and what is wrong with it.
OpticalTable make_optical_table(const MultidimensionalFunction& function, std::span<const ValueRange> ranges,
                                double default_unit_distance);

/// A table of colours that are not premultiplied, and opacities, [..][4], first variable fastest; `sizes`: entries
/// along each variable. Otherwise as above.
OpticalTable make_optical_table(const MultidimensionalFunction& function, std::span<const ValueRange> ranges,
                                double default_unit_distance, std::span<const std::size_t> sizes,
                                std::span<const float> rgba);

/// What is wrong with a function, before anything is known of the data: as `make_optical_table`.
void validate_multidimensional(const MultidimensionalFunction& function);

/// What is wrong with a table.
/// @throws Error (kInvalidArgument) that names the variable or entry.
void validate_optical_table(const OpticalTable& table);

/// Extinction and colour at a place of the domain, one coordinate for each variable.
OpticalPoint eval_optical_table(const OpticalTable& table, std::span<const double> place);

/// Names of enumerators as on the command line and in scene files ("value", "gradient", "array"; "rectangle",
/// "triangle", "gaussian"), and back.
std::string name_of(VariableKind kind);
std::string name_of(WidgetShape shape);
/// @throws Error (kInvalidArgument) that lists the names there are.
VariableKind variable_kind_from_name(const std::string& name);
WidgetShape widget_shape_from_name(const std::string& name);
/// Names, one-line descriptions.
std::vector<std::pair<std::string, std::string>> variable_kind_names();
std::vector<std::pair<std::string, std::string>> widget_shape_names();

/// Colour by another array than the one that gives opacity.
struct ColorBy {
  ArrayRequest array;
  std::optional<TransferFunction> function;  ///< its opacities do not count; empty: a colour map over the array's range
};

}  // namespace tetravox
