#pragma once

/// Options of `tetravox histogram` that no other command has.

#include "apps/tetravox/options.h"

namespace CLI {
class App;
}

namespace tetravox::tool {

/// Adds the options to the command; parsing fills `options`.
void add_histogram(CLI::App& app, HistogramCommandOptions& options);

}  // namespace tetravox::tool
