// What the sources that project cells share.

#include "frame.glsl"

layout(std140, binding = 3) uniform ProjectionBlock {
#include "projection_block.glsl"
} projection;
