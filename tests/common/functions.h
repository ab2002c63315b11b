#pragma once

/// Optical functions that are hard to draw, for a range of values and a size of the mesh.

#include "tetravox/transfer_function.h"

#include <string>
#include <vector>

namespace tetravox::tests {

struct NamedFunction {
  std::string name;
  OpticalFunction function;
};

/// "smooth" (nine points), "thick" (the same, nearly opaque), "spikes" (eight peaks, each a hundredth of the range wide
/// to a side), "steps" (extinction and colour jump), "random" (64 points at random). `diagonal` of the bounds sets the
/// extinctions, as strong as in real pictures.
std::vector<NamedFunction> make_hard_functions(const ValueRange& range, double diagonal);

/// Diagonal of a box.
double diagonal_of(const std::array<ValueRange, 3>& bounds);

}  // namespace tetravox::tests
