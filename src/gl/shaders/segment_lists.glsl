// The segments of each pixel, in lists that are sorted afterwards (Carpenter 1984; Yang, Hensley, Gruen, Thibieroz
// 2010).

layout(std430, binding = 0) buffer ListCounters {
  uint node_count;        // that were asked for, more than there is room for at times
  uint unfinished_count;  // pixels that need another pass
  uint too_long_count;    // lists that cannot be sorted
} list_counters;

struct Node {
  float z_front;
  float z_length;
  float scalar_front;
  float scalar_back;
  uint next;  // kNoNode: the last
};
const uint kNoNode = 0xFFFFFFFFu;

layout(std430, binding = 1) buffer Nodes { Node nodes[]; };
layout(std430, binding = 2) buffer Heads { uint heads[]; };  // [rows of the pass][width]
