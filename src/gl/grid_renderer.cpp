#include "src/gl/frame_parts.h"
#include "src/gl/frame_renderers.h"
#include "src/gl/grid_textures.h"
#include "src/gl/integrator_tables.h"
#include "src/gl/march_bricks.h"
#include "src/gl/march_passes.h"
#include "src/gl/slabs.h"
#include "src/gl/slice_block.h"
#include "src/gl/slice_passes.h"
#include "src/grid/frame.h"
#include "src/optics/steepness_table.h"
#include "src/scene/brick_plan.h"
#include "src/scene/filtered_field.h"
#include "src/scene/fixed_rate.h"
#include "src/scene/grid_view.h"
#include "src/support/threads.h"
#include "src/support/timer.h"
#include "tetravox/error.h"

#include <algorithm>
#include <memory>
#include <utility>
#include <vector>

namespace tetravox::gl {
namespace {

/// Bricks that a ray is taken through in one pass: a fraction of a second on slow devices, which drivers with a
/// watchdog allow.
constexpr int kBricksAPass = 64;

class GridRenderer final : public scene::FrameRenderer {
 public:
  GridRenderer(const PreparedGrid& grid, std::shared_ptr<Context> context)
      : grid_(grid), context_(std::move(context)), frame_(grid::make_grid_frame(grid.data.shape)) {
    const auto current = context_->make_current();
    auto device = std::make_unique<Device>(grid, *context_);  // freed while the context is current
    context_->require_no_error("the grid");
    device_ = std::move(device);
  }
  ~GridRenderer() override { free_parts(*context_, device_); }

  void set_transfer_function(const OpticalFunction& function) override {
    const optics::ScalarMap map = scalar_map();
    device_->tables.set_transfer_function(function, {map, grid_.scalar_range, diagonal(), false});
    optics::build_steepness_table(device_->tables.control_points(), map.stored_from_value(grid_.scalar_range.min),
                                  map.stored_from_value(grid_.scalar_range.max), steepness_);
    device_->slabs.invalidate();
    has_domain_ = is_planned_ = false;
  }
  void set_table(const OpticalTable&, const std::vector<std::size_t>&) override { has_domain_ = true; }
  void set_colors(std::size_t, const OpticalFunction&) override { has_domain_ = true; }
  bool has_domain() const override { return has_domain_; }

  void render(const Camera& camera, const RenderSettings& settings, const scene::FrameContext& context, Image& image,
              RenderStatistics& statistics) override;

  std::uint64_t missing_bytes(const RenderSettings& settings) const override;
  std::uint64_t bytes() const override {
    const Device& device = *device_;
    return device.values.bytes() + device.frame.bytes() + device.tables.bytes() + device.bricks.bytes() +
           device.nodes.bytes() + device.slabs.bytes() + device.march.bytes() + device.slices.bytes() +
           plans_.size() * sizeof(scene::BrickPlan) + field_.coefficients.size() * sizeof(float);
  }
  std::vector<Source> sources() const override { return {Source::kMarch, Source::kSlices}; }
  double diagonal() const override { return scene::diagonal_of(grid_.bounds); }

 private:
  /// What lives on the device, and dies with the context current.
  struct Device {
    Device(const PreparedGrid& grid, const Context& context) : values(grid, context) {}
    GridTexture values;
    FrameParts frame;
    IntegratorTables tables;
    MarchBricks bricks;
    FilteredNodes nodes;
    MarchPasses march;
    Slabs slabs;
    SlicePasses slices;
  };

