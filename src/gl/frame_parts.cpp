#include "src/gl/frame_parts.h"

#include "tetravox/error.h"

#include <algorithm>
#include <string>
#include <utility>

namespace tetravox::gl {
namespace {

constexpr GLuint kFrameBinding = 0, kColumnUnit = 0, kRowUnit = 1;
constexpr std::size_t kBytesAtOnce = std::size_t{1} << 28;

}  // namespace

void require_supported(const RenderSettings& settings) {
  // An iso-surface is lit: it is what was asked for.
  const std::pair<bool, const char*> unknown[] = {
      {!settings.surfaces.empty(), "iso-surfaces"},
      {settings.lighting.is_lit(), "light"},
      {!settings.clipping.shapes.empty(), "clipping"},
      {settings.opacity_weight != OpacityWeight::kNone, "opacity weights"},
      {settings.wants_depth, "depths"},
  };
  const bool is_projected = settings.source == Source::kProject || settings.source == Source::kVicp;
  for (const auto& [is_asked, name] : unknown)
    if (is_asked)
      throw Error(ErrorCode::kUnsupported, "the OpenGL backend does not draw " + std::string(name) +
                                               " here yet: draw with --backend cpu" +
                                               (is_projected ? " --source walk" : ""));
}

void note_backend(const Context& context, RenderStatistics& statistics) {
  statistics.backend = "gl";
  statistics.device = context.device().name;
}

void FrameParts::begin(const Limits& limits, const scene::CameraFrame& camera, double world_per_local,
                       const RenderSettings& settings) {
  if (settings.width > limits.texture_size || settings.height > limits.texture_size)
    throw Error(ErrorCode::kUnsupported, "OpenGL: this device draws pictures of at most " +
                                             std::to_string(limits.texture_size) + " pixels a side: ask for fewer, " +
                                             "or draw with --backend cpu");
  const scene::Rays rays = scene::make_rays(camera, world_per_local);
  const auto upload = [](const std::vector<float>& offsets, const std::vector<float>& slopes, int count,
                         BufferTexture& texture) {
    std::vector<float> pairs;
    for (int i = 0; i < count; ++i) pairs.insert(pairs.end(), {offsets[i], slopes[i]});
    texture.upload(GL_RG32F, pairs.data(), pairs.size() * sizeof(float));
  };
  upload(rays.column_offset, rays.column_slope, settings.width, columns_);
  upload(rays.row_offset, rays.row_slope, settings.height, rows_);
  FrameBlock& block = frame_;
  block = {};
  block.width = settings.width;
  block.height = settings.height;
  block.row_end = settings.height;
  block.z_near = rays.grid.z_near;
  block.world_per_local = rays.grid.world_per_local;
  block.eye_x = static_cast<float>(camera.eye[0]);
  block.eye_y = static_cast<float>(camera.eye[1]);
  block.eye_z = static_cast<float>(camera.eye[2]);
  block.pixel_step = static_cast<float>(camera.pixel_step);
  block.is_orthographic = camera.is_orthographic;
  block.use_early_ray_termination = settings.use_early_ray_termination;
  set_rows(0, settings.height);
  columns_.bind(kColumnUnit);
  rows_.bind(kRowUnit);
  picture_.resize(GL_RGBA32F, settings.width, settings.height);
  glViewport(0, 0, settings.width, settings.height);
}

void FrameParts::set_rows(int begin, int end) {
  frame_.row_begin = begin;
  frame_.row_end = end;
  block_.upload(&frame_, sizeof(frame_));
  block_.bind_uniform(kFrameBinding);
}

void FrameParts::download(Image& image) const {
  glMemoryBarrier(GL_TEXTURE_UPDATE_BARRIER_BIT | GL_FRAMEBUFFER_BARRIER_BIT);
  // In parts: their sizes in bytes are 32-bit numbers.
  const std::size_t row = 4 * static_cast<std::size_t>(frame_.width);
  const int rows = static_cast<int>(kBytesAtOnce / (row * sizeof(float)));
  for (int begin = 0; begin < frame_.height; begin += rows) {
    const int count = std::min(rows, frame_.height - begin);
    glGetTextureSubImage(picture_.get(), 0, 0, begin, 0, frame_.width, count, 1, GL_RGBA, GL_FLOAT,
                         static_cast<GLsizei>(static_cast<std::size_t>(count) * row * sizeof(float)),
                         image.pixels.data() + static_cast<std::size_t>(begin) * row);
  }
}

std::uint64_t FrameParts::bytes() const {
  return block_.bytes() + columns_.bytes() + rows_.bytes() + (picture_.get() ? picture_.bytes() : 0);
}

std::uint64_t count_drawn(const Image& image) {
  std::uint64_t count = 0;
  for (std::size_t i = 3; i < image.pixels.size(); i += 4) count += image.pixels[i] > 0.0f;
  return count;
}

void dispatch_pixels(const RenderSettings& settings, int rows) {
  glDispatchCompute(static_cast<GLuint>(settings.width + 7) / 8, static_cast<GLuint>(rows + 7) / 8, 1);
}

int rows_of(const RenderSettings& settings, std::uint64_t bytes_a_pixel, const Limits& limits) {
  const std::uint64_t rows = limits.storage_bytes / (bytes_a_pixel * static_cast<std::uint64_t>(settings.width));
  return static_cast<int>(std::clamp<std::uint64_t>(rows, 1, static_cast<std::uint64_t>(settings.height)));
}

}  // namespace tetravox::gl
