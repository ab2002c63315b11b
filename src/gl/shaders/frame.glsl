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

// The pixel of an invocation in groups of 8 x 8 over the rows at hand. Those side by side travel together: blocks of 4 x 2
// pixels, which is a vector of eight on many devices.
ivec2 pixel_of(uvec3 group, uint index) {
  uvec2 inside = uvec2((index & 3u) + ((index >> 3u) & 1u) * 4u, ((index >> 2u) & 1u) + (index >> 4u) * 2u);
  return ivec2(8u * group.xy + inside) + ivec2(0, frame.row_begin);
}
bool is_outside_rows(ivec2 pixel) { return pixel.x >= frame.width || pixel.y >= frame.row_end; }

// Where a pixel is in buffers that hold the rows at hand.
uint place_of(ivec2 pixel) { return uint((pixel.y - frame.row_begin) * frame.width + pixel.x); }
