#include "src/cpu/brick_lattice.h"
#include "src/cpu/clip_intervals.h"
#include "src/cpu/frame_renderers.h"
#include "src/cpu/grid_domain.h"
#include "src/cpu/grid_frame.h"
#include "src/cpu/grid_marches.h"
#include "src/cpu/grid_packets.h"
#include "src/cpu/grid_shadows.h"
#include "src/cpu/illustration.h"
#include "src/cpu/planned_brick.h"
#include "src/cpu/tile_intervals.h"
#include "src/grid/summaries.h"
#include "src/optics/antiderivative_table.h"
#include "src/optics/extinction_integral.h"
#include "src/optics/steepness_table.h"
#include "src/optics/transparency_table.h"
#include "src/scene/brick_plan.h"
#include "src/scene/filtered_field.h"
#include "src/scene/fixed_rate.h"
#include "src/scene/preintegration_cache.h"
#include "src/support/threads.h"
#include "src/support/timer.h"
#include "tetravox/error.h"

#include <tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <atomic>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

namespace tetravox::cpu {
namespace {

/// What one thread works with.
struct Workspace {
  std::unique_ptr<MarchRays> rays = std::make_unique<MarchRays>();
  BrickLattices lattices;
  TileIntervals intervals;
};

/// One frame: what all its tiles share.
struct FrameParts {
  scene::GridView view;
  scene::Rays rays;
  BrickBins bins;
  std::vector<LatticeField> others;
  PlannedGrid grid;
  Marches marches;
  const Kernels* kernels = nullptr;
  MarchJob job;
  std::optional<GridPackets> packets;  // where rays need no bricks
  bool has_clipping = false;
  ClipScene clip;
  Illustration illustration;
};

/// The pixel in a tile's corner.
struct TilePlace {
  int column = 0, row = 0;
};

struct TileCounts {
  std::uint64_t segments = 0, rays = 0;
};

class GridRenderer final : public scene::FrameRenderer {
 public:
  explicit GridRenderer(const PreparedGrid& grid)
      : grid_(grid),
        frame_(grid::make_grid_frame(grid.data.shape)),
        reader_(grid.data, {grid.scalar_offset, grid.scalar_scale}),
        domain_(grid) {}

  void set_transfer_function(const OpticalFunction& function) override {
    const ValueRange& range = grid_.scalar_range;
    control_points_ = optics::build_control_point_table(function, scalar_map());
    extinction_ = optics::ExtinctionIntegral(function, scalar_map());
    optics::build_antiderivative_table(function, scalar_map(), range, diagonal(), antiderivative_);
    optics::build_steepness_table(control_points_, scalar_map().stored_from_value(range.min),
                                  scalar_map().stored_from_value(range.max), steepness_);
    has_centroids_ = false;
    preintegration_.invalidate();
    slabs_.invalidate();
    function_ = function;
    domain_.clear();
    is_planned_ = false;
    ++function_number_;
  }

  void set_table(const OpticalTable& table, const std::vector<std::size_t>& others) override {
    domain_.set_table(table, others);
    is_planned_ = false;
    ++function_number_;
  }
  void set_colors(std::size_t other, const OpticalFunction& colors) override {
    domain_.set_colors(other, colors, function_);
    is_planned_ = false;
    ++function_number_;
  }
  bool has_domain() const override { return domain_.is_set(); }

  void render(const Camera& camera, const RenderSettings& settings, const scene::FrameContext& context, Image& image,
              RenderStatistics& statistics) override;

  std::uint64_t missing_bytes(const RenderSettings& settings) const override {
    return estimate_render_memory(grid_.data, settings) -
           std::min(preintegration_.bytes(), scene::preintegration_bytes(settings)) -
           (settings.samples_per_voxel > 0.0 ? slabs_.bytes() : 0);
  }

  std::uint64_t bytes() const override {
    return antiderivative_.bytes() + control_points_.bytes() + extinction_.bytes() +
           (plans_.size() + group_plans_.size()) * sizeof(scene::BrickPlan) +
           (visible_.size() + field_.coefficients.size()) * sizeof(float) + frame_bytes_ +
           centroids_.sums.size() * sizeof(std::int32_t) + shadows_.bytes() + domain_.bytes() +
           preintegration_.bytes() + slabs_.bytes() + seen_spans_.size() + seen_groups_.size() * sizeof(std::uint32_t);
  }

