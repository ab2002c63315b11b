#include "src/gl/walk_passes.h"

#include "src/support/threads.h"
#include "tetravox/error.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <utility>

namespace tetravox::gl {
namespace {

constexpr GLuint kWalkBinding = 2;  // uniform block
constexpr GLuint kCounterBinding = 0, kEntryBinding = 1, kHeadBinding = 2, kPauseBinding = 3,
                 kPeeledBinding = 4;  // storage blocks
constexpr GLuint kFrontFaceUnit = 10;
constexpr GLuint kPictureUnit = 0;  // image

struct Counters {
  std::uint32_t entry_count = 0, unfinished_count = 0, entered_count = 0, stopped_count = 0;
  std::array<std::uint32_t, 64> segments{};
};
struct EntryNode {
  std::uint32_t face, next;
  float depth;
};
struct PeeledFace {
  float key;
  std::uint32_t face;
};

/// Entries a pixel that there is room for at first.
constexpr std::size_t kFirstEntries = 4;

/// Pixels of the rows at hand.
std::size_t pixels_of(const WalkFrame& frame) {
  return static_cast<std::size_t>(frame.settings.width) * static_cast<std::size_t>(frame.row_end - frame.row_begin);
}

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

std::vector<ShaderRecipe> recipe_of_peeling() {
  return {{ShaderStage::kVertex, "boundary.vert", {}, {}}, {ShaderStage::kFragment, "boundary_peel.frag", {}, {}}};
}

ShaderRecipe recipe_of_sorting() { return {ShaderStage::kCompute, "sort_lists.comp", {}, {}}; }

ShaderRecipe recipe_of_walk(const IntegratorShader& integrator, const WalkVariant& variant) {
  ShaderRecipe recipe{ShaderStage::kCompute, "walk.comp", {}, {}};
  if (variant.has_cell_data) recipe.defines.emplace_back("CELL_DATA", "1");
  if (variant.is_behind_eye) recipe.defines.emplace_back("BEHIND_EYE", "1");
  if (variant.order == EntryOrder::kPeeling) recipe.defines.emplace_back("PEELING", "1");
  integrator.add_to(recipe);
  return recipe;
}

void WalkPasses::upload(const WalkBlock& block) {
  block_.upload(&block, sizeof(block));
  block_.bind_uniform(kWalkBinding);
}

/// Makes room for a frame, and binds what all of its passes share.
void WalkPasses::prepare(const WalkFrame& frame) {
  const std::size_t pixels = pixels_of(frame);
  if (!no_attributes_) {
    GLuint names[3] = {};
    glCreateVertexArrays(1, &names[0]);
    no_attributes_ = VertexArrayName(names[0]);
    glCreateFramebuffers(2, &names[1]);
    no_target_ = FramebufferName(names[1]);
    peel_target_ = FramebufferName(names[2]);
  }
  counters_.reserve(sizeof(Counters));
  counters_.clear_to_zero(sizeof(Counters));
  counters_.bind_storage(kCounterBinding);
  pauses_.reserve(pixels * kPauseBytes);
  pauses_.bind_storage(kPauseBinding);
  entries_.reserve(sizeof(EntryNode));
  entries_.bind_storage(kEntryBinding);
  heads_.reserve(sizeof(std::uint32_t));
  heads_.bind_storage(kHeadBinding);
  frame.parts.picture().bind_image(kPictureUnit, GL_WRITE_ONLY);
  glBindVertexArray(no_attributes_.get());
}

/// Fills and sorts the lists of the pixels.
void WalkPasses::collect_entries(const WalkFrame& frame, WalkBlock& block) {
  const std::size_t pixels = pixels_of(frame);
  glNamedFramebufferParameteri(no_target_.get(), GL_FRAMEBUFFER_DEFAULT_WIDTH, frame.settings.width);
  glNamedFramebufferParameteri(no_target_.get(), GL_FRAMEBUFFER_DEFAULT_HEIGHT, frame.settings.height);
  heads_.reserve(pixels * sizeof(std::uint32_t));
  heads_.bind_storage(kHeadBinding);
  entries_.reserve(kFirstEntries * pixels * sizeof(EntryNode));
  const ProgramName& program = find_program(programs_, "lists", [] { return recipe_of_lists(); });
  for (Counters counters;;) {
    constexpr GLuint kNoEntry = 0xFFFFFFFFu;
    glClearNamedBufferData(heads_.get(), GL_R32UI, GL_RED_INTEGER, GL_UNSIGNED_INT, &kNoEntry);
    counters_.clear_to_zero(sizeof(Counters));
    entries_.bind_storage(kEntryBinding);
    block.node_count = static_cast<uint>(entries_.bytes() / sizeof(EntryNode));
    upload(block);
    glUseProgram(program.get());
    glBindFramebuffer(GL_FRAMEBUFFER, no_target_.get());
    glDrawArrays(GL_TRIANGLES, 0, static_cast<GLsizei>(6 * block.face_count));
    glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT | GL_BUFFER_UPDATE_BARRIER_BIT);
    counters_.download(&counters, sizeof(counters));
    if (counters.entry_count <= block.node_count) break;
    const std::uint64_t wanted = counters.entry_count * std::uint64_t{sizeof(EntryNode)};
    if (wanted > frame.limits.storage_bytes)
      throw Error(ErrorCode::kOutOfMemory,
                  "OpenGL: the rays of this picture enter the mesh " + std::to_string(counters.entry_count) +
                      " times, more than this device keeps: use --entry-order peeling, or draw with --backend cpu");
    entries_.reserve(wanted);
  }
  sort_entries(frame, block);
}

void WalkPasses::sort_entries(const WalkFrame& frame, WalkBlock block) {
  const ProgramName& program = find_program(programs_, "sort", [] { return std::vector{recipe_of_sorting()}; });
  for (block.sorted_run = 0;; block.sorted_run = std::max(2 * block.sorted_run, 1u)) {
    upload(block);
    counters_.clear_to_zero(sizeof(Counters));
    glUseProgram(program.get());
    dispatch_pixels(frame.settings, frame.row_end - frame.row_begin);
    glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT | GL_BUFFER_UPDATE_BARRIER_BIT);
    Counters counters;
    counters_.download(&counters, sizeof(counters));
    if (counters.stopped_count > 0)
      throw Error(ErrorCode::kUnsupported,
                  "OpenGL: rays enter the mesh more often than can be sorted in a pixel: use --entry-order peeling, or "
                  "draw with --backend cpu");
    if (counters.unfinished_count == 0) return;
    support::throw_if_cancelled(frame.progress);
  }
}

