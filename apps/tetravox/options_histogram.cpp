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
  tetravox histogram engine.vtu -o engine.csv --bins 100 --range -0.5,1
)";

}  // namespace

void add_histogram(CLI::App& app, HistogramCommandOptions& options) {
  app.option_defaults()->group("Histogram");
  add(app, "-o,--output", "FILE", "What to write: .png, .npy or .csv (default: INPUT's name with -histogram.png, here)",
      [&options](const std::string& option, const std::string& text) {
        if (text.empty()) throw UsageError(option + ": the text is empty");
        options.output = text;
      });
  add(app, "--kind", "value|gradient", "Volume by value, or by value and gradient magnitude (default: value)",
      [&options](const std::string& option, const std::string& text) {
        options.kind =
            parse_choice(option, text, {"value", "gradient"}) == 0 ? HistogramKind::kValue : HistogramKind::kGradient;
      });
  add(app, "--counts", "linear|log", "How a picture shows volumes (default: linear; of gradients: log)",
      [&options](const std::string& option, const std::string& text) {
        options.use_logarithm = parse_choice(option, text, {"linear", "log"}) == 1;
      });
  add(app, "--bins", "N", "Bins of the value (default: one for each of few whole numbers, otherwise 256)",
      [&options](const std::string& option, const std::string& text) {
        options.bins = static_cast<int>(parse_integer(option, text, 1, kLargestBinCount));
      });
  add(app, "--gradient-bins", "N", "Bins of the gradient magnitude (default: 256)",
      [&options](const std::string& option, const std::string& text) {
        options.gradient_bins = static_cast<int>(parse_integer(option, text, 1, kLargestGradientBinCount));
      });
  add(app, "--range", "A,B", "Values to count (default: all)",
      [&options](const std::string& option, const std::string& text) { options.range = parse_range(option, text); });
  add(app, "--gradient-range", "A,B", "Gradient magnitudes to count, per world length (default: all but outliers)",
      [&options](const std::string& option, const std::string& text) {
        options.gradient_range = parse_range(option, text);
      });
  app.footer(kHistogramExamples);
}

}  // namespace tetravox::tool
