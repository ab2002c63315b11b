#include "src/gl/march_passes.h"

#include "src/gl/march_bricks.h"
#include "src/gl/slabs.h"
#include "src/support/threads.h"

#include <algorithm>
#include <array>
#include <numeric>

namespace tetravox::gl {
namespace {

constexpr GLuint kCounterBinding = 0, kPauseBinding = 1;  // storage blocks
constexpr GLuint kPictureUnit = 0;                        // image

struct Counters {
  std::uint32_t unfinished_count = 0, waiting_count = 0, met_count = 0;
  std::array<std::uint32_t, 64> segments{};
};

std::string marcher_file(const MarchKind& kind) {
  if (kind.is_constant) return "march_constants.glsl";
  if (kind.integrator == Integrator::kPre) return kind.has_samples ? "sample_densities.glsl" : "march_densities.glsl";
  if (kind.has_samples) return "sample_scalars.glsl";
  return kind.has_cells ? "march_scalars.glsl" : "march_strides.glsl";
}

/// Of steps that are counted: what integrates each segment, or looks it up.
std::vector<IntegratorShader> run_shaders() {
  std::vector<IntegratorShader> shaders = slab_filling_shaders();
  for (const IntegratorShader& shader : all_integrator_shaders())
    if (shader.name == "partial") shaders.push_back(shader);
  shaders.push_back(slab_shader());
  return shaders;
}

std::string key_of(const MarchKind& kind) {
  std::string key = name_of(kind.integrator) + " " + kind.shader.name;
  for (const bool flag : {kind.is_uneven, kind.is_constant, kind.is_nearest, kind.has_nodes, kind.has_squares,
                          kind.is_filtered, kind.has_samples, kind.has_runs, kind.has_strides, kind.has_cells})
    key += flag ? '1' : '0';
  return key;
}

}  // namespace

ShaderRecipe recipe_of_march(const MarchKind& kind) {
  ShaderRecipe recipe{ShaderStage::kCompute, kind.has_runs ? "march_runs.comp" : "march_grid.comp", {}, {}};
  const auto define = [&](bool is_set, const char* name) {
    if (is_set) recipe.defines.emplace_back(name, "1");
  };
  define(kind.is_uneven, "IS_UNEVEN");
  define(kind.is_nearest, "IS_NEAREST");
  define(kind.has_nodes, "HAS_NODES");
  define(kind.is_filtered, "IS_FILTERED");
  define(kind.has_strides, "HAS_STRIDES");
  recipe.includes.emplace_back("marcher.glsl", marcher_file(kind));
  kind.shader.add_to(recipe);
  const char* nodes = "nodes_of_texture.glsl";
  if (kind.has_nodes) nodes = "nodes_of_buffer.glsl";
  if (kind.has_squares) nodes = "nodes_of_squares.glsl";
  if (kind.is_filtered) nodes = "nodes_of_filter.glsl";
  recipe.includes.emplace_back("nodes.glsl", nodes);
  return recipe;
}

bool takes_points(const MarchKind& kind) {
  // A fixed rate has one sample a step of post-classification.
  return kind.is_constant || (kind.has_samples && kind.integrator == Integrator::kPost) ||
         kind.integrator == Integrator::kPre;
}

std::vector<MarchKind> march_kinds() {
  std::vector<MarchKind> kinds;
  const auto add = [&](MarchKind kind) {
    if (takes_points(kind)) kind.shader = point_shader();
    kinds.push_back(kind);
  };
  const auto add_each_way = [&](MarchKind kind) {
    for (const bool has_squares : {false, true}) {
      kind.has_squares = has_squares;
      if (has_squares && kind.has_nodes) continue;
      kind.has_strides = false;
      kind.has_cells = true;
      add(kind);
      if (kind.has_samples || kind.is_uneven) continue;
      kind.has_strides = true;
      add(kind);
      kind.has_cells = false;
      add(kind);
    }
  };
  for (const bool is_uneven : {false, true}) {
    for (const bool is_nearest : {false, true}) {
      MarchKind kind;
      kind.is_uneven = is_uneven;
      kind.is_constant = true;
      kind.is_nearest = is_nearest;
      add(kind);
    }
    for (const bool has_nodes : {false, true})
      for (const bool has_samples : {false, true}) {
        MarchKind kind;
        kind.is_uneven = is_uneven;
        kind.has_nodes = has_nodes;
        kind.has_samples = has_samples;
        kind.integrator = Integrator::kPre;
        add(kind);
        for (const IntegratorShader& shader : all_integrator_shaders()) {
          if (shader.name == "cylindrical" || shader.name == "cell data") continue;
          kind.integrator = shader.name == "post" ? Integrator::kPost : Integrator::kPartial;
          kind.shader = shader;
          add_each_way(kind);
        }
        kind.integrator = Integrator::kAntiderivative;
        for (const IntegratorShader& shader : bounded_integrator_shaders()) {
          kind.shader = shader;
          if (!has_samples) add_each_way(kind);
        }
      }
  }
  for (const IntegratorShader& shader : run_shaders())
    for (const bool has_squares : {false, true}) {
      MarchKind kind;
      kind.integrator = shader.name == "partial" ? Integrator::kPartial : Integrator::kAntiderivative;
      kind.shader = shader;
      kind.has_runs = true;
      kind.has_squares = has_squares;
      kinds.push_back(kind);
    }
  MarchKind kind;
  kind.shader = slab_shader();
  kind.has_runs = kind.is_filtered = true;
  kinds.push_back(kind);
  return kinds;
}

/// Rays that need another pass, or bricks that are not there yet.
struct MarchPasses::Waiting {
  std::uint32_t for_pass = 0, for_bricks = 0;
};

MarchPasses::Waiting MarchPasses::draw_pass(const MarchFrame& frame, const MarchBlock& block,
                                            RenderStatistics& statistics) {
  block_.upload(&block, sizeof(block));
  block_.bind_uniform(kMarchBinding);
  counters_.clear_to_zero(sizeof(Counters));
  counters_.bind_storage(kCounterBinding);
  pauses_.bind_storage(kPauseBinding);
  glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT | GL_SHADER_IMAGE_ACCESS_BARRIER_BIT | GL_TEXTURE_FETCH_BARRIER_BIT);
  dispatch_pixels(frame.settings, frame.row_end - frame.row_begin);
  glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
  Counters counters;
  counters_.download(&counters, sizeof(counters));
  statistics.segments += std::accumulate(counters.segments.begin(), counters.segments.end(), std::uint64_t{0});
  statistics.rays += counters.met_count;
  support::throw_if_cancelled(frame.progress);
  return {counters.unfinished_count, counters.waiting_count};
}

