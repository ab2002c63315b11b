#include "src/cpu/brick_lattice.h"
#include "src/cpu/frame_renderer.h"
#include "src/cpu/grid_frame.h"
#include "src/grid/summaries.h"
#include "src/optics/antiderivative_table.h"
#include "src/optics/steepness_table.h"
#include "src/optics/transparency_table.h"
#include "src/support/threads.h"
#include "tetravox/error.h"

#include <tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <atomic>
#include <limits>
#include <memory>
#include <vector>

namespace tetravox::cpu {
namespace {

/// A segment's colours may err by this part of the picture's tolerance.
constexpr float kSegmentsOfTolerance = 40.0f;

/// Errors of scalars that lie within their bounds hardly ever add up along a whole ray: a ray may be that many times
/// worse than asked if they all did.
constexpr float kRatePerTolerance = 6.0f;

/// Linear pieces that a cell is cut into at most. Where a ray only touches the height at which the function has a
/// narrow peak, a cubic needs many: twelve leave up to 2e-2 in single pixels of a function of nothing but narrow peaks,
/// and 1e-4 elsewhere. Below `kFineTolerance` there are as many as it takes.
constexpr float kMostPieces = 12.0f, kMostFinePieces = 256.0f;
constexpr double kFineTolerance = 1e-4;

using Integrate = std::uint64_t (*)(const MarchJob&, int);

Integrate choose_march(const Kernels& kernels, bool is_constant, Integrator integrator, bool is_gentle) {
  if (is_constant) return kernels.march_cells;
  switch (integrator) {
    case Integrator::kPartial:
      return kernels.march_partial;
    case Integrator::kPost:
      return kernels.march_post;
    case Integrator::kAntiderivative:
    case Integrator::kPre:
      break;
  }
  return is_gentle ? kernels.march_gentle_antiderivative : kernels.march_antiderivative;
}

/// How a brick is drawn.
struct BrickPlan {
  static constexpr std::uint8_t kTransparent = 0xFF;
  std::uint8_t level = kTransparent;  ///< lattice cells of 2^level cells a side
  bool is_curved = false;             ///< whether rays in its cells may be bent too much to be chords
};

/// What one thread works with.
struct Workspace {
  std::unique_ptr<MarchRays> rays = std::make_unique<MarchRays>();
  BrickLattice lattice;
};

class GridRenderer final : public FrameRenderer {
 public:
  explicit GridRenderer(const PreparedGrid& grid)
      : grid_(grid), reader_(grid.data, {grid.scalar_offset, grid.scalar_scale}) {}

  void set_transfer_function(const OpticalFunction& function) override {
    const optics::ScalarMap map{grid_.scalar_offset, grid_.scalar_scale};
    control_points_ = optics::build_control_point_table(function, map);
    optics::build_antiderivative_table(function, map, grid_.scalar_range, diagonal(), antiderivative_);
    optics::build_steepness_table(control_points_, map.stored_from_value(grid_.scalar_range.min),
                                  map.stored_from_value(grid_.scalar_range.max), steepness_);
    planned_for_ = {};
  }

  void render(const Camera& camera, const RenderSettings& settings, const Kernels& kernels, const Progress& progress,
              Image& image, RenderStatistics& statistics) override;

  std::uint64_t missing_bytes(const RenderSettings& settings) const override {
    return estimate_render_memory(grid_.data, settings);
  }

  std::uint64_t bytes() const override {
    return antiderivative_.bytes() + control_points_.bytes() + plans_.size() * sizeof(BrickPlan) +
           visible_.size() * sizeof(std::uint32_t) + frame_bytes_;
  }

  Source source() const override { return Source::kMarch; }
  double diagonal() const override { return diagonal_of(grid_.bounds); }

 private:
  /// What the plans depend on beside the function.
  struct PlanKey {
    float allowed_rate = -1.0f;
    bool operator==(const PlanKey&) const = default;
  };

  bool is_constant(const RenderSettings& settings) const {
    return settings.filter.kind == FilterKind::kNearest || grid_.data.association == Association::kCell;
  }
  void plan_bricks(float allowed_rate, bool is_constant);
  BrickPlan plan_brick(std::size_t brick, float allowed_rate, bool is_constant) const;
  void draw_tile(std::size_t tile, const GridView& view, const RayGrid& rays, const BrickBins& bins, MarchJob job,
                 const Kernels& kernels, Integrate march, Workspace& workspace, Image& image,
                 std::uint64_t& segments) const;

