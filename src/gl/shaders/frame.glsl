// The rays of a frame (src/scene/camera_frame.h), and what comes of them.

layout(std140, binding = 0) uniform FrameBlock {
#include "frame_block.glsl"
} frame;

layout(binding = 0) uniform samplerBuffer ray_columns;  // [width] offset, slope
layout(binding = 1) uniform samplerBuffer ray_rows;     // [height] the same

// x = offset.x + slope.x * z, and likewise y.
struct Ray {
  vec2 offset;
  vec2 slope;
  float world_per_z;
};

Ray ray_of(ivec2 pixel) {
  vec2 column = texelFetch(ray_columns, pixel.x).xy, row = texelFetch(ray_rows, pixel.y).xy;
  Ray ray;
  ray.offset = vec2(column.x, row.x);
  ray.slope = vec2(column.y, row.y);
  ray.world_per_z = frame.world_per_local * sqrt(1.0 + ray.slope.x * ray.slope.x + ray.slope.y * ray.slope.y);
  return ray;
}
