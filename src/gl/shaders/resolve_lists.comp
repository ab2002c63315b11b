// Sorts the list of segments of each pixel by depth and composites it front to back.

#include "projection.glsl"
#include "projected_segment.glsl"
#include "segment_lists.glsl"
#include "segment.glsl"
#include "integrator.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

layout(binding = 0, rgba32f) uniform writeonly image2D picture;

// By their middles: rounding of thin ones does not change that order.
bool is_before(uint a, uint b) {
  float middle_a = nodes[a].z_front + 0.5 * nodes[a].z_length, middle_b = nodes[b].z_front + 0.5 * nodes[b].z_length;
  return middle_a < middle_b || (middle_a == middle_b && nodes[a].scalar_front < nodes[b].scalar_front);
}

// Merge sort from the bottom up, in place.
uint sort_list(uint head) {
  for (uint run = 1u;; run *= 2u) {
    uint left = head, tail = kNoNode, merges = 0u;
    head = kNoNode;
    while (left != kNoNode) {
      ++merges;
      uint right = left, left_count = 0u;
      while (left_count < run && right != kNoNode) {
        right = nodes[right].next;
        ++left_count;
      }
      uint right_count = run;
      while (left_count > 0u || (right_count > 0u && right != kNoNode)) {
        bool takes_left = left_count > 0u && (right_count == 0u || right == kNoNode || !is_before(right, left));
        uint taken = takes_left ? left : right;
        if (takes_left) {
          left = nodes[left].next;
          --left_count;
        } else {
          right = nodes[right].next;
          --right_count;
        }
        if (tail == kNoNode)
          head = taken;
        else
          nodes[tail].next = taken;
        tail = taken;
      }
      left = right;
    }
    nodes[tail].next = kNoNode;
    if (merges <= 1u) return head;
  }
}

void main() {
  ivec2 pixel = pixel_of(gl_WorkGroupID, gl_LocalInvocationIndex);
  if (is_outside_rows(pixel)) return;
  uint place = place_of(pixel);
  uint node = heads[place];
  vec4 sum = kNothingYet;
  if (node != kNoNode) {
    Ray ray = ray_of(pixel);
    node = sort_list(node);
    while (node != kNoNode) {
      Node passed = nodes[node];
      Segment segment = Segment(passed.scalar_front, passed.scalar_back, passed.z_length * ray.world_per_z);
      Front front = front_at(segment.scalar_front);
      integrate(segment, front, sum);
      node = passed.next;
      if (frame.use_early_ray_termination != 0 && is_settled(sum)) break;
    }
  }
  imageStore(picture, pixel, min(vec4(sum.rgb, 1.0 - sum.a), 1.0));
}
