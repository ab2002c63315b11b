// Iso-surfaces without polygons (Engel, Kraus, Ertl 2001; Engel and Ertl 2002): a slab holds those whose values lie
// between its two scalars. What is seen of them stands in a 2D texture over the two, by how many values lie below each.

layout(binding = 8) uniform sampler2D surface_colors;  // [back][front], premultiplied

int count_below(float scalar) {
  int count = 0;
  for (int i = 0; i < slices.surface_count; ++i) count += slices.surface_values[i / 4][i % 4] <= scalar ? 1 : 0;
  return count;
}

// The value of the surface that is met first on the way from one count to another.
float first_value(int front, int back) {
  int i = min(front, back) == front ? front : front - 1;
  return slices.surface_values[i / 4][i % 4];
}
