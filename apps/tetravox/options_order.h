#pragma once

/// Options of `tetravox order` that no other command has.

#include "apps/tetravox/options.h"

namespace CLI {
class App;
}

namespace tetravox::tool {

/// Adds the options to the command; parsing fills `options`.
void add_order(CLI::App& app, OrderCommandOptions& options);

}  // namespace tetravox::tool
