#include "src/gl/decomposition.h"

#include "src/support/threads.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace tetravox::gl {
namespace {

/// Vertices farther than this from the picture, in pixels, are off the screen: rasterizers need not clip what is
/// nearer.
constexpr double kGuard = 4096.0;

/// Cells in one piece of work, and in one list of indices.
constexpr std::size_t kChunk = 1 << 13;

struct Place {
  std::int64_t x = 0, y = 0;
};
Place place_of(const ScreenVertex& v) { return {v.x, v.y}; }
Place operator-(const Place& a, const Place& b) { return {a.x - b.x, a.y - b.y}; }
/// Exact: places are below 2^23.
std::int64_t cross(const Place& a, const Place& b) { return a.x * b.y - a.y * b.x; }
std::int64_t area(const Place& a, const Place& b, const Place& c) { return cross(b - a, c - a); }

/// Depth and scalar of one side of the cell at the thick vertex.
struct Side {
  double depth = 0.0, scalar = 0.0;  ///< of a perspective the scalar times the depth
};

Side side_of(const std::array<const ScreenVertex*, 4>& vertices, const std::array<std::int64_t, 4>& weights,
             std::span<const int> members, bool is_orthographic) {
  double total = 0.0;
  Side side;
  for (const int k : members) {
    const double weight = static_cast<double>(weights[k]), depth = vertices[k]->depth;
    total += weight;
    side.depth += weight * depth;
    side.scalar += weight * (is_orthographic ? 1.0 : depth) * static_cast<double>(vertices[k]->scalar);
  }
  return {side.depth / total, side.scalar / total};
}

Carried carry(const Side& a, const Side& b, bool is_orthographic) {
  const bool is_first_near = is_orthographic ? a.depth <= b.depth : a.depth >= b.depth;
  const Side& front = is_first_near ? a : b;
  const Side& back = is_first_near ? b : a;
  return {static_cast<float>(front.depth), static_cast<float>(std::abs(a.depth - b.depth)),
          static_cast<float>(front.scalar), static_cast<float>(back.scalar)};
}

/// The step nearest to (x, y) that is inside the quadrilateral, so that no triangle turns over; one of its corners
/// where there is none.
Place snap_inside(double x, double y, const std::array<Place, 4>& corners) {
  const std::int64_t sign = area(corners[0], corners[1], corners[2]) > 0 ? 1 : -1;
  const auto is_inside = [&](const Place& p) {
    for (std::size_t k = 0; k < 4; ++k)
      if (sign * area(corners[k], corners[(k + 1) & 3], p) < 0) return false;
    return true;
  };
  const auto low_x = static_cast<std::int64_t>(std::floor(x)), low_y = static_cast<std::int64_t>(std::floor(y));
  const bool is_right = x - static_cast<double>(low_x) > 0.5, is_low = y - static_cast<double>(low_y) > 0.5;
  for (const bool flip_x : {false, true})
    for (const bool flip_y : {false, true}) {
      const Place place{low_x + (is_right != flip_x), low_y + (is_low != flip_y)};
      if (is_inside(place)) return place;
    }
  const auto distance = [&](const Place& p) {
    return std::hypot(static_cast<double>(p.x) - x, static_cast<double>(p.y) - y);
  };
  return *std::ranges::min_element(corners, {}, distance);
}

/// The picture of a vertex and the face opposite: three triangles, or fewer where an edge is seen as a point.
void cut_at_vertex(const std::array<const ScreenVertex*, 4>& vertices, const std::array<std::int64_t, 4>& weights,
                   int inner, ProjectedCell& cell) {
  cell.x = vertices[inner]->x;
  cell.y = vertices[inner]->y;
  for (int k = 0; k < 4; ++k)
    if (k != inner) cell.outline[cell.outline_count++] = static_cast<std::uint8_t>(k);
  for (int opposite = 0; opposite < 4; ++opposite) {
    if (opposite == inner || weights[opposite] == 0) continue;
    std::uint8_t* corner = cell.corners.data() + 3 * cell.triangle_count++;
    for (int k = 0; k < 4; ++k)
      if (k != inner && k != opposite) *corner++ = static_cast<std::uint8_t>(k);
    *corner = 4;
  }
}

/// The picture of two edges that cross: four triangles.
void cut_at_crossing(const std::array<const ScreenVertex*, 4>& vertices, const std::array<std::int64_t, 4>& weights,
                     const std::array<int, 4>& round, ProjectedCell& cell) {
  const auto [a, c, b, d] = round;  // edges (a, b) and (c, d)
  const double at = static_cast<double>(weights[b]) / static_cast<double>(weights[a] + weights[b]);
  const std::array<Place, 4> corners{place_of(*vertices[a]), place_of(*vertices[c]), place_of(*vertices[b]),
                                     place_of(*vertices[d])};
  const Place along = corners[2] - corners[0];
  const Place thick = snap_inside(static_cast<double>(corners[0].x) + at * static_cast<double>(along.x),
                                  static_cast<double>(corners[0].y) + at * static_cast<double>(along.y), corners);
  cell.x = static_cast<std::int32_t>(thick.x);
  cell.y = static_cast<std::int32_t>(thick.y);
  cell.outline_count = 4;
  for (std::size_t k = 0; k < 4; ++k) {
    cell.outline[k] = static_cast<std::uint8_t>(round[k]);
    std::uint8_t* corner = cell.corners.data() + 3 * cell.triangle_count++;
    corner[0] = static_cast<std::uint8_t>(round[k]);
    corner[1] = static_cast<std::uint8_t>(round[(k + 1) & 3]);
    corner[2] = 4;
  }
}

}  // namespace

