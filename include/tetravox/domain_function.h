#pragma once

/// Transfer functions of two or three variables (Kniss, Kindlmann, Hansen 2002).
///
/// Given as a sum of primitives, or as a table; either is sampled into a lattice of densities (extinction, extinction *
/// colour), linear in between, clamped outside.

#include "tetravox/dataset.h"
#include "tetravox/transfer_function.h"

#include <array>
#include <optional>
#include <string>
#include <vector>

namespace tetravox {

/// What an axis of the domain stands for.
struct DomainAxis {
  enum class Kind {
    kValue,              ///< the field that is drawn
    kGradientMagnitude,  ///< of that field, value per world length
    kArray               ///< another array of the same file
  };
  Kind kind = Kind::kValue;
  ArrayRequest array;               ///< of kArray
  std::optional<ValueRange> range;  ///< empty: all that occurs
};

/// A widget of direct manipulation: a shape with one colour and an opacity.
struct DomainPrimitive {
  enum class Shape {
    kRectangle,  ///< constant inside center +- half_size
    kTriangle,  ///< 2D: tip at (center[0], center[1] - half_size[1]), widest, and opaquest along its middle, at the top
    kGaussian   ///< exp(-|(x - center) / half_size|^2 / 2)
  };
  Shape shape = Shape::kGaussian;
  std::array<double, 3> center{};     ///< in values of the axes
  std::array<double, 3> half_size{};  ///< > 0
  Color color{1, 1, 1};
  double opacity = 0.5;  ///< in [0, 1], for `DomainFunction::unit_distance`, at its strongest
};

/// Exactly one of `primitives`, `table` and `colors` gives it.
struct DomainFunction {
  std::vector<DomainAxis> axes;             ///< two or three; the first is usually kValue
  int samples = 64;                         ///< lattice points an axis: in [16, 1024] for two, [16, 128] for three
  std::vector<DomainPrimitive> primitives;  ///< extinctions add up, colours mix by extinction
  /// Or a file: PNG (RGB or RGBA; 2D; x to the right, y upwards) or NPY (float [y][x][4] or [z][y][x][4]: red, green,
  /// blue, opacity).
  std::string table;
  /// Or colour from the first axis, opacity from the second.
  std::optional<TransferFunction> colors, opacities;
  std::optional<double> unit_distance;  ///< as for TransferFunction
};

/// The function sampled: densities at lattice points, multilinear in between, clamped outside.
struct DomainTable {
  int axes = 2;  ///< 2 or 3
  std::array<int, 3> sizes{1, 1, 1};
  std::array<ValueRange, 3> ranges{};  ///< of the lattice's first and last points, in values of the axes
  std::vector<float> densities;        ///< [z][y][x][4]: extinction per world length, extinction * colour
};

/// Samples a function. `ranges`: of what occurs, for axes that leave theirs open. `image`: the table's file, where the
/// function names one, [z][y][x][4] red, green, blue, opacity, with `image_sizes` points along x, y, z.
/// @throws Error (kInvalidArgument).
DomainTable make_domain_table(const DomainFunction& function, const std::array<ValueRange, 3>& ranges,
                              double default_unit_distance, const std::vector<float>& image = {},
                              const std::array<int, 3>& image_sizes = {});

/// @throws Error (kInvalidArgument) that names the member.
void validate_domain_function(const DomainFunction& function);

}  // namespace tetravox
