#include "src/gl/table_maker.h"

#include "src/optics/cylindrical_atlas.h"
#include "src/optics/polynomial_table.h"
#include "src/optics/preintegration_table.h"
#include "src/support/threads.h"
#include "tetravox/error.h"

#include <algorithm>
#include <array>
#include <utility>

namespace tetravox::gl {
namespace {

// Units and bindings that frames leave alone.
constexpr GLuint kMakerBinding = 8, kNodeUnit = 12, kBeforeUnit = 13, kOtherUnit = 14, kWeightUnit = 15;
constexpr int kNodes = 4096;          // of the function
constexpr int kStepsAPass = 32;       // so that no pass takes long
constexpr int kMostCoefficients = 4;  // beside the one of thin segments

enum Mode { kIntegrals, kDensities, kColors };  // of steps.frag

ShaderRecipe fragment(const std::string& file, bool is_atlas) {
  ShaderRecipe recipe{ShaderStage::kFragment, file, {}, {}};
  if (is_atlas) recipe.defines.emplace_back("ATLAS", "1");
  return recipe;
}

/// Extinction and colour at equal distances over the table's scalars. There is colour where nothing is seen, too: it
/// mixes with that beside it.
std::vector<std::array<float, 4>> sample_function(const optics::PreintegrationSource& source) {
  const optics::ControlPointTable points = optics::build_control_point_table(source.function, source.map);
  OpticalFunction opaque = source.function;
  for (OpticalPoint& point : opaque.points) point.extinction = 1.0;
  const optics::ControlPointTable colors = optics::build_control_point_table(opaque, source.map);
  const ValueRange range = optics::find_table_range(source);
  std::vector<std::array<float, 4>> nodes(kNodes);
  for (int i = 0; i < kNodes; ++i) {
    const double value = range.min + (range.max - range.min) * i / (kNodes - 1);
    const float stored = source.map.stored_from_value(value);
    nodes[i] = optics::eval_densities(colors, stored);
    nodes[i][0] = optics::eval_densities(points, stored)[0];
  }
  return nodes;
}

}  // namespace

void require_table_size(const RenderSettings& settings, const Limits& limits) {
  const PreintegrationSettings& table = settings.preintegration;
  int side = table.scalars, limit = limits.texture_size;
  if (settings.integrator == Integrator::kTable3d) {
    side = std::max(table.scalars, table.lengths);
    limit = limits.volume_size;
  } else if (settings.integrator == Integrator::kCylindrical) {
    side = optics::count_atlas_columns(table.planes) * table.tile;  // no fewer than rows
  }
  if (side > limit)
    throw Error(ErrorCode::kUnsupported, "OpenGL: this device holds tables of at most " + std::to_string(limit) +
                                             " entries a side, and this one has " + std::to_string(side) +
                                             ": ask for fewer (--preintegration-size, --preintegration-planes)");
}

PreintegrationBlock describe_domain(const optics::SegmentDomain& domain) {
  PreintegrationBlock block{};
  block.first_scalar = domain.first;
  block.places_per_scalar = domain.per_scalar;
  block.longest = domain.longest;
  block.largest_extinction = domain.largest_extinction;
  return block;
}

TextureName make_table_texture(GLenum target) {
  GLuint name = 0;
  glCreateTextures(target, 1, &name);
  glTextureParameteri(name, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
  glTextureParameteri(name, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
  for (const GLenum side : {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T, GL_TEXTURE_WRAP_R})
    glTextureParameteri(name, side, GL_CLAMP_TO_EDGE);
  return TextureName(name);
}

std::vector<std::pair<std::string, std::vector<ShaderRecipe>>> recipes_of_tables() {
  std::vector<std::pair<std::string, std::vector<ShaderRecipe>>> recipes;
  const ShaderRecipe fill{ShaderStage::kVertex, "tables/fill.vert", {}, {}};
  for (const bool is_atlas : {false, true})
    for (const std::string file : {"steps", "quotient"})
      recipes.emplace_back(file + (is_atlas ? " atlas" : ""),
                           std::vector{fill, fragment("tables/" + file + ".frag", is_atlas)});
  for (const std::string file : {"thin_map", "fit_maps"})
    recipes.emplace_back(file, std::vector{fill, fragment("tables/" + file + ".frag", false)});
  return recipes;
}

void TableMaker::begin(const optics::PreintegrationSource& source, const PreintegrationSettings& settings, int width,
                       int height) {
  if (!no_attributes_) {
    GLuint name = 0;
    glCreateVertexArrays(1, &name);
    no_attributes_ = VertexArrayName(name);
    glCreateFramebuffers(1, &name);
    target_ = FramebufferName(name);
  }
  const std::vector<std::array<float, 4>> nodes = sample_function(source);
  nodes_.upload(GL_RGBA32F, nodes.data(), nodes.size() * sizeof(nodes[0]));
  nodes_.bind(kNodeUnit);
  const optics::SegmentDomain domain = optics::make_segment_domain(source);
  maker_ = {};
  maker_.scalar_count = settings.scalars;
  maker_.longest_length = domain.longest;
  maker_.most_extinction = std::max(domain.largest_extinction, 1e-30f);
  maker_.step_count = settings.steps;
  maker_.most_number = settings.bits < 32 ? (1 << settings.bits) - 1 : 0;
  maker_.node_count = kNodes;
  width_ = width;
  height_ = height;
  for (Picture& sum : sums_) sum.resize(GL_RGBA32F, width, height);
  glBindVertexArray(no_attributes_.get());
  glBindFramebuffer(GL_FRAMEBUFFER, target_.get());
  glViewport(0, 0, width, height);
}

/// Draws over everything that is attached.
void TableMaker::fill(const std::string& name) {
  const auto found = programs_.find(name);
  if (found == programs_.end())
    for (const auto& [key, stages] : recipes_of_tables())
      if (key == name) programs_.emplace(key, make_program(stages));
  block_.upload(&maker_, sizeof(maker_));
  block_.bind_uniform(kMakerBinding);
  glUseProgram(programs_.at(name).get());
  glDrawArrays(GL_TRIANGLES, 0, 3);
}

void TableMaker::attach(GLuint texture, int layer, GLenum attachment) {
  if (layer < 0)
    glNamedFramebufferTexture(target_.get(), attachment, texture, 0);
  else
    glNamedFramebufferTextureLayer(target_.get(), attachment, texture, 0, layer);
}

/// All steps of a slice; the picture that holds them is bound as the one before. `result`: of the last pass.
const Picture& TableMaker::integrate(float share, int mode, Picture* result) {
  maker_.share = share;
  maker_.mode = mode;
  int last = 0;
  for (int begin = 0; begin < maker_.step_count; begin += kStepsAPass) {
    const bool is_last = begin + kStepsAPass >= maker_.step_count;
    maker_.step_begin = begin;
    maker_.step_end = std::min(begin + kStepsAPass, maker_.step_count);
    last = 1 - last;
    const Picture& target = is_last && result ? *result : sums_[last];
    sums_[1 - last].bind_texture(kBeforeUnit);
    attach(target.get(), -1, GL_COLOR_ATTACHMENT0);
    fill("steps" + variant_);
  }
  const Picture& done = result ? *result : sums_[last];
  done.bind_texture(kBeforeUnit);
  return done;
}

void TableMaker::make_slices(const optics::PreintegrationSource& source, const PreintegrationSettings& settings,
                             DeviceTable& table) {
  glTextureStorage3D(table.table.get(), 1, GL_RGBA32F, settings.scalars, settings.scalars, settings.lengths);
  for (int slice = 0; slice < settings.lengths; ++slice) {
    const double place = static_cast<double>(slice) / (settings.lengths - 1);
    integrate(static_cast<float>(optics::share_of_length_place(settings.length_spacing, place)), kIntegrals);
    attach(table.table.get(), slice, GL_COLOR_ATTACHMENT0);
    fill("quotient");
    support::throw_if_cancelled(source.progress);
  }
  table.block.scalars = settings.scalars;
  table.block.lengths = settings.lengths;
  table.block.is_logarithmic = settings.length_spacing == LengthSpacing::kLogarithmic;
  table.bytes = optics::preintegration_table_bytes(settings.scalars, settings.lengths);
}

/// Their bits depend on what is least and largest in each map, which is known only now.
void TableMaker::store_maps(const PreintegrationSettings& settings, const DeviceTable& table) const {
  const int scalars = settings.scalars, maps = settings.degree + 1;
  std::vector<float> numbers(4 * static_cast<std::size_t>(maps) * static_cast<std::size_t>(scalars) *
                             static_cast<std::size_t>(scalars));
  glGetTextureImage(table.table.get(), 0, GL_RGBA, GL_FLOAT, static_cast<GLsizei>(numbers.size() * sizeof(float)),
                    numbers.data());
  optics::store_maps_in_bits(settings.bits, static_cast<double>(maker_.most_extinction), scalars, numbers);
  glTextureSubImage3D(table.table.get(), 0, 0, 0, 0, scalars, scalars, maps, GL_RGBA, GL_FLOAT, numbers.data());
}

void TableMaker::make_maps(const optics::PreintegrationSource& source, const PreintegrationSettings& settings,
                           DeviceTable& table) {
  const int scalars = settings.scalars, degree = settings.degree;
  glTextureStorage3D(table.table.get(), 1, GL_RGBA32F, scalars, scalars, degree + 1);
  for (Picture* thin : {&densities_, &colors_}) thin->resize(GL_RGBA32F, scalars, scalars);
  integrate(0.0f, kColors, &colors_);
  integrate(0.0f, kDensities, &densities_);
  colors_.bind_texture(kOtherUnit);
  attach(table.table.get(), 0, GL_COLOR_ATTACHMENT0);
  fill("thin_map");

  // Map 0 is read while the others are blended into.
  colors_.resize(GL_RGBA32F, scalars, scalars);
  glCopyImageSubData(table.table.get(), GL_TEXTURE_2D_ARRAY, 0, 0, 0, 0, colors_.get(), GL_TEXTURE_2D, 0, 0, 0, 0,
                     scalars, scalars, 1);
  constexpr std::array<float, 4> kNothing{};
  for (int map = 1; map <= degree; ++map)
    glClearTexSubImage(table.table.get(), 0, 0, 0, map, scalars, scalars, 1, GL_RGBA, GL_FLOAT, kNothing.data());
  const optics::PolynomialFit fit = optics::make_polynomial_fit(degree);
  for (std::size_t k = 0; k < fit.places.size(); ++k) {
    integrate(static_cast<float>(fit.places[k]), kIntegrals);
    std::array<float, kMostCoefficients> weights{};
    std::array<GLenum, kMostCoefficients> targets{};
    for (int i = 0; i < degree; ++i) {
      weights[i] = static_cast<float>(fit.weights[i][k]);
      targets[i] = GL_COLOR_ATTACHMENT0 + static_cast<GLenum>(i);
      attach(table.table.get(), i + 1, targets[i]);
    }
    weights_.upload(GL_RGBA32F, weights.data(), sizeof(weights));
    weights_.bind(kWeightUnit);
    colors_.bind_texture(kOtherUnit);
    glNamedFramebufferDrawBuffers(target_.get(), degree, targets.data());
    {
      const Enabled blending(GL_BLEND);
      glBlendFunc(GL_ONE, GL_ONE);
      fill("fit_maps");
    }
    for (int i = 1; i < degree; ++i) attach(0, -1, targets[i]);
    glNamedFramebufferDrawBuffer(target_.get(), GL_COLOR_ATTACHMENT0);
    support::throw_if_cancelled(source.progress);
  }
  if (settings.bits < 32) store_maps(settings, table);
  const std::vector<float> ratios = optics::make_absorbed_ratios(settings.bits);
  table.ratios = make_table_texture(GL_TEXTURE_2D);
  glTextureStorage2D(table.ratios.get(), 1, GL_R32F, static_cast<GLsizei>(ratios.size()), 1);
  glTextureSubImage2D(table.ratios.get(), 0, 0, 0, static_cast<GLsizei>(ratios.size()), 1, GL_RED, GL_FLOAT,
                      ratios.data());
  table.block.scalars = scalars;
  table.bytes = optics::polynomial_table_bytes(scalars, degree);
}

void TableMaker::make_atlas(DeviceTable& table) {
  glTextureStorage2D(table.table.get(), 1, GL_RGBA32F, width_, height_);
  integrate(1.0f, kIntegrals);
  attach(table.table.get(), -1, GL_COLOR_ATTACHMENT0);
  fill("quotient" + variant_);
  table.block.planes = maker_.plane_count;
  table.block.tile = maker_.tile_size;
  table.block.columns = maker_.column_count;
  table.block.rows = height_ / maker_.tile_size;
  table.bytes = static_cast<std::uint64_t>(width_) * static_cast<std::uint64_t>(height_) * 4 * sizeof(float);
}

DeviceTable TableMaker::make(const optics::PreintegrationSource& source, const RenderSettings& settings) {
  const PreintegrationSettings& asked = settings.preintegration;
  std::array<GLint, 4> viewport{};
  glGetIntegerv(GL_VIEWPORT, viewport.data());
  DeviceTable table;
  table.block = describe_domain(optics::make_segment_domain(source));
  variant_ = settings.integrator == Integrator::kCylindrical ? " atlas" : "";
  if (settings.integrator == Integrator::kTable3d) {
    begin(source, asked, asked.scalars, asked.scalars);
    table.table = make_table_texture(GL_TEXTURE_3D);
    make_slices(source, asked, table);
  } else if (settings.integrator == Integrator::kPolynomial) {
    begin(source, asked, asked.scalars, asked.scalars);
    table.table = make_table_texture(GL_TEXTURE_2D_ARRAY);
    make_maps(source, asked, table);
  } else {
    const int columns = optics::count_atlas_columns(asked.planes), rows = (asked.planes + columns - 1) / columns;
    begin(source, asked, columns * asked.tile, rows * asked.tile);
    maker_.plane_count = asked.planes;
    maker_.tile_size = asked.tile;
    maker_.column_count = columns;
    table.table = make_table_texture(GL_TEXTURE_2D);
    make_atlas(table);
  }
  glBindFramebuffer(GL_FRAMEBUFFER, 0);
  glViewport(viewport[0], viewport[1], viewport[2], viewport[3]);
  return table;
}

}  // namespace tetravox::gl
