// Rays in a grid, its bricks, and the lattice of cells in each: the steps are those of src/cpu/kernels/rays-inl.h and
// lattice-inl.h, for one ray.

#include "frame.glsl"
#include "segment.glsl"

layout(std140, binding = 2) uniform MarchBlock {
#include "march_block.glsl"
} march;

layout(binding = 6) uniform usamplerBuffer bricks;      // [bricks] plan, bits of the steepness, first node, parts
layout(binding = 7) uniform samplerBuffer planes;       // uneven axes: grid coordinates of all lattice planes
layout(binding = 8) uniform samplerBuffer steepnesses;  // [levels][bins], see src/optics/steepness_table.h

// Pieces that the pass has integrated; a pass ends, wherever a ray is, once they are enough (`pieces_a_pass`). A ray gets
// on in every pass.
uint work_done = 0u;
uint segment_count = 0u;  // for statistics
bool ends_pass(float reached, float begun) { return work_done >= uint(march.most_work) && reached > begun; }

const float kParallel = 1e-6;  // a ray that moves less along an axis is parallel to its planes
const float kNever = 1e30;
const float kRounded = 4e-6;   // by what part of itself a depth may be off

// Plans, see src/gl/march_bricks.h. Their highest eight bits: spans that are seen.
const uint kTransparent = 0xFFu, kIsCurved = 1u << 16, kIsGentle = 1u << 17, kHasMissing = 1u << 18;

ivec3 cell_count() { return ivec3(march.cells_x, march.cells_y, march.cells_z); }
ivec3 brick_count() { return ivec3(march.bricks_x, march.bricks_y, march.bricks_z); }

// A ray in grid coordinates: place = origin + direction * z.
struct GridRay {
  vec3 origin, direction, inverse;
  bvec3 is_parallel;
  float world_per_z;
};

GridRay grid_ray_of(ivec2 pixel) {
  Ray ray = ray_of(pixel);
  GridRay g;
  vec4 from = vec4(ray.offset, 0.0, 1.0), along = vec4(ray.slope, 1.0, 0.0);
  g.origin = vec3(dot(march.grid_x, from), dot(march.grid_y, from), dot(march.grid_z, from));
  g.direction = vec3(dot(march.grid_x, along), dot(march.grid_y, along), dot(march.grid_z, along));
  g.is_parallel = lessThan(abs(g.direction), vec3(kParallel));
  g.inverse = 1.0 / mix(g.direction, vec3(1.0), g.is_parallel);
  g.world_per_z = ray.world_per_z;
  return g;
}

// Where the ray is in the grid: depths; empty where the first is not less than the second.
vec2 clip_grid(GridRay ray) {
  vec3 a = -ray.origin * ray.inverse, b = (march.upper.xyz - ray.origin) * ray.inverse;
  bvec3 is_beside = bvec3(ivec3(ray.is_parallel) * ivec3(bvec3(ivec3(lessThan(ray.origin, vec3(0.0))) +
                                                               ivec3(greaterThan(ray.origin, march.upper.xyz)))));
  vec3 near = mix(min(a, b), vec3(-kNever), ray.is_parallel), far = mix(max(a, b), vec3(kNever), ray.is_parallel);
  if (any(is_beside)) return vec2(1.0, 0.0);
  return vec2(max(max(near.x, near.y), max(near.z, frame.z_near)), min(min(far.x, far.y), far.z));
}

// Grid coordinate of a lattice plane.
float plane_at(int axis, int index) {
#ifdef IS_UNEVEN
  int base = axis == 0 ? 0 : axis == 1 ? march.plane_base_y : march.plane_base_z;
  return texelFetch(planes, base + index).x;
#else
  return float(index);
#endif
}

// Of the two planes around brick `at`, that with the higher index.
float brick_plane(int axis, int at) { return plane_at(axis, min(at * 8, cell_count()[axis])); }

// A ray on its way from brick to brick.
struct BrickWalk {
  ivec3 brick;
  vec3 next;  // depth at which the ray leaves the brick along each axis
  float z, z_exit;
};

