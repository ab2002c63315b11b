#pragma once

/// What integrators look up, on the device: made by src/optics, put into textures here.

#include "src/gl/blocks.h"
#include "src/gl/resources.h"
#include "src/gl/shader_source.h"
#include "src/optics/antiderivative_table.h"
#include "tetravox/render.h"

#include <cstdint>
#include <string>
#include <vector>

namespace tetravox::gl {

// Texture units: 0 and 1 belong to the rays, 2 to 5 and 11 to 15 to integrators, 6 to 10 to sources.

/// The data that a function is for.
struct TableSources {
  optics::ScalarMap map;
  ValueRange range;          ///< of the values
  double longest = 1.0;      ///< world length of the longest ray
  bool is_constant = false;  ///< cell data: control points alone
};

/// What `#include "integrator.glsl"` stands for in the shaders of a source.
struct IntegratorShader {
  std::string name;  ///< of its own for each variant
  std::string file;
  std::vector<std::string> defines;

  /// Makes the shader one that integrates so.
  void add_to(ShaderRecipe& recipe) const;
};

/// All that there may be.
std::vector<IntegratorShader> all_integrator_shaders();

/// The tables of one transfer function. With the context current.
class IntegratorTables {
 public:
  void set_transfer_function(const OpticalFunction& function, const TableSources& sources);
  /// Puts on the device what the integrator of these settings needs and is not there yet, and binds it. `tolerance`: of
  /// a segment.
  void bind(const RenderSettings& settings, float tolerance);
  /// @throws Error (kUnsupported) for an integrator that this backend does not know.
  /// `may_overshoot`: scalars may leave the range that the function was set for.
  IntegratorShader shader(Integrator integrator, bool may_overshoot = false) const;
  const optics::ControlPointTable& control_points() const { return control_points_; }
  std::uint64_t bytes() const;

 private:
  void upload_antiderivatives();
  void upload_control_points();

  bool is_constant_ = false;
  optics::AntiderivativeTable antiderivative_;
  optics::ControlPointTable control_points_;
  bool has_antiderivatives_ = false, has_control_points_ = false;  // on the device
  BufferTexture nodes_, variation_, marks_, points_, intervals_;
  Picture absorbed_;
  bool has_absorbed_ = false;
  Buffer block_;
};

}  // namespace tetravox::gl
