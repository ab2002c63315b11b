// Members of the uniform block of a frame, for GLSL and C++ alike (src/gl/blocks.h): scalars of four bytes, four a row.
int width;
int height;
int row_begin;          // of the part of the picture that a pass draws
int row_end;
float z_near;           // rays start at this depth
float world_per_local;
float eye_x;            // camera frame
float eye_y;
float eye_z;
float pixel_step;       // slope (perspective) or distance (orthographic) between pixels
int is_orthographic;
int use_early_ray_termination;