void find_leave(GridRay ray, int axis, inout BrickWalk walk) {
  float plane = brick_plane(axis, walk.brick[axis] + int(ray.direction[axis] >= 0.0));
  walk.next[axis] = ray.is_parallel[axis] ? kNever : (plane - ray.origin[axis]) * ray.inverse[axis];
}

int find_brick_along(int axis, float at) {
#ifdef IS_UNEVEN
  int low = 0, high = brick_count()[axis] - 1;
  while (low < high) {
    int middle = (low + high + 1) / 2;
    if (brick_plane(axis, middle) <= at) low = middle; else high = middle - 1;
  }
  return low;
#else
  return clamp(int(floor(at * 0.125)), 0, brick_count()[axis] - 1);
#endif
}

BrickWalk enter_grid(GridRay ray, float z, float z_exit) {
  BrickWalk walk;
  walk.z = z;
  walk.z_exit = z_exit;
  for (int axis = 0; axis < 3; ++axis) {
    walk.brick[axis] = find_brick_along(axis, ray.origin[axis] + ray.direction[axis] * z);
    find_leave(ray, axis, walk);
  }
  return walk;
}

float leave_of(BrickWalk walk) { return min(min(walk.next.x, min(walk.next.y, walk.next.z)), walk.z_exit); }
bool has_left(BrickWalk walk) {
  return walk.z >= walk.z_exit || any(lessThan(walk.brick, ivec3(0))) ||
         any(greaterThanEqual(walk.brick, brick_count()));
}

// On to the next brick.
void leave_brick(GridRay ray, inout BrickWalk walk) {
  walk.z = max(walk.z, leave_of(walk));
  bvec3 first = bvec3(walk.next.x <= walk.next.y && walk.next.x <= walk.next.z,
                      walk.next.y < walk.next.x && walk.next.y <= walk.next.z,
                      walk.next.z < walk.next.x && walk.next.z < walk.next.y);
  walk.brick += ivec3(first) * mix(ivec3(-1), ivec3(1), greaterThanEqual(ray.direction, vec3(0.0)));
  if (has_left(walk)) return;
#ifdef IS_UNEVEN
  for (int axis = 0; axis < 3; ++axis)
    if (first[axis]) find_leave(ray, axis, walk);
#else
  vec3 plane = vec3(min((walk.brick + ivec3(greaterThanEqual(ray.direction, vec3(0.0)))) * 8, cell_count()));
  walk.next = mix((plane - ray.origin) * ray.inverse, vec3(kNever), ray.is_parallel);
#endif
}

// What a ray carries from brick to brick at a fixed rate.
struct Carried {
  vec4 value;    // of the sample before
  float depth;   // where it lies; before everything: there is none yet
  float number;  // of the next one
  float z_exit;  // where the ray leaves the grid
};
Carried carried;

uvec4 plan_of(ivec3 brick) {
  return texelFetch(bricks, (brick.z * march.bricks_y + brick.y) * march.bricks_x + brick.x);
}

// The lattice of a brick, and a ray in it: lattice coordinates count its cells from the brick's lower corner.
struct Lattice {
  ivec3 first;  // grid cell at the lower corner
  ivec3 size;   // cells
  int level;    // cells of 2^level grid cells a side; 0 where there are parts
  int parts;    // of a grid cell along an axis
  int nodes;    // where its nodes begin, if they stand apart
  float per_unit;
  vec3 origin, direction;
};

Lattice lattice_of(GridRay ray, ivec3 brick, uvec4 plan) {
  Lattice l;
  l.first = brick * 8;
  l.level = int(plan.x & 0xFFu);
#ifdef HAS_NODES
  l.parts = int(plan.w);
  l.level = 0;
#elif defined(IS_NEAREST)
  l.parts = 2;
  l.level = 0;
#else
  l.parts = 1;
#endif
  l.nodes = int(plan.z);
  ivec3 grid_cells = min(l.first + 8, cell_count()) - l.first;
  l.size = ((grid_cells + (1 << l.level) - 1) >> l.level) * l.parts;
  l.per_unit = float(l.parts) / float(1 << l.level);
  l.origin = (ray.origin - vec3(l.first)) * l.per_unit;
  l.direction = ray.direction * l.per_unit;
  return l;
}

