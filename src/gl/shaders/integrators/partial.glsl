// Partial pre-integration (Moreland and Angel 2004; Espinha and Celes 2005): exact for piecewise linear functions.

#include "integrators/control_points.glsl"

// 1 - psi over gamma = d / (d + 1), see src/optics/transparency_table.h; linear between the centres of texels.
layout(binding = 4) uniform sampler2D absorbed_table;

struct Front {
  Course course;
};

Front front_at(float scalar) {
  return Front(Course(Segment(scalar, scalar, 0.0), 1.0, scalar, 0, false));
}
void begin(Segment segment, inout Front front) { front.course = begin_course(segment); }
bool is_pending(Front front) { return front.course.is_pending; }

float look_up_absorbed(float front, float back) {
  float size = float(textureSize(absorbed_table, 0).x - 1);
  vec2 at = size * vec2(back / (back + 1.0), front / (front + 1.0));
  ivec2 node = min(ivec2(at), ivec2(int(size) - 1));
  vec2 f = at - vec2(node);
  float low = mix(texelFetch(absorbed_table, node, 0).x, texelFetch(absorbed_table, node + ivec2(1, 0), 0).x, f.x);
  float high =
      mix(texelFetch(absorbed_table, node + ivec2(0, 1), 0).x, texelFetch(absorbed_table, node + ivec2(1, 1), 0).x, f.x);
  return mix(low, high, f.y);
}

// C = c0 (1 - psi) + c1 (psi - exp(-tau)), written with 1 - psi and alpha so that nothing cancels.
void composite_linear(LinearPiece piece, inout vec4 sum) {
  vec2 depths = vec2(piece.front.x, piece.back.x) * piece.world_length;
  float depth = 0.5 * (depths.x + depths.y);
  float alpha = depth * absorbed_ratio(depth);
  vec3 color = (piece.front.yzw - piece.back.yzw) * look_up_absorbed(depths.x, depths.y) + piece.back.yzw * alpha;
  sum.rgb += sum.a * color;
  sum.a -= sum.a * alpha;
}

void advance(inout Front front, inout vec4 sum) {
  const float kDeepest = 8.0;  // the table is fine up to this optical depth
  LinearPiece piece;
  float goal_t, goal;
  if (!find_piece(front.course, piece, goal_t, goal)) return;
  pass_piece(kDeepest, goal_t, goal, piece, front.course);
  composite_linear(piece, sum);
}

#include "integrators/integrate.glsl"
