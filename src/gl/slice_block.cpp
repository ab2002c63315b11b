#include "src/gl/slice_block.h"

#include "src/optics/antiderivative_table.h"
#include "src/scene/frame_renderer.h"
#include "tetravox/error.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>
#include <tuple>

namespace tetravox::gl {
namespace {

constexpr int kLargestRadius = 3;

/// By how much of the range of values a segment of a curved slab may be off.
constexpr double kStraightOfRange = 5e-4;

bool is_cell(const PreparedGrid& grid) { return grid.data.association == Association::kCell; }

bool is_uneven(const PreparedGrid& grid) {
  return std::ranges::any_of(grid.data.shape.coordinates, [](const auto& c) { return !c.empty(); });
}

bool is_constant(const PreparedGrid& grid, const RenderSettings& settings) {
  return settings.filter.kind == FilterKind::kNearest || (is_cell(grid) && !filters_slices(settings));
}

int radius_of(const Filter& filter) { return filter.kind == FilterKind::kLanczos ? filter.radius : 2; }

bool has_point_light(const Lighting& lighting) {
  return std::ranges::any_of(lighting.lights, [](const Light& light) { return light.kind == LightKind::kPoint; });
}

/// One directional light, and nothing that half-angle slices do not know.
void require_half_angle(const RenderSettings& settings) {
  const Lighting& lighting = settings.lighting;
  const auto fail = [](const char* what) {
    throw Error(ErrorCode::kUnsupported, "half-angle shadows " + std::string(what));
  };
  if (lighting.lights.size() != 1 || lighting.lights[0].kind != LightKind::kDirectional)
    fail("are those of one directional light: give one, or draw other shadows with --backend cpu --source march");
  if (settings.slicing.kind != SlicingKind::kView3d)
    fail("cut the 3D texture by planes of their own: choose --source slices=view-3d");
  if (filters_slices(settings)) fail("know the filters linear and nearest only: choose one of them");
  if (!settings.surfaces.empty()) fail("are those of the volume: leave iso-surfaces out");
}

void require_filter(const PreparedGrid& grid, const RenderSettings& settings) {
  if (!filters_slices(settings)) {
    if (settings.lighting.is_lit() && settings.lighting.gradient == GradientMethod::kFilter)
      throw Error(ErrorCode::kUnsupported, "slices know the gradient 'filter' with kernels only: choose 'central'");
    return;
  }
  const std::string name = "slices with the filter '" + name_of(settings.filter) + "' ";
  if (radius_of(settings.filter) > kLargestRadius)
    throw Error(ErrorCode::kUnsupported, name + "would take too many tiles: choose a radius of 3 at most");
  if (settings.integrator == Integrator::kPre)
    throw Error(ErrorCode::kUnsupported, name + "are not pre-classified: choose another classification");
  if (settings.slicing.kind == SlicingKind::kStripes2d)
    throw Error(ErrorCode::kUnsupported, name + "are not cut into stripes: choose another kind of slices");
  for (const std::uint32_t points : grid.data.shape.dimensions)
    if (is_cell(grid) && points < 3)
      throw Error(ErrorCode::kInvalidArgument, "filter '" + name_of(settings.filter) +
                                                   "' needs two cells or more along each axis: choose 'linear' or "
                                                   "'nearest'");
}

}  // namespace

void require_sliceable(const PreparedGrid& grid, const RenderSettings& settings) {
  const Lighting& lighting = settings.lighting;
  const bool has_shadows = lighting.shadows == ShadowKind::kVolume || lighting.shadows == ShadowKind::kExact;
  const bool is_lit = lighting.is_lit();
  // With the way round each, where there is one.
  const std::tuple<bool, const char*, const char*> unknown[] = {
      {is_uneven(grid), "grids with uneven axes", "choose --source march"},
      {settings.samples_per_voxel > 0.0, "by a fixed rate of samples", "give --slices-per-voxel instead"},
      {is_lit && has_shadows, "these shadows", "choose --shadows half-angle"},
      {!settings.clipping.shapes.empty(), "clipping", nullptr},
      {settings.opacity_weight != OpacityWeight::kNone, "opacity weights", nullptr},
      {settings.wants_depth, "depths", nullptr},
      {lighting.environment.has_value(), "light of surroundings", nullptr},
      {is_lit && lighting.ambient_occlusion > 0, "ambient occlusion", nullptr},
      {has_point_light(lighting), "point lights", nullptr},
      {lighting.lights.size() > kMostSliceLights, "more than 8 lights", "give fewer"},
      {settings.surfaces.size() > kMostSliceSurfaces, "more than 15 iso-surfaces", "give fewer"},
  };
  for (const auto& [is_asked, name, cure] : unknown)
    if (is_asked)
      throw Error(ErrorCode::kUnsupported, "slices do not draw " + std::string(name) + ": " +
                                               (cure ? std::string(cure) + ", or " : "") +
                                               "draw with --backend cpu --source march");
  if (!settings.surfaces.empty() && is_constant(grid, settings))
    throw Error(ErrorCode::kInvalidArgument, "iso-surfaces need a continuous field: this one is constant in each cell");
  require_filter(grid, settings);
  if (lighting.shadows == ShadowKind::kHalfAngle) require_half_angle(settings);
}

bool filters_slices(const RenderSettings& settings) {
  return settings.filter.kind != FilterKind::kLinear && settings.filter.kind != FilterKind::kNearest;
}

SliceVariant variant_of(const PreparedGrid& grid, const RenderSettings& settings) {
  SliceVariant variant;
  variant.is_lit = settings.lighting.is_lit();
  variant.is_curved = settings.slicing.slabs == SlabShape::kCurved;
  variant.has_surfaces = !settings.surfaces.empty();
  variant.is_half_angle = settings.lighting.shadows == ShadowKind::kHalfAngle && variant.is_lit;
  if (filters_slices(settings)) {
    variant.field = SliceField::kPictures;
    variant.has_kernel_gradients = variant.is_lit && settings.lighting.gradient != GradientMethod::kCentral;
  } else if (settings.slicing.kind == SlicingKind::kObject2d ||
             settings.slicing.kind == SlicingKind::kObject2dInterpolated) {
    variant.field = SliceField::kStack;
  } else if (settings.slicing.kind == SlicingKind::kStripes2d) {
    variant.field = SliceField::kStripes;
  }
  if (settings.integrator == Integrator::kPost) variant.classification = SliceClassification::kPost;
  if (settings.integrator == Integrator::kPre) variant.classification = SliceClassification::kPre;
  if (is_constant(grid, settings)) variant.classification = SliceClassification::kConstant;
  return variant;
}

SlicingRequest request_of(const PreparedGrid& grid, const grid::GridFrame& frame, const scene::GridView& view,
                          const RenderSettings& settings) {
  SlicingRequest request;
  request.settings = settings.slicing;
  // Kernels take cell data as points in the middles of the cells.
  const double inset = is_cell(grid) && filters_slices(settings) ? 0.5 : 0.0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    request.lower[axis] = inset;
    request.upper[axis] = static_cast<double>(grid.data.shape.dimensions[axis] - 1) - inset;
  }
  const auto& m = frame.world_from_grid;
  request.mean_spacing = std::cbrt(std::abs(m[0] * (m[4] * m[8] - m[5] * m[7]) - m[1] * (m[3] * m[8] - m[5] * m[6]) +
                                            m[2] * (m[3] * m[7] - m[4] * m[6]))) /
                         view.world_per_local;
  request.diagonal = scene::diagonal_of(grid.bounds) / view.world_per_local;
  // Where samples are single, textures are where they are taken.
  const SliceClassification classification = variant_of(grid, settings).classification;
  request.is_centred = classification == SliceClassification::kPost || classification == SliceClassification::kPre ||
                       (classification == SliceClassification::kConstant && !is_cell(grid));
  return request;
}

