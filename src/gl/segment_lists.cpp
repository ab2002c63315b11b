#include "src/gl/segment_lists.h"

#include "src/support/threads.h"
#include "tetravox/error.h"

#include <algorithm>
#include <string>

namespace tetravox::gl {
namespace {

constexpr GLuint kCounterBinding = 0, kNodeBinding = 1, kHeadBinding = 2, kPictureUnit = 0;
constexpr std::uint64_t kNodeBytes = 20;

struct Counters {
  std::uint32_t node_count = 0, unfinished_count = 0, too_long_count = 0;
};

Counters read(const Buffer& buffer) {
  Counters counters;
  glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT | GL_BUFFER_UPDATE_BARRIER_BIT);
  buffer.download(&counters, sizeof(counters));
  return counters;
}

}  // namespace

ShaderRecipe recipe_of_segment_sorting() { return {ShaderStage::kCompute, "sort_segments.comp", {}, {}}; }

ShaderRecipe recipe_of_resolving(const IntegratorShader& integrator, bool has_cell_data) {
  ShaderRecipe recipe{ShaderStage::kCompute, "resolve_lists.comp", {}, {}};
  if (has_cell_data) recipe.defines.emplace_back("CELL_DATA", "1");
  integrator.add_to(recipe);
  return recipe;
}

const ProgramName& SegmentLists::find_program(const std::string& key, const ShaderRecipe& recipe) {
  const auto found = programs_.find(key);
  if (found != programs_.end()) return found->second;
  return programs_.emplace(key, make_program(std::span(&recipe, 1))).first->second;
}

/// Empties the lists of so many rows, and binds them.
void SegmentLists::clear(const ListFrame& frame, int rows) {
  constexpr GLuint kNoNode = 0xFFFFFFFFu;
  const auto pixels = static_cast<std::uint64_t>(frame.settings.width) * static_cast<std::uint64_t>(rows);
  glClearNamedBufferSubData(heads_.get(), GL_R32UI, 0, static_cast<GLsizeiptr>(pixels * sizeof(std::uint32_t)),
                            GL_RED_INTEGER, GL_UNSIGNED_INT, &kNoNode);
  counters_.clear_to_zero(sizeof(Counters));
  counters_.bind_storage(kCounterBinding);
  nodes_.bind_storage(kNodeBinding);
  heads_.bind_storage(kHeadBinding);
}

void SegmentLists::sort(const ListFrame& frame, int rows) {
  ProjectionBlock block = frame.block;
  for (block.sorted_run = 0;; block.sorted_run = std::max(2 * block.sorted_run, 1u)) {
    counters_.clear_to_zero(sizeof(Counters));
    frame.passes.set(block);
    glUseProgram(find_program("sort", recipe_of_segment_sorting()).get());
    dispatch_pixels(frame.settings, rows);
    const Counters counters = read(counters_);
    if (counters.too_long_count > 0)
      throw Error(ErrorCode::kUnsupported,
                  "OpenGL: rays pass more cells than can be sorted in a pixel: ask for another --sort than exact, or "
                  "draw with --backend cpu");
    if (counters.unfinished_count == 0) return;
    support::throw_if_cancelled(frame.progress);
  }
}

void SegmentLists::composite(const ListFrame& frame, int rows) {
  ProjectionBlock block = frame.block;
  block.segments_a_pass = pieces_a_pass(frame.integrator);
  for (block.is_first_pass = 1;; block.is_first_pass = 0) {
    counters_.clear_to_zero(sizeof(Counters));
    frame.passes.set(block);
    const std::string key = "resolve " + frame.integrator.name;
    glUseProgram(find_program(key, recipe_of_resolving(frame.integrator, frame.has_cell_data)).get());
    frame.parts.picture().bind_image(kPictureUnit, GL_READ_WRITE);
    glMemoryBarrier(GL_SHADER_IMAGE_ACCESS_BARRIER_BIT);
    dispatch_pixels(frame.settings, rows);
    if (read(counters_).unfinished_count == 0) return;
    support::throw_if_cancelled(frame.progress);
  }
}

std::uint64_t SegmentLists::resolve(const ListFrame& frame) {
  const RenderSettings& settings = frame.settings;
  const std::uint64_t room = std::min(kMostBytes, frame.limits.storage_bytes) / kNodeBytes;
  nodes_.reserve(room * kNodeBytes);
  counters_.reserve(sizeof(Counters));
  int rows = rows_of(settings, sizeof(std::uint32_t), frame.limits);
  heads_.reserve(static_cast<std::uint64_t>(settings.width) * static_cast<std::uint64_t>(rows) * sizeof(std::uint32_t));
  ListFrame band = frame;
  band.block.node_count = static_cast<uint>(room);
  const Enabled scissor(GL_SCISSOR_TEST);
  std::uint64_t segments = 0;
  for (int begin = 0; begin < settings.height;) {
    support::throw_if_cancelled(frame.progress);
    const int end = std::min(settings.height, begin + rows);
    clear(band, end - begin);
    frame.parts.set_rows(begin, end);
    glScissor(0, begin, settings.width, end - begin);
    frame.passes.set(band.block);
    frame.draw();
    const std::uint32_t count = read(counters_).node_count;
    if (count > room) {
      if (end - begin == 1)
        throw Error(ErrorCode::kOutOfMemory,
                    "OpenGL: a row of this picture passes " + std::to_string(count) +
                        " cells, more than this device keeps: ask for fewer pixels, or for another --sort than exact");
      // As high as will fit, were all rows alike, and a bit less.
      rows = std::clamp(static_cast<int>(0.9 * static_cast<double>(room) / count * (end - begin)), 1, end - begin - 1);
      continue;
    }
    segments += count;
    sort(band, end - begin);
    composite(band, end - begin);
    begin = end;
  }
  return segments;
}

}  // namespace tetravox::gl
