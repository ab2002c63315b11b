// Composites the sorted segments of each pixel front to back, some pieces a pass. Where two overlap, as those of cells that
// intersect, both are there: one is composited between the halves of the other.

#include "projection.glsl"
#include "segment_lists.glsl"
#include "segment.glsl"
#include "integrator.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

layout(binding = 0, rgba32f) uniform image2D picture;  // colour and transmittance, until a pixel is done

// A part of a segment, from depth `from` to depth `to`.
Node part_of(Node node, float from, float to) {
  float slope = (node.scalar_back - node.scalar_front) / max(node.z_length, 1e-30);
  Node part = node;
  part.scalar_front = node.scalar_front + slope * (from - node.z_front);
  part.scalar_back = node.scalar_front + slope * (to - node.z_front);
  part.z_front = from;
  part.z_length = to - from;
  return part;
}

float back_of(Node node) { return node.z_front + node.z_length; }

// Less is rounding.
float least_overlap(Node a, Node b) {
  return 1e-3 * min(a.z_length, b.z_length) + 4e-6 * max(abs(a.z_front), abs(b.z_front));
}

// How far lists have been walked to put back what is left of segments.
int walked = 0;

// Puts a segment into a list that is sorted by where segments begin; the list's head.
uint insert(uint head, uint number, Node node) {
  uint before = kNoNode, after = head;
  while (after != kNoNode && nodes[after].z_front < node.z_front) {
    before = after;
    after = nodes[after].next;
    ++walked;
  }
  node.next = after;
  nodes[number] = node;
  if (before == kNoNode) return number;
  nodes[before].next = number;
  return head;
}

// A stretch that the first two segments of a list share.
struct Overlap {
  float end;
  int stage;  // 0: none; 1, 2: of its three pieces so many have been taken
};

// The next piece of a pixel's list. What is left of its segments is kept in them.
Node take_piece(inout uint head, inout Overlap overlap) {
  uint first = head;
  Node a = nodes[first];
  uint second = a.next;
  if (second == kNoNode) {
    head = kNoNode;
    return a;
  }
  Node b = nodes[second];
  float least = least_overlap(a, b);
  if (overlap.stage == 1) {
    overlap.stage = 2;
    return part_of(b, b.z_front, overlap.end);
  }
  if (overlap.stage == 2) {
    overlap.stage = 0;
    head = b.next;
    if (back_of(b) - overlap.end > least) head = insert(head, second, part_of(b, overlap.end, back_of(b)));
    if (back_of(a) - overlap.end > least) head = insert(head, first, part_of(a, overlap.end, back_of(a)));
    return part_of(a, a.z_front, overlap.end);
  }
  if (back_of(a) - b.z_front <= least) {
    head = second;
    return a;
  }
  if (b.z_front - a.z_front > least) {
    nodes[first] = part_of(a, b.z_front, back_of(a));
    return part_of(a, a.z_front, b.z_front);
  }
  float end = min(back_of(a), back_of(b));
  if (b.next != kNoNode && nodes[b.next].z_front - b.z_front > least) end = min(end, nodes[b.next].z_front);
  overlap = Overlap(end, 1);
  float middle = 0.5 * (a.z_front + end);
  nodes[first] = part_of(a, middle, back_of(a));
  return part_of(a, a.z_front, middle);
}

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
  Overlap overlap = Overlap(0.0, 0);
  for (int i = 0; (i + walked < projection.segments_a_pass || overlap.stage > 0) && node != kNoNode; ++i) {
    Node passed = take_piece(node, overlap);
    Segment segment = Segment(passed.scalar_front, passed.scalar_back, passed.z_length * ray.world_per_z);
    Front front = front_at(segment.scalar_front);
    integrate(segment, front, sum);
    if (frame.use_early_ray_termination != 0 && is_settled(sum)) node = kNoNode;
  }
  heads[place] = node;
  bool is_done = node == kNoNode;
  imageStore(picture, pixel, is_done ? min(vec4(sum.rgb, 1.0 - sum.a), 1.0) : sum);
  if (!is_done) atomicAdd(list_counters.unfinished_count, 1u);
}
