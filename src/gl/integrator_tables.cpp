#include "src/gl/integrator_tables.h"

#include "src/optics/transparency_table.h"
#include "tetravox/error.h"

#include <cstddef>

namespace tetravox::gl {
namespace {

constexpr GLuint kControlPointUnit = 2, kFirstIntervalUnit = 3, kTableUnit = 4, kVariationUnit = 5, kMarkUnit = 11;
constexpr GLuint kTablesBinding = 1;

const IntegratorShader kCell{"cell data", "integrators/cell.glsl", {}};
const IntegratorShader kPartial{"partial", "integrators/partial.glsl", {}};
const IntegratorShader kPost{"post", "integrators/post.glsl", {}};

/// `has_coarse`: the table has places that are too coarse; `is_beyond`: scalars may lie beyond its ends.
IntegratorShader antiderivative_shader(bool has_coarse, bool is_beyond) {
  IntegratorShader shader{"antiderivative", "integrators/antiderivative.glsl", {}};
  if (has_coarse) shader.defines.emplace_back("HAS_COARSE");
  if (is_beyond) shader.defines.emplace_back("BEYOND");
  for (const std::string& define : shader.defines) shader.name += ", " + define;
  return shader;
}

}  // namespace

void IntegratorShader::add_to(ShaderRecipe& recipe) const {
  recipe.includes.emplace_back("integrator.glsl", file);
  for (const std::string& define : defines) recipe.defines.emplace_back(define, "1");
}

std::vector<IntegratorShader> all_integrator_shaders() {
  std::vector<IntegratorShader> shaders{kCell, kPartial, kPost};
  for (const bool has_coarse : {false, true})
    for (const bool is_beyond : {false, true}) shaders.push_back(antiderivative_shader(has_coarse, is_beyond));
  return shaders;
}

IntegratorShader IntegratorTables::shader(Integrator integrator, bool may_overshoot) const {
  if (is_constant_) return kCell;
  switch (integrator) {
    case Integrator::kAntiderivative:
      return antiderivative_shader(antiderivative_.has_coarse, may_overshoot || !antiderivative_.covers_data);
    case Integrator::kPartial:
      return kPartial;
    case Integrator::kPost:
      return kPost;
    default:
      break;
  }
  throw Error(ErrorCode::kUnsupported, "the OpenGL backend does not know the integrator '" + name_of(integrator) +
                                           "' yet: choose antiderivative, partial or post, or draw with --backend cpu");
}

void IntegratorTables::set_transfer_function(const OpticalFunction& function, const TableSources& sources) {
  control_points_ = optics::build_control_point_table(function, sources.map);
  is_constant_ = sources.is_constant;
  if (!is_constant_)
    optics::build_antiderivative_table(function, sources.map, sources.range, sources.longest, antiderivative_);
  has_antiderivatives_ = has_control_points_ = false;
}

void IntegratorTables::upload_antiderivatives() {
  const auto nodes = static_cast<std::size_t>(antiderivative_.last_node) + 1;
  nodes_.upload(GL_RGBA32I, antiderivative_.entries.data(), nodes * sizeof(optics::AntiderivativeTable::Node));
  variation_.upload(GL_R32F, antiderivative_.color_variation.data(), nodes * sizeof(float));
  std::vector<std::array<std::int32_t, 2>> marks(nodes + 1);
  for (std::size_t node = 0; node < nodes; ++node)
    marks[node] = {antiderivative_.is_coarse[node], antiderivative_.coarse_before[node]};
  marks[nodes][1] = antiderivative_.coarse_before[nodes];
  marks_.upload(GL_RG32I, marks.data(), marks.size() * sizeof(marks[0]));
  has_antiderivatives_ = true;
}

void IntegratorTables::upload_control_points() {
  const auto count = static_cast<std::size_t>(control_points_.interval_count);
  std::vector<std::array<float, 4>> records(3 * count);
  for (std::size_t i = 0; i < count; ++i) {
    records[3 * i] = control_points_.densities_front[i];
    records[3 * i + 1] = control_points_.slopes[i];
    records[3 * i + 2] = {control_points_.starts[i], control_points_.starts[i + 1], control_points_.references[i],
                          0.0f};
  }
  points_.upload(GL_RGBA32F, records.data(), records.size() * sizeof(records[0]));
  intervals_.upload(GL_R32I, control_points_.first_interval.data(),
                    control_points_.first_interval.size() * sizeof(std::int32_t));
  has_control_points_ = true;
}

void IntegratorTables::bind(const RenderSettings& settings, float tolerance) {
  if (!has_control_points_) upload_control_points();
  points_.bind(kControlPointUnit);
  intervals_.bind(kFirstIntervalUnit);
  const Integrator integrator = is_constant_ ? Integrator::kPost : settings.integrator;
  if (integrator == Integrator::kAntiderivative) {
    if (!has_antiderivatives_) upload_antiderivatives();
    nodes_.bind(kTableUnit);
    variation_.bind(kVariationUnit);
    marks_.bind(kMarkUnit);
  }
  if (integrator == Integrator::kPartial) {
    if (!has_absorbed_) {
      constexpr int kSide = optics::TransparencyTable::kSize + 1;
      absorbed_.resize(GL_R32F, kSide, kSide);
      glTextureSubImage2D(absorbed_.get(), 0, 0, 0, kSide, kSide, GL_RED, GL_FLOAT,
                          optics::transparency_table().absorbed.data());
      has_absorbed_ = true;
    }
    absorbed_.bind_texture(kTableUnit);
  }
  const optics::AntiderivativeTable& table = antiderivative_;
  const auto row = [](const std::array<float, 4>& v) { return vec4{v[0], v[1], v[2], v[3]}; };
  TablesBlock block{};
  block.density_below = row(table.density_below);
  block.density_above = row(table.density_above);
  block.first = table.first;
  block.nodes_per_scalar = table.nodes_per_scalar;
  block.density_per_unit = table.density_per_unit;
  block.units_per_density = table.units_per_density;
  block.largest_color_slope = table.largest_color_slope;
  block.split_threshold = 12.0f * tolerance;
  block.last_node = table.last_node;
  block.has_coarse = table.has_coarse;
  block.covers_data = table.covers_data;
  block.points_first = control_points_.first;
  block.buckets_per_scalar = control_points_.buckets_per_scalar;
  block.last_bucket = static_cast<int>(control_points_.first_interval.size()) - 1;
  block.samples = settings.samples;
  block.interval_count = control_points_.interval_count;
  block_.upload(&block, sizeof(block));
  block_.bind_uniform(kTablesBinding);
}

std::uint64_t IntegratorTables::bytes() const {
  return antiderivative_.bytes() + control_points_.bytes() + nodes_.bytes() + marks_.bytes() + variation_.bytes() +
         points_.bytes() + intervals_.bytes() + (has_absorbed_ ? absorbed_.bytes() : 0) + block_.bytes();
}

}  // namespace tetravox::gl
