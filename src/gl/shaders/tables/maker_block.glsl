// Members of the uniform block of passes that make tables, for GLSL and C++ alike (src/gl/blocks.h). Four scalars a row.
int scalar_count;          // entries along each scalar
int plane_count;           // of an atlas,
int tile_size;
int column_count;
float share;               // of the longest length: of the slice
float longest_length;      // world
float most_extinction;     // per world length
int step_count;            // of integration
int step_begin;            // of one pass
int step_end;
int most_number;           // 2^bits - 1, what numbers are rounded to parts of; 0: floats as they are
int mode;                  // see steps.frag
int node_count;            // of the function
int unused_0;
int unused_1;
int unused_2;
