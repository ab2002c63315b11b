#include "tests/common/grid_builder.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <memory>
#include <numbers>
#include <random>
#include <type_traits>

namespace tetravox::tests {
namespace {

template <class T>
void store_as(double value, std::byte* out) {
  T stored;
  if constexpr (std::is_integral_v<T>) {
    const double low = static_cast<double>(std::numeric_limits<T>::min());
    const double high = static_cast<double>(std::numeric_limits<T>::max());
    const double rounded = std::nearbyint(value);
    stored = rounded <= low    ? std::numeric_limits<T>::min()
             : rounded >= high ? std::numeric_limits<T>::max()
                               : static_cast<T>(rounded);
  } else {
    stored = static_cast<T>(value);
  }
  std::memcpy(out, &stored, sizeof stored);
}

using Store = void (*)(double, std::byte*);

struct StoreEntry {
  Store store;
  std::size_t bytes;
};

/// In the order of the enumerators.
constexpr StoreEntry kStores[] = {{store_as<std::int8_t>, 1},  {store_as<std::uint8_t>, 1},
                                  {store_as<std::int16_t>, 2}, {store_as<std::uint16_t>, 2},
                                  {store_as<std::int32_t>, 4}, {store_as<std::uint32_t>, 4},
                                  {store_as<std::int64_t>, 8}, {store_as<std::uint64_t>, 8},
                                  {store_as<float>, 4},        {store_as<double>, 8}};

Vector3 turn(const std::array<double, 9>& m, const Vector3& v) {
  return {m[0] * v[0] + m[1] * v[1] + m[2] * v[2], m[3] * v[0] + m[4] * v[1] + m[5] * v[2],
          m[6] * v[0] + m[7] * v[1] + m[8] * v[2]};
}

GridShape make_shape(const GridOptions& options) {
  GridShape shape;
  shape.dimensions = options.dimensions;
  shape.direction = options.direction;
  Vector3 half{};
  for (int axis = 0; axis < 3; ++axis) {
    const double extent = options.upper[axis] - options.lower[axis];
    half[axis] = 0.5 * extent;
    shape.spacing[axis] = extent / (options.dimensions[axis] - 1);
    for (const double fraction : options.fractions[axis]) shape.coordinates[axis].push_back(fraction * extent);
  }
  const Vector3 turned = turn(options.direction, half);
  for (int axis = 0; axis < 3; ++axis) shape.origin[axis] = options.lower[axis] + half[axis] - turned[axis];
  return shape;
}

}  // namespace

Vector3 lattice_place(const GridShape& shape, const Vector3& index) {
  Vector3 place{};
  for (int axis = 0; axis < 3; ++axis) {
    const std::vector<double>& coordinates = shape.coordinates[axis];
    if (coordinates.empty()) {
      place[axis] = index[axis] * shape.spacing[axis];
    } else {
      const auto below = static_cast<std::size_t>(
          std::clamp(std::floor(index[axis]), 0.0, static_cast<double>(coordinates.size() - 2)));
      place[axis] = std::lerp(coordinates[below], coordinates[below + 1], index[axis] - static_cast<double>(below));
    }
  }
  const Vector3 turned = turn(shape.direction, place);
  return {shape.origin[0] + turned[0], shape.origin[1] + turned[1], shape.origin[2] + turned[2]};
}

GridData make_vector_grid(const GridOptions& options, const std::vector<Field>& fields, int component) {
  GridData grid;
  grid.shape = make_shape(options);
  grid.type = options.type;
  grid.association = options.association;
  grid.components = static_cast<int>(fields.size());
  grid.component = component;
  grid.array_name = "field";
  const auto [store, bytes] = kStores[static_cast<std::size_t>(options.type)];
  const auto [ni, nj, nk] = grid.value_dimensions();
  auto values = std::make_shared<std::vector<std::byte>>(ni * nj * nk * fields.size() * bytes);
  const double shift = options.association == Association::kCell ? 0.5 : 0.0;
  std::byte* out = values->data();
  for (std::size_t k = 0; k < nk; ++k) {
    for (std::size_t j = 0; j < nj; ++j) {
      for (std::size_t i = 0; i < ni; ++i) {
        const Vector3 place = lattice_place(grid.shape, {static_cast<double>(i) + shift, static_cast<double>(j) + shift,
                                                         static_cast<double>(k) + shift});
        for (const Field& field : fields) {
          store(field(place), out);
          out += bytes;
        }
      }
    }
  }
  grid.values = *values;
  grid.storage = values;
  return grid;
}

GridData make_grid(const GridOptions& options, const Field& field) { return make_vector_grid(options, {field}, 0); }

GridData transform_grid(GridData grid, double factor, const Vector3& centre) {
  for (int axis = 0; axis < 3; ++axis) {
    grid.shape.origin[axis] = centre[axis] + factor * grid.shape.origin[axis];
    grid.shape.spacing[axis] *= factor;
    for (double& coordinate : grid.shape.coordinates[axis]) coordinate *= factor;
  }
  return grid;
}

std::vector<double> growing_fractions(std::uint32_t count, double growth) {
  std::vector<double> fractions{0.0};
  for (std::uint32_t i = 1; i < count; ++i)
    fractions.push_back(fractions.back() + std::pow(growth, static_cast<double>(i) / count));
  const double whole = fractions.back();
  for (double& fraction : fractions) fraction /= whole;
  fractions.back() = 1.0;
  return fractions;
}

double marschner_lobb(const Vector3& p, double cycles) {
  constexpr double kAlpha = 0.25, kPi = std::numbers::pi;
  const double ripple = std::cos(2.0 * kPi * cycles * std::cos(0.5 * kPi * std::hypot(p[0], p[1])));
  return (1.0 - std::sin(0.5 * kPi * p[2]) + kAlpha * (1.0 + ripple)) / (2.0 * (1.0 + kAlpha));
}

Field make_random_field(std::uint32_t seed, double cycles) {
  std::mt19937 random(seed);
  const auto draw = [&] { return static_cast<double>(random()) / 4294967295.0; };
  constexpr int kWaves = 12;
  std::vector<std::array<double, 4>> waves(kWaves);
  for (auto& wave : waves) {
    for (int axis = 0; axis < 3; ++axis) wave[axis] = std::numbers::pi * cycles * (2.0 * draw() - 1.0);
    wave[3] = 2.0 * std::numbers::pi * draw();
  }
  return [waves](const Vector3& p) {
    double sum = 0.0;
    for (const auto& wave : waves) sum += std::sin(wave[0] * p[0] + wave[1] * p[1] + wave[2] * p[2] + wave[3]);
    return std::clamp(0.5 + sum / kWaves, 0.0, 1.0);
  };
}

}  // namespace tetravox::tests