  std::vector<Source> sources() const override { return {Source::kMarch}; }
  double diagonal() const override { return scene::diagonal_of(grid_.bounds); }

 private:
  optics::ScalarMap scalar_map() const { return {grid_.scalar_offset, grid_.scalar_scale}; }
  bool is_constant(const RenderSettings& settings) const {
    const bool is_cell = grid_.data.association == Association::kCell;
    return settings.filter.kind == FilterKind::kNearest || (is_cell && !scene::wants_kernel(settings.filter));
  }
  const PreparedGrid& drawn() const { return field_.middles ? *field_.middles : grid_; }
  void prepare_filter(const RenderSettings& settings);
  void prepare_preintegration(const RenderSettings& settings, const Progress& progress);
  void fill_lattices(const FrameParts& frame, std::uint32_t index, Workspace& workspace, MarchBrick& brick) const;
  GradientSource choose_gradients(const RenderSettings& settings) const;
  void describe(const RenderSettings& settings, const scene::FrameContext& context, FrameParts& frame);
  void trace(const RenderSettings& settings, const scene::FrameContext& context, FrameParts& frame) const;
  ShadowedBody shadowed_body() const;
  void prepare_shadows(const Camera& camera, const RenderSettings& settings, const scene::FrameContext& context);
  struct Pass;
  Marches choose_kernels(const Kernels& kernels, const RenderSettings& settings, bool has_effects) const;
  void draw(const Pass& pass, const scene::FrameContext& context, Image& image, RenderStatistics& statistics);
  LatticeField lattice_field(const RenderSettings& settings, const Kernels& kernels) const;
  scene::PlanSources plan_sources(const RenderSettings& settings) const;
  scene::PlanSettings plan_settings(const RenderSettings& settings) const;
  void plan(const RenderSettings& settings);
  std::optional<GridPackets> make_packets(const RenderSettings& settings, const Kernels& kernels, const MarchJob& job);
  MarchJob make_job(const RenderSettings& settings, const IntegratorTables& tables) const;
  std::uint64_t draw_brick(const FrameParts& frame, const TilePlace& place, const BinnedBrick& binned,
                           Workspace& workspace) const;
  std::uint64_t draw_packets(const FrameParts& frame, const TilePlace& place, Workspace& workspace) const;
  std::uint64_t draw_bricks(const FrameParts& frame, const TilePlace& place, std::span<const BinnedBrick> bricks,
                            Workspace& workspace) const;
  TileCounts draw_tile(const FrameParts& frame, std::size_t tile, Workspace& workspace, Image& image) const;

