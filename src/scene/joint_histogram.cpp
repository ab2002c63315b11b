/// Histograms of two variables: value and gradient magnitude, or value and another array.

#include "src/scene/differential_samples.h"
#include "src/scene/other_fields.h"
#include "src/scene/volume_bins.h"
#include "tetravox/analysis.h"

#include <algorithm>
#include <cstddef>

namespace tetravox {
namespace {

constexpr int kLargestBinCount = 4096;

/// A histogram with the value's axis and no counts yet.
template <class Prepared>
Histogram2D make_empty_histogram(const Prepared& prepared, const HistogramOptions& options) {
  scene::require_bins(options.bins, kLargestBinCount);
  scene::require_bins(options.other_bins, kLargestBinCount);
  Histogram2D histogram;
  histogram.bins = options.bins;
  histogram.other_bins = options.other_bins;
  histogram.range = scene::chosen_range(options.range, prepared.scalar_range);
  histogram.counts.resize(static_cast<std::size_t>(options.bins) * static_cast<std::size_t>(options.other_bins));
  return histogram;
}

/// Counts the places; `other(i)` is what the second axis means at place i.
template <class Other>
void count_samples(const std::vector<scene::DifferentialSample>& samples, const ValueRange& values,
                   const ValueRange& others, const Other& other, Histogram2D& histogram) {
  const scene::Bins value_axis(values, histogram.bins), other_axis(others, histogram.other_bins);
  const auto row = static_cast<std::size_t>(histogram.bins);
  double total = 0.0;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    total += samples[i].volume;
    const auto bin = value_axis.bin_of(samples[i].value), other_bin = other_axis.bin_of(other(i));
    if (bin && other_bin) histogram.counts[*other_bin * row + *bin] += samples[i].volume;
  }
  if (total > 0.0)
    for (double& share : histogram.counts) share /= total;
}

template <class Prepared>
Histogram2D count_gradients(const Prepared& prepared, const HistogramOptions& options) {
  Histogram2D histogram = make_empty_histogram(prepared, options);
  ValueRange gradients = scene::chosen_range(options.other_range, {});
  const scene::DifferentialSamples field = scene::sample_differentials(prepared, scene::kLargestDifferentialCount);
  const double world_per_stored = prepared.scalar_scale / field.unit_length;
  if (options.other_range)
    gradients = {gradients.min / world_per_stored, gradients.max / world_per_stored};
  else
    gradients = scene::range_of_gradients(field.samples);
  histogram.other_range = {gradients.min * world_per_stored, gradients.max * world_per_stored};
  count_samples(
      field.samples, scene::stored_range(prepared, histogram.range), gradients,
      [&](std::size_t i) { return field.samples[i].gradient; }, histogram);
  return histogram;
}

template <class Prepared>
Histogram2D count_joint(const Prepared& prepared, std::size_t other, const HistogramOptions& options) {
  Histogram2D histogram = make_empty_histogram(prepared, options);
  const scene::OtherFrame frame = scene::frame_of_other(prepared, other);
  histogram.other_range = scene::chosen_range(options.other_range, frame.range);
  const scene::DifferentialSamples field = scene::sample_differentials(prepared, scene::kLargestDifferentialCount);
  count_samples(
      field.samples, scene::stored_range(prepared, histogram.range), scene::stored_range(frame, histogram.other_range),
      [&](std::size_t i) { return field.others[other][i]; }, histogram);
  return histogram;
}

}  // namespace

Histogram2D make_gradient_histogram(const PreparedMesh& mesh, const HistogramOptions& options) {
  return count_gradients(mesh, options);
}

Histogram2D make_gradient_histogram(const PreparedGrid& grid, const HistogramOptions& options) {
  return count_gradients(grid, options);
}

Histogram2D make_joint_histogram(const PreparedMesh& mesh, std::size_t other, const HistogramOptions& options) {
  return count_joint(mesh, other, options);
}

Histogram2D make_joint_histogram(const PreparedGrid& grid, std::size_t other, const HistogramOptions& options) {
  return count_joint(grid, other, options);
}

}  // namespace tetravox
