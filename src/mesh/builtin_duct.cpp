#include "src/mesh/builtin.h"
#include "src/support/threads.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

namespace tetravox::mesh {
namespace {

// The duct, flat: x along it, y across it in [-1, 1], height z in [-0.6, 0.6]. A pin stands across it around the
// origin. From x = 1 on it bends to the left.
constexpr double kPinRadius = 0.4;
constexpr double kInlet = -2.0;
constexpr double kBendRadius = 2.2;
constexpr double kBendAngle = 2.2;  ///< radians
constexpr double kHalfHeight = 0.6;
constexpr double kSpeed = 1.0;  ///< of the flow far from the pin

/// Number of cells in each direction, for a size m.
struct DuctLattice {
  explicit DuctLattice(std::size_t m)
      : across(8 * m), around(4 * across), radial(5 * m), inlet(3 * m), bend(13 * m), height(4 * m) {}

  std::size_t layer_cells() const { return around * radial + across * (inlet + bend); }
  std::size_t layer_points() const { return around * (radial + 1) + (across + 1) * (inlet + bend); }
  std::uint64_t cells() const { return std::uint64_t{layer_cells()} * height; }
  std::uint64_t points() const { return std::uint64_t{layer_points()} * (height + 1); }

  std::size_t across, around, radial, inlet, bend, height;
};

/// One layer of quadrilaterals of the flat duct.
struct Layer {
  std::vector<std::array<double, 2>> points;
  std::vector<std::array<std::uint32_t, 4>> cells;
};

/// u in [0, 1] -> [-1, 1], finer towards both ends.
double grade_both(double u) { return std::tanh(1.5 * (2.0 * u - 1.0)) / std::tanh(1.5); }
/// u in [0, 1] -> [0, 1], finer towards 0.
double grade_start(double u) { return std::expm1(1.5 * u) / std::expm1(1.5); }

double fraction(std::size_t i, std::size_t n) { return static_cast<double>(i) / static_cast<double>(n); }

/// Point i of the square around the pin, counter-clockwise from its lower right corner.
std::array<double, 2> square_point(std::size_t i, std::size_t across) {
  const double t = grade_both(fraction(i % across, across));
  switch (i / across) {
    case 0:
      return {1.0, t};
    case 1:
      return {-t, 1.0};
    case 2:
      return {-1.0, -t};
    default:
      return {t, -1.0};
  }
}

/// Between the pin and the square around it: rings, point (ring, i) at ring * around + i.
void append_rings(const DuctLattice& n, Layer& layer) {
  for (std::size_t ring = 0; ring <= n.radial; ++ring) {
    const double part = ring == n.radial ? 1.0 : grade_start(fraction(ring, n.radial));
    for (std::size_t i = 0; i < n.around; ++i) {
      const std::array<double, 2> outer = square_point(i, n.across);
      const double to_pin = kPinRadius / std::hypot(outer[0], outer[1]);
      const double scale = to_pin + (1.0 - to_pin) * part;
      layer.points.push_back({outer[0] * scale, outer[1] * scale});
    }
  }
  for (std::size_t ring = 0; ring < n.radial; ++ring)
    for (std::size_t i = 0; i < n.around; ++i) {
      const std::size_t next = (i + 1) % n.around, low = ring * n.around, high = low + n.around;
      layer.cells.push_back({static_cast<std::uint32_t>(low + i), static_cast<std::uint32_t>(high + i),
                             static_cast<std::uint32_t>(high + next), static_cast<std::uint32_t>(low + next)});
    }
}

/// Columns of cells that start from a side of the square: `side(j)` is its point j from below, `x` the columns' places.
template <class Side>
void append_columns(const DuctLattice& n, const Side& side, const std::vector<double>& x, bool is_forward,
                    Layer& layer) {
  const std::size_t first = layer.points.size(), height = n.across + 1;
  for (const double column : x)
    for (std::size_t j = 0; j < height; ++j) layer.points.push_back({column, layer.points[side(j)][1]});
  const auto id = [&](std::size_t column, std::size_t j) {
    return static_cast<std::uint32_t>(column == 0 ? side(j) : first + (column - 1) * height + j);
  };
  for (std::size_t c = 0; c < x.size(); ++c)
    for (std::size_t j = 0; j < n.across; ++j) {
      const std::size_t left = is_forward ? c : c + 1, right = is_forward ? c + 1 : c;
      layer.cells.push_back({id(left, j), id(right, j), id(right, j + 1), id(left, j + 1)});
    }
}

Layer make_layer(const DuctLattice& n) {
  Layer layer;
  append_rings(n, layer);
  const std::size_t outer = n.radial * n.around;
  std::vector<double> inlet, bend;
  for (std::size_t i = 1; i <= n.inlet; ++i) inlet.push_back(-1.0 + (kInlet + 1.0) * fraction(i, n.inlet));
  for (std::size_t i = 1; i <= n.bend; ++i) bend.push_back(1.0 + kBendRadius * kBendAngle * fraction(i, n.bend));
  // The right side runs upwards from ring point 0, the left side downwards from ring point 2 * across.
  append_columns(
      n, [&](std::size_t j) { return outer + j; }, bend, true, layer);
  append_columns(
      n, [&](std::size_t j) { return outer + 3 * n.across - j; }, inlet, false, layer);
  return layer;
}

/// Flat duct -> world.
std::array<double, 3> bend_point(double x, double y, double z) {
  if (x <= 1.0) return {x, y, z};
  const double angle = (x - 1.0) / kBendRadius, radius = kBendRadius - y;
  // The duct rises a little and widens in height along the bend.
  const double part = angle / kBendAngle, ease = part * part * (3.0 - 2.0 * part);
  return {1.0 + radius * std::sin(angle), kBendRadius - radius * std::cos(angle), z * (1.0 + 0.4 * ease) + 0.5 * ease};
}

/// World -> flat duct.
std::array<double, 3> flatten_point(const double* p) {
  if (p[0] <= 1.0 && p[1] < kBendRadius) return {p[0], p[1], p[2]};
  const double angle = std::atan2(p[0] - 1.0, kBendRadius - p[1]);
  const double part = angle / kBendAngle, ease = part * part * (3.0 - 2.0 * part);
  return {1.0 + kBendRadius * angle, kBendRadius - std::hypot(p[0] - 1.0, kBendRadius - p[1]),
          (p[2] - 0.5 * ease) / (1.0 + 0.4 * ease)};
}

/// Speed of a flow around the pin (two-dimensional potential flow), slowed at the walls, with a wake behind the pin
/// and faster on the inside of the bend.
double speed_at(const std::array<double, 3>& flat) {
  const double x = flat[0], y = flat[1], z = flat[2];
  const double r2 = std::max(x * x + y * y, kPinRadius * kPinRadius);
  const double q = kPinRadius * kPinRadius / (r2 * r2);
  const double u = kSpeed * (1.0 - q * (x * x - y * y)), v = kSpeed * (-2.0 * q * x * y);
  const double layer = 0.12;  // thickness of the layers at the walls
  const double walls = std::tanh((1.0 - std::abs(y)) / layer) * std::tanh((kHalfHeight - std::abs(z)) / layer) *
                       std::tanh((std::sqrt(r2) - kPinRadius) / layer + 0.05);
  const double width = 0.3 + 0.08 * std::max(x, 0.0);
  const double wake =
      x > 0.0 ? 0.7 * std::exp(-y * y / (width * width)) * std::exp(-0.25 * x) * std::tanh(x / 0.3) : 0.0;
  const double bend = x > 1.0 ? std::min(1.0, x - 1.0) : 0.0;
  return std::hypot(u, v) * walls * (1.0 - wake) * (1.0 + bend * 0.35 * y);
}

/// Bernoulli's pressure, with friction along the duct and the centrifugal rise towards the outside of the bend.
double pressure_at(const std::array<double, 3>& flat) {
  const double x = flat[0], y = flat[1];
  const double r2 = std::max(x * x + y * y, kPinRadius * kPinRadius);
  const double q = kPinRadius * kPinRadius / (r2 * r2);
  const double u = kSpeed * (1.0 - q * (x * x - y * y)), v = kSpeed * (-2.0 * q * x * y);
  const double bend = x > 1.0 ? std::min(1.0, x - 1.0) : 0.0;
  const double wake = x > 0.0 ? -0.25 * std::exp(-y * y / 0.16) * std::exp(-0.8 * x) * std::tanh(x / 0.3) : 0.0;
  return 0.5 * (kSpeed * kSpeed - u * u - v * v) - 0.12 * x - bend * std::log1p(y / kBendRadius) + wake;
}

/// Volume of a hexahedron with straight edges whose faces are split at a diagonal.
double hexahedron_volume(const BuiltinStorage& storage, const std::uint32_t* corners) {
  const auto point = [&](int i) { return storage.points.data() + 3 * std::size_t{corners[i]}; };
  const auto tetrahedron = [&](int a, int b, int c) {
    std::array<std::array<double, 3>, 3> e;
    for (int axis = 0; axis < 3; ++axis) {
      e[0][axis] = point(a)[axis] - point(0)[axis];
      e[1][axis] = point(b)[axis] - point(0)[axis];
      e[2][axis] = point(c)[axis] - point(0)[axis];
    }
    return (e[0][0] * (e[1][1] * e[2][2] - e[1][2] * e[2][1]) + e[0][1] * (e[1][2] * e[2][0] - e[1][0] * e[2][2]) +
            e[0][2] * (e[1][0] * e[2][1] - e[1][1] * e[2][0])) /
           6.0;
  };
  return tetrahedron(1, 2, 6) + tetrahedron(1, 6, 5) + tetrahedron(2, 3, 6) + tetrahedron(3, 7, 6) +
         tetrahedron(4, 5, 6) + tetrahedron(4, 6, 7);
}

}  // namespace

BuiltinStorage make_duct_mesh(std::uint64_t cells) {
  // Find the size whose number of cells is nearest.
  std::size_t m = 1;
  while (DuctLattice(m + 1).cells() <= cells) ++m;
  if (DuctLattice(m + 1).cells() - cells < cells - std::min(cells, DuctLattice(m).cells())) ++m;
  const DuctLattice n(m);
  BuiltinStorage storage = make_builtin_storage(n.points(), n.cells(), CellType::kHexahedron, 8, "builtin:duct");
  const Layer layer = make_layer(n);
  const std::size_t layer_points = layer.points.size(), layer_cells = layer.cells.size();
  support::parallel_chunks(n.height + 1, 1, [&](std::size_t k, std::size_t k_end) {
    for (; k < k_end; ++k)
      for (std::size_t p = 0; p < layer_points; ++p) {
        const double z = kHalfHeight * grade_both(fraction(k, n.height));
        const auto point = bend_point(layer.points[p][0], layer.points[p][1], z);
        std::copy(point.begin(), point.end(), storage.points.begin() + 3 * (k * layer_points + p));
      }
  });
  support::parallel_chunks(n.height, 1, [&](std::size_t k, std::size_t k_end) {
    for (; k < k_end; ++k)
      for (std::size_t c = 0; c < layer_cells; ++c) {
        std::uint32_t* out = storage.connectivity.data() + 8 * (k * layer_cells + c);
        for (std::size_t level = k; level <= k + 1; ++level)
          for (const std::uint32_t point : layer.cells[c])
            *out++ = static_cast<std::uint32_t>(level * layer_points + point);
      }
  });
  return storage;
}

void fill_duct_scalars(BuiltinStorage& storage, std::size_t array) {
  const bool is_volume = array == 2;
  storage.scalars.resize(is_volume ? storage.cell_types.size() : storage.points.size() / 3);
  support::parallel_chunks(storage.scalars.size(), 1 << 14, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      if (is_volume) {
        storage.scalars[i] = hexahedron_volume(storage, storage.connectivity.data() + 8 * i);
        continue;
      }
      const std::array<double, 3> flat = flatten_point(storage.points.data() + 3 * i);
      storage.scalars[i] = array == 0 ? pressure_at(flat) : speed_at(flat);
    }
  });
}

}  // namespace tetravox::mesh
