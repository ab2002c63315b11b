#pragma once

/// Uniform blocks: their members stand once, in files that GLSL and C++ both include.

#include <array>
#include <cstdint>

namespace tetravox::gl {

using uint = std::uint32_t;
struct vec4 {
  float x = 0.0f, y = 0.0f, z = 0.0f, w = 0.0f;
};

// std140 lays rows of four 4-byte scalars out as C++ does.
struct FrameBlock {
#include "src/gl/shaders/frame_block.glsl"
};
struct WalkBlock {
#include "src/gl/shaders/walk_block.glsl"
};
struct MarchBlock {
#include "src/gl/shaders/march_block.glsl"
};
struct SliceBlock {
#include "src/gl/shaders/slice_block.glsl"
};
struct TablesBlock {
#include "src/gl/shaders/integrators/tables_block.glsl"
};
struct PreintegrationBlock {
#include "src/gl/shaders/integrators/preintegration_block.glsl"
};
struct MakerBlock {
#include "src/gl/shaders/tables/maker_block.glsl"
};
struct ProjectionBlock {
#include "src/gl/shaders/projection_block.glsl"
};
static_assert(sizeof(FrameBlock) == 3 * 16 && sizeof(WalkBlock) == 2 * 16 && sizeof(TablesBlock) == 6 * 16 &&
              sizeof(PreintegrationBlock) == 3 * 16 && sizeof(MakerBlock) == 4 * 16 &&
              sizeof(ProjectionBlock) == 5 * 16 && sizeof(MarchBlock) == 10 * 16);
static_assert(sizeof(SliceBlock) == (9 + 8 + 8 + 4 + 6) * 16);

}  // namespace tetravox::gl
