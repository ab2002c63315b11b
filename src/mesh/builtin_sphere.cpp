#include "src/mesh/builtin.h"
#include "src/support/threads.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace tetravox::mesh {
namespace {

/// A lattice coordinate on its cube shell, in [-1, 1], moved so that rays through equally spaced ones enclose equal
/// angles; exact at -1, 0 and 1.
double equal_angle(double u) { return std::abs(u) == 1.0 ? u : std::tan(u * (std::numbers::pi / 4.0)); }

/// A point of the cube [-1, 1]^3 -> the unit ball: every cube shell becomes the sphere it encloses.
std::array<double, 3> ball_from_cube(const std::array<double, 3>& p) {
  const double radius = std::max({std::abs(p[0]), std::abs(p[1]), std::abs(p[2])});
  if (radius == 0.0) return {0.0, 0.0, 0.0};
  std::array<double, 3> direction;
  for (int axis = 0; axis < 3; ++axis) direction[axis] = equal_angle(p[axis] / radius);
  const double length = std::hypot(direction[0], direction[1], direction[2]);
  for (double& x : direction) x *= radius / length;
  return direction;
}

}  // namespace

BuiltinStorage make_sphere_mesh(std::uint64_t cells) {
  // n^3 cubes, five tetrahedra each; n is even, so that the centre is a point. 8^3 cubes make 2,560.
  const std::size_t n = 2 * std::max<std::size_t>(1, std::lround(std::cbrt(static_cast<double>(cells) / 5.0) / 2.0));
  const std::size_t row = n + 1;
  BuiltinStorage storage =
      make_builtin_storage(row * row * row, 5 * n * n * n, CellType::kTetrahedron, 4, "builtin:sphere");
  const auto place = [n](std::size_t i) { return 2.0 * static_cast<double>(i) / static_cast<double>(n) - 1.0; };
  support::parallel_chunks(row, 1, [&](std::size_t k, std::size_t k_end) {
    for (; k < k_end; ++k)
      for (std::size_t j = 0; j < row; ++j)
        for (std::size_t i = 0; i < row; ++i) {
          const auto point = ball_from_cube({place(i), place(j), place(k)});
          std::copy(point.begin(), point.end(), storage.points.begin() + 3 * ((k * row + j) * row + i));
        }
  });
  // Of each cube, one tetrahedron joins the corners with an even sum of lattice indices and four cut the others off:
  // faces of adjacent cubes are then split alike.
  support::parallel_chunks(n, 1, [&](std::size_t k, std::size_t k_end) {
    for (; k < k_end; ++k)
      for (std::size_t j = 0; j < n; ++j)
        for (std::size_t i = 0; i < n; ++i) {
          const std::size_t odd = (i + j + k) % 2;
          const auto corner = [&](std::size_t dx, std::size_t dy, std::size_t dz) {
            return static_cast<std::uint32_t>(((k + dz) * row + j + dy) * row + i + (dx ^ odd));
          };
          const std::array<std::uint32_t, 4> even = {corner(0, 0, 0), corner(1, 1, 0), corner(1, 0, 1),
                                                     corner(0, 1, 1)};
          const std::array<std::uint32_t, 4> cut = {corner(1, 1, 1), corner(0, 0, 1), corner(0, 1, 0), corner(1, 0, 0)};
          std::uint32_t* out = storage.connectivity.data() + 20 * ((k * n + j) * n + i);
          out = std::copy(even.begin(), even.end(), out);
          // The corner cut[i] is opposite even[i]: its tetrahedron has the other three even corners.
          for (std::size_t c = 0; c < 4; ++c)
            for (std::size_t e = 0; e < 4; ++e) *out++ = e == c ? cut[c] : even[e];
        }
  });
  return storage;
}

void fill_sphere_scalars(BuiltinStorage& storage) {
  const std::size_t points = storage.points.size() / 3;
  storage.scalars.resize(points);
  support::parallel_chunks(points, 1 << 16, [&](std::size_t begin, std::size_t end) {
    for (std::size_t p = begin; p < end; ++p)
      storage.scalars[p] = std::hypot(storage.points[3 * p], storage.points[3 * p + 1], storage.points[3 * p + 2]);
  });
}

}  // namespace tetravox::mesh
