#pragma once

/// Frames of the sources `project` and `vicp`: cells in visibility order, projected and blended.

#include "src/gl/frame_parts.h"
#include "src/gl/mesh_buffers.h"
#include "src/gl/projection_passes.h"
#include "src/gl/segment_lists.h"
#include "tetravox/visibility.h"

#include <optional>

namespace tetravox::gl {

/// One frame; its tables are bound.
struct ProjectionFrame {
  const Camera& camera;
  const scene::CameraFrame& seen_by;  ///< the eye may have been moved
  std::span<const float> seen;        ///< vertices
  FrameParts& parts;
  const RenderSettings& settings;
  IntegratorShader integrator;
  const Limits& limits;
  const Progress& progress;
};

/// With the context current.
class Projector {
 public:
  /// Of cells, their order and what they become, here and on the device.
  static constexpr std::uint64_t kBytesACell = 144;

  explicit Projector(const PreparedMesh& mesh) : mesh_(mesh) {}

  /// Draws into the frame's picture. @throws Error: kCancelled; kOutOfMemory.
  void draw(const ProjectionFrame& frame, RenderStatistics& statistics);
  std::uint64_t bytes() const;

 private:
  std::span<const std::uint32_t> sort_cells(const ProjectionFrame& frame, ProjectionStatistics& statistics);
  void prepare_triangles(const ProjectionFrame& frame, const ProjectionShader& shader,
                         std::span<const std::uint32_t> order, ProjectionStatistics& statistics);
  void prepare_faces(const ProjectionFrame& frame, std::span<const std::uint32_t> order,
                     ProjectionStatistics& statistics);
  void draw_ranges(const ProjectionShader& shader);
  std::uint64_t blend(const ProjectionFrame& frame, const ProjectionShader& shader);

  const PreparedMesh& mesh_;
  std::vector<mesh::CellVertices> cells_;
  std::optional<VisibilitySorter> sorter_;
  std::vector<std::uint32_t> unsorted_;
  Projection projection_;
  ProjectionBlock block_{};
  ProjectionPasses passes_;
  SegmentLists lists_;
  FramebufferName target_;
};

}  // namespace tetravox::gl
