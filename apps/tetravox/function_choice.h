#pragma once

/// Which transfer function is drawn: the command line's, the scene's, or one made from the data.

#include "apps/tetravox/body.h"
#include "apps/tetravox/options.h"

#include "tetravox/scene.h"

namespace tetravox::tool {

/// Puts the transfer function that the options ask for into `scene`; leaves it as it is where they ask for nothing.
/// @throws Error or UsageError that names the option.
void choose_function(const FunctionOptions& options, const Body& body, Scene& scene);

/// The function of a file or a preset, for data in the range `all`. @throws Error or UsageError as above.
TransferFunction make_given_function(const FunctionOptions& options, const ValueRange& all);

/// The function with its values stretched from its own ends to those of `range`, evenly in the value or, along a
/// logarithm, in the value's logarithm (then cut into 16 linear pieces between points).
TransferFunction stretch_function(const TransferFunction& function, const ValueRange& range, bool use_logarithm);

}  // namespace tetravox::tool
