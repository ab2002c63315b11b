#include "src/cpu/brick_lattice.h"
#include "src/cpu/brick_plan.h"
#include "src/cpu/filtered_field.h"
#include "src/cpu/frame_renderer.h"
#include "src/cpu/grid_frame.h"
#include "src/grid/summaries.h"
#include "src/optics/antiderivative_table.h"
#include "src/optics/steepness_table.h"
#include "src/optics/transparency_table.h"
#include "src/support/threads.h"
#include "src/support/timer.h"
#include "tetravox/error.h"

#include <tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <memory>
#include <span>
#include <utility>
#include <vector>

namespace tetravox::cpu {
namespace {

/// A segment's colours may err by this part of the picture's tolerance.
constexpr float kSegmentsOfTolerance = 40.0f;

/// Linear pieces that a cell is cut into at most. Where a ray only touches the height at which the function has a
/// narrow peak, a cubic needs many: twelve leave up to 2e-2 in single pixels of a function of nothing but narrow peaks,
/// and 1e-4 elsewhere. Below `kFineTolerance` there are as many as it takes.
constexpr float kMostPieces = 12.0f, kMostFinePieces = 256.0f;
constexpr double kFineTolerance = 1e-4;

/// Where errors of more than one 8-bit step are allowed, what comes through less than this part of the tolerance is
/// left out.
constexpr double kOneStep = 1.0 / 255.0;
constexpr float kNegligibleOfTolerance = 0.1f;

using Integrate = std::uint64_t (*)(const MarchJob&, int);

/// From cell to cell, and in equal steps; both also for bricks in which scalars may be rounded to nodes of the table.
struct Marches {
  Integrate cells = nullptr, strides = nullptr;
  Integrate gentle_cells = nullptr, gentle_strides = nullptr;
};

Marches choose_marches(const Kernels& kernels, bool is_constant, const RenderSettings& settings) {
  const bool has_rate = settings.samples_per_voxel > 0.0;
  const auto both = [](Integrate cells, Integrate strides) { return Marches{cells, strides, cells, strides}; };
  if (is_constant) return both(kernels.march_cells, nullptr);
  switch (settings.integrator) {
    case Integrator::kPartial:
      return both(has_rate ? kernels.sample_partial : kernels.march_partial, kernels.stride_partial);
    case Integrator::kPost:
      return both(has_rate ? kernels.sample_post : kernels.march_post, nullptr);
    case Integrator::kPre:
      return both(has_rate ? kernels.sample_densities : kernels.march_densities, nullptr);
    case Integrator::kAntiderivative:
      break;
  }
  return {has_rate ? kernels.sample_antiderivative : kernels.march_antiderivative, kernels.stride_antiderivative,
          has_rate ? kernels.sample_antiderivative : kernels.march_gentle_antiderivative,
          kernels.stride_gentle_antiderivative};
}

/// What one thread works with.
struct Workspace {
  std::unique_ptr<MarchRays> rays = std::make_unique<MarchRays>();
  BrickLattice lattice;
};

/// One frame: what all its tiles share.
struct FrameParts {
  GridView view;
  Rays rays;
  BrickBins bins;
  LatticeField field;
  PlanSources sources;
  Marches marches;
  const Kernels* kernels = nullptr;
  MarchJob job;
};

struct TileCounts {
  std::uint64_t segments = 0, rays = 0;
};

/// World length of a voxel: of the cube with its volume.
double mean_spacing(const grid::GridFrame& frame) {
  const auto& m = frame.world_from_grid;
  return std::cbrt(std::abs(m[0] * (m[4] * m[8] - m[5] * m[7]) - m[1] * (m[3] * m[8] - m[5] * m[6]) +
                            m[2] * (m[3] * m[7] - m[4] * m[6])));
}

class GridRenderer final : public FrameRenderer {
 public:
  explicit GridRenderer(const PreparedGrid& grid)
      : grid_(grid),
        frame_(grid::make_grid_frame(grid.data.shape)),
        reader_(grid.data, {grid.scalar_offset, grid.scalar_scale}) {}

  void set_transfer_function(const OpticalFunction& function) override {
    const ValueRange& range = grid_.scalar_range;
    control_points_ = optics::build_control_point_table(function, scalar_map());
    optics::build_antiderivative_table(function, scalar_map(), range, diagonal(), antiderivative_);
    optics::build_steepness_table(control_points_, scalar_map().stored_from_value(range.min),
                                  scalar_map().stored_from_value(range.max), steepness_);
    is_planned_ = false;
  }

