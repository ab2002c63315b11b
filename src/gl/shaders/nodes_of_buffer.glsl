// Filtered values at the nodes of each brick's lattice (src/gl/filtered_nodes.h), one brick after the other.

layout(binding = 9) uniform samplerBuffer nodes;  // [bricks][z][y][x]

int node_at(Lattice l, ivec3 node) { return l.nodes + (node.z * (l.size.y + 1) + node.y) * (l.size.x + 1) + node.x; }

// Corners of a cell: lower or upper (x, y), (x + 1, y), (x, y + 1), (x + 1, y + 1).
void fetch_corners(Lattice l, ivec3 cell, out vec4 low, out vec4 high) {
  int a = node_at(l, cell), b = a + l.size.x + 1, slice = (l.size.x + 1) * (l.size.y + 1);
  low = vec4(texelFetch(nodes, a).x, texelFetch(nodes, a + 1).x, texelFetch(nodes, b).x, texelFetch(nodes, b + 1).x);
  a += slice;
  b += slice;
  high = vec4(texelFetch(nodes, a).x, texelFetch(nodes, a + 1).x, texelFetch(nodes, b).x, texelFetch(nodes, b + 1).x);
}
