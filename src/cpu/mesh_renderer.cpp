#include "src/cpu/clip_intervals.h"
#include "src/cpu/domain.h"
#include "src/cpu/entries.h"
#include "src/cpu/frame_renderers.h"
#include "src/cpu/illustration.h"
#include "src/cpu/mesh_shadows.h"
#include "src/mesh/edges.h"
#include "src/mesh/gradients.h"
#include "src/optics/antiderivative_table.h"
#include "src/optics/extinction_integral.h"
#include "src/optics/transparency_table.h"
#include "src/scene/camera_frame.h"
#include "src/scene/eye_cells.h"
#include "src/scene/preintegration_cache.h"
#include "src/support/memory.h"
#include "src/support/threads.h"
#include "src/support/timer.h"
#include "tetravox/error.h"

#include <tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <atomic>
#include <limits>
#include <optional>
#include <string>
#include <vector>

namespace tetravox::cpu {
namespace {

/// 32-bit gathers reach this many 20-byte cells.
constexpr std::size_t kMostCells = 0x7FFFFFFFu / 5;

auto choose_walk(const Kernels& kernels, Association association, Integrator integrator, bool is_gentle) {
  if (association == Association::kCell) return kernels.walk_cells;
  switch (integrator) {
    case Integrator::kPartial:
      return kernels.walk_partial;
    case Integrator::kPost:
      return kernels.walk_post;
    case Integrator::kPre:
      throw Error(ErrorCode::kUnsupported,
                  "pre-classification is for grids; meshes are drawn with antiderivative, partial, post, table3d, "
                  "polynomial or cylindrical");
    case Integrator::kTable3d:
    case Integrator::kPolynomial:
    case Integrator::kCylindrical:
      return kernels.tables.walk;
    case Integrator::kAntiderivative:
      break;
  }
  return is_gentle ? kernels.walk_gentle_antiderivative : kernels.walk_antiderivative;
}

auto choose_illustrated_walk(const Kernels& kernels, Association association, Integrator integrator, bool is_gentle) {
  if (association == Association::kCell) return kernels.illustrate_walk_cells;
  if (integrator == Integrator::kPartial) return kernels.illustrate_walk_partial;
  if (integrator == Integrator::kPost) return kernels.illustrate_walk_post;
  if (scene::is_of_tables(integrator)) return kernels.tables.illustrate_walk;
  return is_gentle ? kernels.illustrate_walk_gentle_antiderivative : kernels.illustrate_walk_antiderivative;
}

/// Finds the parts of the rays that the clipping keeps, and leaves out rays of which it keeps none.
void clip_rays(const ClipScene& clip, const scene::RayGrid& grid, ClipScratch& scratch,
               std::vector<ClipInterval>& found, TileRays& tile) {
  tile.clips.clear();
  std::erase_if(tile.rays, [&](TileRays::Ray& ray) {
    found.clear();
    find_intervals(clip,
                   {grid.column_offset[ray.column], grid.column_slope[ray.column], grid.row_offset[ray.row],
                    grid.row_slope[ray.row], grid.z_near, std::numeric_limits<double>::infinity()},
                   scratch, found);
    ray.clip_begin = static_cast<std::uint32_t>(tile.clips.size());
    tile.clips.insert(tile.clips.end(), found.begin(), found.end());
    ray.clip_end = static_cast<std::uint32_t>(tile.clips.size());
    return found.empty();
  });
}

/// Everything that the tiles of one frame share.
struct Frame {
  scene::CameraFrame camera;
  scene::Rays rays;
  std::vector<BoundaryFace> faces;  // boundary and faces around the eye; empty where the boundary alone serves
  std::size_t first_eye_face = 0;
  FrameMesh mesh;
  TileBins bins;
};

Frame prepare_frame(const PreparedMesh& mesh, const Camera& camera, const RenderSettings& settings, float* vertices) {
  Frame frame;
  frame.camera = scene::make_camera_frame(mesh, camera, settings.width, settings.height);
  scene::transform_vertices(mesh, frame.camera, vertices);
  frame.mesh = {vertices, static_cast<std::uint32_t>(mesh.vertices.size() - 1), mesh.cells.data(),
                mesh.cell_scalars.empty() ? nullptr : mesh.cell_scalars.data(), mesh.boundary.data()};
  frame.first_eye_face = mesh.boundary.size();
  std::size_t face_count = mesh.boundary.size();
  const std::vector<BoundaryFace> around =
      scene::find_eye_cell_faces(frame.mesh.seen(), mesh.boundary, mesh.cells.size(), frame.camera);
  frame.rays = scene::make_rays(frame.camera, mesh.world_per_local);  // after that: the eye may have been moved
  if (!around.empty()) {
    frame.faces = mesh.boundary;
    frame.faces.insert(frame.faces.end(), around.begin(), around.end());
    frame.mesh.faces = frame.faces.data();
    face_count = frame.faces.size();
  }
  frame.bins = bin_faces(frame.mesh, face_count, frame.first_eye_face, frame.camera);
  return frame;
}

std::uint64_t bytes_of(const Frame& frame) {
  return frame.faces.size() * sizeof(BoundaryFace) + frame.bins.faces.size() * sizeof(BinnedFace) +
         (frame.rays.column_offset.size() + frame.rays.row_offset.size()) * 2 * sizeof(float);
}

/// Gradients of a mesh as the kernels load them.
struct MeshGradients {
  GradientMethod method = GradientMethod::kDefault;
  std::vector<mesh::Gradient> records;  ///< [vertices] or [cells]
};

class MeshRenderer final : public scene::FrameRenderer {
 public:
  explicit MeshRenderer(const PreparedMesh& mesh) : mesh_(mesh) {}

