#include "src/gl/frame_parts.h"
#include "src/gl/frame_renderers.h"
#include "src/gl/integrator_tables.h"
#include "src/gl/mesh_buffers.h"
#include "src/gl/projector.h"
#include "src/gl/walk_passes.h"
#include "src/mesh/edges.h"
#include "src/support/threads.h"
#include "src/support/timer.h"
#include "tetravox/error.h"

#include <algorithm>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace tetravox::gl {
namespace {

class MeshRenderer final : public scene::FrameRenderer {
 public:
  MeshRenderer(const PreparedMesh& mesh, std::shared_ptr<Context> context) : mesh_(mesh), context_(std::move(context)) {
    const auto current = context_->make_current();
    auto device = std::make_unique<Device>(mesh, context_->limits());  // freed while the context is current
    context_->require_no_error("the mesh");
    device_ = std::move(device);
  }
  ~MeshRenderer() override { free_parts(*context_, device_); }

  void set_transfer_function(const OpticalFunction& function) override {
    const auto current = context_->make_current();
    if (longest_edge_ == 0.0) longest_edge_ = mesh::find_longest_edge(mesh_);
    device_->tables.set_transfer_function(function, {{mesh_.scalar_offset, mesh_.scalar_scale},
                                                     mesh_.scalar_range,
                                                     diagonal(),
                                                     mesh_.association == Association::kCell});
    has_domain_ = false;
  }
  void set_table(const OpticalTable&, const std::vector<std::size_t>&) override { has_domain_ = true; }
  void set_colors(std::size_t, const OpticalFunction&) override { has_domain_ = true; }
  bool has_domain() const override { return has_domain_; }

  void render(const Camera& camera, const RenderSettings& settings, const scene::FrameContext& context, Image& image,
              RenderStatistics& statistics) override {
    require_supported(settings);
    if (has_domain_)
      throw Error(ErrorCode::kUnsupported,
                  "the OpenGL backend does not know functions of several variables yet: draw with --backend cpu");
    const auto current = context_->make_current();
    Device& device = *device_;
    const scene::CameraFrame frame = device.mesh.see(camera, settings.width, settings.height);
    device.frame.begin(context_->limits(), frame, mesh_.world_per_local, settings);
    device.mesh.bind();
    const support::Timer timer;
    device.tables.bind(settings, {.longest = longest_edge_}, context_->limits(), context.progress);
    statistics.plan_seconds = timer.seconds();
    const IntegratorShader integrator = device.tables.shader(settings);
    if (settings.source.value_or(Source::kWalk) == Source::kWalk)
      device.walk.draw(
          {device.mesh.describe(),
           device.frame,
           settings,
           integrator,
           {mesh_.association == Association::kCell, device.mesh.is_behind_eye(frame), settings.entry_order},
           context_->limits(),
           context.progress},
          statistics);
    else
      device.projector.draw(
          {camera, frame, device.mesh.seen(), device.frame, settings, integrator, context_->limits(), context.progress},
          statistics);
    device.frame.download(image);
    if (settings.source.value_or(Source::kWalk) != Source::kWalk) statistics.rays = count_drawn(image);
    context_->require_no_error("drawing");
    note_backend(*context_, statistics);
  }

  std::uint64_t missing_bytes(const RenderSettings& settings) const override {
    const std::uint64_t pixels =
        static_cast<std::uint64_t>(settings.width) * static_cast<std::uint64_t>(settings.height);
    constexpr std::uint64_t kPixel = 4 * sizeof(float);
    std::uint64_t on_device = pixels * kPixel;
    if (settings.source.value_or(Source::kWalk) == Source::kWalk)
      on_device += pixels * WalkPasses::kPauseBytes;
    else
      on_device += mesh_.cells.size() * Projector::kBytesACell;
    if (settings.projection.sort == CellSort::kExact) on_device += SegmentLists::kMostBytes;
    const Device& device = *device_;
    const std::uint64_t held = device.frame.bytes() + device.walk.bytes() + device.projector.bytes();
    return pixels * kPixel + on_device - std::min(on_device, held) + 2 * scene::preintegration_bytes(settings);
  }
  std::uint64_t bytes() const override {
    return device_->mesh.bytes() + device_->frame.bytes() + device_->tables.bytes() + device_->walk.bytes() +
           device_->projector.bytes();
  }
  std::vector<Source> sources() const override { return {Source::kWalk, Source::kProject, Source::kVicp}; }
  double diagonal() const override { return scene::diagonal_of(mesh_.bounds); }

 private:
  /// What lives on the device, and dies with the context current.
  struct Device {
    Device(const PreparedMesh& prepared, const Limits& limits) : mesh(prepared, limits), projector(prepared) {}
    MeshBuffers mesh;
    FrameParts frame;
    IntegratorTables tables;
    WalkPasses walk;
    Projector projector;
  };

  const PreparedMesh& mesh_;
  std::shared_ptr<Context> context_;
  std::unique_ptr<Device> device_;
  double longest_edge_ = 0.0;  // world length; 0: not known yet
  bool has_domain_ = false;
};

}  // namespace

std::unique_ptr<scene::FrameRenderer> make_mesh_renderer(const PreparedMesh& mesh, std::shared_ptr<Context> context) {
  if (mesh.cells.empty()) throw Error(ErrorCode::kNothingToDraw, "the mesh has no cells to draw");
  return std::make_unique<MeshRenderer>(mesh, std::move(context));
}

}  // namespace tetravox::gl

namespace tetravox {

Renderer make_gl_renderer(const PreparedMesh& mesh, const GlOptions& options) {
  return Renderer(gl::make_mesh_renderer(mesh, gl::Context::open(options)));
}

}  // namespace tetravox
