#include "src/gl/frame_parts.h"
#include "src/gl/frame_renderers.h"
#include "src/gl/grid_textures.h"
#include "src/gl/integrator_tables.h"
#include "src/gl/slice_block.h"
#include "src/gl/slice_passes.h"
#include "src/grid/frame.h"
#include "src/scene/grid_view.h"
#include "tetravox/error.h"

#include <memory>
#include <optional>
#include <utility>
#include <vector>

namespace tetravox::gl {
namespace {

/// A segment's colours may err by this part of the picture's tolerance, as on the CPU.
constexpr float kSegmentsOfTolerance = 40.0f;

class GridRenderer final : public scene::FrameRenderer {
 public:
  GridRenderer(const PreparedGrid& grid, std::shared_ptr<Context> context)
      : grid_(grid), context_(std::move(context)), frame_(grid::make_grid_frame(grid.data.shape)) {
    const auto current = context_->make_current();
    device_.emplace(grid, *context_);
    context_->require_no_error("the grid");
  }
  ~GridRenderer() override {
    const auto current = context_->make_current();
    device_.reset();
  }

  void set_transfer_function(const OpticalFunction& function) override {
    device_->tables.set_transfer_function(
        function, {{grid_.scalar_offset, grid_.scalar_scale}, grid_.scalar_range, diagonal(), false});
    has_domain_ = false;
  }
  void set_table(const OpticalTable&, const std::vector<std::size_t>&) override { has_domain_ = true; }
  void set_colors(std::size_t, const OpticalFunction&) override { has_domain_ = true; }
  bool has_domain() const override { return has_domain_; }

  void render(const Camera& camera, const RenderSettings& settings, const scene::FrameContext& context, Image& image,
              RenderStatistics& statistics) override;

  std::uint64_t missing_bytes(const RenderSettings& settings) const override {
    return static_cast<std::uint64_t>(settings.width) * static_cast<std::uint64_t>(settings.height) * 4 * sizeof(float);
  }
  std::uint64_t bytes() const override {
    return device_->values.bytes() + device_->frame.bytes() + device_->tables.bytes() + device_->slices.bytes();
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
    SlicePasses slices;
  };

  const PreparedGrid& grid_;
  std::shared_ptr<Context> context_;
  grid::GridFrame frame_;
  std::optional<Device> device_;
  bool has_domain_ = false;
};

void GridRenderer::render(const Camera& camera, const RenderSettings& settings, const scene::FrameContext& context,
                          Image& image, RenderStatistics& statistics) {
  if (has_domain_)
    throw Error(ErrorCode::kUnsupported,
                "the OpenGL backend does not know functions of several variables yet: draw with --backend cpu");
  if (settings.source.value_or(Source::kMarch) != Source::kSlices)
    throw Error(ErrorCode::kUnsupported,
                "the OpenGL backend does not draw grids by march yet: choose --source slices, or --backend cpu");
  require_sliceable(grid_, settings);
  const auto current = context_->make_current();
  Device& device = *device_;
  const scene::GridView view = scene::make_grid_view(grid_, frame_, camera, settings.width, settings.height);
  device.frame.begin(context_->limits(), view.camera, view.world_per_local, settings);
  device.tables.bind(settings, static_cast<float>(settings.tolerance) / kSegmentsOfTolerance);
  device.slices.draw(
      {grid_, frame_, view, device.values, device.tables, device.frame, settings, *context_, context.progress},
      statistics);
  device.frame.download(image);
  context_->require_no_error("drawing");
  note_backend(*context_, statistics);
}

}  // namespace

std::unique_ptr<scene::FrameRenderer> make_grid_renderer(const PreparedGrid& grid, std::shared_ptr<Context> context) {
  return std::make_unique<GridRenderer>(grid, std::move(context));
}

}  // namespace tetravox::gl

namespace tetravox {

Renderer make_gl_renderer(const PreparedGrid& grid, const GlOptions& options) {
  return Renderer(gl::make_grid_renderer(grid, gl::Context::open(options)));
}

}  // namespace tetravox
