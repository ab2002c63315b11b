// A ray through a tetrahedron: the faces it enters and leaves through, by the products of walk.glsl, so that every ray
// passes exactly the cells that it is walked through.

#include "mesh_geometry.glsl"
#include "projected_segment.glsl"

// Nothing (length 0) where the ray misses the cell, or enters it through another face than the one opposite corner
// `entered`: so each pixel is drawn once, by the face that the ray really enters through. -1: any.
ProjectedSegment pass_tetrahedron(Ray ray, vec4 corners[4], int entered) {
  vec2 at[4];
  for (int k = 0; k < 4; ++k) at[k] = shear(ray, corners[k]);
  float p01 = edge_product(at[0], at[1]), p02 = edge_product(at[0], at[2]), p03 = edge_product(at[0], at[3]);
  float p12 = edge_product(at[1], at[2]), p13 = edge_product(at[1], at[3]), p23 = edge_product(at[2], at[3]);
  bool s01 = passes_inside(p01, at[0], at[1]), s02 = passes_inside(p02, at[0], at[2]);
  bool s03 = passes_inside(p03, at[0], at[3]), s12 = passes_inside(p12, at[1], at[2]);
  bool s13 = passes_inside(p13, at[1], at[3]), s23 = passes_inside(p23, at[2], at[3]);
  bool passes[4] = bool[](s12 == s23 && s23 != s13, s02 == s23 && s23 != s03, s01 == s13 && s13 != s03,
                          s01 == s12 && s12 != s02);
  vec4 weights[4] = vec4[](vec4(0.0, p23, -p13, p12), vec4(p23, 0.0, -p03, p02), vec4(p13, -p03, 0.0, p01),
                           vec4(p12, -p02, p01, 0.0));
  vec4 z = vec4(corners[0].z, corners[1].z, corners[2].z, corners[3].z);
  vec4 scalar = vec4(corners[0].w, corners[1].w, corners[2].w, corners[3].w);

  vec4 first = vec4(0.0), last = vec4(0.0);
  int count = 0, first_face = 0, last_face = 0;
  for (int k = 0; k < 4; ++k) {
    if (!passes[k]) continue;
    if (count == 0) {
      first = weights[k];
      first_face = k;
    }
    last = weights[k];
    last_face = k;
    ++count;
  }
  float first_total = first.x + first.y + first.z + first.w, last_total = last.x + last.y + last.z + last.w;
  ProjectedSegment passed = ProjectedSegment(0.0, 0.0, 0.0, 0.0);
  if (count < 2 || first_total == 0.0 || last_total == 0.0) return passed;
  float z_first = dot(first, z) / first_total, z_last = dot(last, z) / last_total;
  float scalar_first = dot(first, scalar) / first_total, scalar_last = dot(last, scalar) / last_total;
  bool is_turned = z_last < z_first;
  if (entered >= 0 && entered != (is_turned ? last_face : first_face)) return passed;
  passed.z_front = is_turned ? z_last : z_first;
  float z_back = is_turned ? z_first : z_last;
  passed.scalar_front = is_turned ? scalar_last : scalar_first;
  passed.scalar_back = is_turned ? scalar_first : scalar_last;
  if (passed.z_front < frame.z_near) {
    // Of what lies behind the eye nothing is integrated.
    float part = z_back > frame.z_near ? (z_back - frame.z_near) / (z_back - passed.z_front) : 0.0;
    passed.scalar_front = mix(passed.scalar_back, passed.scalar_front, part);
    passed.z_front = frame.z_near;
  }
  passed.z_length = max(z_back - passed.z_front, 0.0);
  return passed;
}
