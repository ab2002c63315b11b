#include "src/cpu/entries.h"
#include "src/cpu/eye_cells.h"
#include "src/cpu/frame.h"
#include "src/cpu/frame_renderer.h"
#include "src/optics/antiderivative_table.h"
#include "src/optics/transparency_table.h"
#include "src/support/threads.h"
#include "tetravox/error.h"

#include <tbb/enumerable_thread_specific.h>

#include <atomic>
#include <string>
#include <vector>

namespace tetravox::cpu {
namespace {

/// A ray of a mesh may err by the picture's tolerance where this many of its segments err all they may.
constexpr float kSegmentsOfTolerance = 40.0f;

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
                  "pre-classification is for grids; meshes are drawn with antiderivative, partial or post");
    case Integrator::kAntiderivative:
      break;
  }
  return is_gentle ? kernels.walk_gentle_antiderivative : kernels.walk_antiderivative;
}

/// Everything that the tiles of one frame share.
struct Frame {
  CameraFrame camera;
  Rays rays;
  std::vector<BoundaryFace> faces;  // boundary and faces around the eye; empty where the boundary alone serves
  std::size_t first_eye_face = 0;
  FrameMesh mesh;
  TileBins bins;
};

Frame prepare_frame(const PreparedMesh& mesh, const Camera& camera, const RenderSettings& settings, float* vertices) {
  Frame frame;
  frame.camera = make_camera_frame(mesh, camera, settings.width, settings.height);
  transform_vertices(mesh, frame.camera, vertices);
  frame.mesh = {vertices, static_cast<std::uint32_t>(mesh.vertices.size() - 1), mesh.cells.data(),
                mesh.cell_scalars.empty() ? nullptr : mesh.cell_scalars.data(), mesh.boundary.data()};
  frame.first_eye_face = mesh.boundary.size();
  std::size_t face_count = mesh.boundary.size();
  const std::vector<BoundaryFace> around =
      find_eye_cell_faces(frame.mesh, mesh.boundary, mesh.cells.size(), frame.camera);
  frame.rays = make_rays(frame.camera, mesh.world_per_local);  // after that: the eye may have been moved
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

class MeshRenderer final : public FrameRenderer {
 public:
  explicit MeshRenderer(const PreparedMesh& mesh) : mesh_(mesh) {}

  void set_transfer_function(const OpticalFunction& function) override {
    const optics::ScalarMap map{mesh_.scalar_offset, mesh_.scalar_scale};
    control_points_ = optics::build_control_point_table(function, map);
    if (mesh_.association == Association::kPoint)
      optics::build_antiderivative_table(function, map, mesh_.scalar_range, diagonal(), antiderivative_);
  }

  void render(const Camera& camera, const RenderSettings& settings, const Kernels& kernels, const Progress& progress,
              Image& image, RenderStatistics& statistics) override;

  std::uint64_t missing_bytes(const RenderSettings& settings) const override {
    return estimate_render_memory(vertices_ ? 0 : mesh_.vertices.size(), mesh_.boundary.size(), settings);
  }

  std::uint64_t bytes() const override {
    return (vertices_ ? mesh_.vertices.size() * 4 * sizeof(float) : 0) + frame_bytes_ + antiderivative_.bytes() +
           control_points_.bytes();
  }

  Source source() const override { return Source::kWalk; }
  double diagonal() const override { return diagonal_of(mesh_.bounds); }

 private:
  const PreparedMesh& mesh_;
  optics::AntiderivativeTable antiderivative_;
  optics::ControlPointTable control_points_;
  std::unique_ptr<float[]> vertices_;  // of the camera's frame; allocated at the first one
  std::uint64_t frame_bytes_ = 0;      // of what the last frame needed beside the vertices
};

void MeshRenderer::render(const Camera& camera, const RenderSettings& settings, const Kernels& kernels,
                          const Progress& progress, Image& image, RenderStatistics& statistics) {
  std::atomic<std::uint64_t> segments{0}, stopped_rays{0}, rays{0};
  if (!vertices_) vertices_ = std::make_unique_for_overwrite<float[]>(4 * mesh_.vertices.size());
  const Frame frame = prepare_frame(mesh_, camera, settings, vertices_.get());
  frame_bytes_ = bytes_of(frame);

  const IntegratorTables tables{&antiderivative_, &control_points_,
                                settings.integrator == Integrator::kPartial ? &optics::transparency_table() : nullptr,
                                static_cast<float>(settings.tolerance) / kSegmentsOfTolerance, settings.samples};
  const auto walk = choose_walk(kernels, mesh_.association, settings.integrator, antiderivative_.is_gentle);
  tbb::enumerable_thread_specific<TileScratch> scratches;
  TileProgress tile_progress(progress, frame.bins.tile_count());
  support::parallel_chunks(frame.bins.tile_count(), 1, [&](std::size_t begin, std::size_t end) {
    TileScratch& scratch = scratches.local();
    for (std::size_t tile = begin; tile < end; ++tile) {
      support::throw_if_cancelled(progress);
      if (!frame.bins.faces_of(tile).empty()) {
        collect_rays(kernels, frame.mesh, frame.rays.grid, frame.bins, tile, frame.first_eye_face,
                     frame.camera.is_orthographic, scratch);
        const WalkStatistics walked = walk({&frame.mesh, &frame.rays.grid, &tables, &scratch.rays, image.pixels.data(),
                                            settings.use_early_ray_termination, progress.cancelled});
        segments += walked.segments;
        stopped_rays += walked.stopped_rays;
        rays += scratch.rays.rays.size();
      }
      tile_progress.tile_done();
    }
  });
  statistics.segments = segments;
  statistics.rays = rays;
  statistics.stopped_rays = stopped_rays;
}

}  // namespace

std::unique_ptr<FrameRenderer> make_mesh_renderer(const PreparedMesh& mesh) {
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
  return pixels * 4 * sizeof(float) + vertices * 4 * sizeof(float) +
         boundary_faces * (sizeof(BoundaryFace) + 4 * sizeof(cpu::BinnedFace)) + tables;
}

}  // namespace tetravox
