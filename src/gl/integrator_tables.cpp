#include "src/gl/integrator_tables.h"

#include "src/optics/iso_value_table.h"
#include "src/optics/transparency_table.h"
#include "src/scene/frame_renderer.h"
#include "tetravox/error.h"

#include <algorithm>
#include <bit>
#include <cstddef>

namespace tetravox::gl {
namespace {

constexpr GLuint kControlPointUnit = 2, kFirstIntervalUnit = 3, kTableUnit = 4, kVariationUnit = 5, kMarkUnit = 11;
constexpr GLuint kTablesBinding = 1;

/// Samples that post-classification takes a piece: as integrators/post.glsl has it.
constexpr int kSamplesAPiece = 16;

const IntegratorShader kCell{"cell data", "integrators/cell.glsl", {}};
const IntegratorShader kPartial{"partial", "integrators/partial.glsl", {{"ISO_VALUES", "1"}}};
const IntegratorShader kTable3d{"table3d", "integrators/table3d.glsl", {}};
const IntegratorShader kCylindrical{"cylindrical", "integrators/cylindrical.glsl", {}};
const IntegratorShader kPost{"post", "integrators/post.glsl", {}};

/// `has_coarse`: the table has places that are too coarse; `is_beyond`: scalars may lie beyond its ends.
IntegratorShader antiderivative_shader(bool has_coarse, bool is_beyond) {
  IntegratorShader shader{"antiderivative", "integrators/antiderivative.glsl", {}};
  if (has_coarse) shader.defines.emplace_back("HAS_COARSE", "1");
  if (is_beyond) shader.defines.emplace_back("BEYOND", "1");
  for (const auto& [name, value] : shader.defines) shader.name += ", " + name;
  return shader;
}

/// `is_whole`: no segment needs to be cut; `is_thin`: none is optically thicker than `kThin`.
IntegratorShader gentle_shader(bool is_whole, bool is_thin) {
  IntegratorShader shader{"gentle", "integrators/gentle.glsl", {}};
  if (is_whole) shader.defines.emplace_back("IS_WHOLE", "1");
  if (is_thin) shader.defines.emplace_back("IS_THIN", "1");
  for (const auto& [name, value] : shader.defines) shader.name += ", " + name;
  return shader;
}
constexpr double kThin = 0.25;

IntegratorShader polynomial_shader(int degree, OpacityModel opacity) {
  const std::string number = std::to_string(degree);
  IntegratorShader shader{"polynomial=" + number, "integrators/polynomial.glsl", {{"DEGREE", number}}};
  if (opacity == OpacityModel::kExponential) return shader;
  shader.name += ", linear";
  shader.defines.emplace_back("LINEAR_OPACITY", "1");
  return shader;
}

/// Halvings until the interval of a scalar is found, at most: as find_interval of control_points.glsl goes.
int count_probes(const optics::ControlPointTable& points) {
  const auto& first = points.first_interval;
  unsigned most = 0;
  for (std::size_t i = 0; i < first.size(); ++i) {
    const std::int32_t high = i + 2 < first.size() ? first[i + 2] : points.interval_count - 1;
    most = std::max(most, static_cast<unsigned>(high - first[i]));
  }
  return static_cast<int>(std::bit_width(most));
}

}  // namespace

int pieces_a_pass(const IntegratorShader& shader) {
  constexpr int kIterations = 24000;  // the last piece or segment begun is finished
  return kIterations / shader.loops;
}

void IntegratorShader::add_to(ShaderRecipe& recipe) const {
  recipe.includes.emplace_back("integrator.glsl", file);
  recipe.defines.insert(recipe.defines.end(), defines.begin(), defines.end());
}

std::vector<IntegratorShader> all_integrator_shaders() {
  std::vector<IntegratorShader> shaders{kCell, kPartial, kPost, kTable3d, kCylindrical};
  for (const bool has_coarse : {false, true})
    for (const bool is_beyond : {false, true}) shaders.push_back(antiderivative_shader(has_coarse, is_beyond));
  for (int degree = 0; degree <= kLargestDegree; ++degree)
    for (const OpacityModel opacity : {OpacityModel::kExponential, OpacityModel::kLinear})
      shaders.push_back(polynomial_shader(degree, opacity));
  return shaders;
}

std::vector<IntegratorShader> bounded_integrator_shaders() {
  return {gentle_shader(false, false), gentle_shader(false, true), gentle_shader(true, false),
          gentle_shader(true, true)};
}

IntegratorShader point_shader() { return kCell; }

IntegratorShader IntegratorTables::points() const {
  IntegratorShader shader = kCell;
  shader.loops = std::max(shader.loops, 2 + probes_);
  return shader;
}

IntegratorShader IntegratorTables::shader(const RenderSettings& settings) const {
  if (sources_.is_constant) return points();
  switch (settings.integrator) {
    case Integrator::kAntiderivative:
      if (segments_.is_gentle && !is_beyond_)
        return gentle_shader(segments_.error <= split_threshold_, segments_.depth <= kThin);
      return antiderivative_shader(antiderivative_.has_coarse, is_beyond_);
    case Integrator::kPartial:
      return kPartial;
    case Integrator::kPost: {
      IntegratorShader shader = kPost;
      shader.loops += std::min(settings.samples, kSamplesAPiece) * (1 + std::max(probes_, 2));
      return shader;
    }
    case Integrator::kTable3d:
      return kTable3d;
    case Integrator::kPolynomial:
      return polynomial_shader(settings.preintegration.degree, settings.preintegration.opacity);
    case Integrator::kCylindrical:
      return kCylindrical;
    case Integrator::kPre:
      break;
  }
  throw Error(ErrorCode::kUnsupported, "the integrator 'pre' is for grids: choose another (tetravox list methods)");
}

double IntegratorTables::color_change(float min, float max) const {
  const optics::AntiderivativeTable& table = antiderivative_;
  const auto node_of = [&](float scalar, double rounding) {
    const double at = (static_cast<double>(scalar) - table.first) * table.nodes_per_scalar + rounding;
    return static_cast<std::size_t>(std::clamp(at, 0.0, static_cast<double>(table.last_node)));
  };
  // As far as intervals beside it reach.
  const double change = table.color_variation[node_of(max, 2.0)] - table.color_variation[node_of(min, -1.0)];
  return std::min(change, 1.0);
}

void IntegratorTables::set_transfer_function(const OpticalFunction& function, const TableSources& sources) {
  control_points_ = optics::build_control_point_table(function, sources.map);
  probes_ = count_probes(control_points_);
  function_ = function;
  sources_ = sources;
  preintegration_.invalidate();
  ray_integrals_.invalidate();
  if (!sources_.is_constant)
    optics::build_antiderivative_table(function, sources.map, sources.range, sources.longest, antiderivative_);
  has_antiderivatives_ = has_control_points_ = has_iso_values_ = false;
}

void IntegratorTables::upload_antiderivatives() {
  const auto nodes = static_cast<std::size_t>(antiderivative_.last_node) + 1;
  nodes_.upload(GL_RGBA32I, antiderivative_.entries.data(), nodes * sizeof(optics::AntiderivativeTable::Node));
  variation_.upload(GL_R32F, antiderivative_.color_variation.data(), nodes * sizeof(float));
  std::vector<std::int32_t> marks(nodes);
  for (std::size_t node = 0; node < nodes; ++node)
    marks[node] = 2 * antiderivative_.coarse_before[node] + antiderivative_.is_coarse[node];
  marks_.upload(GL_R32I, marks.data(), marks.size() * sizeof(marks[0]));
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

void IntegratorTables::bind(const RenderSettings& settings, const SegmentBounds& segments, const Limits& limits,
                            const Progress& progress) {
  segments_ = segments;
  if (!has_control_points_) upload_control_points();
  points_.bind(kControlPointUnit);
  intervals_.bind(kFirstIntervalUnit);
  const Integrator integrator = sources_.is_constant ? Integrator::kPost : settings.integrator;
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
    if (!has_iso_values_) {
      constexpr int kSide = optics::IsoValueTable::kSize;
      const optics::IsoValueTable table = optics::build_iso_value_table(control_points_);
      iso_values_.resize(GL_RGBA32F, kSide, kSide);
      glTextureSubImage2D(iso_values_.get(), 0, 0, 0, kSide, kSide, GL_RGBA, GL_FLOAT, table.texels.data());
      first_iso_ = table.first;
      isos_per_scalar_ = table.texels_per_scalar;
      has_iso_values_ = true;
    }
    iso_values_.bind_texture(kVariationUnit);
  }
  if (scene::is_of_tables(integrator)) {
    const optics::PreintegrationSource source{function_, sources_.map, sources_.range, segments.longest, progress};
    require_table_size(settings, limits);
    if (settings.preintegration.device == TableDevice::kGpu) {
      ray_integrals_.make(source, settings);
    } else {
      preintegration_.prepare(source, settings);
      ray_integrals_.bind(preintegration_);
    }
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
  block.split_threshold = 12.0f * scene::segment_tolerance(settings);
  split_threshold_ = block.split_threshold;
  block.last_node = table.last_node;
  is_beyond_ = !table.covers_data || segments.may_overshoot;
  block.points_first = control_points_.first;
  block.buckets_per_scalar = control_points_.buckets_per_scalar;
  block.last_bucket = static_cast<int>(control_points_.first_interval.size()) - 1;
  block.last_interval = control_points_.interval_count - 1;
  block.samples = settings.samples;
  block.first_iso = first_iso_;
  block.isos_per_scalar = isos_per_scalar_;
  block_.upload(&block, sizeof(block));
  block_.bind_uniform(kTablesBinding);
}

std::uint64_t IntegratorTables::bytes() const {
  return antiderivative_.bytes() + preintegration_.bytes() + ray_integrals_.bytes() + control_points_.bytes() +
         nodes_.bytes() + marks_.bytes() + variation_.bytes() + points_.bytes() + intervals_.bytes() +
         absorbed_.bytes() + iso_values_.bytes() + block_.bytes();
}

}  // namespace tetravox::gl