void project_vertices(std::span<const float> seen, const ScreenView& view, std::vector<ScreenVertex>& vertices) {
  vertices.resize(seen.size() / 4);
  const scene::CameraFrame& frame = view.frame;
  const double steps = view.subpixels, scale = steps / frame.pixel_step;
  const double middle_x = 0.5 * frame.width * steps, middle_y = 0.5 * frame.height * steps;
  const double most_x = middle_x + kGuard * steps, most_y = middle_y + kGuard * steps;
  // Nearer than a millionth of its distance from the middle of the mesh, a vertex has no depth of its own in floats.
  const double nearest = frame.is_orthographic ? view.z_near : 1e-6 * std::max(1.0, std::abs(frame.eye[2]));
  support::parallel_chunks(vertices.size(), 1 << 13, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const float* v = seen.data() + 4 * i;
      const double z = frame.is_orthographic ? v[2] : v[2] - frame.eye[2];
      const bool is_seen = z >= nearest;
      const double depth = frame.is_orthographic ? z : 1.0 / (is_seen ? z : 1.0);
      const double grow = frame.is_orthographic ? scale : scale * depth;
      const double x = (v[0] - frame.eye[0]) * grow, y = (frame.eye[1] - v[1]) * grow;
      const bool is_near = is_seen && std::abs(x) < most_x && std::abs(y) < most_y;
      vertices[i].x = is_near ? static_cast<std::int32_t>(std::lrint(x + middle_x)) : kOffScreen;
      vertices[i].y = is_near ? static_cast<std::int32_t>(std::lrint(y + middle_y)) : 0;
      vertices[i].scalar = v[3];
      vertices[i].depth = depth;
    }
  });
}

ProjectedCell decompose_cell(const std::array<const ScreenVertex*, 4>& vertices, bool is_orthographic) {
  // The one linear dependence of four places with coefficients that sum to zero. Places of positive and of negative
  // coefficients have a common point, with these weights (Radon 1921): the thick vertex, in every class.
  const Place p0 = place_of(*vertices[0]), d1 = place_of(*vertices[1]) - p0, d2 = place_of(*vertices[2]) - p0,
              d3 = place_of(*vertices[3]) - p0;
  std::array<std::int64_t, 4> weights{0, cross(d2, d3), cross(d3, d1), cross(d1, d2)};
  weights[0] = -(weights[1] + weights[2] + weights[3]);
  const auto count = [&](auto holds) { return std::ranges::count_if(weights, holds); };
  const auto positive = count([](std::int64_t w) { return w > 0; }),
             negative = count([](std::int64_t w) { return w < 0; });
  ProjectedCell cell;
  if (positive == 0 || negative == 0) return cell;
  if (positive > negative)
    for (std::int64_t& weight : weights) weight = -weight;

  std::array<int, 4> members{};  // positive ones, then the others
  std::size_t split = 0, end = 4;
  for (int k = 0; k < 4; ++k) members[weights[k] > 0 ? split++ : --end] = k;
  const std::span<const int> all(members);
  cell.thick = carry(side_of(vertices, weights, all.first(split), is_orthographic),
                     side_of(vertices, weights, all.subspan(split), is_orthographic), is_orthographic);
  if (split == 1)
    cut_at_vertex(vertices, weights, members[0], cell);
  else
    cut_at_crossing(vertices, weights, {members[0], members[2], members[1], members[3]}, cell);
  return cell;
}

