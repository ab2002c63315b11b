// A prepared mesh (include/tetravox/mesh.h) as the camera sees it, and where rays enter it.

#include "mesh_geometry.glsl"

layout(std140, binding = 2) uniform WalkBlock {
#include "walk_block.glsl"
} walk;

layout(binding = 6) uniform samplerBuffer vertices;       // [vertices] camera frame, stored scalar
layout(binding = 7) uniform usamplerBuffer cells;         // [cells][5] exclusive or of the vertices, neighbours by rank
layout(binding = 8) uniform usamplerBuffer faces;         // [faces] cell, vertices
layout(binding = 9) uniform samplerBuffer cell_scalars;   // [cells], with cell data

const uint kNoCell = 0xFFFFFFFFu;
const uint kNoFace = 0xFFFFFFFFu;

// A face met by a ray: weights of its vertices, not normalised.
struct MetFace {
  uint cell;
  uvec3 id;
  vec2 at[3];
  vec3 z;
  vec3 scalar;
  vec3 weight;
};

MetFace meet_face(Ray ray, uint face) {
  uvec4 links = texelFetch(faces, int(face));
  MetFace met;
  met.cell = links.x;
  met.id = links.yzw;
  for (int k = 0; k < 3; ++k) {
    vec4 vertex = texelFetch(vertices, int(met.id[k]));
    met.at[k] = shear(ray, vertex);
    met.z[k] = vertex.z;
    met.scalar[k] = vertex.w;
  }
  met.weight = vec3(edge_product(met.at[1], met.at[2]), edge_product(met.at[2], met.at[0]),
                    edge_product(met.at[0], met.at[1]));
  return met;
}

// Whether the ray enters through the face, from its outer side.
bool is_entered(MetFace met) {
  return passes_inside(met.weight[2], met.at[0], met.at[1]) && passes_inside(met.weight[0], met.at[1], met.at[2]) &&
         passes_inside(met.weight[1], met.at[2], met.at[0]);
}

float interpolate(vec3 weight, vec3 values, float otherwise) {
  float total = weight.x + weight.y + weight.z;
  return total > 0.0 ? (weight.x * values.x + weight.y * values.y + weight.z * values.z) / total : otherwise;
}

// What rays of a perspective met before the eye is of no concern, unless the eye is in that very cell.
bool is_before_eye(uint face, float depth) {
  return frame.is_orthographic == 0 && face < walk.first_eye_face && depth < frame.z_near;
}
