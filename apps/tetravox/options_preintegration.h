#pragma once

/// Options of the integrators that look ray integrals up in tables.

#include "apps/tetravox/options.h"

namespace CLI {
class App;
}

namespace tetravox::tool {

/// --integrator, and what tables are like.
void add_integrator(CLI::App& app, MethodOptions& method);

}  // namespace tetravox::tool
