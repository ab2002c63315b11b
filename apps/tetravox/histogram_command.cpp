#include "apps/tetravox/body.h"
#include "apps/tetravox/commands.h"
#include "apps/tetravox/histogram_picture.h"
#include "apps/tetravox/interrupt.h"
#include "apps/tetravox/memory_plan.h"
#include "apps/tetravox/output_files.h"
#include "apps/tetravox/progress_line.h"
#include "apps/tetravox/scene_input.h"
#include "apps/tetravox/text.h"

#include "tetravox/analysis.h"
#include "tetravox/io.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <iostream>
#include <numeric>
#include <string>
#include <system_error>
#include <variant>
#include <vector>

namespace tetravox::tool {
namespace {

constexpr int kDefaultBins = 256;
constexpr double kFewWholeNumbers = 1024;
constexpr int kDigits = 9;  // of numbers in a table

/// Name of the file, and that it can be written, before any long work.
std::string choose_output(const HistogramCommandOptions& options, const SceneInput& input) {
  std::string output = options.output.empty() ? input.name + "-histogram.png" : options.output;
  const std::string ending = ending_of(output);
  if (ending != ".png" && ending != ".npy" && ending != ".csv")
    throw UsageError("--output: '" + output + "' does not end in .png, .npy or .csv");
  if (ending != ".png" && options.use_logarithm)
    throw UsageError("--counts: is for .png; " + ending + " holds shares of the volume as they are");
  std::error_code ignored;
  if (std::filesystem::equivalent(output, options.input.input, ignored))
    throw UsageError("--output: name another file, this would replace the input " + output);
  require_writable(output);
  return output;
}

void require_consistent(const HistogramCommandOptions& options) {
  const bool is_joint = options.kind == HistogramKind::kJoint;
  if (options.kind == HistogramKind::kValue && (options.other_bins || options.other_range))
    throw UsageError("--other-bins and --other-range need --kind gradient or joint");
  if (is_joint && !options.other_array) throw UsageError("--kind joint: name the second array with --other-array");
  if (!is_joint && options.other_array) throw UsageError("--other-array needs --kind joint");
}

bool holds_whole_numbers(const Body& body) {
  const auto* grid = std::get_if<PreparedGrid>(&body);
  return grid != nullptr && grid->data.type != ScalarType::kFloat32 && grid->data.type != ScalarType::kFloat64 &&
         grid->data.component != kMagnitude;
}

/// What the library is asked for; a bin for each whole number where there are few, so that none counts twice.
HistogramOptions choose_options(const HistogramCommandOptions& options, const Body& body) {
  HistogramOptions chosen;
  chosen.range = options.range;
  chosen.other_range = options.other_range;
  chosen.other_bins = options.other_bins.value_or(kDefaultBins);
  const ValueRange range = options.range.value_or(scalar_range_of(body));
  const double numbers = std::floor(range.max) - std::ceil(range.min) + 1.0;
  const bool is_counted = holds_whole_numbers(body) && numbers >= 1.0 && numbers <= kFewWholeNumbers;
  chosen.bins = options.bins.value_or(is_counted ? static_cast<int>(numbers) : kDefaultBins);
  return chosen;
}

/// Where bin `i` of `count` begins.
std::string edge(const ValueRange& range, std::size_t i, std::size_t count) {
  return format_number(std::lerp(range.min, range.max, static_cast<double>(i) / static_cast<double>(count)), kDigits);
}

std::string format_csv(const Histogram& histogram, const std::string&) {
  std::string text = "value_from,value_to,share\n";
  const std::size_t count = histogram.counts.size();
  for (std::size_t i = 0; i < count; ++i)
    text += edge(histogram.range, i, count) + "," + edge(histogram.range, i + 1, count) + "," +
            format_number(histogram.counts[i], kDigits) + "\n";
  return text;
}

std::string format_csv(const Histogram2D& histogram, const std::string& other) {
  std::string text = "value_from,value_to," + other + "_from," + other + "_to,share\n";
  const auto columns = static_cast<std::size_t>(histogram.bins), rows = static_cast<std::size_t>(histogram.other_bins);
  for (std::size_t row = 0; row < rows; ++row) {
    const std::string others =
        edge(histogram.other_range, row, rows) + "," + edge(histogram.other_range, row + 1, rows);
    for (std::size_t i = 0; i < columns; ++i)
      text += edge(histogram.range, i, columns) + "," + edge(histogram.range, i + 1, columns) + "," + others + "," +
              format_number(histogram.counts[row * columns + i], kDigits) + "\n";
  }
  return text;
}

std::vector<std::size_t> shape_of(const Histogram& histogram) { return {histogram.counts.size()}; }
std::vector<std::size_t> shape_of(const Histogram2D& histogram) {
  return {static_cast<std::size_t>(histogram.other_bins), static_cast<std::size_t>(histogram.bins)};
}

std::string describe_axes(const Histogram& histogram, const std::string&) {
  return "value " + format_range(histogram.range) + " in " + format_count(histogram.counts.size()) + " bins";
}
std::string describe_axes(const Histogram2D& histogram, const std::string& other) {
  return "value " + format_range(histogram.range) + " in " + format_count(static_cast<std::uint64_t>(histogram.bins)) +
         " bins, " + other + " " + format_range(histogram.other_range) + " in " +
         format_count(static_cast<std::uint64_t>(histogram.other_bins)) + " bins";
}

/// What the picture's numbers mean: the largest share, and how much lies outside.
std::string describe_shares(const std::vector<double>& shares) {
  constexpr double kLeastOutside = 1e-6;
  const double largest = *std::max_element(shares.begin(), shares.end());
  const double outside = 1.0 - std::accumulate(shares.begin(), shares.end(), 0.0);
  std::string text = "largest bin " + format_number(largest, 4) + " of the volume";
  if (outside > kLeastOutside) text += ", " + format_number(outside, 3) + " lies outside";
  return text;
}

template <class AnyHistogram>
void write_histogram(const std::string& output, const AnyHistogram& histogram, const std::string& other,
                     bool use_logarithm) {
  OutputFiles files;
  files.write(output, [&](const std::string& path) {
    const std::string ending = ending_of(path);
    if (ending == ".png") write_image(path, draw_histogram(histogram, use_logarithm));
    if (ending == ".npy") write_array(path, histogram.counts, shape_of(histogram));
    if (ending == ".csv") write_text_file(path, format_csv(histogram, other));
  });
  files.keep();
  std::cout << "wrote " << single_line(output) << ": " << describe_axes(histogram, other) << ", "
            << describe_shares(histogram.counts) << "\n";
}

}  // namespace

void run_histogram(const HistogramCommandOptions& options) {
  require_consistent(options);
  SceneInput input = load_scene_input(options.input);
  input.read.others.clear();
  if (options.other_array) input.read.others.push_back(*options.other_array);
  const std::string output = choose_output(options, input);
  ProgressLine line(true);
  const Dataset dataset = read_dataset(input.data_path, input.read, line.progress());
  throw_if_interrupted();
  require_memory(plan_memory(dataset, input.scene.settings), input.data_path);
  const Body body = prepare_body(dataset, line.progress());
  throw_if_interrupted();
  line.clear();

  const HistogramOptions chosen = choose_options(options, body);
  const bool use_logarithm = options.use_logarithm.value_or(options.kind != HistogramKind::kValue);
  std::visit(
      [&](const auto& prepared) {
        if (options.kind == HistogramKind::kValue)
          write_histogram(output, make_value_histogram(prepared, chosen), "", use_logarithm);
        else if (options.kind == HistogramKind::kGradient)
          write_histogram(output, make_gradient_histogram(prepared, chosen), "gradient", use_logarithm);
        else
          write_histogram(output, make_joint_histogram(prepared, 0, chosen), "other", use_logarithm);
      },
      body);
}

}  // namespace tetravox::tool