  void render(const Camera& camera, const RenderSettings& settings, const Kernels& kernels, const Progress& progress,
              Image& image, RenderStatistics& statistics) override;

  std::uint64_t missing_bytes(const RenderSettings& settings) const override {
    return estimate_render_memory(grid_.data, settings);
  }

  std::uint64_t bytes() const override {
    return antiderivative_.bytes() + control_points_.bytes() + plans_.size() * sizeof(BrickPlan) +
           (visible_.size() + field_.coefficients.size()) * sizeof(float) + frame_bytes_;
  }

  Source source() const override { return Source::kMarch; }
  double diagonal() const override { return diagonal_of(grid_.bounds); }

 private:
  optics::ScalarMap scalar_map() const { return {grid_.scalar_offset, grid_.scalar_scale}; }
  bool is_constant(const RenderSettings& settings) const {
    const bool is_cell = grid_.data.association == Association::kCell;
    return settings.filter.kind == FilterKind::kNearest || (is_cell && !wants_kernel(settings.filter));
  }
  const PreparedGrid& drawn() const { return field_.middles ? *field_.middles : grid_; }
  void prepare_filter(const RenderSettings& settings);
  LatticeField lattice_field(const RenderSettings& settings, const Kernels& kernels) const;
  PlanSources plan_sources(const RenderSettings& settings) const;
  void plan(const RenderSettings& settings);
  MarchJob make_job(const RenderSettings& settings, const IntegratorTables& tables) const;
  std::uint64_t draw_brick(const FrameParts& frame, const BinnedBrick& binned, Workspace& workspace) const;
  TileCounts draw_tile(const FrameParts& frame, std::size_t tile, Workspace& workspace, Image& image) const;

