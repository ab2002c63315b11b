#include "src/cpu/entries.h"
#include "src/cpu/eye_cells.h"
#include "src/cpu/frame.h"
#include "src/cpu/kernels/kernels.h"
#include "src/optics/antiderivative_table.h"
#include "src/optics/transparency_table.h"
#include "src/support/memory.h"
#include "src/support/threads.h"
#include "src/support/timer.h"
#include "tetravox/error.h"
#include "tetravox/render.h"

#include <tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace tetravox {

struct Renderer::State {
  const PreparedMesh& mesh;
  optics::AntiderivativeTable antiderivative;
  optics::ControlPointTable control_points;
  bool has_function = false;
  std::unique_ptr<float[]> vertices;  // of the camera's frame; allocated at the first one
  std::uint64_t frame_bytes = 0;      // of what the last frame needed beside the vertices
};

namespace {

/// A ray of a mesh may err by the picture's tolerance where this many of its segments err all they may.
constexpr float kSegmentsOfTolerance = 40.0f;

/// 32-bit gathers reach this many 20-byte cells.
constexpr std::size_t kMostCells = 0x7FFFFFFFu / 5;

void validate_settings(const RenderSettings& settings) {
  const auto fail = [](const std::string& message) { throw Error(ErrorCode::kInvalidArgument, message); };
  const auto in_range = [](int size) { return size >= 1 && size <= kLargestResolution; };
  if (!in_range(settings.width) || !in_range(settings.height))
    fail("resolution " + std::to_string(settings.width) + " x " + std::to_string(settings.height) +
         " is not possible: each side must be between 1 and " + std::to_string(kLargestResolution));
  if (settings.samples < 1 || settings.samples > 4096) fail("samples must be between 1 and 4096");
  if (!(settings.tolerance >= 1e-7 && settings.tolerance <= 1.0)) fail("tolerance must be between 1e-7 and 1");
  if (settings.threads < 0 || settings.threads > 4096) fail("threads must be between 0 (all cores) and 4096");
}

double diagonal(const std::array<ValueRange, 3>& bounds) {
  return std::hypot(bounds[0].max - bounds[0].min, bounds[1].max - bounds[1].min, bounds[2].max - bounds[2].min);
}

void validate_function(const OpticalFunction& function) {
  const auto fail = [](const std::string& message) { throw Error(ErrorCode::kInvalidArgument, message); };
  if (function.points.empty()) fail("the transfer function has no points");
  for (std::size_t i = 0; i < function.points.size(); ++i) {
    const OpticalPoint& point = function.points[i];
    const std::string name = "point " + std::to_string(i) + " of the transfer function";
    if (!std::isfinite(point.value)) fail(name + ": the value is not finite");
    if (i > 0 && point.value < function.points[i - 1].value) fail(name + ": values must not descend");
    if (!(point.extinction >= 0.0)) fail(name + ": the extinction is negative or not a number");
    for (const double channel : point.color)
      if (!(channel >= 0.0 && channel <= 1.0)) fail(name + ": colours lie in [0, 1]");
  }
}

/// The function with extinctions that float can work with: what is opaque within a millionth of the diagonal is opaque.
OpticalFunction limit_extinction(const OpticalFunction& function, double longest) {
  const double largest = 1e6 / std::max(longest, 1e-300);
  OpticalFunction limited = function;
  for (OpticalPoint& point : limited.points) point.extinction = std::min(point.extinction, largest);
  return limited;
}

auto choose_walk(const cpu::Kernels& kernels, Association association, Integrator integrator, bool is_gentle) {
  if (association == Association::kCell) return kernels.walk_cells;
  switch (integrator) {
    case Integrator::kPartial:
      return kernels.walk_partial;
    case Integrator::kPost:
      return kernels.walk_post;
    case Integrator::kAntiderivative:
      break;
  }
  return is_gentle ? kernels.walk_gentle_antiderivative : kernels.walk_antiderivative;
}

/// Calls `report` with the part done, from one thread at a time.
class TileProgress {
 public:
  TileProgress(const Progress& progress, std::size_t count) : progress_(progress), count_(count) {}

