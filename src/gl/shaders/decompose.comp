// Tetrahedra as triangles on the device: the steps of src/gl/decomposition.cpp, one cell an invocation.

#include "projection.glsl"

layout(local_size_x = 64) in;

layout(binding = 7) uniform usamplerBuffer cell_vertices;  // [cells]
layout(binding = 8) uniform usamplerBuffer order;          // [cells]
layout(binding = 9) uniform samplerBuffer cell_scalars;    // [cells], with cell data
layout(binding = 6) uniform usamplerBuffer screen_vertices;  // [vertices][3] ScreenVertex: place; scalar; depth

layout(std430, binding = 0) buffer Vertices { float drawn[]; };  // [..][6] ProjectedVertex, or [cells][4][3] OutlineVertex
layout(std430, binding = 1) buffer Indices { uint indices[]; };  // [cells][12] or [cells][6]; fewer triangles: no area

const int kOffScreen = int(0x80000000);

struct ScreenVertex {
  ivec2 place;
  float scalar;
  double depth;
};

ScreenVertex fetch_vertex(uint id) {
  int first = 3 * int(id);
  return ScreenVertex(ivec2(texelFetch(screen_vertices, first).xy),
                      uintBitsToFloat(texelFetch(screen_vertices, first + 1).x),
                      packDouble2x32(texelFetch(screen_vertices, first + 2).xy));
}

// Exact: places are below 2^23.
double cross2(dvec2 a, dvec2 b) { return a.x * b.y - a.y * b.x; }

double area(dvec2 a, dvec2 b, dvec2 c) { return cross2(b - a, c - a); }

// The step nearest to `at` inside the quadrilateral, or one of its corners.
dvec2 snap_inside(dvec2 at, dvec2 corners[4]) {
  double turn = area(corners[0], corners[1], corners[2]) > 0.0LF ? 1.0LF : -1.0LF;
  dvec2 low = floor(at);
  bvec2 is_high = bvec2(at.x - low.x > 0.5LF, at.y - low.y > 0.5LF);
  for (int flip = 0; flip < 4; ++flip) {
    dvec2 place = low + dvec2(is_high.x != (flip >= 2) ? 1.0LF : 0.0LF, is_high.y != (flip % 2 == 1) ? 1.0LF : 0.0LF);
    bool is_inside = true;
    for (int k = 0; k < 4; ++k) is_inside = is_inside && turn * area(corners[k], corners[(k + 1) & 3], place) >= 0.0LF;
    if (is_inside) return place;
  }
  dvec2 nearest = corners[0];
  for (int k = 1; k < 4; ++k)
    if (dot(corners[k] - at, corners[k] - at) < dot(nearest - at, nearest - at)) nearest = corners[k];
  return nearest;
}

void write_thick(uint place, dvec2 at, vec4 carried) {
  uint first = 6u * (projection.first_thick + place);
  vec2 clip = vec2(at) * (2.0 / (256.0 * vec2(frame.width, frame.height))) - 1.0;
  drawn[first] = clip.x;
  drawn[first + 1u] = clip.y;
  for (int k = 0; k < 4; ++k) drawn[first + 2u + uint(k)] = carried[k];
}

// As find_outline: `count` corners of `at` in turn, or of a line.
void write_outline(uint place, dvec2 at[4], int count) {
  const double kMargin = 4.0LF, kFarthest = 512.0LF;
  dvec2 outline[4];
  if (count == 0) {
    dvec2 first = at[0], last = at[0];
    for (int k = 1; k < 4; ++k) {
      if (at[k].x < first.x || (at[k].x == first.x && at[k].y < first.y)) first = at[k];
      if (at[k].x > last.x || (at[k].x == last.x && at[k].y > last.y)) last = at[k];
    }
    double size = length(last - first);
    dvec2 u = size > 0.0LF ? (last - first) * (kMargin / size) : dvec2(kMargin, 0.0LF), v = dvec2(-u.y, u.x);
    outline = dvec2[](first - u + v, first - u - v, last + u - v, last + u + v);
    count = 4;
  } else {
    for (int k = 0; k < 4; ++k) {
      int index = min(k, count - 1);
      dvec2 u = at[(index + 1) % count] - at[index], v = at[(index + count - 1) % count] - at[index];
      u /= max(length(u), 1e-9LF);
      v /= max(length(v), 1e-9LF);
      double reach = kMargin / max(abs(cross2(u, v)), 1e-9LF);
      double shrink = min(1.0LF, kFarthest / max(reach * length(u + v), 1e-9LF));
      outline[k] = at[index] - (u + v) * (reach * shrink);
    }
  }
  for (uint k = 0u; k < 4u; ++k) {
    vec2 clip = vec2(outline[k] * (2.0LF / (256.0LF * dvec2(frame.width, frame.height))) - 1.0LF);
    drawn[12u * place + 3u * k] = clip.x;
    drawn[12u * place + 3u * k + 1u] = clip.y;
    drawn[12u * place + 3u * k + 2u] = uintBitsToFloat(place);
  }
  uint corners[6] = uint[](0u, 1u, 2u, 0u, 2u, 3u);
  for (uint k = 0u; k < (count == 3 ? 3u : 6u); ++k) indices[6u * place + k] = 4u * place + corners[k];
}

