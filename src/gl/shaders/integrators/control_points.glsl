// The control points of the function themselves, and the pieces of a segment between them.

#include "segment.glsl"
#include "integrators/tables.glsl"

// [intervals + 1][3]: rho, colour at the reference; their slopes; (start, reference, 0, 0). The last has a start only.
layout(binding = 2) uniform samplerBuffer control_points;
layout(binding = 3) uniform isamplerBuffer first_interval;  // [buckets] interval at the lower end of each

float start_of(int interval) { return texelFetch(control_points, 3 * interval + 2).x; }

// The interval that holds a scalar; one at a control point belongs to the interval that starts there.
int find_interval(float scalar) {
  float at = (scalar - tables.points_first) * tables.buckets_per_scalar;
  int interval = texelFetch(first_interval, int(clamp(at, 0.0, float(tables.last_bucket)))).x;
  while (interval + 1 < tables.interval_count && start_of(interval + 1) <= scalar) ++interval;
  return interval;
}

// The interval in which a ray sets out: one that falls from a control point starts in the interval below (the tie rule
// of Espinha and Celes 2005).
int find_front_interval(float scalar, bool rises) {
  int interval = find_interval(scalar);
  return !rises && start_of(interval) == scalar ? max(interval - 1, 0) : interval;
}

// Extinction and colour by the line of an interval.
vec4 eval_interval(int interval, float scalar) {
  vec4 front = texelFetch(control_points, 3 * interval), slope = texelFetch(control_points, 3 * interval + 1);
  vec4 optics = front + slope * (scalar - texelFetch(control_points, 3 * interval + 2).y);
  return vec4(max(optics.x, 0.0), optics.yzw);
}

vec4 eval_optics(float scalar) { return eval_interval(find_interval(scalar), scalar); }

// Adds a piece of constant extinction and colour.
void composite_uniform(vec4 optics, float len, inout vec4 sum) {
  float depth = optics.x * len;
  composite_piece(depth, depth * optics.yzw, sum);
}

// Goes along a segment from control point to control point. A walk holds where it is; a piece is no deeper than asked.
struct LinearWalk {
  int interval;
  float t;
  float scalar;
  bool is_done;
};

struct LinearPiece {
  vec4 front;  // extinction, colour
  vec4 back;
  float world_length;
};

LinearWalk begin_linear_walk(Segment segment) {
  bool rises = segment.scalar_back >= segment.scalar_front;
  return LinearWalk(find_front_interval(segment.scalar_front, rises), 0.0, segment.scalar_front,
                    !(segment.world_length > 0.0));
}

// Where the next piece would end, at the next control point or the segment's end: place, scalar; and if it is the end.
void find_goal(Segment segment, LinearWalk walk, out float goal_t, out float goal, out bool is_end) {
  float span = segment.scalar_back - segment.scalar_front;
  bool is_level = span == 0.0;
  float border = start_of(walk.interval + (span >= 0.0 ? 1 : 0));
  bool is_open = span >= 0.0 ? walk.interval + 1 >= tables.interval_count : walk.interval == 0;
  float border_t = is_open || is_level ? 1.0 : max((border - segment.scalar_front) / span, walk.t);
  is_end = border_t >= 1.0;
  goal_t = is_end ? 1.0 : border_t;
  goal = is_end ? segment.scalar_back : border;
}

// The next piece, no deeper than `deepest` (optical depth).
LinearPiece next_piece(Segment segment, float deepest, inout LinearWalk walk) {
  float goal_t, goal;
  bool is_end;
  find_goal(segment, walk, goal_t, goal, is_end);
  vec4 front = eval_interval(walk.interval, walk.scalar), back = eval_interval(walk.interval, goal);
  float reach = deepest / max(max(front.x, back.x) * segment.world_length, 1e-30);
  // A step too small for float would never end: then go all the way.
  bool arrives = goal_t <= walk.t + reach || walk.t + reach <= walk.t;
  float next_t = goal_t, next = goal;
  if (!arrives) {
    next_t = walk.t + reach;
    next = segment.scalar_front + next_t * (segment.scalar_back - segment.scalar_front);
    back = eval_interval(walk.interval, next);
  }
  LinearPiece piece = LinearPiece(front, back, segment.world_length * (next_t - walk.t));
  walk.is_done = arrives && is_end;
  if (arrives && !is_end) walk.interval += segment.scalar_back >= segment.scalar_front ? 1 : -1;
  walk.t = next_t;
  walk.scalar = next;
  return piece;
}

// What comes after a millionth of the light has no colour to add.
const float kDark = 1e-6;
