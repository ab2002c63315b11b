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

/// Texture units that sources leave to integrators.
inline constexpr GLuint kFirstTableUnit = 2, kPastTableUnits = 6;

/// The data that a function is for.
struct TableSources {
  optics::ScalarMap map;
  ValueRange range;          ///< of the values
  double longest = 1.0;      ///< world length of the longest ray
  bool is_constant = false;  ///< cell data: control points alone
};

/// Shader file that integrates; `is_constant`: one value a segment.
std::string integrator_file(Integrator integrator, bool is_constant);

/// The tables of one transfer function. With the context current.
class IntegratorTables {
 public:
  void set_transfer_function(const OpticalFunction& function, const TableSources& sources);
  /// Puts on the device what the integrator of these settings needs and is not there yet, and binds it. `tolerance`: of
  /// a segment; `may_overshoot`: whether scalars may lie beyond the range of the data.
  void bind(const RenderSettings& settings, float tolerance, bool may_overshoot = false);
  const optics::ControlPointTable& control_points() const { return control_points_; }
  /// Stored scalars from node to node of the antiderivatives.
  float node_width() const { return 1.0f / antiderivative_.nodes_per_scalar; }
  std::uint64_t bytes() const;

 private:
  void upload_antiderivatives();
  void upload_control_points();

  bool is_constant_ = false;
  optics::AntiderivativeTable antiderivative_;
  optics::ControlPointTable control_points_;
  bool has_antiderivatives_ = false, has_control_points_ = false;  // on the device
  BufferTexture nodes_, marks_, points_, intervals_;
  Picture absorbed_;
  bool has_absorbed_ = false;
  Buffer block_;
};

}  // namespace tetravox::gl
