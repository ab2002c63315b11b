// What becomes of a cell's segment in a pixel: blended, or put into the list of the pixel.

#include "projected_segment.glsl"

#ifdef EXACT_ORDER

#include "segment_lists.glsl"

void finish(ProjectedSegment passed) {
  if (!(passed.z_length > 0.0)) return;
  uint node = atomicAdd(list_counters.node_count, 1u);
  if (node >= projection.node_count) return;
  nodes[node].z_front = passed.z_front;
  nodes[node].z_length = passed.z_length;
  nodes[node].scalar_front = passed.scalar_front;
  nodes[node].scalar_back = passed.scalar_back;
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  nodes[node].next = atomicExchange(heads[place_of(pixel)], node);
}

#else

#include "segment.glsl"
#include "integrator.glsl"

layout(location = 0) out vec4 premultiplied;

void finish(ProjectedSegment passed) {
  vec2 slope = frame.is_orthographic != 0
                   ? vec2(0.0)
                   : (gl_FragCoord.xy - 0.5 * vec2(frame.width, frame.height)) * frame.pixel_step;
  float world_per_z = frame.world_per_local * sqrt(1.0 + dot(slope, slope));
  Segment segment = Segment(passed.scalar_front, passed.scalar_back, passed.z_length * world_per_z);
  Front front = front_at(segment.scalar_front);
  vec4 sum = kNothingYet;
  integrate(segment, front, sum);
  premultiplied = vec4(sum.rgb, 1.0 - sum.a);
}

#endif
