/// Tetrahedra cut into triangles: what they cover, what they carry, and every class that there is.

#include "src/gl/decomposition.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <random>

namespace tetravox::gl {
namespace {

using Vertices = std::array<ScreenVertex, 4>;

std::array<const ScreenVertex*, 4> pointers(const Vertices& v) { return {&v[0], &v[1], &v[2], &v[3]}; }

struct Place {
  std::int64_t x = 0, y = 0;
  auto operator<=>(const Place&) const = default;
};

std::int64_t area(const Place& a, const Place& b, const Place& c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

Place corner_of(const Vertices& v, const ProjectedCell& cell, int index) {
  const int k = cell.corners[index];
  return k == 4 ? Place{cell.x, cell.y} : Place{v[k].x, v[k].y};
}

/// Twice the area of the convex hull of the four places (Andrew 1979).
std::int64_t hull_area(const Vertices& v) {
  std::vector<Place> places;
  for (const ScreenVertex& p : v) places.push_back({p.x, p.y});
  std::sort(places.begin(), places.end());
  std::int64_t sum = 0;
  for (const int sign : {1, -1}) {
    std::vector<Place> chain;
    for (const Place& p : places) {
      while (chain.size() >= 2 && sign * area(chain[chain.size() - 2], chain.back(), p) <= 0) chain.pop_back();
      chain.push_back(p);
    }
    for (std::size_t i = 0; i + 1 < chain.size(); ++i)
      sum += sign * (chain[i].x * chain[i + 1].y - chain[i].y * chain[i + 1].x);
  }
  return std::abs(sum);
}

/// Depths and scalars where the line through a place enters and leaves the tetrahedron, its corners at their places and
/// depths (what is linear in the picture): between the four planes.
struct Passage {
  double near = 0, far = 0, scalar_near = 0, scalar_far = 0;
};
std::optional<Passage> pass(const Vertices& v, double x, double y) {
  // Barycentric coordinates are linear in depth along the line: lambda = a + b * depth.
  const auto row = [&](int k) { return std::array<double, 4>{double(v[k].x), double(v[k].y), v[k].depth, 1.0}; };
  double m[4][6];
  for (int i = 0; i < 4; ++i) {
    for (int k = 0; k < 4; ++k) m[i][k] = row(k)[i];
    m[i][4] = std::array{x, y, 0.0, 1.0}[i];
    m[i][5] = i == 2 ? 1.0 : 0.0;
  }
  for (int i = 0; i < 4; ++i) {
    int pivot = i;
    for (int r = i; r < 4; ++r)
      if (std::abs(m[r][i]) > std::abs(m[pivot][i])) pivot = r;
    std::swap(m[i], m[pivot]);
    if (m[i][i] == 0.0) return std::nullopt;
    for (int r = 0; r < 4; ++r)
      if (r != i) {
        const double factor = m[r][i] / m[i][i];
        for (int c = 0; c < 6; ++c) m[r][c] -= factor * m[i][c];
      }
  }
  Passage passage{-1e30, 1e30, 0, 0};
  std::array<double, 4> a{}, b{};
  for (int k = 0; k < 4; ++k) {
    a[k] = m[k][4] / m[k][k];
    b[k] = m[k][5] / m[k][k];
    if (b[k] > 0.0) passage.near = std::max(passage.near, -a[k] / b[k]);
    if (b[k] < 0.0) passage.far = std::min(passage.far, -a[k] / b[k]);
  }
  for (int k = 0; k < 4; ++k) {
    passage.scalar_near += (a[k] + b[k] * passage.near) * double(v[k].scalar);
    passage.scalar_far += (a[k] + b[k] * passage.far) * double(v[k].scalar);
  }
  return passage;
}

Vertices random_vertices(std::mt19937& random, int spread) {
  std::uniform_int_distribution<int> place(0, spread);
  std::uniform_real_distribution<double> depth(1.0, 3.0);
  std::uniform_real_distribution<float> scalar(-1.0f, 1.0f);
  Vertices v;
  for (ScreenVertex& p : v) {
    p.x = place(random);
    p.y = place(random);
    p.depth = depth(random);
    p.scalar = scalar(random);
  }
  return v;
}

/// Triangles of one orientation or none, that together are as large as the hull: nothing is covered twice or missed.
void expect_exact_cover(const Vertices& v, const ProjectedCell& cell) {
  std::int64_t sum = 0;
  for (int t = 0; t < cell.triangle_count; ++t) {
    EXPECT_EQ(cell.corners[3 * t + 2], 4) << "the thick vertex comes last";
    sum += std::abs(area(corner_of(v, cell, 3 * t), corner_of(v, cell, 3 * t + 1), corner_of(v, cell, 3 * t + 2)));
  }
  EXPECT_EQ(sum, hull_area(v));
}

TEST(Decomposition, TrianglesCoverTheProjectedTetrahedronExactly) {
  std::mt19937 random(1);
  std::array<int, 5> classes{};
  for (const int spread : {2, 5, 40, 3000, 4'000'000})
    for (int i = 0; i < 4000; ++i) {
      const Vertices v = random_vertices(random, spread);
      const ProjectedCell cell = decompose_cell(pointers(v), true);
      expect_exact_cover(v, cell);
      ++classes[cell.triangle_count];
    }
  for (const int count : classes) EXPECT_GT(count, 100);  // all classes have been met
}

/// Where the pictures of two opposite edges cross, or of a vertex and a face: before it is put on a step.
std::array<double, 2> true_thick_place(const Vertices& v) {
  const auto d = [&](int k, int axis) {
    return axis == 0 ? static_cast<double>(v[k].x - v[0].x) : static_cast<double>(v[k].y - v[0].y);
  };
  const auto cross = [&](int a, int b) { return d(a, 0) * d(b, 1) - d(a, 1) * d(b, 0); };
  std::array<double, 4> weight{0, cross(2, 3), cross(3, 1), cross(1, 2)};
  weight[0] = -(weight[1] + weight[2] + weight[3]);
  std::array<double, 3> sum{};
  for (int k = 0; k < 4; ++k)
    if (weight[k] > 0.0) {
      sum[0] += weight[k];
      sum[1] += weight[k] * v[k].x;
      sum[2] += weight[k] * v[k].y;
    }
  return {sum[1] / sum[0], sum[2] / sum[0]};
}

TEST(Decomposition, TheThickVertexCarriesWhatTheRayPassesThere) {
  std::mt19937 random(2);
  int compared = 0;
  for (int i = 0; i < 20000; ++i) {
    const Vertices v = random_vertices(random, 1 << 20);
    const ProjectedCell cell = decompose_cell(pointers(v), true);
    ASSERT_GE(cell.triangle_count, 3);
    const auto [x, y] = true_thick_place(v);
    EXPECT_NEAR(cell.x, x, 1.0);  // a step
    EXPECT_NEAR(cell.y, y, 1.0);
    const std::optional<Passage> exact = pass(v, x, y);
    if (!exact || exact->far - exact->near > 2.0) continue;  // flat cells, where the reference loses its digits
    ++compared;
    constexpr double kSlack = 2e-6;
    EXPECT_NEAR(cell.thick.depth, exact->near, kSlack);
    EXPECT_NEAR(cell.thick.difference, exact->far - exact->near, kSlack);
    EXPECT_NEAR(cell.thick.front, exact->scalar_near, kSlack);
    EXPECT_NEAR(cell.thick.back, exact->scalar_far, kSlack);
  }
  EXPECT_GT(compared, 15000);
}

/// The outline holds all places of the cell, and what is within two steps of them.
TEST(Decomposition, OutlinesHoldTheCellWithAMargin) {
  std::mt19937 random(5);
  for (const int spread : {6, 300, 1 << 18})
    for (int i = 0; i < 2000; ++i) {
      const Vertices v = random_vertices(random, spread);
      const auto outline = find_outline(pointers(v), decompose_cell(pointers(v), true), 256);
      for (const ScreenVertex& p : v)
        for (const auto& [dx, dy] : {std::array{2.0, 0.0}, {-2.0, 0.0}, {0.0, 2.0}, {0.0, -2.0}}) {
          int left = 0, right = 0;
          for (int k = 0; k < 4; ++k) {
            const auto &a = outline[k], &b = outline[(k + 1) & 3];
            const double side = (b[0] - a[0]) * (p.y + dy - a[1]) - (b[1] - a[1]) * (p.x + dx - a[0]);
            left += side > 1e-6;
            right += side < -1e-6;
          }
          EXPECT_TRUE(left == 0 || right == 0) << p.x << " " << p.y << " of a cell " << spread << " wide";
        }
    }
}

TEST(Decomposition, APerspectiveCarriesWhatIsLinearInThePicture) {
  std::mt19937 random(3);
  for (int i = 0; i < 5000; ++i) {
    Vertices v = random_vertices(random, 1 << 20);  // depth is 1 / z
    const ProjectedCell cell = decompose_cell(pointers(v), false);
    const auto inside = static_cast<std::size_t>(
        std::find_if(v.begin(), v.end(), [&](const auto& p) { return p.x == cell.x && p.y == cell.y; }) - v.begin());
    if (inside == 4) continue;  // a vertex before or behind the face opposite: exact
    const double scalar = double(v[inside].scalar) * v[inside].depth;
    const bool is_front = std::abs(double(cell.thick.depth) - v[inside].depth) < 1e-6;
    const double back = double(cell.thick.depth) - double(cell.thick.difference);
    EXPECT_NEAR(is_front ? cell.thick.depth : back, v[inside].depth, 1e-6);
    EXPECT_NEAR(is_front ? cell.thick.front : cell.thick.back, scalar, 1e-6);
    EXPECT_GE(cell.thick.difference, 0.0f);
  }
}

/// What the rasterizer interpolates, anywhere in the picture of a large cell, is what a ray passes there.
TEST(Decomposition, InterpolationIsExact) {
  std::mt19937 random(4);
  std::uniform_int_distribution<int> place(0, 1 << 20);
  int found = 0;
  for (int i = 0; i < 20000; ++i) {
    const Vertices v = random_vertices(random, 1 << 20);
    const ProjectedCell cell = decompose_cell(pointers(v), true);
    const Place p{place(random), place(random)};
    for (int t = 0; t < cell.triangle_count; ++t) {
      const std::array<Place, 3> c{corner_of(v, cell, 3 * t), corner_of(v, cell, 3 * t + 1),
                                   corner_of(v, cell, 3 * t + 2)};
      const auto whole = static_cast<double>(area(c[0], c[1], c[2]));
      const std::array<double, 3> weight{static_cast<double>(area(c[1], c[2], p)) / whole,
                                         static_cast<double>(area(c[2], c[0], p)) / whole,
                                         static_cast<double>(area(c[0], c[1], p)) / whole};
      if (std::ranges::min(weight) < 0.0) continue;
      double depth = weight[2] * double(cell.thick.depth), difference = weight[2] * double(cell.thick.difference);
      double front = weight[2] * double(cell.thick.front), back = weight[2] * double(cell.thick.back);
      for (int k = 0; k < 2; ++k) {
        const ScreenVertex& corner = v[cell.corners[3 * t + k]];
        depth += weight[k] * corner.depth;
        front += weight[k] * double(corner.scalar);
        back += weight[k] * double(corner.scalar);
      }
      const std::optional<Passage> exact = pass(v, static_cast<double>(p.x), static_cast<double>(p.y));
      if (!exact || std::abs(whole) < 1e9) continue;
      ++found;
      // The thick vertex has been moved by up to a step in a million.
      EXPECT_NEAR(depth, exact->near, 5e-3);
      EXPECT_NEAR(difference, exact->far - exact->near, 5e-3);
      EXPECT_NEAR(front, exact->scalar_near, 5e-3);
      EXPECT_NEAR(back, exact->scalar_far, 5e-3);
    }
  }
  EXPECT_GT(found, 1000);
}

struct Degenerate {
  const char* name;
  std::array<std::array<int, 2>, 4> places;
  int triangles;
};

TEST(Decomposition, DegenerateClasses) {
  const Degenerate cases[] = {
      {"a vertex over the face opposite", {{{0, 0}, {8, 0}, {0, 8}, {2, 2}}}, 3},
      {"crossing edges", {{{0, 0}, {8, 8}, {8, 0}, {0, 8}}}, 4},
      {"a vertex over an edge", {{{0, 0}, {8, 0}, {0, 8}, {4, 0}}}, 2},
      {"a vertex over a vertex", {{{0, 0}, {8, 0}, {0, 8}, {0, 0}}}, 1},
      {"a face edge-on, its vertex outside", {{{0, 0}, {4, 0}, {8, 0}, {3, 5}}}, 2},
      {"all on a line", {{{0, 0}, {4, 4}, {8, 8}, {2, 2}}}, 0},
      {"two edges as two points", {{{0, 0}, {0, 0}, {8, 8}, {8, 8}}}, 0},
      {"all at one place", {{{3, 3}, {3, 3}, {3, 3}, {3, 3}}}, 0},
  };
  for (const Degenerate& c : cases) {
    std::array<int, 4> order{0, 1, 2, 3};
    do {
      Vertices v;
      for (int k = 0; k < 4; ++k) v[order[k]] = {c.places[k][0], c.places[k][1], 0.25f * float(k), 1.0 + k};
      const ProjectedCell cell = decompose_cell(pointers(v), true);
      EXPECT_EQ(cell.triangle_count, c.triangles) << c.name;
      expect_exact_cover(v, cell);
      EXPECT_TRUE(std::isfinite(cell.thick.depth) && std::isfinite(cell.thick.difference)) << c.name;
    } while (std::next_permutation(order.begin(), order.end()));
  }
}

/// An orthographic view of 16 x 16 pixels, one local unit each, from z = 0.
ScreenView make_view() {
  ScreenView view;
  view.frame.is_orthographic = true;
  view.frame.pixel_step = 1.0;
  view.frame.width = view.frame.height = 16;
  return view;
}

TEST(Decomposition, CellsKeepTheirOrderAndThoseAtTheEyeAreTold) {
  const ScreenView view = make_view();
  // Four cells: in the picture; cut by the plane of the camera; behind it; beside the picture.
  std::vector<float> seen;
  const auto add = [&](float x, float z) {
    for (const auto& [dx, dy, dz] : {std::array{0.f, 0.f, 0.f}, {2.f, 0.f, 0.f}, {0.f, 2.f, 0.f}, {0.f, 0.f, 2.f}})
      seen.insert(seen.end(), {x + dx, dy, z + dz, 0.5f});
  };
  add(0, 1), add(1, -1), add(0, -9), add(50, 1);
  const std::vector<mesh::CellVertices> cells{{0, 1, 2, 3}, {4, 5, 6, 7}, {8, 9, 10, 11}, {12, 13, 14, 15}};
  const std::vector<std::uint32_t> order{3, 1, 2, 0};
  Projection projection;
  for (int repeat = 0; repeat < 2; ++repeat) {
    decompose(seen, cells, {}, order, false, view, projection);
    EXPECT_EQ(projection.cells, 2u);
    EXPECT_EQ(projection.cells_at_eye, 1u);
    ASSERT_EQ(projection.ranges.size(), 2u);
    EXPECT_TRUE(projection.ranges[0].is_at_eye);
    EXPECT_EQ(projection.ranges[0].first, 1u);
    EXPECT_FALSE(projection.ranges[1].is_at_eye);
    EXPECT_EQ(projection.ranges[1].count, 3u);  // a corner over a corner: one triangle
  }
  find_ranges(seen, cells, order, 12, view, projection);
  EXPECT_EQ(projection.cells_at_eye, 1u);
  EXPECT_EQ(projection.ranges[0].first, 0u);  // twelve indices a place
}

}  // namespace
}  // namespace tetravox::gl