namespace {

vec4 row_of(const std::array<double, 12>& matrix, std::size_t row) {
  const auto at = [&](std::size_t column) { return static_cast<float>(matrix[4 * row + column]); };
  return {at(0), at(1), at(2), at(3)};
}

vec4 row_of(const Point& p, double w) {
  return {static_cast<float>(p[0]), static_cast<float>(p[1]), static_cast<float>(p[2]), static_cast<float>(w)};
}

Point to_camera(const scene::GridView& view, const Vector3& direction) {
  Point seen{};
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (std::size_t i = 0; i < 3; ++i) seen[axis] += view.camera.axes[axis][i] * direction[i];
  const double length = std::hypot(seen[0], seen[1], seen[2]);
  for (double& component : seen) component /= length;
  return seen;
}

void describe_light(const PreparedGrid& grid, const scene::GridView& view, const Lighting& lighting,
                    SliceBlock& block) {
  block.ambient = static_cast<float>(lighting.material.ambient);
  block.diffuse = static_cast<float>(lighting.material.diffuse);
  block.specular = static_cast<float>(lighting.material.specular);
  block.shininess = static_cast<float>(lighting.material.shininess);
  block.is_two_sided = lighting.is_two_sided;
  const double range = grid.scalar_range.max - grid.scalar_range.min;
  const double stored =
      lighting.gradient_threshold * range / scene::diagonal_of(grid.bounds) * view.world_per_local / grid.scalar_scale;
  block.half_strength = static_cast<float>(stored * stored);
  block.light_count = static_cast<int>(lighting.lights.size());
  for (std::size_t i = 0; i < lighting.lights.size(); ++i) {
    const Light& light = lighting.lights[i];
    const bool is_headlight = light.kind == LightKind::kHeadlight;
    block.light_vectors[i] = {0.0f, 0.0f, 0.0f, 1.0f};
    if (!is_headlight)
      block.light_vectors[i] =
          row_of(to_camera(view, {-light.direction[0], -light.direction[1], -light.direction[2]}), 0.0);
    block.light_colors[i] = row_of(
        {light.color[0] * light.intensity, light.color[1] * light.intensity, light.color[2] * light.intensity}, 0.0);
  }
}

void describe_surfaces(const PreparedGrid& grid, const std::vector<Isosurface>& surfaces, SliceBlock& block) {
  const optics::ScalarMap map{grid.scalar_offset, grid.scalar_scale};
  std::vector<float> values;
  for (const Isosurface& surface : surfaces) values.push_back(map.stored_from_value(surface.value));
  std::sort(values.begin(), values.end());
  values.resize(16);
  for (std::size_t i = 0; i < 4; ++i)
    block.surface_values[i] = {values[4 * i], values[4 * i + 1], values[4 * i + 2], values[4 * i + 3]};
  block.surface_count = static_cast<int>(surfaces.size());
}

}  // namespace