// All cells of the grid.
Lattice whole_lattice(GridRay ray) {
  return Lattice(ivec3(0), cell_count(), 0, 1, 0, 1.0, ray.origin, ray.direction);
}

// Grid coordinate of the lattice's plane.
float lattice_plane(Lattice l, int axis, int index) {
#ifdef IS_UNEVEN
  int cell = min(index / l.parts, (l.size[axis] - 1) / l.parts), part = index - cell * l.parts;
  float low = plane_at(axis, l.first[axis] + cell), high = plane_at(axis, l.first[axis] + cell + 1);
  return part == 0 ? low : part == l.parts ? high : low + (high - low) * float(part) / float(l.parts);
#else
  return float(index);
#endif
}

// A ray on its way through the cells of a lattice.
struct CellWalk {
  ivec3 cell;
  vec3 next;  // depth at the next plane of each axis
  float front, leave, leave_soon;
};

void find_next(GridRay ray, Lattice l, int axis, inout CellWalk walk) {
  int up = int(ray.direction[axis] >= 0.0);
  float plane = lattice_plane(l, axis, walk.cell[axis] + up);
#ifdef IS_UNEVEN
  float depth = (plane - ray.origin[axis]) * ray.inverse[axis];
#else
  float depth = (plane - l.origin[axis]) * (ray.inverse[axis] / l.per_unit);
#endif
  walk.next[axis] = ray.is_parallel[axis] ? kNever : depth;
}

CellWalk enter_lattice(GridRay ray, Lattice l, float front, float leave) {
  CellWalk walk;
  walk.front = front;
  walk.leave = leave;
  walk.leave_soon = leave - kRounded * abs(leave);
#ifdef IS_UNEVEN
  for (int axis = 0; axis < 3; ++axis) {
    float at = ray.origin[axis] + ray.direction[axis] * front;
    walk.cell[axis] = 0;
    for (int i = 1; i < l.size[axis]; ++i) walk.cell[axis] += int(lattice_plane(l, axis, i) <= at);
  }
#else
  walk.cell = clamp(ivec3(floor(l.origin + l.direction * front)), ivec3(0), l.size - 1);
#endif
  for (int axis = 0; axis < 3; ++axis) find_next(ray, l, axis, walk);
  return walk;
}

// Depth at which the ray leaves its cell. What would remain to the brick's end by rounding alone belongs to the last
// cell.
float back_of(CellWalk walk) {
  float plane = min(walk.next.x, min(walk.next.y, walk.next.z));
  return max(plane < walk.leave_soon ? plane : walk.leave, walk.front);
}

void leave_cell(GridRay ray, Lattice l, float back, inout CellWalk walk) {
  bool x = walk.next.x <= walk.next.y && walk.next.x <= walk.next.z, y = !x && walk.next.y <= walk.next.z;
  ivec3 crossed = ivec3(x, y, !x && !y) * mix(ivec3(-1), ivec3(1), greaterThanEqual(ray.direction, vec3(0.0)));
  ivec3 to = walk.cell + crossed;
  walk.cell = clamp(to, ivec3(0), l.size - 1);
#ifdef IS_UNEVEN
  for (int axis = 0; axis < 3; ++axis) find_next(ray, l, axis, walk);
#else
  vec3 plane = vec3(to + ivec3(greaterThanEqual(ray.direction, vec3(0.0))));
  walk.next = mix((plane - l.origin) * (ray.inverse / l.per_unit), vec3(kNever), ray.is_parallel);
#endif
  walk.front = back;
}

// Place in the walk's cell at a depth, in [0, 1].
vec3 place_in_cell(GridRay ray, Lattice l, ivec3 cell, float z) {
#ifdef IS_UNEVEN
  vec3 at = ray.origin + ray.direction * z, place;
  for (int axis = 0; axis < 3; ++axis) {
    float low = lattice_plane(l, axis, cell[axis]), high = lattice_plane(l, axis, cell[axis] + 1);
    place[axis] = (at[axis] - low) / (high - low);
  }
  return clamp(place, 0.0, 1.0);
#else
  return clamp(l.origin + l.direction * z - vec3(cell), 0.0, 1.0);
#endif
}

bool is_missing(float value) { return (floatBitsToUint(value) & 0x7FFFFFFFu) > 0x7F800000u; }
