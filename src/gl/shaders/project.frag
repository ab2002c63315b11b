// Projected tetrahedra (Shirley and Tuchman 1990; Wilhelms and Van Gelder 1991): the segment from what a triangle
// carries. Of a perspective that is 1 / z of the front, the difference of 1 / z, and scalar / z: linear in the picture,
// so that nothing is approximated (Kraus, Qiao, Ertl 2004 show what comes of carrying the segments themselves).

#include "projection.glsl"
#include "projected_fragment.glsl"

noperspective in vec4 ends;
#ifdef CELL_DATA
flat in float cell_scalar;
#endif

void main() {
  float difference = max(ends.y, 0.0);
  ProjectedSegment passed;
#ifdef ORTHOGRAPHIC
  passed.z_front = ends.x;
  passed.z_length = difference;
  passed.scalar_front = ends.z;
  passed.scalar_back = ends.w;
#else
  float front = 1.0 / ends.x, back = 1.0 / (ends.x - difference);
  passed.z_front = front + frame.eye_z;
  passed.z_length = difference * front * back;
  passed.scalar_front = ends.z * front;
  passed.scalar_back = ends.w * back;
#endif
#ifdef CELL_DATA
  passed.scalar_front = passed.scalar_back = cell_scalar;
#endif
  finish(passed);
}
