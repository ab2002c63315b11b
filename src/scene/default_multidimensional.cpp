/// What occurs of the variables of a function, and the function that follows from that.

#include "src/optics/opacity_budget.h"
#include "src/scene/differential_samples.h"
#include "src/scene/other_fields.h"
#include "src/scene/volume_bins.h"
#include "src/support/threads.h"
#include "tetravox/analysis.h"
#include "tetravox/scene.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

namespace tetravox {
namespace {

constexpr std::size_t kRangeSampleCount = 1'000'000;
constexpr std::size_t kSampleCount = 200'000;
constexpr int kBins = 256;                // that values are looked at in
constexpr std::size_t kStepsAlone = 16;   // Gaussians along the only axis of many
constexpr std::size_t kStepsEach = 8;     // along each of two
constexpr double kOverlap = 0.8;          // radius of a Gaussian, in steps: their sum is nearly even
constexpr double kThinnest = 0.015;       // radius of a Gaussian, in ranges: two entries of a table
constexpr double kGradientRadius = 0.45;  // of the gradient that counts as large
constexpr double kSteepArea = 0.1;        // of all iso-surfaces together: where gradients are that large, or larger
constexpr double kBackgroundGap = 2.0;    // between a background and a Gaussian's centre, in radii
constexpr double kWide = 8.0;             // radius where a variable does not matter, in ranges
constexpr double kRarity = 0.75;          // 0: alike; 1: all have the same share of the optical depth
constexpr int kResolution = 128, kResolutionOfThree = 64;

/// Values of a variable at the places looked at, in its own units.
struct Axis {
  VariableKind kind = VariableKind::kValue;
  ValueRange range;
  std::vector<float> values;
};

template <class Prepared>
std::vector<ValueRange> ranges_of(const Prepared& prepared, const std::vector<Variable>& variables) {
  std::vector<ValueRange> ranges;
  std::size_t other = 0;
  for (const Variable& variable : variables) {
    ValueRange range = prepared.scalar_range;
    if (variable.kind == VariableKind::kArray) range = scene::frame_of_other(prepared, other++).range;
    if (variable.range) {
      range = *variable.range;
    } else if (variable.kind == VariableKind::kGradient) {
      const scene::DifferentialSamples field = scene::sample_differentials(prepared, kRangeSampleCount);
      const double world_per_stored = prepared.scalar_scale / field.unit_length;
      range = {0.0, scene::range_of_gradients(field.samples).max * world_per_stored};
    }
    ranges.push_back(range);
  }
  return ranges;
}

/// A gradient that counts as large: the area of all iso-surfaces together is the sum of gradients over the volume.
double large_gradient(const std::vector<scene::DifferentialSample>& samples) {
  std::vector<std::pair<float, double>> areas;
  double total = 0.0;
  for (const scene::DifferentialSample& sample : samples) {
    areas.emplace_back(sample.gradient, static_cast<double>(sample.gradient) * sample.volume);
    total += areas.back().second;
  }
  std::sort(areas.begin(), areas.end());
  double above = 0.0;
  while (!areas.empty() && above + areas.back().second < kSteepArea * total) {
    above += areas.back().second;
    areas.pop_back();
  }
  return areas.empty() ? 0.0 : areas.back().first;
}

/// What the table spans where nobody says: a few outliers must not take all its entries.
template <class Prepared>
void choose_ranges(const Prepared& prepared, const Histogram& histogram, const scene::DifferentialSamples& field,
                   std::vector<Variable>& variables) {
  const double world_per_stored = prepared.scalar_scale / field.unit_length;
  for (Variable& variable : variables) {
    ValueRange range;
    if (variable.kind == VariableKind::kValue) range = histogram.range;
    if (variable.kind == VariableKind::kGradient) range.max = large_gradient(field.samples) * world_per_stored;
    if (!variable.range && range.min < range.max) variable.range = range;
  }
}

/// Leaves out the places whose value is that of a background.
template <class Prepared>
void leave_out(const ValueRange& background, const Prepared& prepared, scene::DifferentialSamples& field) {
  const ValueRange stored = scene::stored_range(prepared, background);
  double shown = 0.0;
  for (const scene::DifferentialSample& sample : field.samples)
    if (sample.value < stored.min || sample.value > stored.max) shown += sample.volume;
  for (scene::DifferentialSample& sample : field.samples)
    if (shown > 0.0 && sample.value >= stored.min && sample.value <= stored.max) sample.volume = 0.0f;
}

/// The axes of the function, all over the same places.
template <class Prepared>
std::vector<Axis> make_axes(const Prepared& prepared, const std::vector<Variable>& variables,
                            const scene::DifferentialSamples& field) {
  const std::vector<ValueRange> ranges = ranges_of(prepared, variables);
  std::vector<Axis> axes;
  std::size_t other = 0;
  for (std::size_t i = 0; i < variables.size(); ++i) {
    Axis axis{variables[i].kind, ranges[i], {}};
    if (axis.kind == VariableKind::kArray) {
      const scene::OtherFrame frame = scene::frame_of_other(prepared, other);
      for (const float stored : field.others[other])
        axis.values.push_back(static_cast<float>(frame.scalar_offset + stored * frame.scalar_scale));
      ++other;
    }
    for (const scene::DifferentialSample& sample : field.samples) {
      if (axis.kind == VariableKind::kValue)
        axis.values.push_back(static_cast<float>(prepared.scalar_offset + sample.value * prepared.scalar_scale));
      if (axis.kind == VariableKind::kGradient)
        axis.values.push_back(static_cast<float>(sample.gradient * prepared.scalar_scale / field.unit_length));
    }
    axes.push_back(std::move(axis));
  }
  return axes;
}

/// Where a Gaussian lies along one axis.
struct Step {
  double center = 0.0, radius = 1.0;
  Color color{1, 1, 1};
};

/// How often the values of an axis are in each of its bins.
std::vector<double> shares_along(const Axis& axis, const std::vector<scene::DifferentialSample>& samples) {
  std::vector<double> shares(kBins);
  const scene::Bins bins(axis.range, kBins);
  double total = 0.0;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    shares[bins.nearest_bin(axis.values[i])] += samples[i].volume;
    total += samples[i].volume;
  }
  for (double& share : shares) share /= std::max(total, 1e-30);
  return shares;
}

/// Steps that lie the closer the more values there are to be told apart, with the colours of their positions.
std::vector<Step> make_steps(const Axis& axis, const std::vector<scene::DifferentialSample>& samples,
                             std::size_t count) {
  const std::vector<double> positions = optics::positions(shares_along(axis, samples));
  const double width = axis.range.max - axis.range.min;
  const auto value_at = [&](double position) {
    const auto above = std::lower_bound(positions.begin(), positions.end(), position) - positions.begin();
    return axis.range.min + width * std::min(1.0, (static_cast<double>(above) + 0.5) / kBins);
  };
  std::vector<Step> steps;
  for (std::size_t i = 0; i < count; ++i) {
    const double u = (static_cast<double>(i) + 0.5) / static_cast<double>(count),
                 half = 0.5 / static_cast<double>(count);
    const double step = value_at(u + half) - value_at(u - half);
    steps.push_back({value_at(u), std::max(kOverlap * step, kThinnest * width), optics::color_at(u, false)});
  }
  return steps;
}

/// Steps along each axis, and the axis that colours follow.
struct Layout {
  std::vector<std::vector<Step>> steps;
  std::size_t color_axis = 0;
};

Layout make_layout(const std::vector<Axis>& axes, const std::vector<scene::DifferentialSample>& samples) {
  const auto first_of = [&](VariableKind kind) {
    return static_cast<std::size_t>(
        std::find_if(axes.begin(), axes.end(), [kind](const Axis& axis) { return axis.kind == kind; }) - axes.begin());
  };
  const std::size_t value = first_of(VariableKind::kValue), array = first_of(VariableKind::kArray);
  const std::size_t count = value < axes.size() && array < axes.size() ? kStepsEach : kStepsAlone;
  Layout layout;
  layout.color_axis = array < axes.size() ? array : value;
  for (std::size_t i = 0; i < axes.size(); ++i) {
    const ValueRange& range = axes[i].range;
    const double width = range.max - range.min;
    if (!(width > 0.0))  // constant: one step, as wide as the axis that the table makes of it
      layout.steps.push_back({{range.min, 0.5, optics::color_at(0.5, false)}});
    else if (axes[i].kind == VariableKind::kGradient)
      layout.steps.push_back({{range.max, kGradientRadius * width}});
    else if (i == value || i == array)
      layout.steps.push_back(make_steps(axes[i], samples, count));
    else
      layout.steps.push_back({{range.min + 0.5 * width, kWide * width}});
  }
  return layout;
}

/// One Gaussian for each combination of steps.
std::vector<Widget> make_widgets(const Layout& layout) {
  std::vector<Widget> widgets{Widget{}};
  for (std::size_t axis = 0; axis < layout.steps.size(); ++axis) {
    std::vector<Widget> more;
    for (const Widget& widget : widgets)
      for (const Step& step : layout.steps[axis]) {
        more.push_back(widget);
        more.back().center[axis] = step.center;
        more.back().radius[axis] = step.radius;
        if (axis == layout.color_axis) more.back().color = step.color;
      }
    widgets = std::move(more);
  }
  return widgets;
}

/// Share of the volume under a widget, weighted by its shape.
double share_of(const Widget& widget, const std::vector<Axis>& axes,
                const std::vector<scene::DifferentialSample>& samples) {
  double share = 0.0, total = 0.0;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    double square = 0.0;
    for (std::size_t axis = 0; axis < axes.size(); ++axis) {
      const double offset = (axes[axis].values[i] - widget.center[axis]) / widget.radius[axis];
      square += offset * offset;
    }
    total += samples[i].volume;
    if (square < 30.0) share += samples[i].volume * std::exp(-square);
  }
  return total > 0.0 ? share / total : 0.0;
}

