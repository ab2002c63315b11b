#pragma once

/// What draws one kind of data with one backend: behind `Renderer`, which validates for it.

#include "src/optics/environment_filter.h"
#include "tetravox/multidimensional.h"
#include "tetravox/render.h"

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace tetravox::scene {

/// What frames are drawn with beside camera and settings.
struct FrameContext {
  const Progress& progress;
  std::span<const PreparedGrid* const> clip_volumes;  ///< one a shape of the clipping, null where it is no volume
  std::uint64_t clip_number = 0;                      ///< changes with them
  const optics::FilteredEnvironment* environment = nullptr;  ///< where the lighting has one
};

/// Draws frames of one dataset. Not safe for concurrent calls.
class FrameRenderer {
 public:
  virtual ~FrameRenderer() = default;

  /// The function is valid, and its extinctions are within what float can work with.
  virtual void set_transfer_function(const OpticalFunction& function) = 0;
  /// The same of a table, which then stands alone.
  virtual void set_table(const OpticalTable& table, const std::vector<std::size_t>& others) = 0;
  /// Colours beside the transfer function at hand.
  virtual void set_colors(std::size_t other, const OpticalFunction& colors) = 0;
  /// Whether a table or colours have been set since the last transfer function.
  virtual bool has_domain() const = 0;
  /// Draws into `image`, whose pixels are zero, and says how in `statistics` (backend, device or instruction set, what
  /// was counted). Settings and camera are valid.
  virtual void render(const Camera& camera, const RenderSettings& settings, const FrameContext& context, Image& image,
                      RenderStatistics& statistics) = 0;
  /// Bytes that the next frame needs beside what is held.
  virtual std::uint64_t missing_bytes(const RenderSettings& settings) const = 0;
  /// Bytes held for frames and tables.
  virtual std::uint64_t bytes() const = 0;
  /// Those it draws by, the usual one first.
  virtual std::vector<Source> sources() const = 0;
  /// World length of the longest ray.
  virtual double diagonal() const = 0;
};

/// Error in colour that a segment may have: a ray may err by the picture's tolerance where this many of its segments
/// err all they may.
inline float segment_tolerance(const RenderSettings& settings) {
  constexpr float kSegmentsOfTolerance = 40.0f;
  return static_cast<float>(settings.tolerance) / kSegmentsOfTolerance;
}

/// Transmittance below which rays of grids end: where errors of more than one 8-bit step are allowed, a tenth of the
/// tolerance is left out.
inline float negligible_transmittance(const RenderSettings& settings) {
  constexpr double kOneStep = 1.0 / 255.0;
  constexpr float kNegligibleOfTolerance = 0.1f;
  return settings.tolerance > kOneStep ? kNegligibleOfTolerance * static_cast<float>(settings.tolerance) : 0.0f;
}

/// Length of the diagonal of bounds.
double diagonal_of(const std::array<ValueRange, 3>& bounds);

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

}  // namespace tetravox::scene