  void set_transfer_function(const OpticalFunction& function) override {
    const optics::ScalarMap map{mesh_.scalar_offset, mesh_.scalar_scale};
    control_points_ = optics::build_control_point_table(function, map);
    extinction_ = optics::ExtinctionIntegral(function, map);
    if (mesh_.association == Association::kPoint)
      optics::build_antiderivative_table(function, map, mesh_.scalar_range, diagonal(), antiderivative_);
    has_centroids_ = false;
    preintegration_.invalidate();
    function_ = function;
    domain_ = {};
    ++function_number_;
  }

  void set_table(const OpticalTable& table, const std::vector<std::size_t>& others) override {
    domain_ = make_table_domain(table, others, scalars());
    occupancy_ = {};
    ++function_number_;
  }
  void set_colors(std::size_t other, const OpticalFunction& colors) override {
    domain_ = make_color_domain(other, colors, function_, scalars());
    ++function_number_;
  }
  bool has_domain() const override { return domain_.is_set(); }

  void render(const Camera& camera, const RenderSettings& settings, const scene::FrameContext& context, Image& image,
              RenderStatistics& statistics) override;

  std::uint64_t missing_bytes(const RenderSettings& settings) const override {
    const std::uint64_t held = std::min(preintegration_.bytes(), scene::preintegration_bytes(settings));
    return estimate_render_memory(vertices_ ? 0 : mesh_.vertices.size(), mesh_.boundary.size(), settings) - held;
  }

  std::uint64_t bytes() const override {
    return (vertices_ ? mesh_.vertices.size() * 4 * sizeof(float) : 0) + frame_bytes_ + antiderivative_.bytes() +
           control_points_.bytes() + extinction_.bytes() + boundary_.bytes() +
           gradients_.records.size() * sizeof(mesh::Gradient) + centroids_.sums.size() * sizeof(std::int32_t) +
           shadows_.bytes() + domain_.bytes() + preintegration_.bytes() + occupancy_.sums.size() * sizeof(std::int32_t);
  }

  std::vector<Source> sources() const override { return {Source::kWalk}; }
  double diagonal() const override { return scene::diagonal_of(mesh_.bounds); }