  const PreparedGrid& grid_;
  grid::GridFrame frame_;
  grid::BlockReader reader_;
  scene::FilteredField field_;
  OpticalFunction function_;
  GridDomain domain_;
  optics::AntiderivativeTable antiderivative_;
  optics::ControlPointTable control_points_;
  optics::ExtinctionIntegral extinction_;
  optics::SteepnessTable steepness_;
  bool has_centroids_ = false;
  optics::CentroidTable centroids_;  // made at the first frame with light
  std::uint64_t function_number_ = 0;
  ShadowCache shadows_;
  scene::PreintegrationCache preintegration_;
  SlabCache slabs_;
  bool is_planned_ = false;
  scene::PlanSettings planned_for_;
  scene::BrickGroups groups_;
  std::vector<scene::BrickPlan> plans_, group_plans_;
  std::vector<std::uint32_t> visible_;
  std::vector<std::uint8_t> seen_spans_;    // where steps are counted,
  std::vector<std::uint32_t> seen_groups_;  // and so
  std::uint64_t frame_bytes_ = 0;
};

LatticeField GridRenderer::lattice_field(const RenderSettings& settings, const Kernels& kernels) const {
  LatticeField field;
  field.kernels = &kernels;
  field.reader = field_.reader ? field_.reader.get() : &reader_;
  field.padding = field_.coefficients.empty() ? 0 : scene::FilteredField::kMargin;
  field.kernel = field_.kernel.get();
  field.points = settings.integrator == Integrator::kPre && !is_constant(settings) ? &control_points_ : nullptr;
  field.is_constant = is_constant(settings);
  field.is_nearest = field.is_constant && grid_.data.association == Association::kPoint;
  field.allowed_rate = scene::allowed_rate_of(settings.tolerance, diagonal());
  field.gradients = choose_gradients(settings);
  field.differences = {&reader_, &frame_, drawn().data.value_dimensions(),
                       drawn().data.association == Association::kCell};
  return field;
}

GradientSource GridRenderer::choose_gradients(const RenderSettings& settings) const {
  const GradientMethod method = settings.lighting.gradient;
  if (method == GradientMethod::kVertex || method == GradientMethod::kCell)
    throw Error(ErrorCode::kInvalidArgument,
                "gradient method '" + name_of(method) + "' is for meshes; grids have 'filter' and 'central'");
  if (!wants_gradients(settings) && !domain_.domain().wants_gradients()) return GradientSource::kNone;
  if (method == GradientMethod::kCentral) return GradientSource::kCentral;
  if (field_.kernel) return GradientSource::kKernel;
  // The kernels have the derivative of a trilinear cell at hand; in a constant one it is none.
  const bool is_corner = method == GradientMethod::kFilter && !is_constant(settings);
  return is_corner ? GradientSource::kNone : GradientSource::kCentral;
}

/// Fills the effects of a frame.
void GridRenderer::describe(const RenderSettings& settings, const scene::FrameContext& context, FrameParts& frame) {
  if (!has_centroids_ && !domain_.is_set()) {
    optics::build_centroid_table(antiderivative_, centroids_);
    has_centroids_ = true;
  }
  IllustratedFrame illustrated{frame.view.camera,
                               frame.view.origin,
                               frame.view.world_per_local,
                               scalar_map(),
                               grid_.scalar_range,
                               diagonal(),
                               {},
                               has_centroids_ ? &centroids_ : nullptr,
                               context.environment};
  const auto& axes = frame.view.camera.axes;
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 3; ++column)
      for (int i = 0; i < 3; ++i)
        illustrated.camera_from_gradient[3 * row + column] +=
            axes[row][i] * frame_.grid_from_world[3 * column + i] * frame.view.world_per_local;
  illustrate(settings, illustrated, frame.illustration);
  shadows_.attach(settings, shadowed_body(), frame.view.camera, frame.illustration);
}

/// Shadows by rays.
void GridRenderer::trace(const RenderSettings& settings, const scene::FrameContext& context, FrameParts& frame) const {
  Illustration& illustration = frame.illustration;
  if (settings.lighting.shadows != ShadowKind::kExact || illustration.lights.empty()) return;
  // Where nobody asks for gradients, larger cells will do.
  scene::PlanSettings plan = plan_settings(settings);
  plan.wants_gradients = settings.opacity_weight == OpacityWeight::kGradient;
  plan.samples_per_voxel = 0.0;
  illustration.shadow_plans = scene::plan_bricks(frame.grid.sources, plan);
  PlannedGrid grid = frame.grid;
  grid.plans = illustration.shadow_plans;
  if (!plan.wants_gradients) grid.field.gradients = GradientSource::kNone;
  // Depths need not know a filtered field as well as colours; surfaces must be where the picture has them.
  constexpr int kPartsForDepths = 4;
  if (settings.surfaces.empty()) grid.field.most_parts = kPartsForDepths;
  GridShadowSettings exactness{frame.job.allowed_rate, frame.job.most_pieces, {}};
  std::copy_n(illustration.effects.camera_from_gradient, 9, exactness.camera_from_gradient.begin());
  const scene::LocalFrame local{frame.view.origin, frame.view.world_per_local};
  illustration.medium =
      std::make_unique<GridShadows>(grid, local, make_shadow_optics(settings, extinction_, illustration), exactness);
  trace_shadows(settings, {frame.view.camera, local.origin, local.world_per_local}, context, illustration);
}

ShadowedBody GridRenderer::shadowed_body() const {
  const scene::LocalFrame local = scene::find_local_frame(drawn());
  return {drawn().bounds, local.origin, local.world_per_local};
}

void GridRenderer::prepare_filter(const RenderSettings& settings) {
  domain_.prepare(settings.filter, settings.tolerance, diagonal());
  if (field_.kernel ? field_.filter == settings.filter : !scene::wants_kernel(settings.filter)) return;
  is_planned_ = false;
  scene::FilteredField field = scene::make_filtered_field(grid_, settings.filter);
  field_ = std::move(field);
  groups_ = {};
  frame_ = grid::make_grid_frame(drawn().data.shape);
}

/// Makes the table of ray integrals, where these are looked up. Constant cells need none.
void GridRenderer::prepare_preintegration(const RenderSettings& settings, const Progress& progress) {
  if (!scene::is_of_tables(settings.integrator) || domain_.is_set() || is_constant(settings)) return;
  const double longest = settings.samples_per_voxel > 0.0 ? grid::mean_spacing(frame_) / settings.samples_per_voxel
                                                          : grid::longest_cell_diagonal(frame_);
  preintegration_.prepare({function_, scalar_map(), grid_.scalar_range, longest, progress}, settings);
}

scene::PlanSources GridRenderer::plan_sources(const RenderSettings& settings) const {
  return {&drawn(),         &field_,
          &steepness_,      1.0f / antiderivative_.nodes_per_scalar,
          diagonal(),       is_constant(settings),
          domain_.is_set(), {},
          &groups_};
}

scene::PlanSettings GridRenderer::plan_settings(const RenderSettings& settings) const {
  scene::PlanSettings wanted{settings.filter,           settings.integrator,
                             settings.tolerance,        settings.samples_per_voxel,
                             wants_gradients(settings), {}};
  for (const Isosurface& surface : settings.surfaces)
    wanted.surface_values.push_back(scalar_map().stored_from_value(surface.value));
  std::sort(wanted.surface_values.begin(), wanted.surface_values.end());
  return wanted;
}

void GridRenderer::plan(const RenderSettings& settings) {
  const scene::PlanSettings wanted = plan_settings(settings);
  if (is_planned_ && wanted == planned_for_) return;
  scene::PlanSources sources = plan_sources(settings);
  if (domain_.domain().is_table()) sources.is_seen = domain_.find_seen();
  if (groups_.count() == 0) groups_ = scene::make_brick_groups(drawn(), field_);
  group_plans_ = scene::plan_groups(sources, wanted);
  plans_ = scene::plan_bricks(sources, wanted, group_plans_);
  visible_ = scene::list_drawn(sources, group_plans_, plans_);
  seen_spans_.clear();
  seen_groups_.clear();
  if (scene::counts_steps(grid_, settings)) {
    seen_spans_ = scene::list_seen_spans(grid_.bricks.counts, plans_);
    seen_groups_ = scene::list_seen_groups(plans_.size(), group_plans_);
  }
  planned_for_ = wanted;
  is_planned_ = true;
}

MarchJob GridRenderer::make_job(const RenderSettings& settings, const IntegratorTables& tables) const {
  MarchJob job;
  job.tables = &tables;
  job.steepness = &steepness_;
  job.allowed_rate = scene::allowed_rate_of(settings.tolerance, diagonal());
  job.most_pieces = scene::most_pieces_of(settings.tolerance);
  job.use_early_ray_termination = settings.use_early_ray_termination;
  job.negligible = scene::negligible_transmittance(settings);
  if (settings.samples_per_voxel > 0.0)
    job.sample_distance = static_cast<float>(grid::mean_spacing(frame_) / settings.samples_per_voxel);
  return job;
}

/// At a fixed rate, where the values serve as they lie: rays in packets instead of bricks.
std::optional<GridPackets> GridRenderer::make_packets(const RenderSettings& settings, const Kernels& kernels,
                                                      const MarchJob& job) {
  if (!scene::counts_steps(grid_, settings)) return {};
  const PacketMarches marches = choose_packet_marches(kernels, settings);
  GridPackets packets(grid_, seen_spans_, marches.segments, job);
  if (scene::may_look_slabs_up(grid_, steepness_, settings))
    packets.use_slabs(slabs_.prepare(scene::stored_range(grid_), *job.tables, kernels, job.sample_distance,
                                     settings.lighting.is_lit()),
                      marches.slabs);
  if (settings.lighting.is_lit()) {
    // What is too faint for a normal in a voxel is so in all steps through it.
    const auto steps = static_cast<float>(std::max(1.0, settings.samples_per_voxel));
    packets.use_light(choose_gradients(settings) == GradientSource::kCentral, job.tables->effects->faint / steps);
  }
  return packets;
}

/// Reads the values of a brick, and what the function asks for beside them.
void GridRenderer::fill_lattices(const FrameParts& frame, std::uint32_t index, Workspace& workspace,
                                 MarchBrick& brick) const {
  if (!domain_.is_set()) return fill_planned(frame.grid, index, workspace.lattices.value, brick);
  domain_.fill({drawn(), frame_, frame.grid.field, frame.others, index}, workspace.lattices, brick);
  if (!plans_[index].is_curved) brick.steepness = 0.0f;
}

/// Takes the rays of the workspace through a brick; returns how many segments they had.
std::uint64_t GridRenderer::draw_brick(const FrameParts& frame, const TilePlace& place, const BinnedBrick& binned,
                                       Workspace& workspace) const {
  const scene::BrickPlan& plan =
      binned.brick < plans_.size() ? plans_[binned.brick] : group_plans_[binned.brick - plans_.size()];
  MarchBrick brick = workspace.lattices.value.describe(drawn(), frame_, binned.brick, plan.level);
  brick.bounds = binned.bounds;
  MarchJob job = frame.job;
  job.rays = workspace.rays.get();
  job.brick = &brick;
  job.column = place.column;
  job.row = place.row;
  job.stride = plan.stride;
  const Marches& marches = frame.marches;
  const Integrate march = plan.stride > 0 ? (plan.is_gentle ? marches.gentle_strides : marches.strides)
                                          : (plan.is_gentle ? marches.gentle_cells : marches.cells);
  std::uint64_t segments = 0;
  bool is_filled = false;
  // A ray that the clipping cuts into several parts passes once for each of those that lie in the brick.
  do {
    const int count = frame.kernels->clip_brick(job);
    if (count == 0) continue;
    if (!is_filled) {
      fill_lattices(frame, binned.brick, workspace, brick);
      is_filled = true;
    }
    segments += march(job, count);
    if (workspace.rays->has_intervals) TileIntervals::note_drawn(*workspace.rays, count);
  } while (workspace.rays->ended_count > 0 && workspace.intervals.advance_ended(*workspace.rays));
  return segments;
}

std::uint64_t GridRenderer::draw_bricks(const FrameParts& frame, const TilePlace& place,
                                        std::span<const BinnedBrick> bricks, Workspace& workspace) const {
  std::uint64_t segments = 0;
  for (std::size_t i = 0; i < bricks.size(); ++i) {
    if (i + 1 < bricks.size()) BrickLattice::prefetch(frame.grid.field, drawn(), bricks[i + 1].brick);
    segments += draw_brick(frame, place, bricks[i], workspace);
  }
  return segments;
}

/// One interval of all rays after the other.
std::uint64_t GridRenderer::draw_packets(const FrameParts& frame, const TilePlace& place, Workspace& workspace) const {
  std::uint64_t segments = 0;
  do segments += frame.packets->draw(*workspace.rays, place.column, place.row);
  while (workspace.rays->has_intervals && workspace.intervals.advance_all(*workspace.rays));
  return segments;
}

TileCounts GridRenderer::draw_tile(const FrameParts& frame, std::size_t tile, Workspace& workspace,
                                   Image& image) const {
  const std::span<const BinnedBrick> bricks = frame.bins.bricks_of(tile);
  TileCounts counts;
  if (bricks.empty()) return counts;
  const int column = static_cast<int>(tile % frame.bins.columns) * kTileSize;
  const int row = static_cast<int>(tile / frame.bins.columns) * kTileSize;
  MarchStart start{&frame.rays.grid, column, row, {}, {}, workspace.rays.get()};
  std::copy(frame.view.grid_from_camera.begin(), frame.view.grid_from_camera.end(), start.grid_from_camera);
  for (int axis = 0; axis < 3; ++axis) start.upper[axis] = frame_.plane(axis, drawn().data.shape.dimensions[axis] - 1);
  frame.kernels->start_march(start);
  if (frame.has_clipping) workspace.intervals.find(frame.clip, frame.rays.grid, column, row, *workspace.rays);
  counts.segments = frame.packets ? draw_packets(frame, {column, row}, workspace)
                                  : draw_bricks(frame, {column, row}, bricks, workspace);
  const MarchRays& rays = *workspace.rays;
  for (int y = 0; y < std::min(kTileSize, image.height - row); ++y)
    for (int x = 0; x < std::min(kTileSize, image.width - column); ++x) {
      const float* sum = rays.sums[y * kTileSize + x];
      float* pixel = image.pixel(column + x, row + y);
      std::copy_n(sum, 3, pixel);
      pixel[3] = 1.0f - sum[3];
      if (!image.depth.empty())
        image.depth[static_cast<std::size_t>(row + y) * image.width + column + x] = rays.depth[y * kTileSize + x];
    }
  counts.rays = static_cast<std::uint64_t>(std::count(rays.has_met, rays.has_met + MarchRays::kCount, 1));
  return counts;
}

/// A picture, or the depths that a light sees.
struct GridRenderer::Pass {
  const Camera& camera;
  const RenderSettings& settings;
  bool has_effects = false;
  const DepthRecord* record = nullptr;
};

void GridRenderer::render(const Camera& camera, const RenderSettings& settings, const scene::FrameContext& context,
                          Image& image, RenderStatistics& statistics) {
  // The spline would have to pass through the densities of each function: no table of the values does that.
  if (settings.integrator == Integrator::kPre && settings.filter.kind == FilterKind::kInterpolatingBspline)
    throw Error(
        ErrorCode::kInvalidArgument,
        "pre-classification does not go with the filter 'bspline-interpolating': choose 'bspline' or 'catmull-rom'");
  const bool has_effects = wants_effects(settings) || domain_.is_set();
  if (domain_.is_set()) require_domain_settings(domain_.domain(), settings);
  if (has_effects) require_effects(settings, is_constant(settings));
  if (has_effects) require_rate_effects(grid_, settings);
  const support::Timer timer;
  prepare_filter(settings);
  prepare_preintegration(settings, context.progress);
  const double table_seconds = timer.seconds();
  if (has_effects) prepare_shadows(camera, settings, context);
  const double shadow_seconds = timer.seconds() - table_seconds;
  plan(settings);
  statistics.plan_seconds = timer.seconds() - shadow_seconds;
  draw({camera, settings, has_effects}, context, image, statistics);
  note_backend(settings, statistics);
}

void GridRenderer::prepare_shadows(const Camera& camera, const RenderSettings& settings,
                                   const scene::FrameContext& context) {
  const auto draw_depths = [&](const LightPass& pass, Image& image) {
    RenderStatistics uncounted;
    plan(pass.settings);
    draw({pass.camera, pass.settings, true, &pass.record}, context, image, uncounted);
  };
  shadows_.prepare(settings, {shadowed_body(), camera, function_number_, context.clip_number}, draw_depths,
                   context.progress);
}

Marches GridRenderer::choose_kernels(const Kernels& kernels, const RenderSettings& settings, bool has_effects) const {
  if (domain_.is_set()) return choose_domain_marches(kernels, is_constant(settings), domain_.domain());
  return has_effects ? choose_illustrated_marches(kernels, is_constant(settings), settings.integrator)
                     : choose_marches(kernels, is_constant(settings), settings);
}

/// Draws with the plans at hand.
void GridRenderer::draw(const Pass& pass, const scene::FrameContext& context, Image& image,
                        RenderStatistics& statistics) {
  const RenderSettings& settings = pass.settings;
  const Kernels& kernels = kernels_for(settings.instruction_set);
  const Progress& progress = context.progress;
  const bool has_effects = pass.has_effects;
  IntegratorTables tables{&antiderivative_,
                          &control_points_,
                          settings.integrator == Integrator::kPartial ? &optics::transparency_table() : nullptr,
                          scene::segment_tolerance(settings),
                          settings.samples,
                          field_.kernel != nullptr};
  FrameParts frame;
  tables.effects = &frame.illustration.effects;
  const DomainFunction domain = domain_.make_function(settings.tolerance, diagonal());
  tables.domain = &domain;
  frame.view = scene::make_grid_view(drawn(), frame_, pass.camera, settings.width, settings.height);
  frame.rays = scene::make_rays(frame.view.camera, frame.view.world_per_local);
  attach_preintegration(preintegration_, tables);
  frame.grid = {&frame_, lattice_field(settings, kernels), plan_sources(settings), plans_};
  frame.others = domain_.make_fields(frame.grid.field);
  frame.marches = choose_kernels(kernels, settings, has_effects);
  frame.kernels = &kernels;
  frame.job = make_job(settings, tables);
  frame.job.grid = &frame.rays.grid;
  if (has_effects) describe(settings, context, frame);
  frame.packets = make_packets(settings, kernels, frame.job);
  frame.bins = bin_bricks(drawn(), frame_, frame.packets ? seen_groups_ : visible_, frame.view);
  if (has_effects) trace(settings, context, frame);
  frame.illustration.effects.record = pass.record;
  if (settings.wants_depth) frame.illustration.effects.depth = image.depth.data();
  frame.has_clipping = !settings.clipping.shapes.empty();
  if (frame.has_clipping)
    frame.clip =
        make_clip_scene(settings.clipping, context.clip_volumes,
                        scene::world_from_camera(frame.view.camera, frame.view.origin, frame.view.world_per_local));
  frame_bytes_ = frame.bins.bricks.size() * sizeof(BinnedBrick);

  std::atomic<std::uint64_t> segments{0}, met_rays{0};
  tbb::enumerable_thread_specific<Workspace> workspaces;
  scene::TileProgress tile_progress(progress, frame.bins.tile_count());
  support::parallel_chunks(frame.bins.tile_count(), 1, [&](std::size_t begin, std::size_t end) {
    Workspace& workspace = workspaces.local();
    for (std::size_t tile = begin; tile < end; ++tile) {
      support::throw_if_cancelled(progress);
      const TileCounts counts = draw_tile(frame, tile, workspace, image);
      segments += counts.segments;
      met_rays += counts.rays;
      tile_progress.tile_done();
    }
  });
  support::throw_if_cancelled(progress);  // the last tile may have been given up
  if (frame.illustration.rays) frame.illustration.rays->rethrow_failure();
  if (settings.wants_depth) scene::measure_depth(frame.view.camera, frame.view.world_per_local, image);
  statistics.segments = segments;
  statistics.rays = met_rays;
}

}  // namespace

