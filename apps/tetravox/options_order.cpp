#include "apps/tetravox/options_order.h"

#include "apps/tetravox/option_adding.h"

#include <string>

namespace tetravox::tool {
namespace {

constexpr int kLargestThreadCount = 4096;
constexpr int kLargestRepeat = 1'000'000;

constexpr char kOrderExamples[] = R"(Examples:
  tetravox order engine.vtu                         how long the exact order takes
  tetravox order engine.vtu --sort mpvonc --check   ... another one, and what is wrong with it
  tetravox order engine.vtu --camera-azimuth 30 -o engine.npy
)";

}  // namespace

void add_order(CLI::App& app, OrderCommandOptions& options) {
  begin_group(app, "Order");
  add(app, "--sort", "NAME", "How to sort (tetravox list sorts; default: xmpvo)",
      store(options.method, named(sort_method_from_name)));
  add(app, "--direction", "back-to-front|front-to-back", "Which cell comes first (default: back-to-front)",
      [&options](const std::string& option, const std::string& text) {
        options.direction = parse_choice(option, text, {"back-to-front", "front-to-back"}) == 0
                                ? SortDirection::kBackToFront
                                : SortDirection::kFrontToBack;
      });
  add_flag(app, "--check", options.use_check, "Check the order by brute force: all faces, and rays through pixels");
  add(app, "--resolution", "W,H", "Rays of the check (default: 128,128)", store(options.resolution, parse_resolution));
  add(app, "--repeat", "N", "Sort N times, for timing (default: 1)", store(options.repeat, integer(1, kLargestRepeat)));
  add(app, "--threads", "N", "Threads (default: 0, all cores)",
      store(options.threads, integer(0, kLargestThreadCount)));
  add(app, "-o,--output", "FILE", "Write the order: .npy or .csv, numbers of tetrahedra", store_text(options.output));
  add(app, "--statistics", "FILE", "Write times and counts as JSON", store_text(options.statistics));
  set_footer(app, kOrderExamples);
}

}  // namespace tetravox::tool