/// Opacities that keep to the budget of optical depth; none where the value is that of a background.
void set_opacities(const std::vector<Axis>& axes, const std::vector<scene::DifferentialSample>& samples,
                   const std::optional<ValueRange>& background, std::vector<Widget>& widgets) {
  std::vector<double> shares(widgets.size()), extinctions;
  support::parallel_chunks(widgets.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) shares[i] = share_of(widgets[i], axes, samples);
  });
  for (std::size_t i = 0; i < widgets.size(); ++i) {
    bool is_shown = true;
    for (std::size_t axis = 0; axis < axes.size(); ++axis) {
      const double center = widgets[i].center[axis], gap = kBackgroundGap * widgets[i].radius[axis];
      if (background && axes[axis].kind == VariableKind::kValue)
        is_shown &= center + gap < background->min || center - gap > background->max;
    }
    const double density = shares[i] * static_cast<double>(widgets.size());
    extinctions.push_back(is_shown ? std::pow(density + 0.02, -kRarity) : 0.0);
  }
  extinctions = optics::fit_budget(shares, shares, extinctions);
  for (std::size_t i = 0; i < widgets.size(); ++i) widgets[i].opacity = optics::opacity_from_extinction(extinctions[i]);
}

template <class Prepared>
MultidimensionalFunction make_function(const Prepared& prepared, const std::vector<Variable>& variables) {
  MultidimensionalFunction function;
  function.variables = variables;
  function.resolution = variables.size() == 3 ? kResolutionOfThree : kResolution;
  const Histogram histogram = make_histogram(prepared, kBins);
  function.unit_distance = histogram.unit_distance;
  scene::DifferentialSamples field = scene::sample_differentials(prepared, kSampleCount);
  choose_ranges(prepared, histogram, field, function.variables);
  if (histogram.background) leave_out(*histogram.background, prepared, field);
  const std::vector<Axis> axes = make_axes(prepared, function.variables, field);
  for (std::size_t i = 0; i < axes.size(); ++i)
    if (axes[i].range.min < axes[i].range.max) function.variables[i].range = axes[i].range;
  function.widgets = make_widgets(make_layout(axes, field.samples));
  set_opacities(axes, field.samples, histogram.background, function.widgets);
  return function;
}

}  // namespace

std::vector<ValueRange> make_variable_ranges(const PreparedMesh& mesh, const std::vector<Variable>& variables) {
  return ranges_of(mesh, variables);
}

std::vector<ValueRange> make_variable_ranges(const PreparedGrid& grid, const std::vector<Variable>& variables) {
  return ranges_of(grid, variables);
}

MultidimensionalFunction make_default_multidimensional(const PreparedMesh& mesh,
                                                       const std::vector<Variable>& variables) {
  return make_function(mesh, variables);
}

MultidimensionalFunction make_default_multidimensional(const PreparedGrid& grid,
                                                       const std::vector<Variable>& variables) {
  return make_function(grid, variables);
}

}  // namespace tetravox
