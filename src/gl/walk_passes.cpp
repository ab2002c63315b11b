#include "src/gl/walk_passes.h"

#include "src/gl/integrator_tables.h"
#include "src/support/threads.h"
#include "tetravox/error.h"

#include <algorithm>
#include <array>
#include <numeric>

namespace tetravox::gl {
namespace {

constexpr GLuint kWalkBinding = 2;                                                             // uniform block
constexpr GLuint kCounterBinding = 0, kEntryBinding = 1, kHeadBinding = 2, kPauseBinding = 3;  // storage blocks
constexpr GLuint kPictureUnit = 0;                                                             // image

/// Steps of a ray in one pass: a fraction of a second on slow devices, which drivers with a watchdog allow.
constexpr int kSteps = 4096;

struct Counters {
  std::uint32_t entry_count = 0, unfinished_count = 0, entered_count = 0, stopped_count = 0;
  std::array<std::uint32_t, 64> segments{};
};
struct EntryNode {
  std::uint32_t face, next;
  float depth;
};
constexpr std::size_t kPauseBytes = 48;

template <class Find>
const ProgramName& find_program(std::map<std::string, ProgramName>& programs, const std::string& key,
                                const Find& recipes) {
  const auto found = programs.find(key);
  if (found != programs.end()) return found->second;
  return programs.emplace(key, make_program(recipes())).first->second;
}

}  // namespace

std::vector<ShaderRecipe> recipe_of_lists() {
  return {{ShaderStage::kVertex, "boundary.vert", {}, {}}, {ShaderStage::kFragment, "boundary_list.frag", {}, {}}};
}

ShaderRecipe recipe_of_sorting() { return {ShaderStage::kCompute, "sort_lists.comp", {}, {}}; }

ShaderRecipe recipe_of_walk(Integrator integrator, bool has_cell_data) {
  ShaderRecipe recipe{ShaderStage::kCompute, "walk_lists.comp", {}, {}};
  if (has_cell_data) recipe.defines.emplace_back("CELL_DATA", "1");
  recipe.includes.emplace_back("integrator.glsl", integrator_file(integrator, has_cell_data));
  return recipe;
}

void WalkPasses::upload(const WalkBlock& block) {
  block_.upload(&block, sizeof(block));
  block_.bind_uniform(kWalkBinding);
}

/// Fills the lists of the pixels; how many entries they hold.
std::uint64_t WalkPasses::collect_entries(const WalkFrame& frame, WalkBlock& block) {
  const auto pixels = static_cast<std::size_t>(frame.settings.width) * static_cast<std::size_t>(frame.settings.height);
  if (!no_attributes_) {
    GLuint name = 0;
    glCreateVertexArrays(1, &name);
    no_attributes_ = VertexArrayName(name);
    glCreateFramebuffers(1, &name);
    no_target_ = FramebufferName(name);
  }
  glNamedFramebufferParameteri(no_target_.get(), GL_FRAMEBUFFER_DEFAULT_WIDTH, frame.settings.width);
  glNamedFramebufferParameteri(no_target_.get(), GL_FRAMEBUFFER_DEFAULT_HEIGHT, frame.settings.height);
  heads_.reserve(pixels * sizeof(std::uint32_t));
  counters_.reserve(sizeof(Counters));
  entries_.reserve(4 * pixels * sizeof(EntryNode));
  const ProgramName& program = find_program(programs_, "lists", [] { return recipe_of_lists(); });
  for (;;) {
    constexpr GLuint kNoEntry = 0xFFFFFFFFu;
    glClearNamedBufferData(heads_.get(), GL_R32UI, GL_RED_INTEGER, GL_UNSIGNED_INT, &kNoEntry);
    counters_.clear_to_zero(sizeof(Counters));
    heads_.bind_storage(kHeadBinding);
    counters_.bind_storage(kCounterBinding);
    entries_.bind_storage(kEntryBinding);
    block.node_count = static_cast<uint>(entries_.bytes() / sizeof(EntryNode));
    upload(block);
    glUseProgram(program.get());
    glBindVertexArray(no_attributes_.get());
    glBindFramebuffer(GL_FRAMEBUFFER, no_target_.get());
    glDrawArrays(GL_TRIANGLES, 0, static_cast<GLsizei>(6 * block.face_count));
    glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT | GL_BUFFER_UPDATE_BARRIER_BIT);
    Counters counters;
    counters_.download(&counters, sizeof(counters));
    if (counters.entry_count <= block.node_count) return counters.entry_count;
    const std::uint64_t wanted = counters.entry_count * std::uint64_t{sizeof(EntryNode)};
    if (wanted > frame.limits.storage_bytes)
      throw Error(ErrorCode::kOutOfMemory, "OpenGL: the rays of this picture enter the mesh " +
                                               std::to_string(counters.entry_count) +
                                               " times, more than this device keeps: ask for fewer pixels, or draw "
                                               "with --backend cpu");
    entries_.reserve(wanted);
  }
}

void WalkPasses::draw(const WalkFrame& frame, RenderStatistics& statistics) {
  const auto pixels = static_cast<std::size_t>(frame.settings.width) * static_cast<std::size_t>(frame.settings.height);
  WalkBlock block = frame.block;
  collect_entries(frame, block);
  glUseProgram(find_program(programs_, "sort", [] { return std::vector{recipe_of_sorting()}; }).get());
  dispatch_pixels(frame.settings);

  const Integrator integrator = frame.settings.integrator;
  const std::string key = frame.has_cell_data ? "cells" : name_of(integrator);
  const ProgramName& program =
      find_program(programs_, key, [&] { return std::vector{recipe_of_walk(integrator, frame.has_cell_data)}; });
  pauses_.reserve(pixels * kPauseBytes);
  pauses_.bind_storage(kPauseBinding);
  frame.parts.picture().bind_image(kPictureUnit, GL_WRITE_ONLY);
  block.steps = kSteps;
  block.is_first_pass = 1;
  Counters counters;
  do {
    upload(block);
    glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT | GL_SHADER_IMAGE_ACCESS_BARRIER_BIT);
    glUseProgram(program.get());
    dispatch_pixels(frame.settings);
    glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
    counters_.download(&counters, sizeof(counters));
    statistics.segments += std::accumulate(counters.segments.begin(), counters.segments.end(), std::uint64_t{0});
    statistics.stopped_rays += counters.stopped_count;
    if (block.is_first_pass) statistics.rays = counters.entered_count;
    block.is_first_pass = 0;
    counters_.clear_to_zero(sizeof(Counters));
    support::throw_if_cancelled(frame.progress);
  } while (counters.unfinished_count > 0);
}

std::uint64_t WalkPasses::bytes() const {
  return block_.bytes() + counters_.bytes() + entries_.bytes() + heads_.bytes() + pauses_.bytes();
}

}  // namespace tetravox::gl
