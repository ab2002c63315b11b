// The control points of the function themselves, and a segment taken from one to the next.

#include "segment.glsl"
#include "integrators/tables.glsl"

// [intervals][3]: rho, colour at the reference; their slopes; (start, end, reference, 0).
layout(binding = 2) uniform samplerBuffer control_points;
layout(binding = 3) uniform isamplerBuffer first_interval;  // [buckets] interval at the lower end of each

int guess_interval(float scalar) {
  float at = (scalar - tables.points_first) * tables.buckets_per_scalar;
  return texelFetch(first_interval, int(clamp(at, 0.0, float(tables.last_bucket)))).x;
}

// The interval that holds a scalar, one at a control point that which starts there: by halves, since many may share a
// bucket.
int find_interval(float scalar) {
  int bucket = int(clamp((scalar - tables.points_first) * tables.buckets_per_scalar, 0.0, float(tables.last_bucket)));
  int low = texelFetch(first_interval, bucket).x;
  // The next bucket, too: a scalar on the border may be rounded into either.
  int high = bucket + 2 <= tables.last_bucket ? texelFetch(first_interval, bucket + 2).x : tables.last_interval;
  while (low < high) {
    int middle = (low + high + 1) / 2;
    bool starts_behind = texelFetch(control_points, 3 * middle + 2).x > scalar;
    low = starts_behind ? low : middle;
    high = starts_behind ? middle - 1 : high;
  }
  return low;
}

// Extinction and colour at a scalar.
vec4 eval_optics(float scalar) {
  int interval = find_interval(scalar);
  vec4 place = texelFetch(control_points, 3 * interval + 2);
  vec4 front = texelFetch(control_points, 3 * interval), slope = texelFetch(control_points, 3 * interval + 1);
  vec4 optics = front + slope * (scalar - place.z);
  return vec4(max(optics.x, 0.0), optics.yzw);
}

// Adds a piece of constant extinction and colour.
void composite_uniform(vec4 optics, float len, inout vec4 sum) {
  float depth = optics.x * len;
  composite_piece(depth, depth * optics.yzw, sum);
}

// A segment on its way from control point to control point.
struct Course {
  Segment segment;
  float t;       // share of the segment that has been passed
  float scalar;  // there
  int interval;  // a guess, until it holds the scalar
  bool is_pending;
};

#ifdef ISO_VALUES
// [back][front]: first and next iso-value that a segment meets, the interval before the first (Espinha and Celes 2005).
layout(binding = 5) uniform sampler2D iso_values;

// The interval in which a ray sets out, by their tie rule: see `optics::find_front_interval`.
int first_guess(Segment segment) {
  ivec2 size = textureSize(iso_values, 0);
  vec2 at = (vec2(segment.scalar_front, segment.scalar_back) - tables.first_iso) * tables.isos_per_scalar;
  ivec2 texel = ivec2(clamp(at, vec2(0.0), vec2(size - 1)));
  vec4 isos = texelFetch(iso_values, texel, 0);
  ivec2 is_passed = texel.y < texel.x ? ivec2(lessThanEqual(vec2(segment.scalar_front), isos.xy))
                                      : ivec2(greaterThanEqual(vec2(segment.scalar_front), isos.xy));
  int passed = is_passed.x + is_passed.y;
  return int(isos.z) + (texel.y < texel.x ? -passed : passed);
}
#else
int first_guess(Segment segment) { return guess_interval(segment.scalar_front); }
#endif

Course begin_course(Segment segment) {
  return Course(segment, 0.0, segment.scalar_front, first_guess(segment), segment.world_length > 0.0);
}

// On such a piece extinction and colour are linear.
struct LinearPiece {
  vec4 front;  // extinction, colour
  vec4 back;
  float world_length;
};

// The piece up to the next control point, or the end. False while the interval is still being looked for: then the
// course is nearer to it. A ray that falls from a control point starts in the interval below (the tie rule of Espinha
// and Celes 2005).
bool find_piece(inout Course course, out LinearPiece piece, out float goal_t, out float goal) {
  vec4 front = texelFetch(control_points, 3 * course.interval);
  vec4 slope = texelFetch(control_points, 3 * course.interval + 1);
  vec4 place = texelFetch(control_points, 3 * course.interval + 2);
  Segment segment = course.segment;
  float span = segment.scalar_back - segment.scalar_front;
  bool rises = span >= 0.0;
  bool is_above = rises ? course.scalar >= place.y : course.scalar > place.y;
  bool is_below = rises ? course.scalar < place.x : course.scalar <= place.x;
  course.interval += is_above ? 1 : is_below ? -1 : 0;

  float border = rises ? place.y : place.x;
  float border_t = span == 0.0 ? 1.0 : max((border - segment.scalar_front) / span, course.t);
  goal_t = min(border_t, 1.0);
  goal = border_t >= 1.0 ? segment.scalar_back : border;
  vec4 here = front + slope * (course.scalar - place.z), there = front + slope * (goal - place.z);
  piece.front = vec4(max(here.x, 0.0), here.yzw);
  piece.back = vec4(max(there.x, 0.0), there.yzw);
  piece.world_length = segment.world_length * (goal_t - course.t);
  return !is_above && !is_below;
}

// Takes the piece no further than an optical depth of `deepest`, and the course to its end.
void pass_piece(float deepest, float goal_t, float goal, inout LinearPiece piece, inout Course course) {
  float depth = max(piece.front.x, piece.back.x) * piece.world_length;
  float share = min(deepest / max(depth, 1e-30), 1.0);
  float next_t = mix(course.t, goal_t, share);
  // A step too small for float would never end: then go all the way.
  bool arrives = share >= 1.0 || next_t <= course.t;
  if (!arrives) piece.back = mix(piece.front, piece.back, share);
  piece.world_length *= arrives ? 1.0 : share;
  Segment segment = course.segment;
  course.is_pending = !arrives || goal_t < 1.0;
  course.interval += arrives && goal_t < 1.0 ? (segment.scalar_back >= segment.scalar_front ? 1 : -1) : 0;
  course.t = arrives ? goal_t : next_t;
  course.scalar = arrives ? goal : mix(segment.scalar_front, segment.scalar_back, next_t);
}
