#include "src/optics/boundary_function.h"

#include "src/scene/differential_samples.h"
#include "src/scene/volume_bins.h"
#include "tetravox/analysis.h"
#include "tetravox/scene.h"

#include <algorithm>
#include <cstddef>
#include <string>

namespace tetravox {
namespace {

constexpr int kBins = 512;
constexpr double kThinnest = 0.05, kThickest = 5.0;

/// Sums of volume and derivatives, in bins over `values`.
template <class Prepared>
optics::DerivativeProfile make_profile(const Prepared& prepared, const ValueRange& values) {
  optics::DerivativeProfile profile;
  profile.range = values;
  for (std::vector<double>* sums : {&profile.volumes, &profile.first, &profile.second}) sums->resize(kBins);
  const scene::Bins axis(scene::stored_range(prepared, values), kBins);
  for (const scene::DifferentialSample& sample :
       scene::sample_differentials(prepared, scene::kLargestDifferentialCount).samples) {
    const auto bin = axis.bin_of(sample.value);
    if (!bin) continue;
    const double volume = sample.volume;
    profile.volumes[*bin] += volume;
    profile.first[*bin] += volume * sample.gradient;
    profile.second[*bin] += volume * sample.second;
  }
  return profile;
}

template <class Prepared>
TransferFunction make_function(const Prepared& prepared, const BoundaryOptions& options) {
  if (!(options.thickness >= kThinnest && options.thickness <= kThickest))
    throw Error(ErrorCode::kInvalidArgument,
                "the thickness of boundaries must lie between 0.05 and 5, not " + std::to_string(options.thickness));
  const Histogram histogram = make_histogram(prepared, kBins);
  // A boundary begins in what surrounds the objects: that is looked at too.
  ValueRange range = histogram.range;
  if (histogram.background) {
    range.min = std::min(range.min, histogram.background->min);
    range.max = std::max(range.max, histogram.background->max);
  }
  range = scene::chosen_range(options.range, range);
  optics::BoundaryShape shape;
  shape.thickness = options.thickness;
  shape.invert = options.invert;
  shape.unit_distance = histogram.unit_distance;
  shape.background = histogram.background;
  return optics::make_boundary_function(make_profile(prepared, range), shape);
}

}  // namespace

TransferFunction make_boundary_transfer_function(const PreparedMesh& mesh, const BoundaryOptions& options) {
  return make_function(mesh, options);
}

TransferFunction make_boundary_transfer_function(const PreparedGrid& grid, const BoundaryOptions& options) {
  return make_function(grid, options);
}

}  // namespace tetravox
