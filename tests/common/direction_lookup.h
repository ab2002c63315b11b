#pragma once

/// Environments made of functions, and filtered ones looked up, in double precision.

#include "src/optics/environment_filter.h"
#include "src/optics/environment_texels.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <functional>

namespace tetravox::tests {

/// Radiance by direction (right, up, ahead).
using Radiance = std::function<std::array<double, 3>(const Vector3&)>;

inline Environment make_environment(EnvironmentLayout layout, int height, const Radiance& radiance) {
  Environment environment;
  environment.layout = layout;
  environment.height = height;
  environment.width = layout == EnvironmentLayout::kCube ? height : 2 * height;
  for (int face = 0; face < environment.face_count(); ++face)
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < environment.width; ++x)
        for (const double value :
             radiance(optics::direction_of(layout, {face, (x + 0.5) / environment.width, (y + 0.5) / height})))
          environment.radiance.push_back(static_cast<float>(value));
  return environment;
}

/// What `DirectionTable` says about a direction, written anew from its description.
inline std::array<double, 3> look_up(const optics::DirectionTable& table, const Vector3& direction) {
  std::size_t axis = 0;
  for (std::size_t i = 1; i < 3; ++i)
    if (std::abs(direction[i]) > std::abs(direction[axis])) axis = i;
  const double major = direction[axis];
  const int last = table.size - 1;
  std::array<int, 2> node{};
  std::array<double, 2> t{};
  for (std::size_t i = 0; i < 2; ++i) {
    const double at = 0.5 * last * (1.0 + direction[(axis + 1 + i) % 3] / std::abs(major));
    node[i] = std::clamp(static_cast<int>(at), 0, last - 1);
    t[i] = at - node[i];
  }
  const std::size_t face = 2 * axis + (major < 0.0 ? 1 : 0);
  std::array<double, 3> color{};
  for (std::size_t c = 0; c < 3; ++c) {
    const auto value = [&](int column, int row) {
      const std::size_t line = face * table.size + static_cast<std::size_t>(row);
      return static_cast<double>(table.records[4 * (line * table.size + static_cast<std::size_t>(column)) + c]);
    };
    const auto across = [&](int row) { return (1.0 - t[0]) * value(node[0], row) + t[0] * value(node[0] + 1, row); };
    color[c] = (1.0 - t[1]) * across(node[1]) + t[1] * across(node[1] + 1);
  }
  return color;
}

}  // namespace tetravox::tests
