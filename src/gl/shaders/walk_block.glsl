// Members of the uniform block of the source `walk`, for GLSL and C++ alike (src/gl/blocks.h). Four scalars a row.
uint last_vertex;
uint face_count;      // boundary, then faces of the cells around the eye
uint first_eye_face;
uint node_count;      // of lists: entries that there is room for
int steps;            // of a ray in one pass, at most
int is_first_pass;
int is_first_layer;   // of peeled faces
int unused_0;