std::array<std::array<double, 2>, 4> find_outline(const std::array<const ScreenVertex*, 4>& vertices,
                                                  const ProjectedCell& cell, int subpixels) {
  const double margin = subpixels / 64.0, farthest = 2.0 * subpixels;
  std::array<std::array<double, 2>, 4> outline{};
  if (cell.outline_count == 0) {
    // A line, or a point: a thin rectangle.
    const auto [first, last] =
        std::ranges::minmax(vertices, {}, [](const ScreenVertex* v) { return std::pair(v->x, v->y); });
    const double x = last->x - first->x, y = last->y - first->y, size = std::hypot(x, y);
    const double u = size > 0.0 ? margin * x / size : margin, v = size > 0.0 ? margin * y / size : 0.0;
    const auto corner = [](const ScreenVertex* at, double dx, double dy) {
      return std::array<double, 2>{at->x + dx, at->y + dy};
    };
    return {corner(first, -u - v, u - v), corner(first, v - u, -u - v), corner(last, u + v, v - u),
            corner(last, u - v, u + v)};
  }
  const int count = cell.outline_count;
  const auto towards = [&](const ScreenVertex& from, int to) {
    const ScreenVertex& v = *vertices[cell.outline[to % count]];
    const double x = v.x - from.x, y = v.y - from.y, size = std::max(std::hypot(x, y), 1e-9);
    return std::array<double, 2>{x / size, y / size};
  };
  for (int k = 0; k < 4; ++k) {
    const int index = std::min(k, count - 1);
    const ScreenVertex& at = *vertices[cell.outline[index]];
    const auto u = towards(at, index + 1), v = towards(at, index + count - 1);
    const double x = u[0] + v[0], y = u[1] + v[1];
    const double reach = margin / std::max(std::abs(u[0] * v[1] - u[1] * v[0]), 1e-9);
    const double shrink = std::min(1.0, farthest / std::max(reach * std::hypot(x, y), 1e-9));
    outline[k] = {at.x - x * reach * shrink, at.y - y * reach * shrink};
  }
  return outline;
}

bool is_out_of_sight(const std::array<const float*, 4>& seen, const ScreenView& view) {
  const scene::CameraFrame& frame = view.frame;
  // Half a pixel more than half the picture.
  const double right = 0.5 * (frame.width + 1) * frame.pixel_step, up = 0.5 * (frame.height + 1) * frame.pixel_step;
  std::array<bool, 5> is_beyond{true, true, true, true, true};
  for (const float* v : seen) {
    const double x = v[0] - frame.eye[0], y = v[1] - frame.eye[1], z = v[2] - frame.eye[2];
    const double w = frame.is_orthographic ? 1.0 : z;
    is_beyond[0] &= x > right * w;
    is_beyond[1] &= x < -right * w;
    is_beyond[2] &= y > up * w;
    is_beyond[3] &= y < -up * w;
    is_beyond[4] &= v[2] < view.z_near;
  }
  return std::ranges::find(is_beyond, true) != is_beyond.end();
}

