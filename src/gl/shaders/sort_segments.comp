// Sorts the segments of each pixel by depth.

#include "projection.glsl"
#include "segment_lists.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

const uint kNoItem = kNoNode;
uint next_of(uint node) { return nodes[node].next; }
void set_next(uint node, uint next) { nodes[node].next = next; }

// By where they begin; of those that begin together the shorter one first.
bool is_before(uint a, uint b) {
  if (nodes[a].z_front != nodes[b].z_front) return nodes[a].z_front < nodes[b].z_front;
  if (nodes[a].z_length != nodes[b].z_length) return nodes[a].z_length < nodes[b].z_length;
  return nodes[a].scalar_front < nodes[b].scalar_front;
}

#include "merge_sort.glsl"

void main() {
  ivec2 pixel = pixel_of(gl_WorkGroupID, gl_LocalInvocationIndex);
  if (is_outside_rows(pixel)) return;
  uint place = place_of(pixel);
  uint head = heads[place];
  if (head == kNoNode || next_of(head) == kNoNode) return;
  int result = sort_pass(projection.sorted_run, head);
  heads[place] = head;
  if (result == kNeedsAnother) atomicAdd(list_counters.unfinished_count, 1u);
  if (result == kTooLong) atomicAdd(list_counters.too_long_count, 1u);
}
