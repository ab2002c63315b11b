// Sorts the entries of each ray by depth.

#include "mesh.glsl"
#include "lists.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

const uint kNoItem = kNoEntry;
uint next_of(uint entry) { return entries[entry].next; }
void set_next(uint entry, uint next) { entries[entry].next = next; }

// Faces around the eye come first.
bool is_before(uint a, uint b) {
  bool a_eye = entries[a].face >= walk.first_eye_face, b_eye = entries[b].face >= walk.first_eye_face;
  if (a_eye != b_eye) return a_eye;
  if (entries[a].depth != entries[b].depth) return entries[a].depth < entries[b].depth;
  return entries[a].face < entries[b].face;
}

#include "merge_sort.glsl"

void main() {
  ivec2 pixel = pixel_of(gl_WorkGroupID, gl_LocalInvocationIndex);
  if (is_outside_rows(pixel)) return;
  uint place = place_of(pixel);
  uint head = heads[place];
  if (head == kNoEntry || next_of(head) == kNoEntry) return;
  int result = sort_pass(walk.sorted_run, head);
  heads[place] = head;
  if (result == kNeedsAnother) atomicAdd(counters.unfinished_count, 1u);
  if (result == kTooLong) atomicAdd(counters.stopped_count, 1u);
}
