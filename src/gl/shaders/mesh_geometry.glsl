// Places and edges as a ray sees them: the same in every cell that has them.

#include "frame.glsl"

// A vertex seen along a ray, which is the z axis then.
vec2 shear(Ray ray, vec4 vertex) {
  precise vec2 sheared = (vertex.xy - ray.slope * vertex.z) - ray.offset;
  return sheared;
}

// a x b: the same two vertices give the same product in every face and cell, up to its sign.
float edge_product(vec2 a, vec2 b) {
  precise float product = a.x * b.y - a.y * b.x;
  return product;
}

// Whether the ray passes on the inner (left) side of the edge from a to b. One that meets it exactly passes as if it
// were moved by an infinitesimal (Edelsbrunner, Muecke 1990, "Simulation of Simplicity").
bool passes_inside(float product, vec2 a, vec2 b) {
  return product > 0.0 || (product == 0.0 && (b.y < a.y || (b.y == a.y && b.x > a.x)));
}
