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
  /// The rows that passes draw from now on, a part of the picture at a time: what they keep for each pixel must not
  /// exceed what a device allows for a buffer. `begin` sets all.
  void set_rows(int begin, int end);
  /// Reads the picture back.
  void download(Image& image) const;
  const Picture& picture() const { return picture_; }
  std::uint64_t bytes() const;

 private:
  FrameBlock frame_{};
  Buffer block_;
  BufferTexture columns_, rows_;
  Picture picture_;
};

/// Pixels that anything was drawn into: rays, for sources that do not count them.
std::uint64_t count_drawn(const Image& image);

/// Starts one invocation a pixel of so many rows, in groups of 8 x 8.
void dispatch_pixels(const RenderSettings& settings, int rows);

/// Rows of a picture for which a buffer with that many bytes a pixel can be had.
int rows_of(const RenderSettings& settings, std::uint64_t bytes_a_pixel, const Limits& limits);

}  // namespace tetravox::gl