  const PreparedGrid& grid_;
  grid::GridFrame frame_;
  grid::BlockReader reader_;
  FilteredField field_;
  optics::AntiderivativeTable antiderivative_;
  optics::ControlPointTable control_points_;
  optics::SteepnessTable steepness_;
  bool is_planned_ = false;
  PlanSettings planned_for_;
  std::vector<BrickPlan> plans_;
  std::vector<std::uint32_t> visible_;
  std::uint64_t frame_bytes_ = 0;
};

LatticeField GridRenderer::lattice_field(const RenderSettings& settings, const Kernels& kernels) const {
  LatticeField field;
  field.kernels = &kernels;
  field.reader = field_.reader ? field_.reader.get() : &reader_;
  field.padding = field_.coefficients.empty() ? 0 : FilteredField::kMargin;
  field.kernel = field_.kernel.get();
  field.points = settings.integrator == Integrator::kPre && !is_constant(settings) ? &control_points_ : nullptr;
  field.is_constant = is_constant(settings);
  field.is_nearest = field.is_constant && grid_.data.association == Association::kPoint;
  field.allowed_rate = allowed_rate_of(settings.tolerance, diagonal());
  return field;
}

void GridRenderer::prepare_filter(const RenderSettings& settings) {
  if (field_.kernel ? field_.filter == settings.filter : !wants_kernel(settings.filter)) return;
  is_planned_ = false;
  FilteredField field = make_filtered_field(grid_, settings.filter);
  field_ = std::move(field);
  frame_ = grid::make_grid_frame(drawn().data.shape);
}

PlanSources GridRenderer::plan_sources(const RenderSettings& settings) const {
  return {&drawn(), &field_, &steepness_, 1.0f / antiderivative_.nodes_per_scalar, diagonal(), is_constant(settings)};
}

void GridRenderer::plan(const RenderSettings& settings) {
  const PlanSettings wanted{settings.filter, settings.integrator, settings.tolerance, settings.samples_per_voxel};
  if (is_planned_ && wanted == planned_for_) return;
  plans_ = plan_bricks(plan_sources(settings), wanted);
  visible_.clear();
  for (std::size_t i = 0; i < plans_.size(); ++i)
    if (plans_[i].level != BrickPlan::kTransparent) visible_.push_back(static_cast<std::uint32_t>(i));
  planned_for_ = wanted;
  is_planned_ = true;
}

MarchJob GridRenderer::make_job(const RenderSettings& settings, const IntegratorTables& tables) const {
  MarchJob job;
  job.tables = &tables;
  job.steepness = &steepness_;
  job.allowed_rate = allowed_rate_of(settings.tolerance, diagonal());
  job.most_pieces = settings.tolerance < kFineTolerance ? kMostFinePieces : kMostPieces;
  job.use_early_ray_termination = settings.use_early_ray_termination;
  if (settings.tolerance > kOneStep) job.negligible = kNegligibleOfTolerance * static_cast<float>(settings.tolerance);
  if (settings.samples_per_voxel > 0.0)
    job.sample_distance = static_cast<float>(mean_spacing(frame_) / settings.samples_per_voxel);
  return job;
}

/// Takes the rays of the workspace through a brick; returns how many segments they had.
std::uint64_t GridRenderer::draw_brick(const FrameParts& frame, const BinnedBrick& binned, Workspace& workspace) const {
  const BrickPlan& plan = plans_[binned.brick];
  MarchBrick brick = workspace.lattice.describe(drawn(), frame_, binned.brick, plan.level);
  brick.bounds = binned.bounds;
  MarchJob job = frame.job;
  job.rays = workspace.rays.get();
  job.brick = &brick;
  job.stride = plan.stride;
  const int count = frame.kernels->clip_brick(job);
  if (count == 0) return 0;
  const ValueRange range = range_of(frame.sources, binned.brick);
  brick.steepness = steepness_.largest_steepness(static_cast<float>(range.min), static_cast<float>(range.max));
  brick.has_missing |= field_.kernel && drawn().missing_values > 0;  // a kernel reaches into other bricks
  workspace.lattice.fill(frame.field, brick);
  if (!plan.is_curved) brick.steepness = 0.0f;
  const Marches& marches = frame.marches;
  if (plan.stride > 0) return (plan.is_gentle ? marches.gentle_strides : marches.strides)(job, count);
  return (plan.is_gentle ? marches.gentle_cells : marches.cells)(job, count);
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
  for (std::size_t i = 0; i < bricks.size(); ++i) {
    if (i + 1 < bricks.size()) BrickLattice::prefetch(frame.field, drawn(), bricks[i + 1].brick);
    counts.segments += draw_brick(frame, bricks[i], workspace);
  }
  const MarchRays& rays = *workspace.rays;
  for (int y = 0; y < std::min(kTileSize, image.height - row); ++y)
    for (int x = 0; x < std::min(kTileSize, image.width - column); ++x) {
      const float* sum = rays.sums[y * kTileSize + x];
      float* pixel = image.pixel(column + x, row + y);
      std::copy_n(sum, 3, pixel);
      pixel[3] = 1.0f - sum[3];
    }
  counts.rays = static_cast<std::uint64_t>(std::count(rays.has_met, rays.has_met + MarchRays::kCount, 1));
  return counts;
}

void GridRenderer::render(const Camera& camera, const RenderSettings& settings, const Kernels& kernels,
                          const Progress& progress, Image& image, RenderStatistics& statistics) {
  // The spline would have to pass through the densities of each function: no table of the values does that.
  if (settings.integrator == Integrator::kPre && settings.filter.kind == FilterKind::kInterpolatingBspline)
    throw Error(
        ErrorCode::kInvalidArgument,
        "pre-classification does not go with the filter 'bspline-interpolating': choose 'bspline' or 'catmull-rom'");
  const support::Timer timer;
  prepare_filter(settings);
  plan(settings);
  statistics.plan_seconds = timer.seconds();

  const IntegratorTables tables{&antiderivative_,
                                &control_points_,
                                settings.integrator == Integrator::kPartial ? &optics::transparency_table() : nullptr,
                                static_cast<float>(settings.tolerance) / kSegmentsOfTolerance,
                                settings.samples,
                                field_.kernel != nullptr};
  FrameParts frame;
  frame.view = make_grid_view(drawn(), frame_, camera, settings.width, settings.height);
  frame.rays = make_rays(frame.view.camera, frame.view.world_per_local);
  frame.bins = bin_bricks(drawn(), frame_, visible_, frame.view);
  frame.field = lattice_field(settings, kernels);
  frame.sources = plan_sources(settings);
  frame.marches = choose_marches(kernels, is_constant(settings), settings);
  frame.kernels = &kernels;
  frame.job = make_job(settings, tables);
  frame.job.z_near = frame.rays.grid.z_near;
  frame_bytes_ = frame.bins.bricks.size() * sizeof(BinnedBrick);

  std::atomic<std::uint64_t> segments{0}, met_rays{0};
  tbb::enumerable_thread_specific<Workspace> workspaces;
  TileProgress tile_progress(progress, frame.bins.tile_count());
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
  statistics.segments = segments;
  statistics.rays = met_rays;
}

}  // namespace

std::unique_ptr<FrameRenderer> make_grid_renderer(const PreparedGrid& grid) {
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
  return pixels * 4 * sizeof(float) + bricks * of_brick + coefficients + kTables;
}

}  // namespace tetravox
