#include "src/gl/segment_lists.h"

#include "src/support/threads.h"
#include "tetravox/error.h"

#include <algorithm>
#include <string>
#include <vector>

namespace tetravox::gl {
namespace {

constexpr GLuint kCounterBinding = 0, kNodeBinding = 1, kHeadBinding = 2, kPictureUnit = 0;
constexpr std::uint64_t kNodeBytes = 20;
/// Of lists, unless the device allows less.
constexpr std::uint64_t kMostBytes = std::uint64_t{1} << 28;

}  // namespace

ShaderRecipe recipe_of_resolving(const IntegratorShader& integrator, bool has_cell_data) {
  ShaderRecipe recipe{ShaderStage::kCompute, "resolve_lists.comp", {}, {}};
  if (has_cell_data) recipe.defines.emplace_back("CELL_DATA", "1");
  integrator.add_to(recipe);
  return recipe;
}

std::uint64_t SegmentLists::resolve(FrameParts& parts, const RenderSettings& settings,
                                    const IntegratorShader& integrator, bool has_cell_data, const Limits& limits,
                                    const Progress& progress, const std::function<void(std::uint32_t)>& draw) {
  if (!programs_.contains(integrator.name))
    programs_.emplace(integrator.name, make_program(std::vector{recipe_of_resolving(integrator, has_cell_data)}));
  const auto width = static_cast<std::uint64_t>(settings.width);
  const std::uint64_t room = std::min(kMostBytes, limits.storage_bytes) / kNodeBytes;
  nodes_.reserve(room * kNodeBytes);
  counters_.reserve(sizeof(std::uint32_t));
  heads_.reserve(width * static_cast<std::uint64_t>(settings.height) * sizeof(std::uint32_t));
  const Enabled scissor(GL_SCISSOR_TEST);
  std::uint64_t segments = 0;
  int rows = settings.height;
  for (int begin = 0; begin < settings.height;) {
    support::throw_if_cancelled(progress);
    const int end = std::min(settings.height, begin + rows);
    constexpr GLuint kNoNode = 0xFFFFFFFFu;
    glClearNamedBufferSubData(heads_.get(), GL_R32UI, 0,
                              static_cast<GLsizeiptr>(width * static_cast<std::uint64_t>(end - begin) * 4),
                              GL_RED_INTEGER, GL_UNSIGNED_INT, &kNoNode);
    counters_.clear_to_zero(sizeof(std::uint32_t));
    counters_.bind_storage(kCounterBinding);
    nodes_.bind_storage(kNodeBinding);
    heads_.bind_storage(kHeadBinding);
    parts.set_rows(begin, end);
    glScissor(0, begin, settings.width, end - begin);
    draw(static_cast<std::uint32_t>(room));
    glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT | GL_BUFFER_UPDATE_BARRIER_BIT);
    std::uint32_t count = 0;
    counters_.download(&count, sizeof(count));
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
    glUseProgram(programs_.at(integrator.name).get());
    parts.picture().bind_image(kPictureUnit, GL_WRITE_ONLY);
    dispatch_pixels(settings, end - begin);
    glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT | GL_BUFFER_UPDATE_BARRIER_BIT);
    begin = end;
  }
  return segments;
}

}  // namespace tetravox::gl
