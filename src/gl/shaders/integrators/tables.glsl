layout(std140, binding = 1) uniform TablesBlock {
#include "integrators/tables_block.glsl"
} tables;
