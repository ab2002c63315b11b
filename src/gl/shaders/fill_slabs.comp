// Integrates slabs of one thickness: those that integrators/slab.glsl looks up.

#include "march.glsl"
#include "integrator.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

layout(binding = 1, rgba32f) uniform writeonly image2D filled;

void main() {
  ivec2 node = ivec2(gl_GlobalInvocationID.xy);
  vec2 place = (vec2(node) + 0.5) / vec2(imageSize(filled));
  vec2 scalars = (place - march.slab_offset) / march.slab_scale;  // behind, in front
  Segment segment = Segment(scalars.y, scalars.x, march.sample_distance);
  vec4 sum = kNothingYet;
  Front front = front_at(segment.scalar_front);
#ifdef TAKES_WHOLE_SEGMENTS
  integrate(segment, front, sum);
#else
  begin(segment, front);
  while (is_pending(front)) advance(front, sum);
#endif
  imageStore(filled, node, vec4(sum.rgb, 1.0 - sum.a));
}
