/// Embedded grids with a closed formula.

#include "src/grid/builtin.h"
#include "src/support/threads.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>
#include <vector>

namespace tetravox::grid {
namespace {

constexpr double kFrequency = 6.0;   // f_M
constexpr double kAmplitude = 0.25;  // alpha
constexpr double kPi = std::numbers::pi;

/// Half the side of the cube around the atom, Bohr radii: beyond it the density is about 1 % of its largest value.
constexpr double kOrbitalReach = 20.0;

double eval_orbital(double x, double y, double z) {
  const double square = x * x + y * y + z * z;
  const double lobes = 3.0 * z * z - square;
  return lobes * lobes * std::exp(-2.0 / 3.0 * std::sqrt(square));
}

double eval_wave(double x, double y, double z) {
  const double square = x * x + y * y + z * z;
  return (3.0 * z * z - square) * std::exp(-std::sqrt(square) / 3.0);
}

/// The largest density among the points, all of which have a twin in one octant. Not 0 even where they all miss it.
double largest_density(const std::vector<double>& places) {
  double largest = std::numeric_limits<double>::min();
  for (std::size_t k = places.size() / 2; k < places.size(); ++k)
    for (std::size_t j = places.size() / 2; j < places.size(); ++j)
      for (std::size_t i = j; i < places.size(); ++i)
        largest = std::max(largest, eval_orbital(places[i], places[j], places[k]));
  return largest;
}

std::vector<double> places_in(const ValueRange& extent, std::uint32_t size) {
  std::vector<double> places(size);
  for (std::size_t i = 0; i < places.size(); ++i) places[i] = place_in(extent, i, size);
  return places;
}

/// A field of the atom: `eval(x, y, z, largest_density)`, in [0, 1].
template <class Eval>
BuiltinField make_atom_field(const char* name, std::uint32_t size, const Eval& eval) {
  BuiltinField field;
  field.array_name = name;
  field.extent = {-kOrbitalReach, kOrbitalReach};
  const std::vector<double> places = places_in(field.extent, size);
  const double largest = largest_density(places);
  field.visit_slice = [places, largest, eval](std::size_t k, const auto& write) {
    std::vector<double> row(places.size());
    for (const double y : places) {
      for (std::size_t i = 0; i < row.size(); ++i) row[i] = eval(places[i], y, places[k], largest);
      write(row);
    }
  };
  return field;
}

}  // namespace

BuiltinField make_marschner_lobb_field(std::uint32_t size) {
  BuiltinField field;
  field.array_name = "signal";
  field.extent = {-1.0, 1.0};
  const std::vector<double> places = places_in(field.extent, size);
  // The signal is a sum of a function of z and a function of x and y, tabulated here.
  const auto waves = std::make_shared<std::vector<double>>(std::size_t{size} * size);
  support::parallel_chunks(size, 8, [&](std::size_t begin, std::size_t end) {
    for (std::size_t j = begin; j < end; ++j)
      for (std::size_t i = 0; i < size; ++i) {
        const double radius = std::sqrt(places[i] * places[i] + places[j] * places[j]);
        const double wave = std::cos(2.0 * kPi * kFrequency * std::cos(kPi * radius / 2.0));
        (*waves)[j * size + i] = kAmplitude * (1.0 + wave) / (2.0 * (1.0 + kAmplitude));
      }
  });
  field.visit_slice = [places, waves, size](std::size_t k, const auto& write) {
    const double base = (1.0 - std::sin(kPi * places[k] / 2.0)) / (2.0 * (1.0 + kAmplitude));
    std::vector<double> row(size);
    for (std::size_t j = 0; j < size; ++j) {
      const double* wave = waves->data() + j * size;
      for (std::size_t i = 0; i < size; ++i) row[i] = std::min(base + wave[i], 1.0);
      write(row);
    }
  };
  return field;
}

BuiltinField make_hydrogen_field(std::uint32_t size) {
  return make_atom_field("density", size, [](double x, double y, double z, double largest_density) {
    return std::min(eval_orbital(x, y, z) / largest_density, 1.0);
  });
}

BuiltinField make_hydrogen_wave(std::uint32_t size) {
  return make_atom_field("wave", size, [](double x, double y, double z, double largest_density) {
    return std::clamp(0.5 + 0.5 * eval_wave(x, y, z) / std::sqrt(largest_density), 0.0, 1.0);
  });
}

}  // namespace tetravox::grid
