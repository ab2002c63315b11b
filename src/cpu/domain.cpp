#include "src/cpu/domain.h"

#include "src/scene/brick_plan.h"
#include "src/scene/preintegration_cache.h"
#include "tetravox/error.h"

#include <algorithm>
#include <cmath>
#include <string>

namespace tetravox::cpu {
namespace {

std::size_t require_other(std::size_t other, const DomainScalars& scalars) {
  if (other >= scalars.others.size())
    throw Error(ErrorCode::kInvalidArgument, "the function asks for array " + std::to_string(other) + " of " +
                                                 std::to_string(scalars.others.size()) +
                                                 " further ones: prepare the data with all of them");
  return other;
}

/// `map`: of the axis' scalars.
DomainAxis make_axis(DomainAxis::Source source, const optics::ScalarMap& map, const ValueRange& range,
                     std::size_t size) {
  DomainAxis axis;
  axis.source = source;
  axis.first = map.stored_from_value(range.min);
  axis.last = static_cast<std::int32_t>(size) - 1;
  const double density = axis.last * map.scale / (range.max - range.min);
  if (!(std::abs(axis.first) < 1e30f && density > 1e-30 && density < 1e30))
    throw Error(ErrorCode::kInvalidArgument, "the range of a variable, " + std::to_string(range.min) + " to " +
                                                 std::to_string(range.max) +
                                                 ", is too narrow or too wide beside the data: choose another");
  axis.entries_per_scalar = static_cast<float>(density);
  return axis;
}

/// Largest change of density from entry to entry along an axis.
float find_steepness(const std::vector<float>& entries, std::size_t stride, std::size_t size) {
  float largest = 0.0f;
  for (std::size_t i = 0; i < entries.size() / 4; ++i) {
    if (i / stride % size + 1 == size) continue;
    const float *a = entries.data() + 4 * i, *b = a + 4 * stride;
    largest = std::max(largest, std::abs(b[0] - a[0]));
    for (int channel = 1; channel < 4; ++channel)
      largest = std::max(largest, std::abs(b[0] * b[channel] - a[0] * a[channel]));
  }
  return largest;
}

/// Largest change of the colour with the value; huge at steps.
double find_color_slope(const OpticalFunction& colors) {
  constexpr double kNarrowest = 1e-4;  // of the range: what is steeper counts as a step
  const auto& points = colors.points;
  const double least = kNarrowest * (points.back().value - points.front().value);
  double slope = 0.0;
  for (std::size_t i = 1; i < points.size(); ++i) {
    const double width = std::max(points[i].value - points[i - 1].value, least);
    if (!(width > 0.0)) continue;
    for (std::size_t channel = 0; channel < 3; ++channel)
      slope = std::max(slope, std::abs(points[i].color[channel] - points[i - 1].color[channel]) / width);
  }
  return slope;
}

}  // namespace

bool Domain::wants_gradients() const {
  return std::any_of(axes.begin(), axes.begin() + count,
                     [](const DomainAxis& axis) { return axis.source == DomainAxis::Source::kGradient; });
}

Domain make_table_domain(const OpticalTable& table, const std::vector<std::size_t>& others,
                         const DomainScalars& scalars) {
  Domain domain;
  domain.count = static_cast<int>(table.variables.size());
  domain.entries.reserve(4 * table.entries.size());
  for (const OpticalPoint& entry : table.entries)
    for (const double part : {entry.extinction, entry.color[0], entry.color[1], entry.color[2]})
      domain.entries.push_back(static_cast<float>(part));
  std::size_t stride = 1, arrays = 0;
  for (std::size_t i = 0; i < table.variables.size(); ++i) {
    const Variable& variable = table.variables[i];
    DomainAxis& axis = domain.axes[i];
    switch (variable.kind) {
      case VariableKind::kValue:
        axis = make_axis(DomainAxis::Source::kScalar, scalars.scalar, *variable.range, table.sizes[i]);
        break;
      case VariableKind::kGradient:
        axis = make_axis(DomainAxis::Source::kGradient, {0.0, scalars.gradient_scale}, *variable.range, table.sizes[i]);
        break;
      case VariableKind::kArray:
        if (!others.empty() && arrays >= others.size())
          throw Error(ErrorCode::kInvalidArgument,
                      "the function has more arrays than were named: " + std::to_string(others.size()) + " of them");
        domain.others[i] = require_other(others.empty() ? arrays : others[arrays], scalars);
        axis =
            make_axis(DomainAxis::Source::kOther, scalars.others[*domain.others[i]], *variable.range, table.sizes[i]);
        ++arrays;
        break;
    }
    axis.steepness = find_steepness(domain.entries, stride, table.sizes[i]) * axis.entries_per_scalar;
    stride *= table.sizes[i];
  }
  return domain;
}

Domain make_color_domain(std::size_t other, const OpticalFunction& colors, const OpticalFunction& function,
                         const DomainScalars& scalars) {
  Domain domain;
  domain.count = 2;
  domain.others[1] = require_other(other, scalars);
  const optics::ScalarMap& map = scalars.others[other];
  domain.colors = optics::build_control_point_table(colors, map);
  const optics::ScalarMap& scalar = scalars.scalar;
  optics::build_steepness_table(optics::build_control_point_table(function, scalar),
                                scalar.stored_from_value(scalars.range.min),
                                scalar.stored_from_value(scalars.range.max), domain.extinctions);
  domain.axes[0].steepness = 1.0f;  // as `extinctions` say
  domain.axes[1].source = DomainAxis::Source::kOther;
  domain.axes[1].steepness = static_cast<float>(find_color_slope(colors) * map.scale);
  return domain;
}

const Kernels::OfDomain& choose_domain_kernels(const Kernels& kernels, const Domain& domain) {
  if (!domain.is_table()) return kernels.separate_colors;
  return domain.count == 2 ? kernels.domain_2d : kernels.domain_3d;
}

void require_domain_settings(const Domain& domain, const RenderSettings& settings) {
  const auto fail = [](const std::string& message) { throw Error(ErrorCode::kUnsupported, message); };
  const std::string what = domain.is_table() ? "a function of several variables" : "colour from another array";
  if (settings.integrator == Integrator::kPre || settings.integrator == Integrator::kPost ||
      scene::is_of_tables(settings.integrator))
    fail(what + " is integrated along each segment: integrator '" + name_of(settings.integrator) +
         "' does not go with it, leave it out");
  if (settings.samples_per_voxel > 0.0)
    fail(what + " follows the cells, not a fixed rate: draw without one (--samples-per-voxel auto)");
  if (domain.is_table() && settings.lighting.shadows == ShadowKind::kExact && !settings.lighting.lights.empty())
    fail("exact shadows follow functions of one variable: choose shadows 'volume'");
}

void build_occupancy(const Domain& domain, double tolerance, double diagonal, TableOccupancy& occupancy) {
  if (!domain.is_table() || occupancy.tolerance == tolerance) return;
  const float least = scene::allowed_haze_of(tolerance, diagonal);
  std::array<std::size_t, kMostVariables> sizes{0, 0, 0};
  for (int axis = 0; axis < domain.count; ++axis) sizes[axis] = static_cast<std::size_t>(domain.axes[axis].last) + 1;
  const std::size_t row = sizes[0] + 1, slice = row * (sizes[1] + 1);
  occupancy.sums.assign(slice * (sizes[2] + 1), 0);
  // A table of two variables is a single slice; so its sums are.
  const std::size_t shift = domain.count == 3 ? row + 1 + slice : row + 1;
  for (std::size_t i = 0; i < domain.entries.size() / 4; ++i) {
    const std::size_t x = i % sizes[0], y = i / sizes[0] % sizes[1], z = i / sizes[0] / sizes[1];
    occupancy.sums[z * slice + y * row + x + shift] = domain.entries[4 * i] > least ? 1 : 0;
  }
  for (const std::size_t stride : {std::size_t{1}, row, slice})
    for (std::size_t i = stride; i < occupancy.sums.size(); ++i)
      if (stride == slice || i % (stride == 1 ? row : slice) >= stride) occupancy.sums[i] += occupancy.sums[i - stride];
  occupancy.tolerance = tolerance;
}

bool is_transparent(const Domain& domain, const TableOccupancy& occupancy,
                    const std::array<ValueRange, kMostVariables>& ranges) {
  std::array<std::size_t, kMostVariables> begin{}, end{};
  for (int i = 0; i < domain.count; ++i) {
    const DomainAxis& axis = domain.axes[i];
    const auto entry = [&](double scalar) {
      return std::clamp((scalar - axis.first) * axis.entries_per_scalar, 0.0, static_cast<double>(axis.last));
    };
    // A hair more on either side stands for rounding.
    begin[i] = static_cast<std::size_t>(std::max(std::floor(entry(ranges[i].min) - 1e-3), 0.0));
    end[i] = std::min(static_cast<std::size_t>(std::ceil(entry(ranges[i].max) + 1e-3)),
                      static_cast<std::size_t>(axis.last)) +
             1;
  }
  // Inclusion and exclusion.
  std::int32_t count = 0;
  for (std::size_t corner = 0; corner < std::size_t{1} << domain.count; ++corner) {
    std::size_t index = 0, stride = 1;
    bool is_added = true;
    for (int i = 0; i < domain.count; ++i) {
      const bool is_lower = (corner >> i & 1) != 0;
      index += (is_lower ? begin[i] : end[i]) * stride;
      stride *= static_cast<std::size_t>(domain.axes[i].last) + 2;
      is_added ^= is_lower;
    }
    count += is_added ? occupancy.sums[index] : -occupancy.sums[index];
  }
  return count == 0;
}

DomainFunction make_domain_function(const Domain& domain, const TableOccupancy& occupancy, double tolerance,
                                    double diagonal) {
  DomainFunction function;
  function.count = domain.count;
  std::copy(domain.axes.begin(), domain.axes.end(), function.axes);
  for (int axis = 0; axis < domain.count; ++axis)
    if (domain.axes[axis].source == DomainAxis::Source::kGradient) function.gradient_axis = axis;
  if (domain.is_table()) {
    function.entries = domain.entries.data();
    function.occupied = occupancy.sums.data();
  } else {
    function.colors = &domain.colors;
    function.extinctions = &domain.extinctions;
  }
  function.haze = scene::allowed_haze_of(tolerance, diagonal);
  function.allowed_rate = scene::allowed_rate_of(tolerance, diagonal);
  function.most_pieces = scene::most_pieces_of(tolerance);
  return function;
}

}  // namespace tetravox::cpu
