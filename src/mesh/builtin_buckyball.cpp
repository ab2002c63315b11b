#include "src/mesh/builtin.h"
#include "src/support/threads.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

namespace tetravox::mesh {
namespace {

constexpr double kRadius = 0.7;  ///< of the sphere through the atoms; the lattice is [-1, 1]^3
constexpr double kSigma = 0.1;   ///< standard deviation of an atom's density; bonds are 0.28 long

std::size_t lattice_size(std::uint64_t cells) {
  return std::max<std::size_t>(2, std::lround(std::cbrt(static_cast<double>(cells) / 6.0)));
}

double place(std::size_t i, std::size_t n) { return 2.0 * static_cast<double>(i) / static_cast<double>(n) - 1.0; }

/// The 60 vertices of a truncated icosahedron: the even permutations of (0, +-1, +-3g), (+-1, +-(2+g), +-2g) and
/// (+-2, +-(1+2g), +-g) with the golden ratio g.
std::vector<std::array<double, 3>> atom_positions() {
  constexpr double g = std::numbers::phi;
  const double scale = kRadius / std::sqrt(9.0 * g + 10.0);
  std::vector<std::array<double, 3>> atoms;
  for (const std::array<double, 3>& base :
       {std::array{0.0, 1.0, 3.0 * g}, std::array{1.0, 2.0 + g, 2.0 * g}, std::array{2.0, 1.0 + 2.0 * g, g}})
    for (int signs = 0; signs < 8; ++signs) {
      if (base[0] == 0.0 && (signs & 1)) continue;
      for (int turn = 0; turn < 3; ++turn) {
        std::array<double, 3> atom;
        for (int i = 0; i < 3; ++i) atom[(i + turn) % 3] = scale * (signs >> i & 1 ? -base[i] : base[i]);
        atoms.push_back(atom);
      }
    }
  return atoms;
}

}  // namespace

BuiltinStorage make_buckyball_mesh(std::uint64_t cells) {
  // n^3 cubes, six tetrahedra each, all along the cube's diagonal (Kuhn 1960). 31^3 cubes make 178,746.
  const std::size_t n = lattice_size(cells), row = n + 1;
  BuiltinStorage storage =
      make_builtin_storage(row * row * row, 6 * n * n * n, CellType::kTetrahedron, 4, "builtin:buckyball");
  support::parallel_chunks(row, 1, [&](std::size_t k, std::size_t k_end) {
    for (; k < k_end; ++k)
      for (std::size_t j = 0; j < row; ++j)
        for (std::size_t i = 0; i < row; ++i) {
          double* point = storage.points.data() + 3 * ((k * row + j) * row + i);
          point[0] = place(i, n);
          point[1] = place(j, n);
          point[2] = place(k, n);
        }
  });
  // Each order in which to step along the three axes from the first corner to the last is a tetrahedron.
  const std::array<std::size_t, 3> step = {1, row, row * row};
  static constexpr std::array<std::array<int, 3>, 6> kOrders = {
      {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {2, 1, 0}, {1, 0, 2}}};
  support::parallel_chunks(n, 1, [&](std::size_t k, std::size_t k_end) {
    for (; k < k_end; ++k)
      for (std::size_t j = 0; j < n; ++j)
        for (std::size_t i = 0; i < n; ++i) {
          std::uint32_t* out = storage.connectivity.data() + 24 * ((k * n + j) * n + i);
          for (const std::array<int, 3>& order : kOrders) {
            std::size_t point = (k * row + j) * row + i;
            *out++ = static_cast<std::uint32_t>(point);
            for (const int axis : order) *out++ = static_cast<std::uint32_t>(point += step[axis]);
          }
        }
  });
  return storage;
}

void fill_buckyball_scalars(BuiltinStorage& storage) {
  // A Gaussian is a product of one for each axis: tabulate those, [atoms][lattice].
  const std::size_t points = storage.points.size() / 3;
  const std::size_t row = std::lround(std::cbrt(static_cast<double>(points)));
  const std::vector<std::array<double, 3>> atoms = atom_positions();
  std::array<std::vector<double>, 3> factor;
  for (int axis = 0; axis < 3; ++axis)
    for (const std::array<double, 3>& atom : atoms)
      for (std::size_t i = 0; i < row; ++i) {
        const double distance = (place(i, row - 1) - atom[axis]) / kSigma;
        factor[axis].push_back(std::exp(-0.5 * distance * distance));
      }
  storage.scalars.assign(row * row * row, 0.0);
  support::parallel_chunks(row, 1, [&](std::size_t k, std::size_t k_end) {
    for (; k < k_end; ++k)
      for (std::size_t j = 0; j < row; ++j) {
        double* out = storage.scalars.data() + (k * row + j) * row;
        for (std::size_t atom = 0; atom < atoms.size(); ++atom) {
          const double weight = factor[2][atom * row + k] * factor[1][atom * row + j];
          const double* along = factor[0].data() + atom * row;
          for (std::size_t i = 0; i < row; ++i) out[i] += weight * along[i];
        }
      }
  });
}

}  // namespace tetravox::mesh
