#include "src/gl/projector.h"

#include "src/support/threads.h"
#include "src/support/timer.h"

#include <algorithm>
#include <numeric>

namespace tetravox::gl {
namespace {

SortMethod method_of(CellSort sort) {
  switch (sort) {
    case CellSort::kCentroid:
      return SortMethod::kCentroid;
    case CellSort::kMpvo:
      return SortMethod::kMpvo;
    case CellSort::kMpvonc:
      return SortMethod::kMpvonc;
    case CellSort::kXmpvo:
    case CellSort::kExact:
      break;
  }
  return SortMethod::kXmpvo;
}

vec4 row_of(const Vector3& v) {
  return {static_cast<float>(v[0]), static_cast<float>(v[1]), static_cast<float>(v[2]), 0.0f};
}

/// What rasterizers have since Direct3D 11 asks it of them; some report less than they do (GL_SUBPIXEL_BITS).
constexpr int kSubpixels = 256;

}  // namespace

/// All cells, from the back to the front; for lists as they are.
std::span<const std::uint32_t> Projector::sort_cells(const ProjectionFrame& frame, ProjectionStatistics& statistics) {
  const CellSort sort = frame.settings.projection.sort;
  if (sort == CellSort::kExact) {
    if (unsorted_.empty()) {
      unsorted_.resize(mesh_.cells.size());
      std::iota(unsorted_.begin(), unsorted_.end(), 0u);
    }
    return unsorted_;
  }
  if (!sorter_) sorter_.emplace(mesh_);
  SortStatistics sorted;
  const std::span<const std::uint32_t> order = sorter_->sort(
      frame.camera, {.method = method_of(sort), .threads = frame.settings.threads}, &sorted, frame.progress);
  statistics.sort_seconds = sorted.seconds;
  statistics.cycles = sorted.cycles;
  statistics.cyclic_cells = sorted.cyclic_cells;
  statistics.broken_relations = sorted.broken_relations;
  return order;
}

void Projector::prepare_triangles(const ProjectionFrame& frame, const ProjectionShader& shader,
                                  std::span<const std::uint32_t> order, ProjectionStatistics& statistics) {
  const support::Timer timer;
  const scene::CameraFrame& seen_by = frame.seen_by;
  const ScreenView view{seen_by, kSubpixels, static_cast<float>(seen_by.eye[2])};
  if (frame.settings.projection.decomposition == Decomposition::kGpu) {
    project_mesh(frame.seen, order.size(), shader.use_outlines, view, projection_);
    find_ranges(frame.seen, cells_, order, shader.use_outlines ? 6 : 12, view, projection_);
    passes_.keep(mesh_, cells_);
    passes_.send(order);
    passes_.decompose(projection_, order.size(), shader, frame.limits, block_);
  } else {
    decompose(frame.seen, cells_, mesh_.cell_scalars, order, shader.use_outlines, view, projection_);
    passes_.send(projection_, shader.use_outlines);
  }
  statistics.cells = projection_.cells;
  statistics.cells_at_eye = projection_.cells_at_eye;
  statistics.decompose_seconds = timer.seconds();
  if (shader.use_outlines || projection_.cells_at_eye > 0) prepare_faces(frame, order, statistics);
}

void Projector::prepare_faces(const ProjectionFrame& frame, std::span<const std::uint32_t> order,
                              ProjectionStatistics& statistics) {
  const bool keeps_mesh = frame.settings.projection.transfer == MeshTransfer::kOrder;
  block_.is_ordered = keeps_mesh;
  const std::array<Vector3, 3> identity{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  const auto& axes = keeps_mesh ? frame.seen_by.axes : identity;
  block_.right = row_of(axes[0]);
  block_.up = row_of(axes[1]);
  block_.forward = row_of(axes[2]);
  if (keeps_mesh) {
    passes_.keep(mesh_, cells_);
    passes_.send(order);
  } else {
    passes_.send(frame.seen, cells_, mesh_.cell_scalars, order);
  }
  if (frame.settings.source == Source::kVicp) {
    projection_.ranges = {{true, 0, order.size()}};
    statistics.cells = order.size();
  }
}

void Projector::draw_ranges(const ProjectionShader& shader) {
  for (const ProjectedRange& range : projection_.ranges) {
    if (range.is_at_eye)
      passes_.draw_faces(shader, range.first, range.count);
    else
      passes_.draw_triangles(shader, range.first, range.count);
  }
}

/// Draws back to front, premultiplied colours over each other; how many segments.
std::uint64_t Projector::blend(const ProjectionFrame& frame, const ProjectionShader& shader) {
  passes_.set(block_);
  glNamedFramebufferTexture(target_.get(), GL_COLOR_ATTACHMENT0, frame.parts.picture().get(), 0);
  const Enabled blending(GL_BLEND);
  glBlendFunc(GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
  GLuint query = 0;
  glGenQueries(1, &query);
  glBeginQuery(GL_SAMPLES_PASSED, query);
  draw_ranges(shader);
  glEndQuery(GL_SAMPLES_PASSED);
  GLuint64 count = 0;
  glGetQueryObjectui64v(query, GL_QUERY_RESULT, &count);
  glDeleteQueries(1, &query);
  glNamedFramebufferTexture(target_.get(), GL_COLOR_ATTACHMENT0, 0, 0);
  return count;
}

void Projector::draw(const ProjectionFrame& frame, RenderStatistics& statistics) {
  const RenderSettings& settings = frame.settings;
  if (cells_.empty()) cells_ = mesh::find_cell_vertices(mesh_);
  if (!target_) {
    GLuint name = 0;
    glCreateFramebuffers(1, &name);
    target_ = FramebufferName(name);
  }
  const std::span<const std::uint32_t> order = sort_cells(frame, statistics.projection);
  support::throw_if_cancelled(frame.progress);
  const bool fills_lists = settings.projection.sort == CellSort::kExact;
  const ProjectionShader shader{frame.integrator, mesh_.association == Association::kCell,
                                frame.seen_by.is_orthographic, fills_lists,
                                settings.source == Source::kProject && settings.projection.use_pixel_correction};
  if (settings.source == Source::kVicp)
    prepare_faces(frame, order, statistics.projection);
  else
    prepare_triangles(frame, shader, order, statistics.projection);
  support::throw_if_cancelled(frame.progress);

  const support::Timer timer;
  constexpr std::array<float, 4> kNothing{};
  glClearTexImage(frame.parts.picture().get(), 0, GL_RGBA, GL_FLOAT, kNothing.data());
  glBindFramebuffer(GL_FRAMEBUFFER, target_.get());
  if (fills_lists) {
    glNamedFramebufferParameteri(target_.get(), GL_FRAMEBUFFER_DEFAULT_WIDTH, settings.width);
    glNamedFramebufferParameteri(target_.get(), GL_FRAMEBUFFER_DEFAULT_HEIGHT, settings.height);
    statistics.segments =
        lists_.resolve({frame.parts, passes_, block_, settings, shader.integrator, shader.has_cell_data, frame.limits,
                        frame.progress, [&] { draw_ranges(shader); }});
  } else {
    statistics.segments = blend(frame, shader);
  }
  statistics.projection.draw_seconds = timer.seconds();
}

std::uint64_t Projector::bytes() const {
  return cells_.capacity() * sizeof(mesh::CellVertices) + unsorted_.capacity() * sizeof(std::uint32_t) +
         (sorter_ ? sorter_->bytes() : 0) + projection_.bytes() + passes_.bytes() + lists_.bytes();
}

}  // namespace tetravox::gl