void MarchPasses::draw_rows(const MarchFrame& frame, RenderStatistics& statistics) {
  MarchBlock block = frame.block;
  block.is_first_pass = 1;
  for (bool has_more = true; has_more;) {
    has_more = frame.next_bricks && frame.next_bricks();
    Waiting waiting;
    do {
      waiting = draw_pass(frame, block, statistics);
      block.is_first_pass = 0;
    } while (waiting.for_pass > 0);
    has_more = has_more && waiting.for_bricks > 0;
  }
}

void MarchPasses::draw(const MarchFrame& whole, RenderStatistics& statistics) {
  const std::string key = key_of(whole.kind);
  auto program = programs_.find(key);
  if (program == programs_.end()) {
    const ShaderRecipe recipe = recipe_of_march(whole.kind);
    program = programs_.emplace(key, make_program(std::span(&recipe, 1))).first;
  }
  const int rows = rows_of(whole.settings, kPauseBytes, whole.limits);
  counters_.reserve(sizeof(Counters));
  pauses_.reserve(static_cast<std::size_t>(rows) * static_cast<std::size_t>(whole.settings.width) * kPauseBytes);
  whole.parts.picture().bind_image(kPictureUnit, GL_WRITE_ONLY);
  for (int begin = 0; begin < whole.settings.height; begin += rows) {
    MarchFrame part = whole;
    part.row_begin = begin;
    part.row_end = std::min(begin + rows, whole.settings.height);
    whole.parts.set_rows(part.row_begin, part.row_end);
    if (whole.begin_bricks) whole.begin_bricks();
    glUseProgram(program->second.get());
    draw_rows(part, statistics);
  }
}

}  // namespace tetravox::gl