namespace {

/// Steps of the rasterizer in clip space.
float to_clip(double at, int size, const ScreenView& view) {
  return static_cast<float>(2.0 * at / (static_cast<double>(view.subpixels) * size) - 1.0);
}

ProjectedVertex vertex_at(std::int32_t x, std::int32_t y, const Carried& carried, const ScreenView& view) {
  return {to_clip(x, view.frame.width, view), to_clip(y, view.frame.height, view), carried};
}

void extend(std::vector<ProjectedRange>& ranges, const ProjectedRange& range) {
  if (range.count == 0) return;
  const bool continues = !ranges.empty() && ranges.back().is_at_eye == range.is_at_eye &&
                         ranges.back().first + ranges.back().count == range.first;
  if (continues)
    ranges.back().count += range.count;
  else
    ranges.push_back(range);
}

/// What one piece of the order comes to.
struct Piece {
  std::vector<ProjectedRange> ranges;  ///< indices counted from the piece's first
  std::uint64_t cells = 0, cells_at_eye = 0;
};

/// Decomposes a piece of the order.
class Decomposer {
 public:
  Decomposer(std::span<const float> seen, std::span<const mesh::CellVertices> cells,
             std::span<const float> cell_scalars, std::span<const std::uint32_t> order, bool use_outlines,
             const ScreenView& view, Projection& projection)
      : seen_(seen),
        cells_(cells),
        cell_scalars_(cell_scalars),
        order_(order),
        use_outlines_(use_outlines),
        view_(view),
        projection_(projection),
        width_(view.frame.width * view.subpixels),
        height_(view.frame.height * view.subpixels) {}

  Piece decompose(std::size_t begin, std::size_t end, std::vector<std::uint32_t>& indices) const {
    Piece piece;
    for (std::size_t place = begin; place < end; ++place) {
      const mesh::CellVertices& ids = cells_[order_[place]];
      if (ids[0] == kNoCell) continue;
      std::array<const ScreenVertex*, 4> vertices{};
      for (int k = 0; k < 4; ++k) vertices[k] = &projection_.vertices[ids[k]];
      if (std::ranges::any_of(vertices, [](const ScreenVertex* v) { return v->x == kOffScreen; })) {
        if (is_out_of_sight({at(ids[0]), at(ids[1]), at(ids[2]), at(ids[3])}, view_)) continue;
        ++piece.cells_at_eye;
        extend(piece.ranges, {true, place, 1});
      } else if (!is_beside_picture(vertices)) {
        const std::size_t first = indices.size();
        const std::size_t count =
            use_outlines_ ? add_outline(place, vertices, indices) : add_triangles(place, ids, vertices, indices);
        extend(piece.ranges, {false, first, count});
      } else {
        continue;
      }
      ++piece.cells;
    }
    return piece;
  }

 private:
  const float* at(std::uint32_t id) const { return seen_.data() + 4 * std::size_t{id}; }

  bool is_beside_picture(const std::array<const ScreenVertex*, 4>& v) const {
    const auto [low_x, high_x] = std::minmax({v[0]->x, v[1]->x, v[2]->x, v[3]->x});
    const auto [low_y, high_y] = std::minmax({v[0]->y, v[1]->y, v[2]->y, v[3]->y});
    return high_x < 0 || low_x > width_ || high_y < 0 || low_y > height_;
  }

  std::size_t add_outline(std::size_t place, const std::array<const ScreenVertex*, 4>& vertices,
                          std::vector<std::uint32_t>& indices) const {
    const ProjectedCell cell = decompose_cell(vertices, view_.frame.is_orthographic);
    const auto outline = find_outline(vertices, cell, view_.subpixels);
    for (std::size_t k = 0; k < 4; ++k)
      projection_.outlines[4 * place + k] = {to_clip(outline[k][0], view_.frame.width, view_),
                                             to_clip(outline[k][1], view_.frame.height, view_),
                                             static_cast<std::uint32_t>(place)};
    const std::size_t count = cell.outline_count == 3 ? 3 : 6;
    for (std::size_t k = 0; k < count; ++k)
      indices.push_back(static_cast<std::uint32_t>(4 * place + std::array{0, 1, 2, 0, 2, 3}[k]));
    return count;
  }

  std::size_t add_triangles(std::size_t place, const mesh::CellVertices& ids,
                            const std::array<const ScreenVertex*, 4>& vertices,
                            std::vector<std::uint32_t>& indices) const {
    ProjectedCell cell = decompose_cell(vertices, view_.frame.is_orthographic);
    const std::size_t thick = projection_.vertices.size() + place;
    if (!cell_scalars_.empty()) cell.thick.front = cell_scalars_[order_[place]];
    projection_.drawn[thick] = vertex_at(cell.x, cell.y, cell.thick, view_);
    const std::size_t count = 3 * static_cast<std::size_t>(cell.triangle_count);
    for (std::size_t k = 0; k < count; ++k)
      indices.push_back(cell.corners[k] == 4 ? static_cast<std::uint32_t>(thick) : ids[cell.corners[k]]);
    return count;
  }

