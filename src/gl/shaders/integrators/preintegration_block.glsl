// Members of the uniform block of tables of ray integrals, for GLSL and C++ alike (src/gl/blocks.h): see
// src/optics/segment_domain.h. Four scalars of four bytes a row.
float first_scalar;        // stored scalar at place 0
float places_per_scalar;
float longest;             // world length of the longest segment
float largest_extinction;
int scalars;               // entries along each scalar (table3d, polynomial)
int lengths;               // along the length (table3d)
int is_logarithmic;        // spacing of the lengths
int planes;                // (cylindrical)
int tile;                  // texels a side
int columns;               // of tiles
int rows;
int unused_2;