  optics::ScalarMap scalar_map() const { return {grid_.scalar_offset, grid_.scalar_scale}; }
  bool is_constant(const RenderSettings& settings) const {
    const bool is_cell = grid_.data.association == Association::kCell;
    return settings.filter.kind == FilterKind::kNearest || (is_cell && !scene::wants_kernel(settings.filter));
  }
  const PreparedGrid& drawn() const { return field_.middles ? *field_.middles : grid_; }
  scene::PlanSources plan_sources(const RenderSettings& settings) const;
  void plan(const RenderSettings& settings);
  void slice(const Camera& camera, const RenderSettings& settings, const scene::FrameContext& context, Image& image,
             RenderStatistics& statistics);
  FilteredBricks filtered_bricks(const scene::PlanSources& sources, const RenderSettings& settings) const;
  MarchKind kind_of(const RenderSettings& settings) const;
  /// Whether the device is to interpolate values: floats, where rays look slabs up, which rounds scalars anyway.
  /// Software rounds filtered integers to whole numbers.
  bool wants_filter(const MarchKind& kind, const RenderSettings& settings) const {
    return kind.has_runs && device_->values.has_floats() && scene::may_look_slabs_up(grid_, steepness_, settings);
  }
  /// Where every fetch is a call, as of software, fewer and larger ones pay; hardware has caches and units for them.
  bool wants_squares(const RenderSettings& settings) const {
    return context_->device().is_software && !scene::wants_kernel(settings.filter) && !is_constant(settings) &&
           settings.integrator != Integrator::kPre;
  }
  void march(const scene::GridView& view, const RenderSettings& settings, const scene::FrameContext& context,
             RenderStatistics& statistics);
  MarchBlock describe(const scene::GridView& view, const RenderSettings& settings) const;

