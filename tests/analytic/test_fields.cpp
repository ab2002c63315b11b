/// Constant and linear fields in a box, drawn through every integrator and kind of cell, and as a grid.

#include "tests/analytic/show.h"
#include "tests/common/grid_builder.h"
#include "tests/common/mesh_builder.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>

namespace tetravox::analytic {
namespace {

const Vector3 kLower{-1.0, -0.8, -0.9};
const Vector3 kUpper{1.1, 0.9, 0.7};

/// The field s = 0.5 + gradient . p, in about [0, 1] over the box.
double linear_field(const Vector3& p) { return 0.5 + 0.21 * p[0] - 0.13 * p[1] + 0.16 * p[2]; }

struct Case {
  Integrator integrator;
  std::optional<CellType> type;  ///< empty: a grid
};

void PrintTo(const Case& c, std::ostream* out) {
  *out << name_of(c.integrator) << ", " << (c.type ? cell_type_name(static_cast<std::uint8_t>(*c.type)) : "grid");
}

class Fields : public ::testing::TestWithParam<Case> {
 protected:
  tests::Body box(const tests::Field& field) const {
    if (!GetParam().type) {
      tests::GridOptions options;
      options.dimensions = {6, 5, 7};
      options.lower = kLower;
      options.upper = kUpper;
      return tests::make_grid(options, field);
    }
    tests::BoxOptions options;
    options.bricks = {5, 4, 6};
    options.lower = kLower;
    options.upper = kUpper;
    options.type = *GetParam().type;
    return tests::make_box(options, field);
  }
  /// Draws the box from all standard cameras and holds each picture against `expected`.
  void expect_shown(const tests::Field& field, const OpticalFunction& function,
                    const std::function<Rgba(const Ray&, const Chord&)>& expected, const Tolerance& tolerance) const {
    analytic::expect_shown(
        box(field), function, make_careful_settings(GetParam().integrator),
        [&](const Ray& ray) {
          const Chord chord = intersect_box(ray, kLower, kUpper);
          return chord.length() > 0.0 ? expected(ray, chord) : Rgba{};
        },
        tolerance);
  }
  Tolerance tolerance(double sampled) const { return varying_tolerance(GetParam().integrator, sampled); }
  Tolerance constant_tolerance() const { return analytic::constant_tolerance(GetParam().integrator); }
};

TEST_P(Fields, ConstantFieldAbsorbsByItsLength) {
  const OpticalFunction function{{{0.0, 0.0, {0, 0, 0}}, {1.0, 4.0, {1.0, 0.5, 0.2}}}};
  expect_shown([](const Vector3&) { return 0.25; }, function,
               [](const Ray&, const Chord& chord) {
                 return fill({0.25, 0.125, 0.05}, chord.length());
               },
               constant_tolerance());
}

TEST_P(Fields, ConstantFieldBeyondTheLastControlPointIsClamped) {
  const OpticalFunction function{{{0.0, 0.3, {0.1, 0.2, 0.3}}, {1.0, 1.2, {1.0, 0.5, 0.2}}}};
  expect_shown([](const Vector3&) { return 17.0; }, function,
               [](const Ray&, const Chord& chord) {
                 return fill({1.0, 0.5, 0.2}, 1.2 * chord.length());
               },
               constant_tolerance());
  expect_shown([](const Vector3&) { return -17.0; }, function,
               [](const Ray&, const Chord& chord) {
                 return fill({0.1, 0.2, 0.3}, 0.3 * chord.length());
               },
               constant_tolerance());
}

TEST_P(Fields, LinearExtinctionHasTheMeanOfItsEnds) {
  const OpticalFunction function{{{0.0, 0.1, {0.0, 0.3, 0.9}}, {1.0, 3.3, {1.0, 0.4, 0.1}}}};
  expect_shown(
      linear_field, function,
      [&](const Ray& ray, const Chord& chord) {
        const double front = linear_field(ray.at(chord.near)), back = linear_field(ray.at(chord.far));
        Rgba result = integrate(chord.length(), [&](double u) {
          const OpticalPoint point = eval_optical_function(function, front + u * (back - front));
          return Medium{point.extinction, point.color};
        });
        result[3] = -std::expm1(-chord.length() * (0.1 + 3.2 * 0.5 * (front + back)));
        return result;
      },
      tolerance(2e-4));
}

TEST_P(Fields, ConstantExtinctionWithLinearColourHasTheClosedForm) {
  const double rho = 1.7;
  const OpticalFunction function{{{0.0, rho, {0, 0, 1}}, {1.0, rho, {1, 0, 0}}}};
  expect_shown(
      linear_field, function,
      [&](const Ray& ray, const Chord& chord) {
        const double front = linear_field(ray.at(chord.near)), back = linear_field(ray.at(chord.far));
        const double length = chord.length(), depth = rho * length;
        const double alpha = -std::expm1(-depth);
        // integral of t rho exp(-rho t)
        const double moment = (1.0 - (1.0 + depth) * std::exp(-depth)) / rho;
        const double red = front * alpha + (back - front) / length * moment;
        return Rgba{red, 0.0, alpha - red, alpha};
      },
      tolerance(2e-4));
}

TEST_P(Fields, WhiteIsAsBrightAsItIsOpaque) {
  OpticalFunction function;
  for (int i = 0; i <= 20; ++i) function.points.push_back({0.05 * i, 3.0 + 3.0 * std::sin(2.1 * i), {1, 1, 1}});
  const tests::Body body = box(linear_field);
  for (const auto& [name, camera] : standard_cameras()) {
    const Image image = body.draw(function, camera, tests::make_settings(GetParam().integrator, 61, 43));
    for (std::size_t i = 0; i < image.pixels.size(); ++i)
      ASSERT_NEAR(image.pixels[i], image.pixels[i - i % 4 + 3], 2e-5) << name << " value " << i;
  }
}

TEST_P(Fields, ATentHasItsIntegral) {
  // Extinction rises from 0 at 0.3 to 8 at 0.5 and falls to 0 at 0.6; one colour.
  const OpticalFunction function{
      {{0.3, 0.0, {0.2, 0.9, 0.4}}, {0.5, 8.0, {0.2, 0.9, 0.4}}, {0.6, 0.0, {0.2, 0.9, 0.4}}}};
  const auto integral = [](double s) {
    if (s <= 0.3) return 0.0;
    if (s <= 0.5) return 20.0 * (s - 0.3) * (s - 0.3);
    const double left = std::max(0.6 - s, 0.0);
    return 1.2 - 40.0 * left * left;
  };
  expect_shown(
      linear_field, function,
      [&](const Ray& ray, const Chord& chord) {
        const double front = linear_field(ray.at(chord.near)), back = linear_field(ray.at(chord.far));
        return fill({0.2, 0.9, 0.4}, chord.length() * (integral(back) - integral(front)) / (back - front));
      },
      tolerance(1e-3));
}

TEST_P(Fields, StepsCutTheChord) {
  const Color kRed{0.9, 0.1, 0.1}, kBlue{0.1, 0.2, 0.8};
  const OpticalFunction function{{{0.35, 0.0, kRed},
                                  {0.35, 1.5, kRed},
                                  {0.55, 1.5, kRed},
                                  {0.55, 6.0, kBlue},
                                  {0.7, 6.0, kBlue},
                                  {0.7, 0.0, kBlue}}};
  expect_shown(
      linear_field, function,
      [&](const Ray& ray, const Chord& chord) {
        const double front = linear_field(ray.at(chord.near)), back = linear_field(ray.at(chord.far));
        const auto part = [&](double low, double high) {
          const double first = std::clamp(std::min(front, back), low, high);
          const double last = std::clamp(std::max(front, back), low, high);
          return chord.length() * (last - first) / std::abs(back - front);
        };
        const Rgba red = fill(kRed, 1.5 * part(0.35, 0.55)), blue = fill(kBlue, 6.0 * part(0.55, 0.7));
        return back > front ? over(red, blue) : over(blue, red);
      },
      tolerance(5e-3));
}

std::vector<Case> all_cases() {
  std::vector<Case> cases;
  for (const CellType type :
       {CellType::kTetrahedron, CellType::kVoxel, CellType::kWedge, CellType::kPyramid, CellType::kPolyhedron})
    cases.push_back({Integrator::kAntiderivative, type});
  for (const Integrator integrator : tests::kAllIntegrators) {
    cases.push_back({integrator, CellType::kHexahedron});
    cases.push_back({integrator, std::nullopt});
  }
  return cases;
}

INSTANTIATE_TEST_SUITE_P(Box, Fields, ::testing::ValuesIn(all_cases()), [](const auto& test) {
  const Case& c = test.param;
  return name_of(c.integrator) + "_" + (c.type ? std::to_string(static_cast<int>(*c.type)) : "grid");
});

}  // namespace
}  // namespace tetravox::analytic
