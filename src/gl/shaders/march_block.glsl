// Members of the uniform block of the source `march`, for GLSL and C++ alike (src/gl/blocks.h). Four scalars a row.
vec4 grid_x;  // rows of the matrix that takes places of the camera frame to grid coordinates
vec4 grid_y;
vec4 grid_z;
vec4 upper;   // grid coordinates of the grid's last corner; lowest is 0
int cells_x;
int cells_y;
int cells_z;
int bricks_a_pass;   // that a ray is taken through, at most
int bricks_x;
int bricks_y;
int bricks_z;
int is_first_pass;
int plane_base_y;    // where the planes of the second axis begin, and of the third
int plane_base_z;
int most_work;       // pieces that a ray is taken through in a pass, about
float slab_scale;    // place in the picture of slabs = slab_offset + stored scalar * slab_scale
float texel_offset;  // stored scalar = texel_offset + texel * texel_scale
float texel_scale;
float allowed_rate;  // error in colour for one unit of world length that a segment may have
float most_pieces;   // that a cell is cut into
float steepness_first;
float bins_per_scalar;
float sample_distance;  // world length between samples at a fixed rate; 0: none
float negligible;       // transmittance below which a ray ends
float texel_x;  // sides of a texel where that of a texture with as many as there are values is 1
float texel_y;
float texel_z;
float slab_offset;
