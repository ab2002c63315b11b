// The source `walk`: a ray goes from tetrahedron to tetrahedron (Garrity 1990; Weiler et al. 2003; Espinha and Celes
// 2005); the steps are those of src/cpu/kernels/walk-inl.h.

#include "mesh.glsl"
#include "segment.glsl"
#include "integrator.glsl"

// A ray on its way: the face it enters through, seen along it, and what it has gathered.
struct Walker {
  uvec3 id;
  uint cell;  // kNoCell: outside
  vec3 x, y, z, scalar, weight;
  float z_front, scalar_front;
  vec4 sum;
};

void enter(Ray ray, uint face, inout Walker walker) {
  MetFace met = meet_face(ray, face);
  walker.id = met.id;
  walker.cell = met.cell;
  walker.x = vec3(met.at[0].x, met.at[1].x, met.at[2].x);
  walker.y = vec3(met.at[0].y, met.at[1].y, met.at[2].y);
  walker.z = met.z;
  walker.scalar = met.scalar;
  walker.weight = max(met.weight, 0.0);
  walker.z_front = interpolate(walker.weight, walker.z, met.z[0]);
  walker.scalar_front = interpolate(walker.weight, walker.scalar, met.scalar[0]);
}

// Through one cell: the segment that the ray passes there.
Segment walk_cell(Ray ray, inout Walker walker) {
  // The vertex opposite the entry face: by exclusive or with the three that are known.
  int links = 5 * int(walker.cell);
  uint d = min(texelFetch(cells, links).x ^ walker.id.x ^ walker.id.y ^ walker.id.z, walk.last_vertex);
  vec4 vertex = texelFetch(vertices, int(d));
  vec2 at = shear(ray, vertex);

  // On which side of the edges (a, d), (b, d), (c, d) does the ray pass?
  precise vec3 product = walker.x * at.y - walker.y * at.x;
  bool passes_a = passes_inside(product.x, vec2(walker.x.x, walker.y.x), at);
  bool passes_b = passes_inside(product.y, vec2(walker.x.y, walker.y.y), at);
  bool passes_c = passes_inside(product.z, vec2(walker.x.z, walker.y.z), at);

  // It leaves through the face without a, b or c: that vertex is replaced by d.
  bool out_a = passes_c && !passes_b, out_c = passes_b && !passes_a, out_b = !out_a && !out_c;
  uint replaced = out_a ? walker.id.x : out_c ? walker.id.z : walker.id.y;
  uint rank = 1u + uint(walker.id.x < replaced) + uint(walker.id.y < replaced) + uint(walker.id.z < replaced) +
              uint(d < replaced);
  uint neighbour = texelFetch(cells, links + int(rank)).x;

  // Edge products of the new face; those that keep their edge keep their weight.
  bvec3 is_out = bvec3(out_a, out_b, out_c);
  vec3 fresh = vec3(out_b ? -product.z : product.y, out_c ? -product.x : product.z, out_a ? -product.y : product.x);
  walker.weight = mix(max(fresh, 0.0), walker.weight, is_out);
  walker.id = uvec3(out_a ? d : walker.id.x, out_b ? d : walker.id.y, out_c ? d : walker.id.z);
  walker.x = mix(walker.x, vec3(at.x), is_out);
  walker.y = mix(walker.y, vec3(at.y), is_out);
  walker.z = mix(walker.z, vec3(vertex.z), is_out);
  walker.scalar = mix(walker.scalar, vec3(vertex.w), is_out);

  // Depth and scalar where it leaves.
  float z_back = max(interpolate(walker.weight, walker.z, walker.z_front), walker.z_front);
  float scalar_back = interpolate(walker.weight, walker.scalar, walker.scalar_front);
#ifdef CELL_DATA
  scalar_back = walker.scalar_front = texelFetch(cell_scalars, int(walker.cell)).x;
#endif
  Segment segment = Segment(walker.scalar_front, scalar_back, (z_back - walker.z_front) * ray.world_per_z);
#ifdef BEHIND_EYE
  // Of what lies behind the eye nothing is integrated.
  float part = z_back <= frame.z_near            ? 0.0
               : walker.z_front < frame.z_near ? (z_back - frame.z_near) / (z_back - walker.z_front)
                                               : 1.0;
  segment.scalar_front = mix(scalar_back, walker.scalar_front, part);
  segment.world_length *= part;
#endif
  walker.z_front = z_back;
  walker.scalar_front = scalar_back;
  walker.cell = neighbour;
  return segment;
}

// Sums may round past 1 by an ulp.
vec4 premultiplied(vec4 sum) { return min(vec4(sum.rgb, 1.0 - sum.a), 1.0); }
