/// Reflection maps against closed forms and direct sums.

#include "src/optics/environment_filter.h"
#include "src/optics/sphere_bins.h"
#include "src/support/threads.h"
#include "tests/common/direction_lookup.h"

#include <gtest/gtest.h>

#include <numbers>
#include <random>
#include <vector>

namespace tetravox::optics {
namespace {

using tests::look_up;
using tests::make_environment;
using Rgb = std::array<double, 3>;

constexpr double kPi = std::numbers::pi;
constexpr EnvironmentLayout kLayouts[] = {EnvironmentLayout::kEquirectangular, EnvironmentLayout::kCube};

double dot(const Vector3& a, const Vector3& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

Vector3 normalized(const Vector3& a) {
  const double length = std::sqrt(dot(a, a));
  return {a[0] / length, a[1] / length, a[2] / length};
}

/// Directions all over the sphere, those of axes, edges and corners of the cube among them.
std::vector<Vector3> make_directions(int count) {
  std::vector<Vector3> directions;
  for (int i = -1; i <= 1; ++i)
    for (int j = -1; j <= 1; ++j)
      for (int k = -1; k <= 1; ++k)
        if (i != 0 || j != 0 || k != 0)
          directions.push_back(normalized({static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)}));
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  for (int i = 0; i < count; ++i) directions.push_back(normalized({normal(random), normal(random), normal(random)}));
  return directions;
}

/// The weight of light at this cosine with the middle of the specular lobe, its tail left out.
double specular_weight(double cosine, double shininess) {
  return std::max(0.0, std::pow(0.5 + 0.5 * cosine, 0.5 * shininess) - 1e-4);
}

TEST(EnvironmentFilter, UniformStaysUniform) {
  const Rgb radiance{0.7, 1.0, 3.1};
  for (const EnvironmentLayout layout : kLayouts)
    for (const int height : {1, 50})
      for (const double shininess : {1.0, 40.0}) {
        const FilteredEnvironment filtered =
            filter_environment(make_environment(layout, height, [&](const Vector3&) { return radiance; }), shininess);
        for (std::size_t c = 0; c < 3; ++c) {
          EXPECT_NEAR(filtered.mean[c], radiance[c], 3e-6);
          for (const DirectionTable* table : {&filtered.diffuse, &filtered.specular})
            for (std::size_t i = c; i < table->records.size(); i += 4)
              ASSERT_NEAR(table->records[i], radiance[c], 3e-6) << height << " " << shininess;
        }
      }
}

TEST(EnvironmentFilter, IrradianceOfBandsOfHarmonics) {
  // A band of order l is multiplied by A_l / pi = 1, 2/3, 1/4, 0 (Ramamoorthi and Hanrahan 2001, equation 8).
  for (const EnvironmentLayout layout : kLayouts) {
    const FilteredEnvironment filtered =
        filter_environment(make_environment(layout, layout == EnvironmentLayout::kCube ? 64 : 96,
                                            [](const Vector3& d) {
                                              return Rgb{1.0 + 0.6 * d[0] - 0.3 * d[1], 1.0 + 0.8 * d[1] * d[2],
                                                         2.0 + 0.5 * (5.0 * d[2] * d[2] - 3.0) * d[2]};
                                            }),
                           8.0);
    for (const Vector3& n : make_directions(300)) {
      const Rgb found = look_up(filtered.diffuse, n);
      EXPECT_NEAR(found[0], 1.0 + 2.0 / 3.0 * (0.6 * n[0] - 0.3 * n[1]), 1e-3);
      EXPECT_NEAR(found[1], 1.0 + 0.25 * 0.8 * n[1] * n[2], 1e-3);
      EXPECT_NEAR(found[2], 2.0, 2e-3);
    }
    EXPECT_NEAR(filtered.mean[0], 1.0, 1e-4);
    EXPECT_NEAR(filtered.mean[2], 2.0, 1e-4);
  }
}

TEST(EnvironmentFilter, ASmallLightGivesTheLobeItself) {
  // One bright texel somewhere: the map is the lobe around it, over the integral of the lobe.
  for (const double shininess : {1.0, 32.0, 1000.0})
    for (const auto& [column, row] : {std::pair{301, 100}, std::pair{12, 3}}) {
      Environment environment =
          make_environment(EnvironmentLayout::kEquirectangular, 512, [](const Vector3&) { return Rgb{}; });
      const std::size_t texel = static_cast<std::size_t>(row) * 1024 + static_cast<std::size_t>(column);
      environment.radiance[3 * texel] = 1e5f;
      const Vector3 towards = direction_of(environment.layout, {0, (column + 0.5) / 1024, (row + 0.5) / 512});
      const double solid_angle = 2.0 * kPi / 1024 * (std::cos(kPi * row / 512) - std::cos(kPi * (row + 1) / 512));
      const FilteredEnvironment filtered = filter_environment(environment, shininess);
      const double peak = 1e5 * solid_angle * (shininess + 2.0) / (8.0 * kPi);
      double worst = 0.0, worst_diffuse = 0.0;
      std::vector<Vector3> directions = make_directions(400);
      for (const Vector3& d : make_directions(400)) {  // and close to the light
        const double reach = 1.0 / std::sqrt(shininess);
        directions.push_back(
            normalized({towards[0] + reach * d[0], towards[1] + reach * d[1], towards[2] + reach * d[2]}));
      }
      for (const Vector3& d : directions) {
        const double wanted = specular_weight(dot(d, towards), shininess);
        worst = std::max(worst, std::abs(look_up(filtered.specular, d)[0] / peak - wanted));
        const double irradiance = 1e5 * solid_angle * std::max(0.0, dot(d, towards)) / kPi;
        worst_diffuse =
            std::max(worst_diffuse, std::abs(look_up(filtered.diffuse, d)[0] - irradiance) / (1e5 * solid_angle / kPi));
      }
      EXPECT_LT(worst, 0.012) << shininess << " " << column;
      EXPECT_LT(worst_diffuse, 0.012) << shininess << " " << column;
    }
}

/// Direct sum over all texels.
Rgb sum_lobe(const Environment& environment, const Vector3& direction, double shininess) {
  Rgb sum{};
  double total = 0.0;
  for (int face = 0; face < environment.face_count(); ++face)
    for (int y = 0; y < environment.height; ++y)
      for (int x = 0; x < environment.width; ++x) {
        const FacePlace place{face, (x + 0.5) / environment.width, (y + 0.5) / environment.height};
        const double weight = spread_of(environment.layout, place) *
                              specular_weight(dot(direction, direction_of(environment.layout, place)), shininess);
        total += weight;
        const std::size_t texel =
            (static_cast<std::size_t>(face) * environment.height + y) * static_cast<std::size_t>(environment.width) + x;
        for (std::size_t c = 0; c < 3; ++c) sum[c] += weight * environment.radiance[3 * texel + c];
      }
  for (double& channel : sum) channel /= total;
  return sum;
}

TEST(EnvironmentFilter, SpecularMapAgreesWithDirectIntegration) {
  const auto scenery = [](const Vector3& d) {
    const double spot = dot(d, normalized({0.4, 0.7, -0.5})) > 0.97 ? 6.0 : 0.0;
    return Rgb{0.5 + 0.4 * std::sin(5.0 * d[0]) * std::cos(4.0 * d[1]) + spot, d[1] > 0.0 ? 1.0 : 0.2,
               d[2] > 0.2 ? 0.1 : 0.9};
  };
  for (const EnvironmentLayout layout : kLayouts) {
    const Environment environment = make_environment(layout, layout == EnvironmentLayout::kCube ? 64 : 128, scenery);
    for (const double shininess : {1.0, 10.0, 60.0, 300.0}) {
      const FilteredEnvironment filtered = filter_environment(environment, shininess);
      double worst = 0.0, square = 0.0;
      const std::vector<Vector3> directions = make_directions(40);
      for (const Vector3& d : directions) {
        const Rgb found = look_up(filtered.specular, d), wanted = sum_lobe(environment, d, shininess);
        for (std::size_t c = 0; c < 3; ++c) {
          const double error = std::abs(found[c] - wanted[c]);
          worst = std::max(worst, error);
          square += error * error / (3.0 * static_cast<double>(directions.size()));
        }
      }
      EXPECT_LT(worst, 0.02) << shininess;
      EXPECT_LT(std::sqrt(square), 0.003) << shininess;
    }
  }
}

TEST(EnvironmentFilter, BothLayoutsHoldTheSameSurroundings) {
  const auto scenery = [](const Vector3& d) {
    return Rgb{1.0 + d[0], 1.0 + d[1] * d[2], 1.0 + 0.5 * d[2] - 0.3 * d[1]};
  };
  const FilteredEnvironment one = filter_environment(make_environment(kLayouts[0], 128, scenery), 20.0);
  const FilteredEnvironment other = filter_environment(make_environment(kLayouts[1], 64, scenery), 20.0);
  for (const Vector3& d : make_directions(200))
    for (std::size_t c = 0; c < 3; ++c) {
      EXPECT_NEAR(look_up(one.diffuse, d)[c], look_up(other.diffuse, d)[c], 1e-3);
      EXPECT_NEAR(look_up(one.specular, d)[c], look_up(other.specular, d)[c], 2e-3);
    }
}

TEST(EnvironmentFilter, NodesOnEdgesAreTheSameOnBothFaces) {
  const FilteredEnvironment filtered = filter_environment(make_builtin_environment("room"), 90.0);
  for (const DirectionTable* table : {&filtered.diffuse, &filtered.specular}) {
    const int last = table->size - 1;
    const auto record = [&](std::size_t face, int column, int row) {
      const std::size_t line = face * table->size + static_cast<std::size_t>(row);
      return table->records.data() + 4 * (line * table->size + static_cast<std::size_t>(column));
    };
    // Face of +axis a: column is component a + 1, row is a + 2. Its edge column = last is on the face of a + 1, where
    // component a is the row and at its last, and a + 2 is the column.
    for (std::size_t axis = 0; axis < 3; ++axis)
      for (int i = 0; i <= last; ++i)
        for (std::size_t c = 0; c < 3; ++c)
          ASSERT_EQ(record(2 * axis, last, i)[c], record(2 * ((axis + 1) % 3), i, last)[c]) << axis << " " << i;
  }
}

TEST(EnvironmentFilter, TheSameBytesForAnyThreads) {
  const Environment environment = make_builtin_environment("sky");
  const auto filter = [&](int threads) {
    FilteredEnvironment filtered;
    support::with_threads(threads, [&] { filtered = filter_environment(environment, 50.0); });
    return filtered;
  };
  const FilteredEnvironment one = filter(1), three = filter(3);
  EXPECT_EQ(one.diffuse.records, three.diffuse.records);
  EXPECT_EQ(one.specular.records, three.specular.records);
  EXPECT_EQ(one.mean, three.mean);
}

TEST(SphereBins, KeepAllLight) {
  const Environment environment = make_builtin_environment("studio");
  double wanted = 0.0;
  for (int y = 0; y < environment.height; ++y)
    for (int x = 0; x < environment.width; ++x)
      wanted += spread_of(environment.layout, {0, 0.0, (y + 0.5) / environment.height}) *
                environment.radiance[3 * (static_cast<std::size_t>(y) * environment.width + x)];
  for (const double spacing : {0.4, 0.05, 0.004}) {
    const SphereBins bins = gather_environment(environment, spacing);
    double found = 0.0, area = 0.0;
    for (const Glow& bin : bins.bins) {
      found += bin.flux[0];
      area += bin.flux[3];
      ASSERT_NEAR(std::hypot(bin.direction[0], bin.direction[1], bin.direction[2]), bin.flux[3] > 0.0f ? 1.0f : 0.0f,
                  1e-5f);
    }
    EXPECT_NEAR(found / area, wanted / (2.0 / kPi * environment.width * environment.height), 1e-4) << spacing;
  }
}

}  // namespace
}  // namespace tetravox::optics
