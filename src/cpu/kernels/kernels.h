#pragma once

/// What the vector code is given and what it offers: plain pointers in, no vector type out.
///
/// The kernels are compiled once for each instruction set and chosen at run time (kernels.cpp). All of them use the
/// same operations in the same order, without fused multiply-add, so that every instruction set gives the same bits.

#include "src/cpu/kernels/domain.h"
#include "src/cpu/kernels/effects.h"
#include "src/optics/antiderivative_table.h"
#include "src/optics/cylindrical_atlas.h"
#include "src/optics/polynomial_table.h"
#include "src/optics/preintegration_table.h"
#include "src/optics/slab_table.h"
#include "src/optics/steepness_table.h"
#include "src/optics/transparency_table.h"
#include "src/scene/camera_frame.h"
#include "src/scene/eye_cells.h"
#include "tetravox/mesh.h"

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace tetravox::cpu {

/// Pixels are drawn in square tiles.
inline constexpr int kTileSize = 32;

/// The mesh as seen by the camera.
struct FrameMesh {
  const float* vertices = nullptr;  ///< [vertices][4] x, y, z in the camera frame, stored scalar
  std::uint32_t last_vertex = 0;
  const TetrahedronLinks* cells = nullptr;
  const float* cell_scalars = nullptr;  ///< [cells], or null for point data
  const BoundaryFace* faces = nullptr;  ///< where rays enter: the boundary, then the faces of cells around the eye
  const float* gradients = nullptr;     ///< [vertices][4], or [cells][4] where `has_cell_gradients`; for effects
  bool has_cell_gradients = false;
  /// Further stored scalars, [vertices], or [cells] with cell data; one for each axis of a function that asks for it.
  const float* others[kMostVariables] = {};

  scene::SeenMesh seen() const { return {vertices, last_vertex, cells}; }
};

/// What integrators look up; each uses one or two of them.
struct IntegratorTables {
  const optics::AntiderivativeTable* antiderivative = nullptr;
  const optics::ControlPointTable* control_points = nullptr;
  const optics::TransparencyTable* transparency = nullptr;
  float tolerance = 5e-5f;
  int samples = 8;
  bool may_overshoot = false;              ///< whether scalars may lie beyond the range of the data
  const Effects* effects = nullptr;        ///< of the kernels with effects
  const DomainFunction* domain = nullptr;  ///< of those for functions of several variables
  /// Ray integrals: the one that is not null counts.
  const optics::PreintegrationTable* preintegration = nullptr;
  const optics::PolynomialTable* polynomial = nullptr;
  const optics::CylindricalAtlas* atlas = nullptr;
  const optics::SlabTable* slabs = nullptr;  ///< of packets at a fixed rate
  float slab_thickness = 1.0f;               ///< world length
};

/// Segments one by one; stored scalars, world lengths.
struct SegmentArrays {
  const float* scalar_front = nullptr;
  const float* scalar_back = nullptr;
  const float* length = nullptr;
  std::size_t count = 0;
};

/// Where a ray enters the mesh.
struct Entry {
  std::uint32_t face = 0;
  float depth = 0.0f;
};

/// A tile's rays, each with its entries in order of depth.
struct TileRays {
  struct Ray {
    int column = 0, row = 0;
    std::uint32_t begin = 0, end = 0;            ///< into entries
    std::uint32_t clip_begin = 0, clip_end = 0;  ///< into clips; none: all of the ray in front of the eye is drawn
  };
  std::vector<Ray> rays;
  std::vector<Entry> entries;
  std::vector<ClipInterval> clips;  ///< of one ray after the other, ascending and apart
};

/// A face of `FrameMesh::faces` found in a pixel.
struct FaceHit {
  std::uint32_t pixel = 0;  ///< in the tile: row * kTileSize + column
  Entry entry;
};

struct TileBounds {
  int column_begin = 0, column_end = 0, row_begin = 0, row_end = 0;
};

/// A face with the pixels that it may cover.
struct BinnedFace {
  std::uint32_t face = 0;
  TileBounds bounds;
};

struct WalkStatistics {
  std::uint64_t segments = 0;
  std::uint64_t stopped_rays = 0;
};

struct WalkJob {
  const FrameMesh* mesh = nullptr;
  const scene::RayGrid* rays = nullptr;
  const IntegratorTables* tables = nullptr;
  const TileRays* tile = nullptr;
  float* pixels = nullptr;  ///< [height][width][4], premultiplied
  bool use_early_ray_termination = true;
  const std::atomic<bool>* cancelled = nullptr;  ///< once true, the tile is given up
};

/// The rays of a tile on their way through a grid, [kTileSize][kTileSize] each. Grid coordinates.
struct MarchRays {
  static constexpr int kCount = kTileSize * kTileSize;
  static constexpr int kPadding = 16;  ///< kernels load whole vectors

  alignas(64) float start[kCount][4];   ///< origin (at depth 0 of the camera frame), world length of a unit of depth
  alignas(64) float course[kCount][4];  ///< direction, for one unit of depth; nothing
  alignas(64) float sums[kCount][4];    ///< red, green, blue, transmittance
  alignas(64) float z_near[kCount];     ///< where what is drawn of the ray begins: the eye, or a clip interval
  alignas(64) float z_far[kCount];      ///< where it ends: infinite, or below everything once the ray is settled
  alignas(64) float depth[kCount];      ///< see Effects::depth
  alignas(64) float z_left[kCount];     ///< with effects: where the ray has left the last brick, and its scalar there
  alignas(64) float scalar_left[kCount];
  // For cutting with bricks: the same axis by axis, and 1 / direction (anything for rays parallel to the axis' planes).
  alignas(64) float origin[3][kCount], direction[3][kCount], inverse[3][kCount];
  bool has_parallel[3];                      ///< whether a ray is
  alignas(64) std::uint8_t has_met[kCount];  ///< whether the ray has met a brick
  // At a fixed rate: where the ray leaves the grid, the sample before (depth, scalar or densities), the next one's
  // number.
  alignas(64) float z_exit[kCount], z_sample[kCount], sample[4][kCount], next_number[kCount];

  /// Those that meet the brick at hand.
  struct Met {
    alignas(64) std::int32_t ray[kCount + kPadding];  ///< in the tile
    alignas(64) float z_enter[kCount + kPadding], z_leave[kCount + kPadding];
    alignas(64) std::int32_t cells[kCount + kPadding];  ///< about how many cells it crosses
  };
  Met met;                     ///< by the number of cells
  Met unsorted;                ///< scratch: in order of pixels
  bool has_intervals = false;  ///< whether rays may have more than one clip interval
  int ended_count = 0;
  std::int32_t ended[kCount];  ///< where they may: rays whose interval ends before they leave the brick at hand
};

/// Floats behind the nodes, and records behind the records, that kernels may touch.
inline constexpr std::size_t kRecordPadding = 32;

/// A brick as a lattice of cells between whose corners the scalar is trilinear (or in which it is constant).
struct MarchBrick {
  float lower[3] = {}, upper[3] = {};  ///< grid coordinates
  bool is_last[3] = {};                ///< whether the brick ends the grid along the axis
  std::int32_t cells[3] = {1, 1, 1};
  bool is_uneven = false;
  const float* planes[3] = {};  ///< [cells + 1] grid coordinates of the planes, where the brick is uneven
  TileBounds bounds;            ///< the pixels of the tile that may see it, counted from the tile's corner
  const float* records =
      nullptr;  ///< [z nodes][y cells][x cells][4]: the corners (x, y), (x+1, y), (x, y+1), (x+1, y+1)
  const float* densities = nullptr;  ///< [z nodes][y nodes][x nodes][4] instead: rho, rho * colour
  const float* constants = nullptr;  ///< [z cells][y cells][x cells] instead, where the scalar is constant in each cell
  const float* gradients = nullptr;  ///< [z nodes][y nodes][x nodes][4], or like `constants`; in grid coordinates
  const float* others[kMostVariables] = {};  ///< like `records` or `constants`: of the axes of a function of several
  bool has_missing = false;                  ///< whether a corner is not a number
  float steepness = 0.0f;                    ///< largest change of density with the scalar in the brick
};

struct MarchJob {
  MarchRays* rays = nullptr;
  const MarchBrick* brick = nullptr;
  const IntegratorTables* tables = nullptr;
  const optics::SteepnessTable* steepness = nullptr;
  float allowed_rate = 0.0f;             ///< error in colour for one unit of world length that a segment may have
  float most_pieces = 12.0f;             ///< that a cell is cut into
  const scene::RayGrid* grid = nullptr;  ///< for effects, with the tile's corner
  int column = 0, row = 0;
  float stride = 1.0f;           ///< lattice cells
  float sample_distance = 0.0f;  ///< world length between samples at a fixed rate, which goes before `stride`
  bool use_early_ray_termination = true;
  float negligible = 0.0f;  ///< transmittance below which a ray ends, too
};

/// Where the rays of a tile lie in a grid.
struct MarchStart {
  const scene::RayGrid* rays = nullptr;
  int column = 0, row = 0;          ///< of the tile's corner
  float grid_from_camera[12] = {};  ///< rows of a 3 x 4 matrix
  float upper[3] = {};              ///< of the grid; its lower corner is 0
  MarchRays* tile = nullptr;
};

/// Values of a whole grid where they lie: one scalar a value, [k][j][i], in this machine's byte order.
struct MarchValues {
  const std::byte* values = nullptr;
  std::int32_t dimensions[3] = {2, 2, 2};  ///< at least 2 each
  std::ptrdiff_t row_bytes = 1, slice_bytes = 1;
  int value_bytes = 1;     ///< 1: integers without sign; 2: integers with one; 4: floats
  std::uint32_t flip = 0;  ///< turned over in each word of integers, to make them so
  /// scalar of the integrator = (value - offset) * inverse_scale
  float offset = 0.0f, inverse_scale = 1.0f;
};

/// Takes the rays of a tile through a whole grid in equal steps.
struct PacketJob {
  MarchRays* rays = nullptr;
  const MarchValues* values = nullptr;
  const IntegratorTables* tables = nullptr;
  /// [bricks] bit `span`: whether the brick is to be drawn, or one of those up to one further along the axes whose bits
  /// are set in `span`.
  const std::uint8_t* seen_spans = nullptr;
  std::int32_t brick_counts[3] = {};
  bool is_large = false;         ///< whether values will have to be asked for early
  float sample_distance = 0.0f;  ///< world length
  bool use_early_ray_termination = true;
  float negligible = 0.0f;  ///< as in `MarchJob`
  /// For light:
  float faint = 0.0f;                    ///< as `Effects::faint`, of one step
  const scene::RayGrid* grid = nullptr;  ///< with the tile's corner
  int column = 0, row = 0;
  bool has_central_gradients = true;  ///< else those of the trilinear field
  float stored_per_scalar = 1.0f;     ///< stored scalars in one of the integrator's
};

/// One row of a table of slabs.
struct SlabJob {
  const IntegratorTables* tables = nullptr;
  optics::SlabTable* table = nullptr;  ///< with room for its entries, and for centers if they are to be found
  int front = 0;
  float thickness = 1.0f;  ///< world length
};

/// The kernels of one instruction set. All are safe to call from many threads.
struct Kernels {
  /// Appends to `hits` the pixels of `bounds` whose ray meets `face` from its outer side.
  void (*rasterize_face)(const FrameMesh& mesh, const scene::RayGrid& rays, const BinnedFace& face, int tile_column,
                         int tile_row, std::vector<FaceHit>& hits) = nullptr;
  WalkStatistics (*walk_antiderivative)(const WalkJob& job) = nullptr;
  WalkStatistics (*walk_gentle_antiderivative)(const WalkJob& job) = nullptr;  ///< for `AntiderivativeTable::is_gentle`
  WalkStatistics (*walk_partial)(const WalkJob& job) = nullptr;
  WalkStatistics (*walk_post)(const WalkJob& job) = nullptr;
  /// Corners of the cells of a lattice as `MarchBrick::records`, from its nodes [z][y][x]; both with room for
  /// `kRecordPadding` more.
  void (*make_records)(const float* nodes, const std::int32_t cells[3], float* records) = nullptr;
  void (*start_march)(const MarchStart& start) = nullptr;
  /// Finds the rays that meet the brick; returns how many.
  int (*clip_brick)(const MarchJob& job) = nullptr;
  /// Marches those rays through the brick; returns how many segments they had.
  std::uint64_t (*march_antiderivative)(const MarchJob& job, int count) = nullptr;
  std::uint64_t (*march_gentle_antiderivative)(const MarchJob& job, int count) = nullptr;
  std::uint64_t (*march_partial)(const MarchJob& job, int count) = nullptr;
  std::uint64_t (*march_post)(const MarchJob& job, int count) = nullptr;
  std::uint64_t (*march_densities)(const MarchJob& job, int count) = nullptr;  ///< pre-classification
  /// In equal steps of at most `MarchJob::stride` lattice cells instead of from cell to cell: bricks that are even and
  /// have no missing values.
  std::uint64_t (*stride_antiderivative)(const MarchJob& job, int count) = nullptr;
  std::uint64_t (*stride_gentle_antiderivative)(const MarchJob& job, int count) = nullptr;
  std::uint64_t (*stride_partial)(const MarchJob& job, int count) = nullptr;
  /// At a fixed rate: pre-integrated from sample to sample, post-classified, pre-classified.
  std::uint64_t (*sample_antiderivative)(const MarchJob& job, int count) = nullptr;
  std::uint64_t (*sample_partial)(const MarchJob& job, int count) = nullptr;
  std::uint64_t (*sample_post)(const MarchJob& job, int count) = nullptr;
  std::uint64_t (*sample_densities)(const MarchJob& job, int count) = nullptr;
  /// The same where the values of the grid serve as they lie; returns how many segments there were.
  std::uint64_t (*packets_antiderivative)(const PacketJob& job) = nullptr;
  std::uint64_t (*packets_partial)(const PacketJob& job) = nullptr;
  std::uint64_t (*packets_slabs)(const PacketJob& job) = nullptr;  ///< of `IntegratorTables::slabs`
  void (*fill_slabs)(const SlabJob& job) = nullptr;
  std::uint64_t (*march_cells)(const MarchJob& job,
                               int count) = nullptr;           ///< constant cells, exact with every integrator
  WalkStatistics (*walk_cells)(const WalkJob& job) = nullptr;  ///< cell data, exact with every integrator
  /// The same with what `IntegratorTables::effects` asks for.
  WalkStatistics (*illustrate_walk_antiderivative)(const WalkJob& job) = nullptr;
  WalkStatistics (*illustrate_walk_gentle_antiderivative)(const WalkJob& job) = nullptr;
  WalkStatistics (*illustrate_walk_partial)(const WalkJob& job) = nullptr;
  WalkStatistics (*illustrate_walk_post)(const WalkJob& job) = nullptr;
  WalkStatistics (*illustrate_walk_cells)(const WalkJob& job) = nullptr;
  std::uint64_t (*light_packets_antiderivative)(const PacketJob& job) = nullptr;
  std::uint64_t (*light_packets_partial)(const PacketJob& job) = nullptr;
  std::uint64_t (*light_packets_slabs)(const PacketJob& job) = nullptr;
  std::uint64_t (*illustrate_march_antiderivative)(const MarchJob& job, int count) = nullptr;
  std::uint64_t (*illustrate_march_gentle_antiderivative)(const MarchJob& job, int count) = nullptr;
  std::uint64_t (*illustrate_stride_antiderivative)(const MarchJob& job, int count) = nullptr;
  std::uint64_t (*illustrate_stride_gentle_antiderivative)(const MarchJob& job, int count) = nullptr;
  std::uint64_t (*illustrate_stride_partial)(const MarchJob& job, int count) = nullptr;
  std::uint64_t (*illustrate_march_partial)(const MarchJob& job, int count) = nullptr;
  std::uint64_t (*illustrate_march_post)(const MarchJob& job, int count) = nullptr;
  std::uint64_t (*illustrate_march_cells)(const MarchJob& job, int count) = nullptr;
  /// The same for what `IntegratorTables::domain` asks for, with or without effects.
  struct OfDomain {
    WalkStatistics (*walk)(const WalkJob& job) = nullptr;
    WalkStatistics (*walk_cells)(const WalkJob& job) = nullptr;
    std::uint64_t (*march)(const MarchJob& job, int count) = nullptr;
    std::uint64_t (*march_cells)(const MarchJob& job, int count) = nullptr;
  };
  OfDomain domain_2d, domain_3d, separate_colors;
  /// The same for the integrators that look ray integrals up: table3d, polynomial, cylindrical.
  struct OfTables {
    WalkStatistics (*walk)(const WalkJob& job) = nullptr;
    std::uint64_t (*march)(const MarchJob& job, int count) = nullptr;
    std::uint64_t (*sample)(const MarchJob& job, int count) = nullptr;
    WalkStatistics (*illustrate_walk)(const WalkJob& job) = nullptr;
    std::uint64_t (*illustrate_march)(const MarchJob& job, int count) = nullptr;
    /// `colors`, [count][4]: what a frame takes for each segment; for tests.
    void (*look_up)(const IntegratorTables& tables, const SegmentArrays& segments, float* colors) = nullptr;
  };
  OfTables tables;
};

/// Names of the instruction sets that were compiled in and that this machine has, best first.
std::vector<std::string> available_instruction_sets();

/// The kernels of an instruction set; the best for an empty name.
/// @throws Error (kInvalidArgument) that lists the names there are.
const Kernels& kernels_for(const std::string& instruction_set);

/// The name that `kernels_for("")` stands for.
std::string best_instruction_set();

}  // namespace tetravox::cpu
