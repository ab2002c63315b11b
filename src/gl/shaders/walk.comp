// Walks each ray through the mesh from entry to entry, some steps a pass: of its sorted list, or with PEELING of the one
// face that has been peeled.

#include "walk.glsl"
#include "lists.glsl"

layout(local_size_x = 8, local_size_y = 8) in;

layout(binding = 0, rgba32f) uniform writeonly image2D picture;

struct Pause {  // what a ray needs to go on in another pass
  uvec4 id_cell;
  vec4 sum;
  float z_front;
  float scalar_front;
  float z_checked;
  uint entry;  // the next one
};
layout(std430, binding = 3) buffer Pauses { Pause pauses[]; };  // [rows][width]

#ifdef PEELING
#include "peeling.glsl"

layout(binding = 10) uniform usampler2D front_faces;  // kNoEntry: none

uint first_entry(ivec2 pixel) { return texelFetch(front_faces, pixel, 0).x; }
uint face_of(uint entry) { return entry; }
uint entry_behind(uint entry) { return kNoEntry; }

// Notes what the next layer lies behind.
void note_entered(uint place, uint face, float depth) { peeled[place] = Peeled(key_of(face, depth), face); }
void end_ray(uint place) { peeled[place].key = kBehindAll; }
#else
uint first_entry(ivec2 pixel) { return heads[place_of(pixel)]; }
uint face_of(uint entry) { return entries[entry].face; }
uint entry_behind(uint entry) { return entries[entry].next; }
void note_entered(uint place, uint face, float depth) {}
void end_ray(uint place) {}
#endif

void resume(Ray ray, Pause pause, inout Walker walker) {
  walker.id = pause.id_cell.xyz;
  walker.cell = pause.id_cell.w;
  walker.sum = pause.sum;
  walker.z_front = pause.z_front;
  walker.scalar_front = pause.scalar_front;
  if (walker.cell == kNoCell) return;
  for (int k = 0; k < 3; ++k) {
    vec4 vertex = texelFetch(vertices, int(walker.id[k]));
    vec2 at = shear(ray, vertex);
    walker.x[k] = at.x;
    walker.y[k] = at.y;
    walker.z[k] = vertex.z;
    walker.scalar[k] = vertex.w;
  }
  vec2 a = vec2(walker.x.x, walker.y.x), b = vec2(walker.x.y, walker.y.y), c = vec2(walker.x.z, walker.y.z);
  walker.weight = max(vec3(edge_product(b, c), edge_product(c, a), edge_product(a, b)), 0.0);
}

void main() {
  ivec2 pixel = pixel_of(gl_WorkGroupID, gl_LocalInvocationIndex);
  if (is_outside_rows(pixel)) return;
  uint place = place_of(pixel);
  Ray ray = ray_of(pixel);
  Walker walker;
  walker.cell = kNoCell;
  walker.sum = kNothingYet;
  walker.scalar_front = 0.0;
  uint entry;
  float z_checked = -1e30;
  if (walk.is_first_pass != 0) {
    entry = first_entry(pixel);
    if (walk.is_first_layer != 0)
      imageStore(picture, pixel, vec4(0.0));
    else
      walker.sum = pauses[place].sum;
    pauses[place].id_cell.w = kNoCell;
    pauses[place].entry = kNoEntry;
    if (walk.is_first_layer != 0) pauses[place].sum = kNothingYet;
    if (entry == kNoEntry) return;
    atomicAdd(counters.entered_count, 1u);
  } else {
    if (pauses[place].entry == kNoEntry && pauses[place].id_cell.w == kNoCell) return;
    resume(ray, pauses[place], walker);
    entry = pauses[place].entry;
    z_checked = pauses[place].z_checked;
  }

  uint segment_count = 0u, steps_left = uint(walk.steps);
  while (steps_left > 0u && (walker.cell != kNoCell || entry != kNoEntry)) {
    if (walker.cell == kNoCell) {
      uint face = face_of(entry);
      enter(ray, face, walker);
      note_entered(place, face, walker.z_front);
      entry = entry_behind(entry);
      z_checked = -1e30;
    }
    Front front = front_at(walker.scalar_front);
    bool is_pending_segment = false;
    while (is_pending_segment || (steps_left > 0u && walker.cell != kNoCell)) {
      if (!is_pending_segment) {
#ifdef BEHIND_EYE
        bool is_behind = walker.z_front < frame.z_near;
#endif
        Segment segment = walk_cell(ray, walker);
#ifdef BEHIND_EYE
        if (is_behind) front = front_at(segment.scalar_front);
#endif
        begin(segment, front);
        ++segment_count;
      }
      steps_left -= min(steps_left, 1u);
      advance(front, walker.sum);
      is_pending_segment = is_pending(front);
      if (frame.use_early_ray_termination != 0 && is_settled(walker.sum)) {
        walker.cell = kNoCell;
        entry = kNoEntry;
        is_pending_segment = false;
        end_ray(place);
      }
    }
  }
  // A ray that did not get on in a whole pass goes round in circles (damaged meshes).
  if (walker.cell != kNoCell) {
    if (walker.z_front <= z_checked) {
      atomicAdd(counters.stopped_count, 1u);
      walker.cell = kNoCell;
    }
    z_checked = walker.z_front;
  }

  atomicAdd(counters.segments[place % 64u], segment_count);
  pauses[place].id_cell = uvec4(walker.id, walker.cell);
  pauses[place].entry = entry;
  pauses[place].sum = walker.sum;
  if (walker.cell == kNoCell && entry == kNoEntry) {
    imageStore(picture, pixel, premultiplied(walker.sum));
    return;
  }
  pauses[place].z_front = walker.z_front;
  pauses[place].scalar_front = walker.scalar_front;
  pauses[place].z_checked = z_checked;
  atomicAdd(counters.unfinished_count, 1u);
}
