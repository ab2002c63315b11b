#pragma once

/// What integrators look up, on the device: made by src/optics, put into textures here.

#include "src/gl/blocks.h"
#include "src/gl/context.h"
#include "src/gl/preintegration_textures.h"
#include "src/gl/resources.h"
#include "src/gl/shader_source.h"
#include "src/optics/antiderivative_table.h"
#include "tetravox/render.h"

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace tetravox::gl {

// Texture units: 0 and 1 belong to the rays, 2 to 5 and 11 to integrators, 6 to 10 to sources, 12 to 15 to passes that
// make tables.

/// The data that a function is for.
struct TableSources {
  optics::ScalarMap map;
  ValueRange range;          ///< of the values
  double longest = 1.0;      ///< world length of the longest ray
  bool is_constant = false;  ///< cell data: control points alone
};

/// What holds for all segments of a frame. Where more is known than by default, a cheaper integrator may serve.
struct SegmentBounds {
  double longest = 0.0;        ///< world length: tables of ray integrals reach as far
  bool may_overshoot = false;  ///< whether scalars may lie beyond the range of the data
  bool is_gentle = false;      ///< whether they may be rounded to nodes of the table (`scene::BrickPlan::is_gentle`)
  double depth = 0.0;          ///< gentle ones: largest optical depth
  double error = 0.0;          ///< the same: largest of depth^2 times the change of colour
};

/// What `#include "integrator.glsl"` stands for in the shaders of a source.
struct IntegratorShader {
  std::string name;  ///< of its own for each variant
  std::string file;
  std::vector<std::pair<std::string, std::string>> defines;
  int loops = 4;  ///< iterations of loops that a piece of a segment takes at most

  /// Makes the shader one that integrates so.
  void add_to(ShaderRecipe& recipe) const;
};

/// Pieces of segments that one invocation of a shader may integrate, so that no pass takes long, which drivers with a
/// watchdog ask for, and none exceeds what llvmpipe allows: it leaves loops, without a word, once an invocation has
/// gone through 65,535 iterations in all.
int pieces_a_pass(const IntegratorShader& shader);

/// All that there may be.
std::vector<IntegratorShader> all_integrator_shaders();
/// Those that rely on bounds of segments.
std::vector<IntegratorShader> bounded_integrator_shaders();
/// Of points that are looked up one by one: cell data, and samples.
IntegratorShader point_shader();

/// The tables of one transfer function. With the context current.
class IntegratorTables {
 public:
  void set_transfer_function(const OpticalFunction& function, const TableSources& sources);
  /// Puts on the device what the integrator of these settings needs and is not there yet, and binds it.
  /// @throws Error (kUnsupported) for tables larger than the device allows, before they are made.
  void bind(const RenderSettings& settings, const SegmentBounds& segments, const Limits& limits,
            const Progress& progress);
  /// Of the settings and segments bound last. @throws Error (kUnsupported) for an integrator that this backend does not
  /// know.
  IntegratorShader shader(const RenderSettings& settings) const;
  /// `point_shader()` with the loops that the function asks for.
  IntegratorShader points() const;
  const optics::ControlPointTable& control_points() const { return control_points_; }
  /// Stored scalars from node to node of the antiderivatives.
  float node_width() const { return 1.0f / antiderivative_.nodes_per_scalar; }
  /// Bound on the change of colour between two stored scalars.
  double color_change(float min, float max) const;
  std::uint64_t bytes() const;

 private:
  void upload_antiderivatives();
  void upload_control_points();

  OpticalFunction function_;
  TableSources sources_;
  optics::AntiderivativeTable antiderivative_;
  optics::ControlPointTable control_points_;
  int probes_ = 0;  // halvings until the interval of a scalar is found
  SegmentBounds segments_;
  double split_threshold_ = 0.0;  // of SegmentBounds::error
  bool is_beyond_ = false;        // whether scalars may lie beyond the table of antiderivatives
  bool has_antiderivatives_ = false, has_control_points_ = false;  // on the device
  BufferTexture nodes_, variation_, marks_, points_, intervals_;
  scene::PreintegrationCache preintegration_;
  PreintegrationTextures ray_integrals_;
  Picture absorbed_;
  Picture iso_values_;
  bool has_absorbed_ = false, has_iso_values_ = false;
  float first_iso_ = 0.0f, isos_per_scalar_ = 0.0f;
  Buffer block_;
};

}  // namespace tetravox::gl
