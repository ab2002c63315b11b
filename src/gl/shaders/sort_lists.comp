// Sorts the list of each pixel by depth: merge sort of a linked list from the bottom up, in place.

#include "mesh.glsl"
#include "lists.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

// Faces around the eye come first.
bool is_before(uint a, uint b) {
  bool a_eye = entries[a].face >= walk.first_eye_face, b_eye = entries[b].face >= walk.first_eye_face;
  if (a_eye != b_eye) return a_eye;
  if (entries[a].depth != entries[b].depth) return entries[a].depth < entries[b].depth;
  return entries[a].face < entries[b].face;
}

void main() {
  ivec2 pixel = pixel_of(gl_WorkGroupID, gl_LocalInvocationIndex);
  if (is_outside_rows(pixel)) return;
  uint place = place_of(pixel);
  uint head = heads[place];
  if (head == kNoEntry || entries[head].next == kNoEntry) return;
  for (uint run = 1u;; run *= 2u) {
    uint left = head, tail = kNoEntry, merges = 0u;
    head = kNoEntry;
    while (left != kNoEntry) {
      ++merges;
      uint right = left, left_count = 0u;
      while (left_count < run && right != kNoEntry) {
        right = entries[right].next;
        ++left_count;
      }
      uint right_count = run;
      while (left_count > 0u || (right_count > 0u && right != kNoEntry)) {
        bool takes_left = left_count > 0u && (right_count == 0u || right == kNoEntry || !is_before(right, left));
        uint taken = takes_left ? left : right;
        if (takes_left) {
          left = entries[left].next;
          --left_count;
        } else {
          right = entries[right].next;
          --right_count;
        }
        if (tail == kNoEntry)
          head = taken;
        else
          entries[tail].next = taken;
        tail = taken;
      }
      left = right;
    }
    entries[tail].next = kNoEntry;
    if (merges <= 1u) break;
  }
  heads[place] = head;
}
