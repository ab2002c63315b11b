// The field between eight values, whatever holds them.

// Values at the corners of a cell, (i, j), (i + 1, j), (i, j + 1), (i + 1, j + 1), below and above; stored scalars.
struct Corners {
  vec4 low;
  vec4 high;
  vec3 share;  // of the way from the lower to the upper ones
};

vec4 stored(vec4 texels) { return slices.texel_offset + texels * slices.texel_scale; }
float stored(float texel) { return slices.texel_offset + texel * slices.texel_scale; }

float interpolate(Corners corners) {
  vec4 across = mix(corners.low, corners.high, corners.share.z);
  vec2 along = mix(across.xy, across.zw, corners.share.y);
  return mix(along.x, along.y, corners.share.x);
}

// Which value is at the lower corner, and how far a place is from it.
ivec3 lower_corner(vec3 at, ivec3 size, out vec3 share) {
  ivec3 corner = clamp(ivec3(floor(at)), ivec3(0), max(size - 2, ivec3(0)));
  share = clamp(at - vec3(corner), 0.0, 1.0);
  return corner;
}

// The value whose cell a place is in: of cell data, or the nearest.
ivec3 nearest_value(vec3 at, ivec3 size) { return clamp(ivec3(floor(at)), ivec3(0), size - 1); }
