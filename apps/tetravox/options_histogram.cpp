#include "apps/tetravox/options_histogram.h"

#include "apps/tetravox/option_adding.h"

#include <string>

namespace tetravox::tool {
namespace {

constexpr int kLargestBinCount = 1 << 16;
constexpr int kLargestGradientBinCount = 4096;

constexpr char kHistogramExamples[] = R"(Examples:
  tetravox histogram engine.vtu                     engine-histogram.png: how much volume each value takes
  tetravox histogram head.nii.gz --counts log       rare values can be seen too
  tetravox histogram head.nii.gz --kind gradient    materials are spots at the bottom, boundaries are arches
  tetravox histogram engine.vtu --kind joint --array pressure --other-array density
  tetravox histogram engine.vtu -o engine.csv --bins 100 --range -0.5,1
)";

}  // namespace

void add_histogram(CLI::App& app, HistogramCommandOptions& options) {
  begin_group(app, "Histogram");
  add(app, "-o,--output", "FILE", "What to write: .png, .npy or .csv (default: INPUT's name with -histogram.png, here)",
      [&options](const std::string& option, const std::string& text) {
        if (text.empty()) throw UsageError(option + ": the text is empty");
        options.output = text;
      });
  add(app, "--kind", "value|gradient|joint",
      "Volume by value (default), by value and gradient magnitude, or by value and --other-array",
      [&options](const std::string& option, const std::string& text) {
        options.kind = static_cast<HistogramKind>(parse_choice(option, text, {"value", "gradient", "joint"}));
      });
  add(app, "--other-array", "NAME[:COMPONENT]", "The second axis of --kind joint",
      store(options.other_array, parse_array));
  add(app, "--counts", "linear|log", "How a picture shows volumes (default: linear; of two axes: log)",
      [&options](const std::string& option, const std::string& text) {
        options.use_logarithm = parse_choice(option, text, {"linear", "log"}) == 1;
      });
  add(app, "--bins", "N", "Bins of the value (default: one for each of few whole numbers, otherwise 256)",
      [&options](const std::string& option, const std::string& text) {
        options.bins = static_cast<int>(parse_integer(option, text, 1, kLargestBinCount));
      });
  add(app, "--other-bins,--gradient-bins", "N", "Bins of the gradient magnitude, or of the other array (default: 256)",
      [&options](const std::string& option, const std::string& text) {
        options.other_bins = static_cast<int>(parse_integer(option, text, 1, kLargestGradientBinCount));
      });
  add(app, "--range", "A,B", "Values to count (default: all)",
      [&options](const std::string& option, const std::string& text) { options.range = parse_range(option, text); });
  add(app, "--other-range,--gradient-range", "A,B",
      "Gradient magnitudes per world length (default: all but outliers), or values of the other array, to count",
      [&options](const std::string& option, const std::string& text) {
        options.other_range = parse_range(option, text);
      });
  set_footer(app, kHistogramExamples);
}

}  // namespace tetravox::tool