  std::span<const float> seen_;
  std::span<const mesh::CellVertices> cells_;
  std::span<const float> cell_scalars_;
  std::span<const std::uint32_t> order_;
  bool use_outlines_;
  const ScreenView& view_;
  Projection& projection_;
  std::int32_t width_, height_;
};

}  // namespace

void project_mesh(std::span<const float> seen, std::size_t cell_count, bool use_outlines, const ScreenView& view,
                  Projection& projection) {
  project_vertices(seen, view, projection.vertices);
  if (use_outlines) {
    projection.outlines.resize(4 * cell_count);
    return;
  }
  const std::size_t vertex_count = projection.vertices.size();
  projection.drawn.resize(vertex_count + cell_count);
  support::parallel_chunks(vertex_count, 1 << 13, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const ScreenVertex& v = projection.vertices[i];
      const auto carried = static_cast<float>(view.frame.is_orthographic ? v.scalar : v.scalar * v.depth);
      projection.drawn[i] = vertex_at(v.x, v.y, {static_cast<float>(v.depth), 0.0f, carried, carried}, view);
    }
  });
}

void decompose(std::span<const float> seen, std::span<const mesh::CellVertices> cells,
               std::span<const float> cell_scalars, std::span<const std::uint32_t> order, bool use_outlines,
               const ScreenView& view, Projection& projection) {
  project_mesh(seen, order.size(), use_outlines, view, projection);
  const Decomposer decomposer(seen, cells, cell_scalars, order, use_outlines, view, projection);
  const std::size_t count = (order.size() + kChunk - 1) / kChunk;
  projection.indices.resize(count);
  std::vector<Piece> pieces(count);
  support::parallel_chunks(count, 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      projection.indices[i].clear();
      pieces[i] = decomposer.decompose(i * kChunk, std::min(order.size(), (i + 1) * kChunk), projection.indices[i]);
    }
  });

  projection.ranges.clear();
  projection.cells = projection.cells_at_eye = 0;
  std::size_t first = 0;
  for (std::size_t i = 0; i < count; ++i) {
    for (ProjectedRange range : pieces[i].ranges) {
      if (!range.is_at_eye) range.first += first;
      extend(projection.ranges, range);
    }
    first += projection.indices[i].size();
    projection.cells += pieces[i].cells;
    projection.cells_at_eye += pieces[i].cells_at_eye;
  }
}

void find_ranges(std::span<const float> seen, std::span<const mesh::CellVertices> cells,
                 std::span<const std::uint32_t> order, std::size_t indices, const ScreenView& view,
                 Projection& projection) {
  projection.ranges.clear();
  projection.cells = order.size();
  projection.cells_at_eye = 0;
  const auto is_off_screen = [&](std::uint32_t id) { return projection.vertices[id].x == kOffScreen; };
  if (std::ranges::none_of(projection.vertices, [](const ScreenVertex& v) { return v.x == kOffScreen; })) {
    extend(projection.ranges, {false, 0, indices * order.size()});
    return;
  }
  for (std::size_t place = 0; place < order.size(); ++place) {
    const mesh::CellVertices& ids = cells[order[place]];
    if (ids[0] == kNoCell) continue;
    if (std::ranges::none_of(ids, is_off_screen)) {
      extend(projection.ranges, {false, indices * place, indices});
      continue;
    }
    std::array<const float*, 4> corners{};
    for (int k = 0; k < 4; ++k) corners[k] = seen.data() + 4 * std::size_t{ids[k]};
    if (is_out_of_sight(corners, view)) continue;
    ++projection.cells_at_eye;
    extend(projection.ranges, {true, place, 1});
  }
}

std::uint64_t Projection::bytes() const {
  std::uint64_t sum = vertices.capacity() * sizeof(ScreenVertex) + drawn.capacity() * sizeof(ProjectedVertex) +
                      outlines.capacity() * sizeof(OutlineVertex) + ranges.capacity() * sizeof(ProjectedRange);
  for (const auto& list : indices) sum += list.capacity() * sizeof(std::uint32_t);
  return sum;
}

}  // namespace tetravox::gl
