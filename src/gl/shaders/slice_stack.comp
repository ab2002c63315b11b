// Puts the values of a 3D texture into a stack of 2D textures along one axis.

layout(local_size_x = 8, local_size_y = 8, local_size_z = 1) in;
layout(binding = 6) uniform sampler3D values;
layout(binding = 1) writeonly uniform image2DArray stack;
layout(location = 0) uniform int axis;

void main() {
  ivec3 at = ivec3(gl_GlobalInvocationID);
  ivec3 from = axis == 0 ? at.zxy : axis == 1 ? at.xzy : at;
  if (any(greaterThanEqual(from, textureSize(values, 0)))) return;
  imageStore(stack, at, vec4(texelFetch(values, from, 0).x));
}