  void tile_done() {
    const std::size_t done = ++done_;
    if (!progress_.report || (done % 16 != 0 && done != count_) || busy_.test_and_set()) return;
    progress_.report("draw", static_cast<double>(done) / static_cast<double>(count_));
    busy_.clear();
  }

 private:
  const Progress& progress_;
  std::size_t count_;
  std::atomic<std::size_t> done_{0};
  std::atomic_flag busy_;
};

/// Everything that the tiles of one frame share.
struct Frame {
  cpu::CameraFrame camera;
  cpu::Rays rays;
  std::vector<BoundaryFace> faces;  // boundary and faces around the eye; empty where the boundary alone serves
  std::size_t first_eye_face = 0;
  cpu::FrameMesh mesh;
  cpu::TileBins bins;
};

Frame prepare_frame(const PreparedMesh& mesh, const Camera& camera, const RenderSettings& settings, float* vertices) {
  Frame frame;
  frame.camera = cpu::make_camera_frame(mesh, camera, settings.width, settings.height);
  cpu::transform_vertices(mesh, frame.camera, vertices);
  frame.mesh = {vertices, static_cast<std::uint32_t>(mesh.vertices.size() - 1), mesh.cells.data(),
                mesh.cell_scalars.empty() ? nullptr : mesh.cell_scalars.data(), mesh.boundary.data()};
  frame.first_eye_face = mesh.boundary.size();
  std::size_t face_count = mesh.boundary.size();
  const std::vector<BoundaryFace> around =
      cpu::find_eye_cell_faces(frame.mesh, mesh.boundary, mesh.cells.size(), frame.camera);
  frame.rays = cpu::make_rays(frame.camera, mesh.world_per_local);  // after that: the eye may have been moved
  if (!around.empty()) {
    frame.faces = mesh.boundary;
    frame.faces.insert(frame.faces.end(), around.begin(), around.end());
    frame.mesh.faces = frame.faces.data();
    face_count = frame.faces.size();
  }
  frame.bins = cpu::bin_faces(frame.mesh, face_count, frame.first_eye_face, frame.camera);
  return frame;
}

std::uint64_t bytes_of(const Frame& frame) {
  return frame.faces.size() * sizeof(BoundaryFace) + frame.bins.faces.size() * sizeof(cpu::BinnedFace) +
         (frame.rays.column_offset.size() + frame.rays.row_offset.size()) * 2 * sizeof(float);
}

}  // namespace

Renderer::Renderer(const PreparedMesh& mesh)
    : state_(new State{.mesh = mesh, .antiderivative = {}, .control_points = {}, .vertices = {}}) {
  if (mesh.cells.empty()) throw Error(ErrorCode::kNothingToDraw, "the mesh has no cells to draw");
  if (mesh.cells.size() > kMostCells)
    throw Error(ErrorCode::kUnsupported, "the mesh has " + std::to_string(mesh.cells.size()) + " tetrahedra; at most " +
                                             std::to_string(kMostCells) + " can be drawn: split it");
}

Renderer::~Renderer() = default;
Renderer::Renderer(Renderer&&) noexcept = default;
Renderer& Renderer::operator=(Renderer&&) noexcept = default;

void Renderer::set_transfer_function(const OpticalFunction& asked) {
  validate_function(asked);
  const OpticalFunction function = limit_extinction(asked, diagonal(state_->mesh.bounds));
  const optics::ScalarMap map{state_->mesh.scalar_offset, state_->mesh.scalar_scale};
  state_->control_points = optics::build_control_point_table(function, map);
  if (state_->mesh.association == Association::kPoint)
    optics::build_antiderivative_table(function, map, state_->mesh.scalar_range, diagonal(state_->mesh.bounds),
                                       state_->antiderivative);
  state_->has_function = true;
}