void main() {
  uint place = gl_GlobalInvocationID.x;
  if (place >= projection.node_count) return;
  uint cell = texelFetch(order, int(place)).x, thick = projection.first_thick + place;
#ifdef OUTLINES
  for (uint k = 0u; k < 6u; ++k) indices[6u * place + k] = 4u * place;
#else
  for (uint k = 0u; k < 12u; ++k) indices[12u * place + k] = thick;
#endif
  uvec4 ids = texelFetch(cell_vertices, int(cell));
  if (ids.x == 0xFFFFFFFFu) return;
  ScreenVertex v[4];
  for (int k = 0; k < 4; ++k) {
    v[k] = fetch_vertex(ids[k]);
    if (v[k].place.x == kOffScreen) return;
  }
  dvec2 p0 = dvec2(v[0].place), d1 = dvec2(v[1].place) - p0, d2 = dvec2(v[2].place) - p0, d3 = dvec2(v[3].place) - p0;
  double weights[4] = double[](0.0LF, cross2(d2, d3), cross2(d3, d1), cross2(d1, d2));
  weights[0] = -(weights[1] + weights[2] + weights[3]);
  int positive = 0, negative = 0;
  for (int k = 0; k < 4; ++k) {
    positive += int(weights[k] > 0.0LF);
    negative += int(weights[k] < 0.0LF);
  }
  dvec2 at[4];
  for (int k = 0; k < 4; ++k) at[k] = dvec2(v[k].place);
#ifdef OUTLINES
  if (positive == 0 || negative == 0) write_outline(place, at, 0);
#endif
  if (positive == 0 || negative == 0) return;
  double turn = positive > negative ? -1.0LF : 1.0LF;
  int members[4] = int[](0, 0, 0, 0), split = 0, end = 4;
  dvec2 depths = dvec2(0.0LF), scalars = dvec2(0.0LF), totals = dvec2(0.0LF);
  for (int k = 0; k < 4; ++k) {
    weights[k] *= turn;
    bool is_positive = weights[k] > 0.0LF;
    if (is_positive)
      members[split++] = k;
    else
      members[--end] = k;
    dvec2 weight = is_positive ? dvec2(weights[k], 0.0LF) : dvec2(0.0LF, weights[k]);
    totals += weight;
    depths += weight * v[k].depth;
    scalars += weight * ((frame.is_orthographic != 0 ? 1.0LF : v[k].depth) * double(v[k].scalar));
  }
#ifdef OUTLINES
  // One vertex inside: the three others; otherwise the edges in turn.
  if (split == 1) write_outline(place, dvec2[](at[members[1]], at[members[2]], at[members[3]], at[members[0]]), 3);
  else write_outline(place, dvec2[](at[members[0]], at[members[2]], at[members[1]], at[members[3]]), 4);
#else
  depths /= totals;
  scalars /= totals;
  bool is_first_near = frame.is_orthographic != 0 ? depths.x <= depths.y : depths.x >= depths.y;
  vec4 carried = vec4(is_first_near ? depths.x : depths.y, abs(depths.x - depths.y),
                      is_first_near ? scalars.x : scalars.y, is_first_near ? scalars.y : scalars.x);
#ifdef CELL_DATA
  carried.z = texelFetch(cell_scalars, int(cell)).x;
#endif
  uint next = 12u * place;
  if (split == 1) {
    int inner = members[0];
    write_thick(place, dvec2(v[inner].place), carried);
    for (int opposite = 0; opposite < 4; ++opposite) {
      if (opposite == inner || weights[opposite] == 0.0LF) continue;
      for (int k = 0; k < 4; ++k)
        if (k != inner && k != opposite) indices[next++] = ids[k];
      indices[next++] = thick;
    }
  } else {
    int round[4] = int[](members[0], members[2], members[1], members[3]);
    dvec2 corners[4];
    for (int k = 0; k < 4; ++k) corners[k] = dvec2(v[round[k]].place);
    double along = weights[round[2]] / (weights[round[0]] + weights[round[2]]);
    write_thick(place, snap_inside(corners[0] + along * (corners[2] - corners[0]), corners), carried);
    for (int k = 0; k < 4; ++k) {
      indices[next++] = ids[round[k]];
      indices[next++] = ids[round[(k + 1) & 3]];
      indices[next++] = thick;
    }
  }
#endif
}
