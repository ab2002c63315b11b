#pragma once

/// One function for each command. They print to stdout and throw `UsageError` or `Error`.

#include "apps/tetravox/options.h"

namespace tetravox::tool {

void run_render(const RenderOptions& options);
void run_info(const InfoOptions& options);
void run_histogram(const HistogramCommandOptions& options);
void run_order(const OrderCommandOptions& options);
void run_list(const ListOptions& options);

}  // namespace tetravox::tool
