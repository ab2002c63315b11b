#include "src/cpu/grid_domain.h"

#include "src/cpu/grid_frame.h"
#include "tetravox/error.h"

#include <algorithm>
#include <limits>
#include <utility>

namespace tetravox::cpu {

DomainScalars GridDomain::scalars() const {
  DomainScalars scalars{{grid_.scalar_offset, grid_.scalar_scale},
                        grid_.scalar_range,
                        grid_.scalar_scale / scene::find_local_frame(grid_).world_per_local,
                        {}};
  for (const PreparedGrid& other : grid_.others) {
    if (other.data.shape.dimensions != grid_.data.shape.dimensions || other.data.association != grid_.data.association)
      throw Error(ErrorCode::kInvalidArgument,
                  "the further field '" + other.data.array_name + "' has another shape or association than the grid");
    scalars.others.push_back({other.scalar_offset, other.scalar_scale});
  }
  return scalars;
}

void GridDomain::set(Domain domain) {
  domain_ = std::move(domain);
  occupancy_ = {};
  others_.clear();
  for (std::size_t axis = 0; axis < domain_.others.size(); ++axis)
    if (domain_.others[axis]) others_.emplace_back(grid_.others[*domain_.others[axis]], axis);
}

void GridDomain::set_table(const OpticalTable& table, const std::vector<std::size_t>& others) {
  set(make_table_domain(table, others, scalars()));
}

void GridDomain::set_colors(std::size_t other, const OpticalFunction& colors, const OpticalFunction& function) {
  set(make_color_domain(other, colors, function, scalars()));
}

void GridDomain::prepare(const Filter& filter, double tolerance, double diagonal) {
  build_occupancy(domain_, tolerance, diagonal, occupancy_);
  for (Other& other : others_)
    if (other.field.kernel ? other.field.filter != filter : scene::wants_kernel(filter))
      other.field = scene::make_filtered_field(*other.grid, filter);
}

std::vector<LatticeField> GridDomain::make_fields(const LatticeField& field) const {
  std::vector<LatticeField> fields;
  for (const Other& other : others_) {
    LatticeField& same = fields.emplace_back(field);
    same.reader = other.field.reader ? other.field.reader.get() : &other.reader;
    same.kernel = other.field.kernel.get();
    same.gradients = GradientSource::kNone;
  }
  return fields;
}

scene::IsSeen GridDomain::find_seen() const {
  return [this](std::size_t brick, const ValueRange& range) {
    constexpr double kAny = std::numeric_limits<double>::max();
    std::array<ValueRange, kMostVariables> ranges;
    ranges.fill({-kAny, kAny});
    for (int axis = 0; axis < domain_.count; ++axis)
      if (domain_.axes[axis].source == DomainAxis::Source::kScalar) ranges[axis] = range;
    for (const Other& other : others_) {
      scene::PlanSources source;
      source.grid = &other.drawn();
      source.field = &other.field;
      ranges[other.axis] = range_of(source, brick);
      if (!(ranges[other.axis].min <= ranges[other.axis].max)) return false;  // missing throughout
    }
    return !is_transparent(domain_, occupancy_, ranges);
  };
}

void GridDomain::fill(const Filling& filling, BrickLattices& lattices, MarchBrick& brick) const {
  const bool may_miss = filling.field.kernel && filling.drawn.missing_values > 0;  // a kernel reaches into other bricks
  // With a kernel it depends on each field how finely its lattice is divided: all take the finest.
  for (int least = 1, most = 1;; least = most) {
    MarchBrick value = lattices.value.describe(filling.drawn, filling.frame, filling.brick, 0);
    value.bounds = brick.bounds;
    value.has_missing |= may_miss;
    for (int axis = 0; axis < domain_.count; ++axis)
      if (domain_.axes[axis].source == DomainAxis::Source::kScalar) value.steepness = domain_.axes[axis].steepness;
    most = std::max(most, lattices.value.fill(filling.field, value, least));
    for (std::size_t i = 0; i < others_.size(); ++i) {
      const Other& other = others_[i];
      MarchBrick further = lattices.others[i].describe(other.drawn(), filling.frame, filling.brick, 0);
      further.steepness = domain_.axes[other.axis].steepness;
      further.has_missing |= filling.field.kernel && other.drawn().missing_values > 0;
      most = std::max(most, lattices.others[i].fill(filling.others[i], further, least));
      value.others[other.axis] = further.records ? further.records : further.constants;
    }
    brick = value;
    if (most == least) return;
  }
}

std::uint64_t GridDomain::bytes() const {
  std::uint64_t bytes = domain_.bytes() + occupancy_.sums.size() * sizeof(std::int32_t);
  for (const Other& other : others_)
    bytes += (other.field.coefficients.size() + other.field.min.size() + other.field.max.size()) * sizeof(float);
  return bytes;
}

}  // namespace tetravox::cpu
