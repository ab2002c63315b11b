// Where rays enter the mesh: a list for each pixel (Yang, Hensley, Gruen, Thibieroz 2010).

layout(std430, binding = 0) buffer Counters {
  uint entry_count;       // that were asked for, more than there is room for at times
  uint unfinished_count;  // rays that need another pass
  uint entered_count;     // rays that met the mesh
  uint stopped_count;     // rays stopped because they did not get on
  uint segments[64];      // spread, so that they are not fought for
} counters;

struct Entry {
  uint face;
  float depth;
  uint next;  // kNoEntry: the last
};
const uint kNoEntry = 0xFFFFFFFFu;

layout(std430, binding = 1) buffer Entries { Entry entries[]; };
layout(std430, binding = 2) buffer Heads { uint heads[]; };  // [rows][width]
