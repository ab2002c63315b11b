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
#include <cmath>
#include <cstdlib>
#include <limits>
#include <memory>
#include <span>
#include <utility>
#include <vector>

namespace tetravox::cpu {
namespace {

/// A segment's colours may err by this part of the picture's tolerance.
constexpr float kSegmentsOfTolerance = 40.0f;

/// Errors of scalars that lie within their bounds hardly ever add up along a whole ray: a ray may be that many times
/// worse than asked if they all did.
constexpr float kRatePerTolerance = 5.0f;

/// Linear pieces that a cell is cut into at most. Where a ray only touches the height at which the function has a
/// narrow peak, a cubic needs many: twelve leave up to 2e-2 in single pixels of a function of nothing but narrow peaks,
/// and 1e-4 elsewhere. Below `kFineTolerance` there are as many as it takes.
constexpr float kMostPieces = 12.0f, kMostFinePieces = 256.0f;
constexpr double kFineTolerance = 1e-4;

using Integrate = std::uint64_t (*)(const MarchJob&, int);

Integrate choose_march(const Kernels& kernels, bool is_constant, const RenderSettings& settings, bool is_gentle) {
  const bool has_rate = settings.samples_per_voxel > 0.0;
  if (is_constant) return kernels.march_cells;
  switch (settings.integrator) {
    case Integrator::kPartial:
      return has_rate ? kernels.sample_partial : kernels.march_partial;
    case Integrator::kPost:
      return has_rate ? kernels.sample_post : kernels.march_post;
    case Integrator::kPre:
      return has_rate ? kernels.sample_densities : kernels.march_densities;
    case Integrator::kAntiderivative:
      break;
  }
  if (has_rate) return kernels.sample_antiderivative;
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

/// What a filter other than linear and nearest needs beside the values.
struct FilteredField {
  Filter filter;
  std::unique_ptr<grid::SeparableKernel> kernel;
  std::shared_ptr<const PreparedGrid> middles;  ///< cell data: the values as points at the middles of their cells
  std::vector<float> coefficients;              ///< with a margin of `kMargin` places; empty: the values serve
  std::unique_ptr<grid::BlockReader> reader;
  std::vector<float> min, max;  ///< of the filtered field in each brick
  static constexpr std::int64_t kMargin = 2;
};

/// World length of a voxel: of the cube with its volume.
double mean_spacing(const grid::GridFrame& frame) {
  const auto& m = frame.world_from_grid;
  return std::cbrt(std::abs(m[0] * (m[4] * m[8] - m[5] * m[7]) - m[1] * (m[3] * m[8] - m[5] * m[6]) +
                            m[2] * (m[3] * m[7] - m[4] * m[6])));
}

bool wants_kernel(const Filter& filter) {
  return filter.kind != FilterKind::kLinear && filter.kind != FilterKind::kNearest;
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
  /// What the plans depend on beside the function.
  struct PlanKey {
    Filter filter;
    Integrator integrator = Integrator::kAntiderivative;
    double tolerance = 0.0;
    bool has_rate = false;
    bool operator==(const PlanKey&) const = default;
  };

  optics::ScalarMap scalar_map() const { return {grid_.scalar_offset, grid_.scalar_scale}; }
  bool is_constant(const RenderSettings& settings) const {
    const bool is_cell = grid_.data.association == Association::kCell;
    return settings.filter.kind == FilterKind::kNearest || (is_cell && !wants_kernel(settings.filter));
  }
  const PreparedGrid& drawn() const { return field_.middles ? *field_.middles : grid_; }
  void prepare_filter(const RenderSettings& settings);
  void bound_filtered_field();
  LatticeField lattice_field(const RenderSettings& settings, float allowed_rate) const;
  void plan_bricks(const RenderSettings& settings, float allowed_rate);
  BrickPlan plan_brick(std::size_t brick, const RenderSettings& settings, float allowed_rate) const;
  ValueRange range_of(std::size_t brick) const;
  void draw_tile(std::size_t tile, const GridView& view, const RayGrid& rays, const BrickBins& bins,
                 const LatticeField& field, MarchJob job, const Kernels& kernels, Integrate march, Workspace& workspace,
                 Image& image, std::uint64_t& segments) const;

  const PreparedGrid& grid_;
  grid::GridFrame frame_;
  grid::BlockReader reader_;
  FilteredField field_;
  optics::AntiderivativeTable antiderivative_;
  optics::ControlPointTable control_points_;
  optics::SteepnessTable steepness_;
  bool is_planned_ = false;
  PlanKey planned_for_;
  std::vector<BrickPlan> plans_;
  std::vector<std::uint32_t> visible_;
  std::uint64_t frame_bytes_ = 0;
};

/// The values of cell data as points at the middles of the cells.
GridData points_at_middles(const GridData& cells) {
  GridData points = cells;
  points.association = Association::kPoint;
  for (int axis = 0; axis < 3; ++axis) {
    --points.shape.dimensions[axis];
    const std::vector<double>& from = cells.shape.coordinates[axis];
    std::vector<double>& to = points.shape.coordinates[axis];
    to.clear();
    for (std::size_t i = 0; i + 1 < from.size(); ++i) to.push_back(0.5 * from[i] + 0.5 * from[i + 1]);
    if (!from.empty()) continue;
    for (int row = 0; row < 3; ++row)
      points.shape.origin[row] += 0.5 * cells.shape.spacing[axis] * cells.shape.direction[3 * row + axis];
  }
  return points;
}

/// Values with a margin of mirrored places, as coefficients of the spline through them.
std::vector<float> make_coefficients(const PreparedGrid& grid, const grid::BlockReader& reader) {
  const auto dimensions = grid.data.value_dimensions();
  grid::Block whole;
  for (int axis = 0; axis < 3; ++axis) whole.count[axis] = static_cast<std::int64_t>(dimensions[axis]);
  std::vector<float> inside(static_cast<std::size_t>(whole.size()));
  reader.read(whole, inside.data());
  grid::prefilter_bspline(dimensions, inside);
  constexpr std::int64_t kMargin = FilteredField::kMargin;
  const auto mirrored = [&](std::int64_t i, int axis) {
    const std::int64_t last = whole.count[axis] - 1;
    i = std::abs(i - kMargin);
    return std::clamp(i > last ? 2 * last - i : i, std::int64_t{0}, last);
  };
  std::vector<float> coefficients;
  coefficients.reserve(static_cast<std::size_t>((whole.count[0] + 2 * kMargin) * (whole.count[1] + 2 * kMargin) *
                                                (whole.count[2] + 2 * kMargin)));
  for (std::int64_t k = 0; k < whole.count[2] + 2 * kMargin; ++k)
    for (std::int64_t j = 0; j < whole.count[1] + 2 * kMargin; ++j)
      for (std::int64_t i = 0; i < whole.count[0] + 2 * kMargin; ++i)
        coefficients.push_back(inside[static_cast<std::size_t>(
            (mirrored(k, 2) * whole.count[1] + mirrored(j, 1)) * whole.count[0] + mirrored(i, 0))]);
  return coefficients;
}

void GridRenderer::prepare_filter(const RenderSettings& settings) {
  if (field_.kernel ? field_.filter == settings.filter : !wants_kernel(settings.filter)) return;
  field_ = {};
  is_planned_ = false;
  if (wants_kernel(settings.filter)) {
    field_.filter = settings.filter;
    if (grid_.data.association == Association::kCell) {
      PreparedGrid middles = prepare_grid(points_at_middles(grid_.data));
      field_.middles = std::make_shared<const PreparedGrid>(std::move(middles));
    }
    std::unique_ptr<grid::SeparableKernel> kernel = grid::make_kernel(settings.filter);
    const grid::ScalarFrame scalars{grid_.scalar_offset, grid_.scalar_scale};
    field_.reader = std::make_unique<grid::BlockReader>(drawn().data, scalars);
    if (kernel->wants_prefilter()) {
      field_.coefficients = make_coefficients(drawn(), *field_.reader);
      GridData padded;
      padded.type = ScalarType::kFloat32;
      for (int axis = 0; axis < 3; ++axis)
        padded.shape.dimensions[axis] =
            drawn().data.shape.dimensions[axis] + static_cast<std::uint32_t>(2 * FilteredField::kMargin);
      padded.values = std::as_bytes(std::span<const float>(field_.coefficients));
      field_.reader = std::make_unique<grid::BlockReader>(padded, grid::ScalarFrame{});
    }
    field_.kernel = std::move(kernel);
    bound_filtered_field();
  }
  frame_ = grid::make_grid_frame(drawn().data.shape);
}

/// Range of the filtered field in each brick: of the values in reach, widened by what the kernel may overshoot.
void GridRenderer::bound_filtered_field() {
  const std::size_t count = drawn().bricks.count();
  const auto& counts = drawn().bricks.counts;
  const int radius = field_.kernel->radius();
  const auto overshoot = static_cast<float>(grid::overshoot_of(*field_.kernel));
  field_.min.resize(count);
  field_.max.resize(count);
  support::parallel_chunks(count, 64, [&](std::size_t begin, std::size_t end) {
    std::vector<float> values;
    for (std::size_t i = begin; i < end; ++i) {
      const grid::BrickBox box =
          grid::box_of_brick(drawn().data.shape, {static_cast<std::uint32_t>(i % counts[0]),
                                                  static_cast<std::uint32_t>(i / counts[0] % counts[1]),
                                                  static_cast<std::uint32_t>(i / counts[0] / counts[1])});
      const std::int64_t padding = field_.coefficients.empty() ? 0 : FilteredField::kMargin;
      grid::Block block;
      for (int axis = 0; axis < 3; ++axis) {
        block.first[axis] = box.first[axis] - radius + 1 + padding;
        block.count[axis] = box.count[axis] + 2 * radius;
      }
      values.resize(static_cast<std::size_t>(block.size()));
      field_.reader->read(block, values.data());
      float min = std::numeric_limits<float>::infinity(), max = -min;
      for (const float value : values) {
        min = value < min ? value : min;
        max = value > max ? value : max;
      }
      const float middle = 0.5f * min + 0.5f * max, half = (0.5f * max - 0.5f * min) * overshoot;
      field_.min[i] = min <= max ? middle - half : min;
      field_.max[i] = min <= max ? middle + half : max;
    }
  });
}

LatticeField GridRenderer::lattice_field(const RenderSettings& settings, float allowed_rate) const {
  LatticeField field;
  field.reader = field_.reader ? field_.reader.get() : &reader_;
  field.padding = field_.coefficients.empty() ? 0 : FilteredField::kMargin;
  field.kernel = field_.kernel.get();
  field.points = settings.integrator == Integrator::kPre && !is_constant(settings) ? &control_points_ : nullptr;
  field.is_constant = is_constant(settings);
  field.is_nearest = field.is_constant && grid_.data.association == Association::kPoint;
  field.allowed_rate = allowed_rate;
  return field;
}

ValueRange GridRenderer::range_of(std::size_t brick) const {
  if (field_.kernel) return {field_.min[brick], field_.max[brick]};
  return {grid_.bricks.min[brick], grid_.bricks.max[brick]};
}

BrickPlan GridRenderer::plan_brick(std::size_t brick, const RenderSettings& settings, float allowed_rate) const {
  const ValueRange range = range_of(brick);
  const auto min = static_cast<float>(range.min), max = static_cast<float>(range.max);
  BrickPlan plan;
  if (!(min <= max)) return plan;
  const bool has_rate = settings.samples_per_voxel > 0.0 && !is_constant(settings);
  if (!has_rate && !(steepness_.largest_extinction(min, max) > 0.0f)) return plan;
  plan.level = 0;
  if (is_constant(settings) || has_rate || settings.integrator == Integrator::kPre) return plan;
  const bool has_missing = field_.kernel ? drawn().missing_values > 0 : grid_.bricks.has_missing[brick] != 0;
  const float steepness = steepness_.largest_steepness(min, max);
  const auto is_good = [&](float deviation) { return steepness == 0.0f || deviation * steepness <= allowed_rate; };
  plan.is_curved = field_.kernel ? steepness > 0.0f : !is_good(grid_.bricks.deviation[0][brick]);
  if (field_.kernel) return plan;
  for (int level = has_missing ? 0 : 3; level > 0 && plan.level == 0; --level)
    if (is_good(grid_.bricks.deviation[level][brick])) plan.level = static_cast<std::uint8_t>(level);
  plan.is_curved &= plan.level == 0;
  return plan;
}

void GridRenderer::plan_bricks(const RenderSettings& settings, float allowed_rate) {
  const PlanKey key{settings.filter, settings.integrator, settings.tolerance, settings.samples_per_voxel > 0.0};
  if (is_planned_ && key == planned_for_) return;
  plans_.resize(drawn().bricks.count());
  support::parallel_chunks(plans_.size(), 1 << 12, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) plans_[i] = plan_brick(i, settings, allowed_rate);
  });
  visible_.clear();
  for (std::size_t i = 0; i < plans_.size(); ++i)
    if (plans_[i].level != BrickPlan::kTransparent) visible_.push_back(static_cast<std::uint32_t>(i));
  planned_for_ = key;
  is_planned_ = true;
}

void GridRenderer::draw_tile(std::size_t tile, const GridView& view, const RayGrid& rays, const BrickBins& bins,
                             const LatticeField& field, MarchJob job, const Kernels& kernels, Integrate march,
                             Workspace& workspace, Image& image, std::uint64_t& segments) const {
  const int column = static_cast<int>(tile % bins.columns) * kTileSize;
  const int row = static_cast<int>(tile / bins.columns) * kTileSize;
  MarchStart start{&rays, column, row, {}, {}, workspace.rays.get()};
  std::copy(view.grid_from_camera.begin(), view.grid_from_camera.end(), start.grid_from_camera);
  for (int axis = 0; axis < 3; ++axis) start.upper[axis] = frame_.plane(axis, drawn().data.shape.dimensions[axis] - 1);
  kernels.start_march(start);
  job.rays = workspace.rays.get();
  for (const BinnedBrick& binned : bins.bricks_of(tile)) {
    const BrickPlan& plan = plans_[binned.brick];
    MarchBrick brick = workspace.lattice.describe(drawn(), frame_, binned.brick, plan.level);
    brick.bounds = binned.bounds;
    job.brick = &brick;
    const int count = kernels.clip_brick(job);
    if (count == 0) continue;
    const ValueRange range = range_of(binned.brick);
    brick.steepness = steepness_.largest_steepness(static_cast<float>(range.min), static_cast<float>(range.max));
    brick.has_missing |= field_.kernel && drawn().missing_values > 0;  // a kernel reaches into other bricks
    workspace.lattice.fill(field, brick);
    if (!plan.is_curved) brick.steepness = 0.0f;
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
  prepare_filter(settings);
  const auto allowed_rate = static_cast<float>(kRatePerTolerance * settings.tolerance / diagonal());
  plan_bricks(settings, allowed_rate);
  const GridView view = make_grid_view(drawn(), frame_, camera, settings.width, settings.height);
  const Rays rays = make_rays(view.camera, view.world_per_local);
  const BrickBins bins = bin_bricks(drawn(), frame_, visible_, view);
  frame_bytes_ = bins.bricks.size() * sizeof(BinnedBrick);

  const IntegratorTables tables{&antiderivative_, &control_points_,
                                settings.integrator == Integrator::kPartial ? &optics::transparency_table() : nullptr,
                                static_cast<float>(settings.tolerance) / kSegmentsOfTolerance, settings.samples};
  const Integrate march = choose_march(kernels, is_constant(settings), settings, antiderivative_.is_gentle);
  const LatticeField field = lattice_field(settings, allowed_rate);
  MarchJob job;
  job.tables = &tables;
  job.steepness = &steepness_;
  job.allowed_rate = allowed_rate;
  job.most_pieces = settings.tolerance < kFineTolerance ? kMostFinePieces : kMostPieces;
  job.z_near = rays.grid.z_near;
  job.use_early_ray_termination = settings.use_early_ray_termination;
  if (settings.samples_per_voxel > 0.0)
    job.sample_distance = static_cast<float>(mean_spacing(frame_) / settings.samples_per_voxel);
  std::atomic<std::uint64_t> segments{0};
  tbb::enumerable_thread_specific<Workspace> workspaces;
  TileProgress tile_progress(progress, bins.tile_count());
  support::parallel_chunks(bins.tile_count(), 1, [&](std::size_t begin, std::size_t end) {
    Workspace& workspace = workspaces.local();
    for (std::size_t tile = begin; tile < end; ++tile) {
      support::throw_if_cancelled(progress);
      std::uint64_t drawn_segments = 0;
      if (!bins.bricks_of(tile).empty())
        draw_tile(tile, view, rays.grid, bins, field, job, kernels, march, workspace, image, drawn_segments);
      segments += drawn_segments;
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
  const auto values = grid.value_dimensions();
  const std::uint64_t coefficients = settings.filter.kind == FilterKind::kInterpolatingBspline
                                         ? 2 * (values[0] + 4) * (values[1] + 4) * (values[2] + 4) * sizeof(float)
                                         : 0;
  return pixels * 4 * sizeof(float) + bricks * of_brick + coefficients + kTables;
}

}  // namespace tetravox
