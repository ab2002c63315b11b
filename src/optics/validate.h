#pragma once

#include "tetravox/transfer_function.h"

namespace tetravox::optics {

/// @throws Error (kInvalidArgument) that names the first point that is wrong, as `make_optical_function` documents.
void validate_transfer_function(const TransferFunction& function);

}  // namespace tetravox::optics
