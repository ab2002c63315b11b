// The ray of the pixel through the cell: view-independent cell projection (Weiler, Kraus, Merz, Ertl 2003), and
// projected tetrahedra with corrected pixels.

#include "projection.glsl"
#include "tetrahedron.glsl"
#include "projected_fragment.glsl"

flat in vec4 corners[4];
flat in int entered_face;

void main() { finish(pass_tetrahedron(ray_of(ivec2(gl_FragCoord.xy)), corners, entered_face)); }
