// Filtered values of the two slices of a slab, where each ray meets them or is cut off by the box before it does.

layout(binding = 9) uniform sampler2D lower_slice;   // gradient in grid coordinates, scalar
layout(binding = 10) uniform sampler2D upper_slice;  // the one with the larger t