  const PreparedGrid& grid_;
  std::shared_ptr<Context> context_;
  grid::GridFrame frame_;
  scene::FilteredField field_;
  optics::SteepnessTable steepness_;
  std::unique_ptr<Device> device_;
  std::vector<scene::BrickPlan> plans_;
  RaySteps steps_;
  scene::PlanSettings planned_for_;
  bool is_planned_ = false, has_domain_ = false;
};

std::uint64_t GridRenderer::missing_bytes(const RenderSettings& settings) const {
  const std::uint64_t pixels = static_cast<std::uint64_t>(settings.width) * static_cast<std::uint64_t>(settings.height);
  std::uint64_t of_values = 0;
  if (scene::wants_kernel(settings.filter)) {
    constexpr std::uint64_t kNodes = (8 * kBrickCells + 1) * (8 * kBrickCells + 1) * (8 * kBrickCells + 1);
    const std::uint64_t texel = settings.integrator == Integrator::kPre ? 16 : 4;
    // Here and on the device.
    of_values = 2 * texel * std::min<std::uint64_t>(kNodes * grid_.bricks.count(), FilteredNodes::kMostTexels);
  } else if (wants_squares(settings) && !wants_filter(kind_of(settings), settings)) {
    of_values = GridTexture::bytes_of_squares(device_->values.volume());
  }
  return estimate_render_memory(grid_.data, settings) + pixels * MarchPasses::kPauseBytes + of_values;
}

scene::PlanSources GridRenderer::plan_sources(const RenderSettings& settings) const {
  return {&drawn(), &field_, &steepness_, device_->tables.node_width(), diagonal(), is_constant(settings), false, {}};
}

/// Filter, plans, and what of them goes to the device.
void GridRenderer::plan(const RenderSettings& settings) {
  if (field_.kernel ? field_.filter != settings.filter : scene::wants_kernel(settings.filter)) {
    is_planned_ = false;
    field_ = scene::make_filtered_field(grid_, settings.filter);
    frame_ = grid::make_grid_frame(drawn().data.shape);
  }
  const scene::PlanSettings wanted{
      settings.filter, settings.integrator, settings.tolerance, settings.samples_per_voxel, false, {}};
  if (is_planned_ && wanted == planned_for_) return;
  const scene::PlanSources sources = plan_sources(settings);
  plans_ = scene::plan_bricks(sources, wanted);
  device_->bricks.upload(sources, plans_, frame_);
  const double step = settings.samples_per_voxel > 0.0 ? grid::mean_spacing(frame_) / settings.samples_per_voxel : 0.0;
  steps_ = find_ray_steps(sources, plans_, {grid::longest_cell_diagonal(frame_), step}, device_->tables);
  device_->nodes.forget();
  planned_for_ = wanted;
  is_planned_ = true;
}

MarchKind GridRenderer::kind_of(const RenderSettings& settings) const {
  MarchKind kind;
  kind.integrator = settings.integrator;
  kind.is_uneven = std::any_of(frame_.planes.begin(), frame_.planes.end(), [](const auto& p) { return !p.empty(); });
  kind.is_constant = is_constant(settings);
  kind.is_nearest = kind.is_constant && grid_.data.association == Association::kPoint;
  kind.has_nodes = field_.kernel != nullptr;
  kind.has_samples =
      settings.samples_per_voxel > 0.0 && !kind.is_constant && !scene::restarts_rate(drawn(), settings.integrator);
  if (kind.is_constant) kind.integrator = Integrator::kAntiderivative;  // all are the same
  if (takes_points(kind) || kind.has_samples) return kind;
  kind.has_runs = scene::counts_steps(grid_, settings);
  if (kind.has_runs) return kind;
  kind.has_strides = steps_.has_strides;
  kind.has_cells = steps_.has_cells || !steps_.has_strides;
  return kind;
}

FilteredBricks GridRenderer::filtered_bricks(const scene::PlanSources& sources, const RenderSettings& settings) const {
  FilteredBricks bricks{&sources, &plans_, {}, nullptr};
  bricks.field.reader = field_.reader.get();
  bricks.field.padding = field_.coefficients.empty() ? 0 : scene::FilteredField::kMargin;
  bricks.field.kernel = field_.kernel.get();
  bricks.field.allowed_rate = scene::allowed_rate_of(settings.tolerance, diagonal());
  if (settings.integrator == Integrator::kPre) bricks.points = &device_->tables.control_points();
  return bricks;
}

MarchBlock GridRenderer::describe(const scene::GridView& view, const RenderSettings& settings) const {
  MarchBlock block{};
  const auto row = [&](int i) {
    const double* m = view.grid_from_camera.data() + 4 * i;
    return vec4{static_cast<float>(m[0]), static_cast<float>(m[1]), static_cast<float>(m[2]), static_cast<float>(m[3])};
  };
  block.grid_x = row(0);
  block.grid_y = row(1);
  block.grid_z = row(2);
  const auto& dimensions = drawn().data.shape.dimensions;
  block.upper = {frame_.plane(0, dimensions[0] - 1), frame_.plane(1, dimensions[1] - 1),
                 frame_.plane(2, dimensions[2] - 1), 0.0f};
  block.cells_x = static_cast<int>(dimensions[0] - 1);
  block.cells_y = static_cast<int>(dimensions[1] - 1);
  block.cells_z = static_cast<int>(dimensions[2] - 1);
  block.texel_x = 1.0f / static_cast<float>(dimensions[0]);
  block.texel_y = 1.0f / static_cast<float>(dimensions[1]);
  block.texel_z = 1.0f / static_cast<float>(dimensions[2]);
  block.bricks_x = static_cast<int>(drawn().bricks.counts[0]);
  block.bricks_y = static_cast<int>(drawn().bricks.counts[1]);
  block.bricks_z = static_cast<int>(drawn().bricks.counts[2]);
  block.plane_base_y = static_cast<int>(dimensions[0]);
  block.plane_base_z = static_cast<int>(dimensions[0] + dimensions[1]);
  block.bricks_a_pass = kBricksAPass;
  block.texel_offset = device_->values.map().offset;
  block.texel_scale = device_->values.map().scale;
  block.allowed_rate = scene::allowed_rate_of(settings.tolerance, diagonal());
  block.most_pieces = scene::most_pieces_of(settings.tolerance);
  block.steepness_first = steepness_.first;
  block.bins_per_scalar = steepness_.bins_per_scalar;
  if (settings.samples_per_voxel > 0.0)
    block.sample_distance = static_cast<float>(grid::mean_spacing(frame_) / settings.samples_per_voxel);
  Slabs::describe(scene::stored_range(grid_), block);
  block.negligible = scene::negligible_transmittance(settings);
  return block;
}

/// A frame by the source `slices`: of the grid as it is, whatever the filter.
void GridRenderer::slice(const Camera& camera, const RenderSettings& settings, const scene::FrameContext& context,
                         Image& image, RenderStatistics& statistics) {
  require_sliceable(grid_, settings);
  const auto current = context_->make_current();
  Device& device = *device_;
  const grid::GridFrame frame = grid::make_grid_frame(grid_.data.shape);
  const scene::GridView view = scene::make_grid_view(grid_, frame, camera, settings.width, settings.height);
  device.frame.begin(context_->limits(), view.camera, view.world_per_local, settings);
  device.slices.draw(
      {grid_, frame, view, device.values, device.tables, device.frame, settings, *context_, context.progress},
      statistics);
  device.frame.download(image);
  context_->require_no_error("drawing");
  note_backend(*context_, statistics);
}

/// Draws with everything bound but the values.
void GridRenderer::march(const scene::GridView& view, const RenderSettings& settings,
                         const scene::FrameContext& context, RenderStatistics& statistics) {
  Device& device = *device_;
  MarchKind kind = kind_of(settings);
  kind.shader = takes_points(kind) ? device.tables.points() : device.tables.shader(settings);
  device.values.volume().bind(kValueUnit);
  kind.is_filtered = wants_filter(kind, settings);
  const bool has_squares = !kind.is_filtered && wants_squares(settings);
  if (const Volume* squares = has_squares ? device.values.squares(*context_) : nullptr) {
    squares->bind(kSquareUnit);
    kind.has_squares = true;
  }
  MarchBlock block = describe(view, settings);
  if (kind.has_runs && scene::may_look_slabs_up(grid_, steepness_, settings)) {
    device.slabs.make(block, kind.shader, settings.tolerance);
    device.slabs.bind();
    kind.shader = slab_shader();
  }
  block.most_work = pieces_a_pass(kind.shader);
  MarchFrame frame{block, kind, device.frame, settings, context_->limits(), context.progress};
  const scene::PlanSources sources = plan_sources(settings);
  const FilteredBricks filtered = filtered_bricks(sources, settings);
  std::vector<NodePlace> places;
  if (kind.has_nodes) {
    frame.begin_bricks = [&] { device.nodes.begin(frame_, view, filtered, context_->limits()); };
    frame.next_bricks = [&] {
      const bool has_more = device.nodes.next(filtered, context.progress, places);
      device.bricks.place_nodes(places);
      device.bricks.bind();
      device.nodes.bind(kValueUnit);
      return has_more;
    };
  }
  device.march.draw(frame, statistics);
}

void GridRenderer::render(const Camera& camera, const RenderSettings& settings, const scene::FrameContext& context,
                          Image& image, RenderStatistics& statistics) {
  if (settings.integrator == Integrator::kCylindrical)
    throw Error(ErrorCode::kInvalidArgument,
                "the integrator 'cylindrical' is for meshes: choose another (tetravox list methods)");
  if (has_domain_)
    throw Error(ErrorCode::kUnsupported,
                "the OpenGL backend does not know functions of several variables yet: draw with --backend cpu");
  if (settings.source == Source::kSlices) return slice(camera, settings, context, image, statistics);
  require_supported(settings);
  // The spline would have to pass through the densities of each function: no table of the values does that.
  if (settings.integrator == Integrator::kPre && settings.filter.kind == FilterKind::kInterpolatingBspline)
    throw Error(
        ErrorCode::kInvalidArgument,
        "pre-classification does not go with the filter 'bspline-interpolating': choose 'bspline' or 'catmull-rom'");
  const auto current = context_->make_current();
  Device& device = *device_;
  const support::Timer timer;
  plan(settings);
  const double longest = settings.samples_per_voxel > 0.0 ? grid::mean_spacing(frame_) / settings.samples_per_voxel
                                                          : grid::longest_cell_diagonal(frame_);
  SegmentBounds segments = steps_.segments;
  segments.longest = longest;
  segments.may_overshoot = field_.kernel != nullptr;
  device.tables.bind(settings, segments, context_->limits(), context.progress);
  statistics.plan_seconds = timer.seconds();
  const scene::GridView view = scene::make_grid_view(drawn(), frame_, camera, settings.width, settings.height);
  device.frame.begin(context_->limits(), view.camera, view.world_per_local, settings);
  device.bricks.bind();
  march(view, settings, context, statistics);
  device.frame.download(image);
  context_->require_no_error("drawing");
  note_backend(*context_, statistics);
}

}  // namespace

std::unique_ptr<scene::FrameRenderer> make_grid_renderer(const PreparedGrid& grid, std::shared_ptr<Context> context) {
  if (grid.bricks.count() == 0) throw Error(ErrorCode::kNothingToDraw, "the grid has no cells to draw");
  return std::make_unique<GridRenderer>(grid, std::move(context));
}

}  // namespace tetravox::gl

namespace tetravox {

Renderer make_gl_renderer(const PreparedGrid& grid, const GlOptions& options) {
  return Renderer(gl::make_grid_renderer(grid, gl::Context::open(options)));
}

}  // namespace tetravox