  const PreparedGrid& grid_;
  grid::BlockReader reader_;
  optics::AntiderivativeTable antiderivative_;
  optics::ControlPointTable control_points_;
  optics::SteepnessTable steepness_;
  PlanKey planned_for_;
  std::vector<BrickPlan> plans_;
  std::vector<std::uint32_t> visible_;
  std::uint64_t frame_bytes_ = 0;
};

BrickPlan GridRenderer::plan_brick(std::size_t brick, float allowed_rate, bool is_constant) const {
  const BrickSummaries& bricks = grid_.bricks;
  const float min = bricks.min[brick], max = bricks.max[brick];
  BrickPlan plan;
  if (!(min <= max) || !(steepness_.largest_extinction(min, max) > 0.0f)) return plan;
  const float steepness = steepness_.largest_steepness(min, max);
  const auto is_good = [&](float deviation) { return steepness == 0.0f || deviation * steepness <= allowed_rate; };
  plan.level = 0;
  if (is_constant) return plan;
  for (int level = 3; level > 0 && plan.level == 0; --level)
    if (is_good(bricks.deviation[level][brick])) plan.level = static_cast<std::uint8_t>(level);
  plan.is_curved = plan.level == 0 && !is_good(bricks.deviation[0][brick]);
  return plan;
}

void GridRenderer::plan_bricks(float allowed_rate, bool is_constant) {
  const PlanKey key{allowed_rate};
  if (key == planned_for_) return;
  plans_.resize(grid_.bricks.count());
  support::parallel_chunks(plans_.size(), 1 << 12, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) plans_[i] = plan_brick(i, allowed_rate, is_constant);
  });
  visible_.clear();
  for (std::size_t i = 0; i < plans_.size(); ++i)
    if (plans_[i].level != BrickPlan::kTransparent) visible_.push_back(static_cast<std::uint32_t>(i));
  planned_for_ = key;
}

void GridRenderer::draw_tile(std::size_t tile, const GridView& view, const RayGrid& rays, const BrickBins& bins,
                             MarchJob job, const Kernels& kernels, Integrate march, Workspace& workspace, Image& image,
                             std::uint64_t& segments) const {
  const int column = static_cast<int>(tile % bins.columns) * kTileSize;
  const int row = static_cast<int>(tile / bins.columns) * kTileSize;
  MarchStart start{&rays, column, row, {}, workspace.rays.get()};
  std::copy(view.grid_from_camera.begin(), view.grid_from_camera.end(), start.grid_from_camera);
  kernels.start_march(start);
  job.rays = workspace.rays.get();
  for (const BinnedBrick& binned : bins.bricks_of(tile)) {
    const BrickPlan& plan = plans_[binned.brick];
    MarchBrick brick = workspace.lattice.describe(grid_, binned.brick, plan.level);
    brick.bounds = binned.bounds;
    job.brick = &brick;
    const int count = kernels.clip_brick(job);
    if (count == 0) continue;
    workspace.lattice.fill(reader_, grid_, job.is_constant, brick);
    if (plan.is_curved)
      brick.steepness = steepness_.largest_steepness(grid_.bricks.min[binned.brick], grid_.bricks.max[binned.brick]);
    segments += march(job, count);
  }
  for (int y = 0; y < std::min(kTileSize, image.height - row); ++y)
    for (int x = 0; x < std::min(kTileSize, image.width - column); ++x) {
      const int i = y * kTileSize + x;
      float* pixel = image.pixel(column + x, row + y);
      pixel[0] = workspace.rays->red[i];
      pixel[1] = workspace.rays->green[i];
      pixel[2] = workspace.rays->blue[i];
      pixel[3] = 1.0f - workspace.rays->transmittance[i];
    }
}

void GridRenderer::render(const Camera& camera, const RenderSettings& settings, const Kernels& kernels,
                          const Progress& progress, Image& image, RenderStatistics& statistics) {
  const bool constant = is_constant(settings);
  const auto allowed_rate = static_cast<float>(kRatePerTolerance * settings.tolerance / diagonal());
  plan_bricks(allowed_rate, constant);
  const GridView view = make_grid_view(grid_, camera, settings.width, settings.height);
  const Rays rays = make_rays(view.camera, view.world_per_local);
  const BrickBins bins = bin_bricks(grid_, visible_, view);
  frame_bytes_ = bins.bricks.size() * sizeof(BinnedBrick);

  const IntegratorTables tables{&antiderivative_, &control_points_,
                                settings.integrator == Integrator::kPartial ? &optics::transparency_table() : nullptr,
                                static_cast<float>(settings.tolerance) / kSegmentsOfTolerance, settings.samples};
  const Integrate march = choose_march(kernels, constant, settings.integrator, antiderivative_.is_gentle);
  MarchJob job;
  job.tables = &tables;
  job.steepness = &steepness_;
  job.allowed_rate = allowed_rate;
  job.most_pieces = settings.tolerance < kFineTolerance ? kMostFinePieces : kMostPieces;
  job.z_near = rays.grid.z_near;
  job.is_constant = constant;
  job.use_early_ray_termination = settings.use_early_ray_termination;
  std::atomic<std::uint64_t> segments{0};
  tbb::enumerable_thread_specific<Workspace> workspaces;
  TileProgress tile_progress(progress, bins.tile_count());
  support::parallel_chunks(bins.tile_count(), 1, [&](std::size_t begin, std::size_t end) {
    Workspace& workspace = workspaces.local();
    for (std::size_t tile = begin; tile < end; ++tile) {
      support::throw_if_cancelled(progress);
      std::uint64_t drawn = 0;
      if (!bins.bricks_of(tile).empty())
        draw_tile(tile, view, rays.grid, bins, job, kernels, march, workspace, image, drawn);
      segments += drawn;
      tile_progress.tile_done();
    }
  });
  statistics.segments = segments;
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
  return pixels * 4 * sizeof(float) + bricks * of_brick + kTables;
}

}  // namespace tetravox
