#include "src/scene/differential_samples.h"
#include "src/scene/robust_range.h"
#include "src/scene/volume_bins.h"
#include "tetravox/analysis.h"

#include <algorithm>
#include <cstddef>

namespace tetravox {
namespace {

constexpr int kLargestBinCount = 4096;

/// From 0 to the largest gradient, without a few outliers.
ValueRange range_of_gradients(const std::vector<scene::DifferentialSample>& samples) {
  float largest = 0.0f;
  for (const scene::DifferentialSample& sample : samples) largest = std::max(largest, sample.gradient);
  const ValueRange all{0.0, largest};
  if (!(largest > 0.0f)) return all;
  const auto count = [&](const ValueRange& range, int bins) {
    std::vector<double> counts(static_cast<std::size_t>(bins));
    const scene::Bins axis(range, bins);
    for (const scene::DifferentialSample& sample : samples) counts[axis.nearest_bin(sample.gradient)] += sample.volume;
    return counts;
  };
  return {0.0, scene::robust_range(all, count).max};
}

template <class Prepared>
Histogram2D make_histogram_of(const Prepared& prepared, const HistogramOptions& options) {
  scene::require_bins(options.bins, kLargestBinCount);
  scene::require_bins(options.gradient_bins, kLargestBinCount);
  Histogram2D histogram;
  histogram.bins = options.bins;
  histogram.gradient_bins = options.gradient_bins;
  histogram.range = scene::chosen_range(options.range, prepared.scalar_range);
  ValueRange gradients = scene::chosen_range(options.gradient_range, {});

  const scene::DifferentialSamples field = scene::sample_differentials(prepared, scene::kLargestDifferentialCount);
  const double world_per_stored = prepared.scalar_scale / field.unit_length;
  if (options.gradient_range)
    gradients = {gradients.min / world_per_stored, gradients.max / world_per_stored};
  else
    gradients = range_of_gradients(field.samples);
  histogram.gradient_range = {gradients.min * world_per_stored, gradients.max * world_per_stored};

  const scene::Bins value_axis(scene::stored_range(prepared, histogram.range), options.bins);
  const scene::Bins gradient_axis(gradients, options.gradient_bins);
  const std::size_t row = static_cast<std::size_t>(options.bins);
  histogram.counts.resize(row * static_cast<std::size_t>(options.gradient_bins));
  double total = 0.0;
  for (const scene::DifferentialSample& sample : field.samples) {
    total += sample.volume;
    const auto bin = value_axis.bin_of(sample.value), gradient_bin = gradient_axis.bin_of(sample.gradient);
    if (bin && gradient_bin) histogram.counts[*gradient_bin * row + *bin] += sample.volume;
  }
  if (total > 0.0)
    for (double& share : histogram.counts) share /= total;
  return histogram;
}

}  // namespace

Histogram2D make_gradient_histogram(const PreparedMesh& mesh, const HistogramOptions& options) {
  return make_histogram_of(mesh, options);
}

Histogram2D make_gradient_histogram(const PreparedGrid& grid, const HistogramOptions& options) {
  return make_histogram_of(grid, options);
}

}  // namespace tetravox
