// Composites the sorted segments of each pixel front to back, some of them a pass.

#include "projection.glsl"
#include "segment_lists.glsl"
#include "segment.glsl"
#include "integrator.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

layout(binding = 0, rgba32f) uniform image2D picture;  // colour and transmittance, until a pixel is done

void main() {
  ivec2 pixel = pixel_of(gl_WorkGroupID, gl_LocalInvocationIndex);
  if (is_outside_rows(pixel)) return;
  uint place = place_of(pixel);
  uint node = heads[place];
  bool is_first = projection.is_first_pass != 0;
  if (node == kNoNode) {
    if (is_first) imageStore(picture, pixel, vec4(0.0));
    return;
  }
  vec4 sum = is_first ? kNothingYet : imageLoad(picture, pixel);
  Ray ray = ray_of(pixel);
  for (int i = 0; i < projection.segments_a_pass && node != kNoNode; ++i) {
    Node passed = nodes[node];
    Segment segment = Segment(passed.scalar_front, passed.scalar_back, passed.z_length * ray.world_per_z);
    Front front = front_at(segment.scalar_front);
    integrate(segment, front, sum);
    node = frame.use_early_ray_termination != 0 && is_settled(sum) ? kNoNode : passed.next;
  }
  heads[place] = node;
  bool is_done = node == kNoNode;
  imageStore(picture, pixel, is_done ? min(vec4(sum.rgb, 1.0 - sum.a), 1.0) : sum);
  if (!is_done) atomicAdd(list_counters.unfinished_count, 1u);
}