 private:
  DomainScalars scalars() const;
  ShadowedBody shadowed_body() const { return {mesh_.bounds, mesh_.origin, mesh_.world_per_local}; }
  struct Pass;
  using WalkKernel = WalkStatistics (*)(const WalkJob&);
  WalkKernel choose_kernel(const Kernels& kernels, const RenderSettings& settings, bool has_effects) const;
  void prepare_effects(const RenderSettings& settings);
  void prepare_preintegration(const RenderSettings& settings, const Progress& progress);
  void describe(const RenderSettings& settings, const scene::FrameContext& context, Frame& frame,
                Illustration& illustration) const;
  void draw(const Pass& pass, const scene::FrameContext& context, Image& image, RenderStatistics& statistics);

  const PreparedMesh& mesh_;
  OpticalFunction function_;
  Domain domain_;
  TableOccupancy occupancy_;
  optics::AntiderivativeTable antiderivative_;
  optics::ControlPointTable control_points_;
  optics::ExtinctionIntegral extinction_;
  FaceTree boundary_;  // made at the first frame with exact shadows
  bool has_centroids_ = false;
  optics::CentroidTable centroids_;  // made at the first frame with light
  MeshGradients gradients_;
  std::uint64_t function_number_ = 0;
  ShadowCache shadows_;
  scene::PreintegrationCache preintegration_;
  std::optional<double> longest_edge_;  // world length; found at the first frame with tables of ray integrals
  std::unique_ptr<float[]> vertices_;   // of the camera's frame; allocated at the first one
  std::uint64_t frame_bytes_ = 0;       // of what the last frame needed beside the vertices
};

DomainScalars MeshRenderer::scalars() const {
  const bool is_cell = mesh_.association == Association::kCell;
  const std::size_t wanted = is_cell ? mesh_.cells.size() : mesh_.vertices.size();
  DomainScalars scalars{{mesh_.scalar_offset, mesh_.scalar_scale}, mesh_.scalar_range, mesh::gradient_scale(mesh_), {}};
  for (const OtherScalars& other : mesh_.others) {
    if (other.scalars.size() != wanted)
      throw Error(ErrorCode::kInvalidArgument, "a further field of the mesh has " +
                                                   std::to_string(other.scalars.size()) + " values where the " +
                                                   (is_cell ? "cells are " : "vertices are ") + std::to_string(wanted));
    scalars.others.push_back({other.offset, other.scale});
  }
  return scalars;
}

/// A picture, or the depths that a light sees.
struct MeshRenderer::Pass {
  const Camera& camera;
  const RenderSettings& settings;
  bool has_effects = false;
  const DepthRecord* record = nullptr;
};

MeshRenderer::WalkKernel MeshRenderer::choose_kernel(const Kernels& kernels, const RenderSettings& settings,
                                                     bool has_effects) const {
  if (domain_.is_set()) {
    const Kernels::OfDomain& set = choose_domain_kernels(kernels, domain_);
    return mesh_.association == Association::kCell ? set.walk_cells : set.walk;
  }
  const auto choose = has_effects ? &choose_illustrated_walk : &choose_walk;
  return choose(kernels, mesh_.association, settings.integrator, antiderivative_.is_gentle);
}

/// Makes what effects need and no frame changes.
void MeshRenderer::prepare_effects(const RenderSettings& settings) {
  if (!has_centroids_ && !domain_.is_set() && mesh_.association == Association::kPoint) {
    optics::build_centroid_table(antiderivative_, centroids_);
    has_centroids_ = true;
  }
  if (settings.lighting.shadows == ShadowKind::kExact && boundary_.is_empty()) boundary_ = FaceTree(mesh_);
  GradientMethod method = settings.lighting.gradient;
  if (method == GradientMethod::kDefault) method = GradientMethod::kVertex;
  if (method != GradientMethod::kVertex && method != GradientMethod::kCell)
    throw Error(ErrorCode::kInvalidArgument,
                "gradient method '" + name_of(method) + "' is for grids; meshes have 'vertex' and 'cell'");
  const bool is_wanted = wants_gradients(settings) || domain_.wants_gradients();
  if (!is_wanted || gradients_.method == method) return;
  const bool is_of_cells = method == GradientMethod::kCell;
  support::require_memory((is_of_cells ? mesh_.cells.size() : mesh_.vertices.size()) * 4 * sizeof(float),
                          "the gradients of the mesh");
  gradients_.records = is_of_cells ? mesh::cell_gradients(mesh_) : mesh::vertex_gradients(mesh_);
  gradients_.method = method;
}

/// Makes the table of ray integrals, where these are looked up. With cell data segments need none.
void MeshRenderer::prepare_preintegration(const RenderSettings& settings, const Progress& progress) {
  if (!scene::is_of_tables(settings.integrator) || domain_.is_set() || mesh_.association == Association::kCell) return;
  if (!longest_edge_) longest_edge_ = mesh::find_longest_edge(mesh_);
  preintegration_.prepare(
      {function_, {mesh_.scalar_offset, mesh_.scalar_scale}, mesh_.scalar_range, *longest_edge_, progress}, settings);
}

/// Fills the effects of a frame, and points it at the gradients.
void MeshRenderer::describe(const RenderSettings& settings, const scene::FrameContext& context, Frame& frame,
                            Illustration& illustration) const {
  frame.mesh.gradients = gradients_.records.empty() ? nullptr : gradients_.records.front().data();
  frame.mesh.has_cell_gradients = gradients_.method == GradientMethod::kCell;
  for (std::size_t axis = 0; axis < domain_.others.size(); ++axis)
    if (domain_.others[axis]) frame.mesh.others[axis] = mesh_.others[*domain_.others[axis]].scalars.data();
  IllustratedFrame illustrated{frame.camera,
                               mesh_.origin,
                               mesh_.world_per_local,
                               {mesh_.scalar_offset, mesh_.scalar_scale},
                               mesh_.scalar_range,
                               diagonal(),
                               {},
                               has_centroids_ ? &centroids_ : nullptr,
                               context.environment};
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 3; ++column)
      illustrated.camera_from_gradient[3 * row + column] = frame.camera.axes[row][column];
  illustrate(settings, illustrated, illustration);
  shadows_.attach(settings, shadowed_body(), frame.camera, illustration);
  if (settings.lighting.shadows != ShadowKind::kExact || illustration.lights.empty()) return;
  illustration.medium =
      std::make_unique<MeshShadows>(mesh_, boundary_, make_shadow_optics(settings, extinction_, illustration),
                                    gradients_.records, frame.mesh.has_cell_gradients);
  trace_shadows(settings, {frame.camera, mesh_.origin, mesh_.world_per_local}, context, illustration);
}

void MeshRenderer::render(const Camera& camera, const RenderSettings& settings, const scene::FrameContext& context,
                          Image& image, RenderStatistics& statistics) {
  if (!vertices_) vertices_ = std::make_unique_for_overwrite<float[]>(4 * mesh_.vertices.size());
  const bool has_effects = wants_effects(settings) || domain_.is_set();
  if (domain_.is_set()) require_domain_settings(domain_, settings);
  const support::Timer timer;
  prepare_preintegration(settings, context.progress);
  statistics.plan_seconds = timer.seconds();
  if (has_effects) {
    require_effects(settings, mesh_.association == Association::kCell);
    prepare_effects(settings);
    const auto draw_depths = [&](const LightPass& pass, Image& unseen) {
      RenderStatistics uncounted;
      draw({pass.camera, pass.settings, true, &pass.record}, context, unseen, uncounted);
    };
    shadows_.prepare(settings, {shadowed_body(), camera, function_number_, context.clip_number}, draw_depths,
                     context.progress);
  }
  draw({camera, settings, has_effects}, context, image, statistics);
  note_backend(settings, statistics);
}

void MeshRenderer::draw(const Pass& pass, const scene::FrameContext& context, Image& image,
                        RenderStatistics& statistics) {
  const RenderSettings& settings = pass.settings;
  const Kernels& kernels = kernels_for(settings.instruction_set);
  Frame frame = prepare_frame(mesh_, pass.camera, settings, vertices_.get());
  frame_bytes_ = bytes_of(frame);
  Illustration illustration;
  if (pass.has_effects) describe(settings, context, frame, illustration);
  if (settings.wants_depth) illustration.effects.depth = image.depth.data();
  illustration.effects.record = pass.record;
  illustration.effects.is_whole = settings.clipping.shapes.empty() && settings.surfaces.empty() &&
                                  !scene::reaches_behind_eye(frame.mesh.seen(), frame.camera, !frame.faces.empty());

  IntegratorTables tables{&antiderivative_, &control_points_,
                          settings.integrator == Integrator::kPartial ? &optics::transparency_table() : nullptr,
                          scene::segment_tolerance(settings), settings.samples};
  tables.effects = &illustration.effects;
  build_occupancy(domain_, settings.tolerance, diagonal(), occupancy_);
  const DomainFunction domain = make_domain_function(domain_, occupancy_, settings.tolerance, diagonal());
  tables.domain = &domain;
  attach_preintegration(preintegration_, tables);
  const auto walk = choose_kernel(kernels, settings, pass.has_effects);
  const ClipScene clip = make_clip_scene(settings.clipping, context.clip_volumes,
                                         scene::world_from_camera(frame.camera, mesh_.origin, mesh_.world_per_local));
  std::atomic<std::uint64_t> segments{0}, stopped_rays{0}, rays{0};
  tbb::enumerable_thread_specific<TileScratch> scratches;
  tbb::enumerable_thread_specific<ClipScratch> clip_scratch;
  scene::TileProgress tile_progress(context.progress, frame.bins.tile_count());
  support::parallel_chunks(frame.bins.tile_count(), 1, [&](std::size_t begin, std::size_t end) {
    TileScratch& scratch = scratches.local();
    for (std::size_t tile = begin; tile < end; ++tile) {
      support::throw_if_cancelled(context.progress);
      if (!frame.bins.faces_of(tile).empty()) {
        collect_rays(kernels, frame.mesh, frame.rays.grid, frame.bins, tile, frame.first_eye_face,
                     frame.camera.is_orthographic, scratch);
        if (!settings.clipping.shapes.empty())
          clip_rays(clip, frame.rays.grid, clip_scratch.local(), scratch.intervals, scratch.rays);
        const WalkStatistics walked = walk({&frame.mesh, &frame.rays.grid, &tables, &scratch.rays, image.pixels.data(),
                                            settings.use_early_ray_termination, context.progress.cancelled});
        segments += walked.segments;
        stopped_rays += walked.stopped_rays;
        rays += scratch.rays.rays.size();
      }
      tile_progress.tile_done();
    }
  });
  support::throw_if_cancelled(context.progress);  // the last tile may have been given up
  if (illustration.rays) illustration.rays->rethrow_failure();
  if (settings.wants_depth) scene::measure_depth(frame.camera, mesh_.world_per_local, image);
  statistics.segments = segments;
  statistics.rays = rays;
  statistics.stopped_rays = stopped_rays;
}

}  // namespace