Image Renderer::render(const Camera& camera, const RenderSettings& settings, RenderStatistics* statistics,
                       const Progress& progress) {
  validate_settings(settings);
  validate_camera(camera);
  if (!state_->has_function) throw Error(ErrorCode::kInvalidArgument, "set a transfer function before drawing");
  const PreparedMesh& mesh = state_->mesh;
  const cpu::Kernels& kernels = cpu::kernels_for(settings.instruction_set);
  support::require_memory(
      estimate_render_memory(state_->vertices ? 0 : mesh.vertices.size(), mesh.boundary.size(), settings),
      "drawing this picture");

  const support::Timer timer;
  Image image{settings.width, settings.height, {}};
  std::atomic<std::uint64_t> segments{0}, stopped_rays{0}, rays{0};
  support::with_threads(settings.threads, [&] {
    image.pixels.resize(4 * static_cast<std::size_t>(settings.width) * settings.height);
    if (!state_->vertices) state_->vertices = std::make_unique_for_overwrite<float[]>(4 * mesh.vertices.size());
    const Frame frame = prepare_frame(mesh, camera, settings, state_->vertices.get());
    state_->frame_bytes = bytes_of(frame);

    const cpu::IntegratorTables tables{
        &state_->antiderivative, &state_->control_points,
        settings.integrator == Integrator::kPartial ? &optics::transparency_table() : nullptr,
        static_cast<float>(settings.tolerance) / kSegmentsOfTolerance, settings.samples};
    const auto walk = choose_walk(kernels, mesh.association, settings.integrator, state_->antiderivative.is_gentle);
    tbb::enumerable_thread_specific<cpu::TileScratch> scratches;
    TileProgress tile_progress(progress, frame.bins.tile_count());
    support::parallel_chunks(frame.bins.tile_count(), 1, [&](std::size_t begin, std::size_t end) {
      cpu::TileScratch& scratch = scratches.local();
      for (std::size_t tile = begin; tile < end; ++tile) {
        support::throw_if_cancelled(progress);
        if (!frame.bins.faces_of(tile).empty()) {
          cpu::collect_rays(kernels, frame.mesh, frame.rays.grid, frame.bins, tile, frame.first_eye_face,
                            frame.camera.is_orthographic, scratch);
          const cpu::WalkStatistics walked =
              walk({&frame.mesh, &frame.rays.grid, &tables, &scratch.rays, image.pixels.data(),
                    settings.use_early_ray_termination, progress.cancelled});
          segments += walked.segments;
          stopped_rays += walked.stopped_rays;
          rays += scratch.rays.rays.size();
        }
        tile_progress.tile_done();
      }
    });
  });
  if (statistics)
    *statistics = {timer.seconds(),
                   segments,
                   rays,
                   stopped_rays,
                   settings.threads > 0 ? settings.threads : support::hardware_threads(),
                   settings.instruction_set.empty() ? cpu::best_instruction_set() : settings.instruction_set};
  return image;
}

std::uint64_t Renderer::bytes() const {
  return (state_->vertices ? state_->mesh.vertices.size() * 4 * sizeof(float) : 0) + state_->frame_bytes +
         state_->antiderivative.entries.size() * sizeof(optics::AntiderivativeTable::Node) +
         state_->antiderivative.color_variation.size() * sizeof(float) +
         state_->control_points.starts.size() * 11 * sizeof(float) +
         state_->control_points.first_interval.size() * sizeof(std::int32_t);
}

Image render(const PreparedMesh& mesh, const OpticalFunction& function, const Camera& camera,
             const RenderSettings& settings) {
  Renderer renderer(mesh);
  renderer.set_transfer_function(function);
  return renderer.render(camera, settings);
}

std::vector<std::string> instruction_sets() { return cpu::available_instruction_sets(); }

std::uint64_t estimate_render_memory(std::uint64_t vertices, std::uint64_t boundary_faces,
                                     const RenderSettings& settings) {
  const std::uint64_t pixels = static_cast<std::uint64_t>(settings.width) * static_cast<std::uint64_t>(settings.height);
  const std::uint64_t tables = 4u << 20;
  return pixels * 4 * sizeof(float) + vertices * 4 * sizeof(float) +
         boundary_faces * (sizeof(BoundaryFace) + 4 * sizeof(cpu::BinnedFace)) + tables;
}

}  // namespace tetravox
