#pragma once

/// What frames of all sources have in common on the device: rays, picture, what is refused.

#include "src/gl/blocks.h"
#include "src/gl/context.h"
#include "src/gl/resources.h"
#include "src/scene/camera_frame.h"
#include "tetravox/image.h"
#include "tetravox/render.h"

#include <cstdint>
#include <vector>

namespace tetravox::gl {

/// @throws Error (kUnsupported) that names the first thing asked for that this backend cannot draw yet.
void require_supported(const RenderSettings& settings);

/// Writes down what drew a frame.
void note_backend(const Context& context, RenderStatistics& statistics);

/// Rays and picture of a frame. With the context current.
class FrameParts {
 public:
  /// @throws Error (kUnsupported) where the picture is too large for the device.
  void begin(const Limits& limits, const scene::CameraFrame& camera, double world_per_local,
             const RenderSettings& settings);
  /// Rows [begin, end) are what the next passes draw.
  void choose_rows(int begin, int end);
  /// Reads the picture back.
  void download(Image& image) const;
  const Picture& picture() const { return picture_; }
  std::uint64_t bytes() const;

 private:
  FrameBlock members_;
  Buffer block_;
  BufferTexture columns_, rows_;
  Picture picture_;
};

/// Starts one invocation a pixel of the picture, in groups of 8 x 8.
void dispatch_pixels(const RenderSettings& settings);

}  // namespace tetravox::gl