std::unique_ptr<scene::FrameRenderer> make_grid_renderer(const PreparedGrid& grid) {
  if (grid.bricks.count() == 0) throw Error(ErrorCode::kNothingToDraw, "the grid has no cells to draw");
  return std::make_unique<GridRenderer>(grid);
}

}  // namespace tetravox::cpu

namespace tetravox {

std::uint64_t estimate_render_memory(const GridData& grid, const RenderSettings& settings) {
  const std::uint64_t pixels = static_cast<std::uint64_t>(settings.width) * static_cast<std::uint64_t>(settings.height);
  std::uint64_t bricks = 1;
  for (const std::uint32_t points : grid.shape.dimensions) bricks *= (points + kBrickCells) / kBrickCells;
  constexpr std::uint64_t kTables = 4u << 20;
  // Plan, order and pixels of each brick, and the tiles that it is seen in.
  const std::uint64_t of_brick = 32 + 3 * sizeof(cpu::BinnedBrick);
  const auto values = grid.value_dimensions();
  const std::uint64_t coefficients = settings.filter.kind == FilterKind::kInterpolatingBspline
                                         ? 2 * (values[0] + 4) * (values[1] + 4) * (values[2] + 4) * sizeof(float)
                                         : 0;
  std::uint64_t shadows = 0;
  if (settings.lighting.shadows == ShadowKind::kExact && settings.lighting.is_lit()) {
    const auto threads =
        static_cast<std::uint64_t>(settings.threads > 0 ? settings.threads : support::hardware_threads());
    shadows = threads * std::min<std::uint64_t>(bricks * cpu::BrickStore::kBytesOfBrick, cpu::BrickStore::kMostBytes);
  }
  const std::uint64_t slabs = settings.samples_per_voxel > 0.0 ? cpu::SlabCache::kBytes + bricks : 0;
  return pixels * 4 * sizeof(float) + bricks * of_brick + coefficients + shadows + slabs + kTables +
         scene::preintegration_bytes(settings);
}

}  // namespace tetravox
