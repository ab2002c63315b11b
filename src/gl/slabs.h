#pragma once

/// Ray integrals of slabs as thick as two samples of a grid are apart, made on the device.

#include "src/gl/blocks.h"
#include "src/gl/integrator_tables.h"
#include "src/gl/program.h"
#include "src/gl/resources.h"

#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace tetravox::gl {

/// Fills a picture of them by the integrator of a frame's segments, one of `slab_filling_shaders`.
ShaderRecipe recipe_of_slabs(const IntegratorShader& integrator);
std::vector<IntegratorShader> slab_filling_shaders();
/// Looks them up.
IntegratorShader slab_shader();

/// With the context current.
class Slabs {
 public:
  /// Says where `scalars` (stored) lie in the picture: `MarchBlock::slab_scale` and `slab_offset`.
  static void describe(const ValueRange& scalars, MarchBlock& block);

  /// Makes them unless they are there, with the tables of `integrator` bound.
  void make(const MarchBlock& block, const IntegratorShader& integrator, double tolerance);
  void bind() const;
  void invalidate() { thickness_ = 0.0f; }
  std::uint64_t bytes() const { return block_.bytes() + picture_.bytes(); }

 private:
  std::map<std::string, ProgramName> programs_;
  Buffer block_;
  Picture picture_;
  float thickness_ = 0.0f;
  double tolerance_ = 0.0;
};

}  // namespace tetravox::gl
