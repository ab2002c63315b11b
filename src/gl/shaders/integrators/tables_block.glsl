// Members of the uniform block of the integrators' tables, for GLSL and C++ alike (src/gl/blocks.h): see
// src/optics/antiderivative_table.h. Four scalars of four bytes a row.
vec4 density_below;   // rho, rho * colour before node 0
vec4 density_above;   // and after the last one
float first;          // stored scalar at node 0
float nodes_per_scalar;
float density_per_unit;
float units_per_density;
float split_threshold;
int last_node;
float points_first;
float buckets_per_scalar;
int last_bucket;
int last_interval;    // between control points
int samples;          // of post-classification, a segment
float first_iso;      // stored scalar where iso-values begin (src/optics/iso_value_table.h)
float isos_per_scalar;
int unused_0;
int unused_1;
int unused_2;
