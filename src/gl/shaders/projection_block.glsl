// Members of the uniform block of the sources that project cells, for GLSL and C++ alike (src/gl/blocks.h).
vec4 right;           // rows of camera from mesh, for vertices that are kept in the mesh's frame
vec4 up;
vec4 forward;
int is_ordered;       // whether cells are looked up in the order, or stored in it
uint node_count;      // of lists: segments that there is room for
uint first_thick;     // vertices of the mesh come before
uint sorted_run;      // of lists: items in a row that are in order; 0: the first pass
int is_first_pass;    // of compositing them
int segments_a_pass;
int unused_0, unused_1;