std::unique_ptr<scene::FrameRenderer> make_mesh_renderer(const PreparedMesh& mesh) {
  if (mesh.cells.empty()) throw Error(ErrorCode::kNothingToDraw, "the mesh has no cells to draw");
  if (mesh.cells.size() > kMostCells)
    throw Error(ErrorCode::kUnsupported, "the mesh has " + std::to_string(mesh.cells.size()) + " tetrahedra; at most " +
                                             std::to_string(kMostCells) + " can be drawn: split it");
  return std::make_unique<MeshRenderer>(mesh);
}

}  // namespace tetravox::cpu

namespace tetravox {

std::uint64_t estimate_render_memory(std::uint64_t vertices, std::uint64_t boundary_faces,
                                     const RenderSettings& settings) {
  const std::uint64_t pixels = static_cast<std::uint64_t>(settings.width) * static_cast<std::uint64_t>(settings.height);
  const std::uint64_t tables = 4u << 20;
  // Exact shadows: a tree over the faces, and for each light those that it enters, while they are sorted.
  const bool has_rays = settings.lighting.shadows == ShadowKind::kExact;
  const std::uint64_t shadows = has_rays ? 64 + 96 * settings.lighting.lights.size() : 0;
  return pixels * 4 * sizeof(float) + vertices * 4 * sizeof(float) +
         boundary_faces * (sizeof(BoundaryFace) + 4 * sizeof(cpu::BinnedFace) + shadows) + tables +
         scene::preintegration_bytes(settings);
}

}  // namespace tetravox
