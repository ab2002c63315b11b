// For marchers that take a brick at once.

struct Marcher {
  ivec3 brick;
  uvec4 plan;
  float z, leave;
};

Marcher no_brick_yet() { return Marcher(ivec3(0), uvec4(0u), 0.0, 0.0); }
void enter_brick(GridRay ray, ivec3 brick, uvec4 plan, float z, float leave, inout Marcher m) {
  m = Marcher(brick, plan, z, leave);
}
float reached_by(Marcher m) { return m.z; }
bool take_step(GridRay ray, inout Marcher m, inout vec4 sum) {
  m.z = march_brick(ray, m.brick, m.plan, m.z, m.leave, sum, segment_count);
  return false;
}
