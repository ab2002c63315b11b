// Members of the uniform block of slices, for GLSL and C++ alike (src/gl/blocks.h): scalars of four bytes, four a row.
vec4 grid_x;          // grid coordinates of a place (x, y, z, 1) of the camera frame
vec4 grid_y;
vec4 grid_z;
vec4 lower;           // of the box, grid coordinates
vec4 upper;
vec4 plane;           // position t of a place (x, y, z, 1), of planes
vec4 light_x;         // half-angle: axes of the light's buffer, and the way the light goes; camera frame
vec4 light_y;
vec4 light_z;
vec4 light_vectors[8];  // camera frame, towards the light; w: 1 for a headlight
vec4 light_colors[8];
vec4 surface_values[4];  // stored scalars, ascending
float t_first;        // of slice 0
float t_step;
int are_shells;       // t is the distance from the eye
int stack_axis;       // of the 2D textures
float value_shift;    // index of a value = grid coordinate + shift
float texel_offset;   // stored scalar = offset + texel * scale
float texel_scale;
int light_count;
float ambient;
float diffuse;
float specular;
float shininess;
float half_strength;  // square of the gradient magnitude at which shading has half its strength
int is_two_sided;
int surface_count;
int kernel_radius;
float translucency;
float blur_radius;    // of the indirect light between two slabs, in the light's buffer from 0 to 1
float segments_per_bend;  // square of the segments of a slab that the field is off its chord by 1
float scalar_low;     // what the field keeps to, stored scalars
float scalar_high;
int unused_0;
int unused_1;
int unused_2;