/// Finds the next face that each ray enters through.
void WalkPasses::peel_layer(const WalkFrame& frame, const WalkBlock& block) {
  const std::size_t bytes = pixels_of(frame) * sizeof(PeeledFace);
  if (block.is_first_layer) {
    front_faces_.resize(GL_R32UI, frame.settings.width, frame.settings.height);
    peel_depths_.resize(GL_DEPTH_COMPONENT32F, frame.settings.width, frame.settings.height);
    glNamedFramebufferTexture(peel_target_.get(), GL_COLOR_ATTACHMENT0, front_faces_.get(), 0);
    glNamedFramebufferTexture(peel_target_.get(), GL_DEPTH_ATTACHMENT, peel_depths_.get(), 0);
    peeled_.reserve(bytes);
    constexpr GLfloat kBeforeAll = -1.0f;
    glClearNamedBufferSubData(peeled_.get(), GL_R32F, 0, static_cast<GLsizeiptr>(bytes), GL_RED, GL_FLOAT, &kBeforeAll);
    peeled_.bind_storage(kPeeledBinding);
    front_faces_.bind_texture(kFrontFaceUnit);
  }
  upload(block);
  glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
  constexpr GLuint kNoFace[4] = {0xFFFFFFFFu};
  constexpr GLfloat kFar = 1.0f;
  glBindFramebuffer(GL_FRAMEBUFFER, peel_target_.get());
  glClearNamedFramebufferuiv(peel_target_.get(), GL_COLOR, 0, kNoFace);
  glClearNamedFramebufferfv(peel_target_.get(), GL_DEPTH, 0, &kFar);
  const Enabled depth_test(GL_DEPTH_TEST);
  glDepthFunc(GL_LESS);
  glUseProgram(find_program(programs_, "peeling", [] { return recipe_of_peeling(); }).get());
  glDrawArrays(GL_TRIANGLES, 0, static_cast<GLsizei>(6 * block.face_count));
  glMemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT);
}

/// Takes all rays from the entries at hand to their ends; how many set out.
std::uint64_t WalkPasses::walk(const WalkFrame& frame, WalkBlock& block, RenderStatistics& statistics) {
  const std::string key =
      frame.integrator.name + ", " + name_of(frame.variant.order) + (frame.variant.is_behind_eye ? ", behind" : "");
  const ProgramName& program =
      find_program(programs_, key, [&] { return std::vector{recipe_of_walk(frame.integrator, frame.variant)}; });
  std::uint64_t entered = 0;
  block.steps = pieces_a_pass(frame.integrator);
  block.is_first_pass = 1;
  for (Counters counters;;) {
    upload(block);
    counters_.clear_to_zero(sizeof(Counters));
    glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT | GL_SHADER_IMAGE_ACCESS_BARRIER_BIT);
    glUseProgram(program.get());
    dispatch_pixels(frame.settings, frame.row_end - frame.row_begin);
    glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
    counters_.download(&counters, sizeof(counters));
    statistics.segments += std::accumulate(counters.segments.begin(), counters.segments.end(), std::uint64_t{0});
    statistics.stopped_rays += counters.stopped_count;
    entered += counters.entered_count;
    block.is_first_pass = 0;
    support::throw_if_cancelled(frame.progress);
    if (counters.unfinished_count == 0) return entered;
  }
}

void WalkPasses::draw_rows(const WalkFrame& frame, RenderStatistics& statistics) {
  prepare(frame);
  glScissor(0, frame.row_begin, frame.settings.width, frame.row_end - frame.row_begin);
  WalkBlock block = frame.block;
  block.is_first_layer = 1;
  if (frame.variant.order == EntryOrder::kLists) {
    collect_entries(frame, block);
    statistics.rays += walk(frame, block, statistics);
    return;
  }
  for (bool is_any_left = true; is_any_left; block.is_first_layer = 0) {
    peel_layer(frame, block);
    const std::uint64_t entered = walk(frame, block, statistics);
    if (block.is_first_layer) statistics.rays += entered;
    is_any_left = entered > 0;
  }
}

void WalkPasses::draw(const WalkFrame& whole, RenderStatistics& statistics) {
  const int rows = rows_of(whole.settings, kPauseBytes, whole.limits);
  const Enabled scissor(GL_SCISSOR_TEST);
  for (int begin = 0; begin < whole.settings.height; begin += rows) {
    WalkFrame part = whole;
    part.row_begin = begin;
    part.row_end = std::min(begin + rows, whole.settings.height);
    whole.parts.set_rows(part.row_begin, part.row_end);
    draw_rows(part, statistics);
  }
}

std::uint64_t WalkPasses::bytes() const {
  return block_.bytes() + counters_.bytes() + entries_.bytes() + heads_.bytes() + pauses_.bytes() + peeled_.bytes() +
         front_faces_.bytes() + peel_depths_.bytes();
}

}  // namespace tetravox::gl
