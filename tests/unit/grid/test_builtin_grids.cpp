/// The embedded grids: formulas, number types, determinism; and what is known of a grid's values.

#include "src/grid/builtin.h"
#include "src/support/threads.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <numbers>
#include <vector>

namespace tetravox::grid {
namespace {

Dataset make(const std::string& name, std::uint32_t size, ScalarType type, std::uint64_t seed = 0) {
  for (const BuiltinGridEntry& entry : builtin_grids())
    if (entry.name == name) return make_builtin_grid(entry, {size, type, seed}, "test:" + name);
  ADD_FAILURE() << name;
  return {};
}

template <class T>
std::vector<T> values_of(const Dataset& dataset) {
  std::vector<T> values(dataset.grid.values.size() / sizeof(T));
  std::memcpy(values.data(), dataset.grid.values.data(), dataset.grid.values.size());
  return values;
}

/// World coordinate of lattice point i along an axis.
double place(const Dataset& dataset, std::size_t axis, std::size_t i) {
  return dataset.grid.shape.origin[axis] + dataset.grid.shape.spacing[axis] * static_cast<double>(i);
}

TEST(BuiltinGrids, MarschnerLobbIsThePublishedSignal) {
  const Dataset dataset = make("marschner-lobb", 41, ScalarType::kFloat32);
  const std::vector<float> values = values_of<float>(dataset);
  ASSERT_EQ(values.size(), 41u * 41 * 41);
  const double pi = std::numbers::pi;
  for (std::size_t k = 0; k < 41; k += 3)
    for (std::size_t j = 0; j < 41; j += 2)
      for (std::size_t i = 0; i < 41; ++i) {
        const double x = place(dataset, 0, i), y = place(dataset, 1, j), z = place(dataset, 2, k);
        const double rho = std::cos(2 * pi * 6.0 * std::cos(pi * std::sqrt(x * x + y * y) / 2));
        const double expected = (1 - std::sin(pi * z / 2) + 0.25 * (1 + rho)) / (2 * 1.25);
        EXPECT_NEAR(values[(k * 41 + j) * 41 + i], expected, 1e-6);
      }
  // The middle of the axis: cos(12 pi) = 1.
  EXPECT_FLOAT_EQ(values[(20 * 41 + 20) * 41 + 20], 0.6f);
  EXPECT_EQ(dataset.info.bounds[2].min, -1.0);
  EXPECT_DOUBLE_EQ(dataset.info.bounds[2].max, 1.0);
}

TEST(BuiltinGrids, HydrogenHasTwoLobesAndARing) {
  const std::uint32_t size = 61;
  const Dataset dataset = make("hydrogen", size, ScalarType::kFloat64);
  const std::vector<double> values = values_of<double>(dataset);
  const auto at = [&](std::size_t i, std::size_t j, std::size_t k) { return values[(k * size + j) * size + i]; };
  const std::size_t middle = size / 2, reach = 9;  // 6 Bohr radii
  EXPECT_NEAR(place(dataset, 2, middle + reach), 6.0, 1e-12);
  EXPECT_EQ(at(middle, middle, middle), 0.0);
  EXPECT_EQ(at(middle, middle, middle + reach), 1.0);
  EXPECT_DOUBLE_EQ(at(middle, middle, middle - reach), 1.0);
  EXPECT_DOUBLE_EQ(at(middle + reach, middle, middle), 0.25);
  EXPECT_DOUBLE_EQ(at(middle, middle - reach, middle), 0.25);
  for (std::size_t k = 0; k < size; ++k)
    for (std::size_t j = 0; j < size; ++j)
      for (const std::size_t i : {std::size_t{0}, std::size_t{size} - 1}) EXPECT_LT(at(i, j, k), 0.01);
}

TEST(BuiltinGrids, IntegersAreTheFieldStretchedOverTheirType) {
  const auto check = [](ScalarType type, auto zero) {
    using T = decltype(zero);
    for (const char* name : {"turbulence", "hydrogen", "marschner-lobb"}) {
      const std::vector<double> exact = values_of<double>(make(name, 20, ScalarType::kFloat64));
      const std::vector<T> values = values_of<T>(make(name, 20, type));
      const double low = static_cast<double>(std::numeric_limits<T>::lowest());
      const double width = static_cast<double>(std::numeric_limits<T>::max()) - low;
      const double step = std::max(1.0, width * 0x1p-50);
      for (std::size_t i = 0; i < exact.size(); ++i)
        ASSERT_NEAR(static_cast<double>(values[i]), low + exact[i] * width, 0.501 * step) << name;
      if (std::string(name) == "marschner-lobb") continue;
      EXPECT_EQ(*std::max_element(values.begin(), values.end()), std::numeric_limits<T>::max());
      if (std::string(name) == "hydrogen" && sizeof(T) > 2) continue;  // No point lies where it vanishes.
      EXPECT_EQ(*std::min_element(values.begin(), values.end()), std::numeric_limits<T>::lowest());
    }
  };
  check(ScalarType::kInt8, std::int8_t{});
  check(ScalarType::kUint8, std::uint8_t{});
  check(ScalarType::kInt16, std::int16_t{});
  check(ScalarType::kUint16, std::uint16_t{});
  check(ScalarType::kInt32, std::int32_t{});
  check(ScalarType::kUint32, std::uint32_t{});
  check(ScalarType::kInt64, std::int64_t{});
  check(ScalarType::kUint64, std::uint64_t{});
}

TEST(BuiltinGrids, TurbulenceFillsItsRange) {
  for (const std::uint32_t size : {2u, 3u, 17u, 64u}) {
    const std::vector<float> values = values_of<float>(make("turbulence", size, ScalarType::kFloat32));
    EXPECT_EQ(*std::min_element(values.begin(), values.end()), 0.0f);
    EXPECT_EQ(*std::max_element(values.begin(), values.end()), 1.0f);
  }
}

/// Part of the variance along x that lies below `cycles` across the grid, by a discrete Fourier transform of rows.
double part_below(const std::vector<double>& values, std::size_t size, std::size_t cycles) {
  double below = 0.0, all = 0.0;
  std::vector<double> row(size);
  for (std::size_t n = 0; n < values.size() / size; n += 37) {
    for (std::size_t i = 0; i < size; ++i) {
      const double t = static_cast<double>(i) / static_cast<double>(size);
      row[i] = (values[n * size + i] - 0.5) * (0.5 - 0.5 * std::cos(2 * std::numbers::pi * t));
    }
    for (std::size_t f = 3; f < size / 2; ++f) {
      double real = 0.0, imaginary = 0.0;
      for (std::size_t i = 0; i < size; ++i) {
        const double angle = 2 * std::numbers::pi * static_cast<double>(f * i % size) / static_cast<double>(size);
        real += row[i] * std::cos(angle);
        imaginary += row[i] * std::sin(angle);
      }
      const double power = real * real + imaginary * imaginary;
      all += power;
      if (f <= cycles) below += power;
    }
  }
  return below / all;
}

TEST(BuiltinGrids, TurbulenceHasNoFrequencyAboveItsFinestOctave) {
  // The finest lattice of 128 points has 32 cells, and so waves of at most 32 cycles (a band of splines fades there).
  const std::vector<double> values = values_of<double>(make("turbulence", 128, ScalarType::kFloat64));
  EXPECT_GT(part_below(values, 128, 32), 0.999);
  // And finer octaves are there.
  EXPECT_LT(part_below(values, 128, 8), 0.95);
}

TEST(BuiltinGrids, TurbulenceIsTheSameEverywhere) {
  // FNV-1a (Fowler, Noll, Vo) of the values, as a machine made them once.
  const auto hash_of = [](std::span<const std::byte> bytes) {
    std::uint64_t hash = 0xcbf29ce484222325u;
    for (const std::byte byte : bytes) hash = (hash ^ static_cast<std::uint64_t>(byte)) * 0x100000001b3u;
    return hash;
  };
  EXPECT_EQ(hash_of(make("turbulence", 64, ScalarType::kUint8).grid.values), 10687795033794005734u);
  EXPECT_EQ(hash_of(make("turbulence", 33, ScalarType::kFloat32, 7).grid.values), 17897908923759011167u);
  const Dataset all = make("turbulence", 70, ScalarType::kFloat64);
  for (const int threads : {1, 2, 5})
    support::with_threads(threads, [&] {
      const Dataset few = make("turbulence", 70, ScalarType::kFloat64);
      EXPECT_TRUE(std::ranges::equal(few.grid.values, all.grid.values)) << threads;
    });
}

TEST(BuiltinGrids, InfoIsComplete) {
  for (const BuiltinGridEntry& entry : builtin_grids()) {
    const Dataset dataset = make(entry.name, 12, ScalarType::kFloat32);
    const DatasetInfo& info = dataset.info;
    EXPECT_FALSE(entry.description.empty());
    EXPECT_EQ(info.source, "test:" + entry.name);
    EXPECT_EQ(info.format, "embedded");
    EXPECT_EQ(info.point_count, 12u * 12 * 12);
    EXPECT_EQ(info.cell_count, 11u * 11 * 11);
    ASSERT_TRUE(info.grid.has_value());
    EXPECT_EQ(info.grid->dimensions, dataset.grid.shape.dimensions);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      EXPECT_EQ(info.bounds[axis].min, dataset.grid.shape.origin[axis]);
      EXPECT_DOUBLE_EQ(info.bounds[axis].max, place(dataset, axis, 11));
    }
    ASSERT_EQ(info.arrays.size(), 1 + dataset.other_grids.size());
    EXPECT_EQ(info.arrays[0].name, dataset.grid.array_name);
    EXPECT_EQ(info.arrays[0].type, "float32");
    const std::vector<float> values = values_of<float>(dataset);
    const auto [low, high] = std::minmax_element(values.begin(), values.end());
    EXPECT_EQ(info.arrays[0].component_ranges.at(0).min, static_cast<double>(*low));
    EXPECT_EQ(info.arrays[0].magnitude_range.max, static_cast<double>(*high));
    EXPECT_EQ(info.arrays[0].nan_count, 0u);
  }
}

}  // namespace
}  // namespace tetravox::grid
