// Members of the uniform block of the source `walk`, for GLSL and C++ alike (src/gl/blocks.h). Four scalars a row.
uint last_vertex;
uint face_count;      // boundary, then faces of the cells around the eye
uint first_eye_face;
uint node_count;      // of lists: entries that there is room for
int steps;            // of a ray in one pass, at most
int is_first_pass;
int is_first_layer;   // of peeled faces
uint sorted_run;      // of lists: entries in a row that are in order; 0: the first pass