SliceBlock describe(const PreparedGrid& grid, const scene::GridView& view, const RenderSettings& settings,
                    const SlicingRequest& request, const TexelMap& map) {
  SliceBlock block{};
  block.grid_x = row_of(view.grid_from_camera, 0);
  block.grid_y = row_of(view.grid_from_camera, 1);
  block.grid_z = row_of(view.grid_from_camera, 2);
  block.lower = row_of(request.lower, 0.0);
  block.upper = row_of(request.upper, 0.0);
  block.stack_axis = axis_along(view);
  const double range = (grid.scalar_range.max - grid.scalar_range.min) / grid.scalar_scale;
  block.segments_per_bend = static_cast<float>(1.0 / std::max(kStraightOfRange * range, 1e-30));
  // Kernels may leave the range of the values, and then the integrator knows.
  const optics::ScalarMap stored{grid.scalar_offset, grid.scalar_scale};
  block.scalar_low = filters_slices(settings) ? -1e30f : stored.stored_from_value(grid.scalar_range.min);
  block.scalar_high = filters_slices(settings) ? 1e30f : stored.stored_from_value(grid.scalar_range.max);
  block.texel_offset = map.offset;
  block.texel_scale = map.scale;
  if (is_cell(grid) && filters_slices(settings)) block.value_shift = -0.5f;
  if (!is_cell(grid) && settings.filter.kind == FilterKind::kNearest) block.value_shift = 0.5f;
  describe_light(grid, view, settings.lighting, block);
  describe_surfaces(grid, settings.surfaces, block);
  return block;
}

void describe(const SlabFamily& family, SliceBlock& block) {
  block.plane = row_of(family.plane.normal, family.plane.offset);
  block.t_first = static_cast<float>(family.first);
  block.t_step = static_cast<float>(family.step);
  block.are_shells = family.are_shells;
}

Point way_of_light(const scene::GridView& view, const Lighting& lighting) {
  return to_camera(view, lighting.lights.front().direction);
}

Point half_way(const Point& light) {
  Point half{light[0], light[1], light[2] + (light[2] >= 0.0 ? 1.0 : -1.0)};
  const double length = std::hypot(half[0], half[1], half[2]);
  for (double& component : half) component /= length;
  return half;
}

std::vector<std::array<float, 4>> make_surface_colors(const std::vector<Isosurface>& surfaces) {
  std::vector<Isosurface> sorted = surfaces;
  std::stable_sort(sorted.begin(), sorted.end(), [](const auto& a, const auto& b) { return a.value < b.value; });
  const std::size_t side = sorted.size() + 1;
  std::vector<std::array<float, 4>> colors(side * side);
  for (std::size_t back = 0; back < side; ++back)
    for (std::size_t front = 0; front < side; ++front) {
      const bool rises = front < back;
      double color[3] = {}, through = 1.0;
      for (std::size_t met = 0; met < (rises ? back - front : front - back); ++met) {
        const Isosurface& surface = sorted[rises ? front + met : front - 1 - met];
        const double opacity = rises || surface.is_two_sided ? surface.opacity : 0.0;
        const Color& side_color = rises ? surface.front_color : surface.back_color;
        for (std::size_t i = 0; i < 3; ++i) color[i] += through * opacity * side_color[i];
        through *= 1.0 - opacity;
      }
      colors[back * side + front] = {static_cast<float>(color[0]), static_cast<float>(color[1]),
                                     static_cast<float>(color[2]), static_cast<float>(1.0 - through)};
    }
  return colors;
}

}  // namespace tetravox::gl
