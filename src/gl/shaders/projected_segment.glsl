// What a ray passes of one cell.
struct ProjectedSegment {
  float z_front;  // camera frame
  float z_length;
  float scalar_front;  // stored scalars
  float scalar_back;
};
