#pragma once

/// Grids that are hard to draw, with the functions and cameras that conformance tests draw them with.

#include "tests/common/cameras.h"
#include "tests/common/draw.h"
#include "tests/common/functions.h"
#include "tests/common/grid_builder.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

namespace tetravox::conformance {

struct NamedGrid {
  const char* name;
  GridData grid;
};

/// A grid drawn: functions for its range, cameras for its bounds.
struct GridSubject {
  PreparedGrid grid;
  std::vector<tests::NamedFunction> functions;
  std::vector<tests::NamedCamera> cameras;

  explicit GridSubject(const GridData& data)
      : grid(prepare_grid(data)),
        functions(tests::make_hard_functions(grid.scalar_range, tests::diagonal_of(grid.bounds))),
        cameras(tests::make_cameras(grid.bounds)) {}

  const OpticalFunction& function(const std::string& name) const {
    return std::find_if(functions.begin(), functions.end(), [&](const auto& f) { return f.name == name; })->function;
  }
  const Camera& camera(const std::string& name) const {
    return std::find_if(cameras.begin(), cameras.end(), [&](const auto& c) { return c.name == name; })->camera;
  }
};

/// `field` without the values in a ball, on a plane and at single points at random.
inline tests::Field with_holes(const tests::Field& field) {
  return [field](const Vector3& p) {
    const double noise = 43758.5453 * std::sin(12.9898 * p[0] + 78.233 * p[1] + 37.719 * p[2]);
    const bool is_alone = noise - std::floor(noise) < 0.004;
    const bool is_in_ball = std::hypot(p[0] - 0.4, p[1] + 0.3, p[2] - 0.2) < 0.3;
    return is_alone || is_in_ball ? std::numeric_limits<double>::quiet_NaN() : field(p);
  };
}

/// Smooth fields of about four cells a wave as point data, bytes, uneven, sheared, as cell data, with holes, of noise.
inline std::vector<NamedGrid> make_hard_grids() {
  const tests::Field smooth = tests::make_random_field(21, 3.0);
  tests::GridOptions options;
  options.dimensions = {22, 19, 17};
  std::vector<NamedGrid> grids;
  grids.push_back({"smooth", make_grid(options, smooth)});
  grids.push_back(
      {"marschner_lobb", make_grid(options, [](const Vector3& p) { return tests::marschner_lobb(p, 3.0); })});

  tests::GridOptions bytes = options;
  bytes.type = ScalarType::kUint8;
  grids.push_back({"bytes", make_grid(bytes, [&](const Vector3& p) { return 255.0 * smooth(p); })});

  tests::GridOptions uneven = options;
  uneven.fractions[0] = tests::growing_fractions(22, 6.0);
  uneven.fractions[2] = tests::growing_fractions(17, 0.3);
  grids.push_back({"uneven", make_grid(uneven, smooth)});

  tests::GridOptions sheared = options;
  sheared.direction = {0.9, 0.3, 0.0, -0.2, 0.8, 0.3, 0.1, 0.0, -1.1};
  sheared.type = ScalarType::kInt16;
  grids.push_back({"sheared", make_grid(sheared, [&](const Vector3& p) { return 30000.0 * smooth(p) - 15000.0; })});

  tests::GridOptions cells = options;
  cells.association = Association::kCell;
  grids.push_back({"cell_data", make_grid(cells, smooth)});

  tests::GridOptions holes = options;
  grids.push_back({"holes", make_grid(holes, with_holes(smooth))});

  tests::GridOptions noise = options;
  noise.dimensions = {11, 10, 12};
  grids.push_back({"noise", make_grid(noise, tests::make_random_field(22, 40.0))});
  return grids;
}

inline const std::vector<Filter>& all_filters() {
  static const std::vector<Filter> filters = {{FilterKind::kLinear},     {FilterKind::kNearest},
                                              {FilterKind::kBspline},    {FilterKind::kInterpolatingBspline},
                                              {FilterKind::kCatmullRom}, {FilterKind::kMitchell},
                                              {FilterKind::kLanczos, 2}, {FilterKind::kLanczos, 3}};
  return filters;
}

}  // namespace tetravox::conformance
