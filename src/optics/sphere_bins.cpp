#include "src/optics/sphere_bins.h"

#include "src/optics/environment_texels.h"
#include "src/support/threads.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace tetravox::optics {
namespace {

constexpr double kPi = std::numbers::pi;

/// Radiance that is taken for everywhere when centres are found: what is black has one, too.
constexpr float kLeastLight = 1e-20f;

/// How texels are taken: each as `split` samples a side, `block` samples a side as one part. Parts are half as large as
/// bins at most, so that those which lie across the border of two bins blur no light.
struct PartGrid {
  int split = 1, block = 1;
  int samples[2] = {1, 1};  ///< of a face, across and down
  int parts[2] = {1, 1};
};

PartGrid choose_parts(const Environment& environment, double spacing) {
  const bool is_cube = environment.layout == EnvironmentLayout::kCube;
  const double texel = (is_cube ? 0.5 * kPi : kPi) / environment.height, wanted = 0.5 * spacing;
  PartGrid grid;
  grid.split = std::max(1, static_cast<int>(std::ceil(texel / wanted)));
  grid.block = std::max(1, static_cast<int>(wanted / texel));
  const int sizes[2] = {environment.width, environment.height};
  for (int axis = 0; axis < 2; ++axis) {
    grid.samples[axis] = sizes[axis] * grid.split;
    grid.parts[axis] = (grid.samples[axis] + grid.block - 1) / grid.block;
  }
  return grid;
}

void add_light(const float* radiance, double spread, const Vector3& direction, Glow& glow) {
  const auto solid_angle = static_cast<float>(spread);
  float light = kLeastLight * solid_angle;
  for (std::size_t c = 0; c < 3; ++c) {
    glow.flux[c] += solid_angle * radiance[c];
    light += solid_angle * radiance[c];
  }
  glow.flux[3] += solid_angle;
  for (std::size_t axis = 0; axis < 3; ++axis) glow.direction[axis] += light * static_cast<float>(direction[axis]);
}

Glow sum_part(const Environment& environment, const PartGrid& grid, int face, int part_x, int part_y) {
  Glow part;
  const int last_x = std::min((part_x + 1) * grid.block, grid.samples[0]);
  const int last_y = std::min((part_y + 1) * grid.block, grid.samples[1]);
  for (int y = part_y * grid.block; y < last_y; ++y)
    for (int x = part_x * grid.block; x < last_x; ++x) {
      const FacePlace place{face, (x + 0.5) / grid.samples[0], (y + 0.5) / grid.samples[1]};
      const std::size_t row = static_cast<std::size_t>(face) * environment.height + y / grid.split;
      const float* texel = environment.radiance.data() + 3 * (row * environment.width + x / grid.split);
      add_light(texel, spread_of(environment.layout, place), direction_of(environment.layout, place), part);
    }
  return part;
}

std::vector<Glow> sum_parts(const Environment& environment, const PartGrid& grid) {
  const auto columns = static_cast<std::size_t>(grid.parts[0]), rows = static_cast<std::size_t>(grid.parts[1]);
  std::vector<Glow> parts(columns * rows * static_cast<std::size_t>(environment.face_count()));
  support::parallel_chunks(parts.size() / columns, 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t row = begin; row < end; ++row)
      for (std::size_t column = 0; column < columns; ++column)
        parts[row * columns + column] = sum_part(environment, grid, static_cast<int>(row / rows),
                                                 static_cast<int>(column), static_cast<int>(row % rows));
  });
  return parts;
}

SphereBins make_bins(double spacing) {
  SphereBins bins;
  const int rows = std::max(4, static_cast<int>(std::ceil(kPi / spacing)));
  bins.starts = {0};
  for (int row = 0; row < rows; ++row) {
    const double colatitude = kPi * (row + 0.5) / rows, around = 2.0 * rows * std::sin(colatitude);
    bins.heights.push_back(std::cos(colatitude));
    bins.columns.push_back(4 * std::max(1, static_cast<int>(std::ceil(0.25 * around))));
    bins.starts.push_back(bins.starts.back() + static_cast<std::size_t>(bins.columns.back()));
  }
  bins.bins.resize(bins.starts.back());
  return bins;
}

Glow& find_bin(SphereBins& bins, const Glow& part) {
  const auto [right, up, ahead] = part.direction;
  const auto index = [](double unit, int count) { return std::clamp(static_cast<int>(unit * count), 0, count - 1); };
  const double colatitude = std::atan2(std::hypot(right, ahead), up), longitude = std::atan2(right, ahead);
  const auto row = static_cast<std::size_t>(index(colatitude / kPi, static_cast<int>(bins.row_count())));
  return bins.bins[bins.starts[row] + index(0.5 + 0.5 * longitude / kPi, bins.columns[row])];
}

/// The sum of directions becomes a unit vector.
void complete(Glow& glow) {
  const double length = std::hypot(static_cast<double>(glow.direction[0]), static_cast<double>(glow.direction[1]),
                                   static_cast<double>(glow.direction[2]));
  for (float& component : glow.direction) component = length > 0.0 ? static_cast<float>(component / length) : 0.0f;
}

}  // namespace

SphereBins gather_environment(const Environment& environment, double spacing) {
  const std::vector<Glow> parts = sum_parts(environment, choose_parts(environment, spacing));
  SphereBins bins = make_bins(spacing);
  for (const Glow& part : parts) {
    Glow& bin = find_bin(bins, part);
    for (std::size_t c = 0; c < 4; ++c) bin.flux[c] += part.flux[c];
    for (std::size_t axis = 0; axis < 3; ++axis) bin.direction[axis] += part.direction[axis];
  }
  for (Glow& bin : bins.bins) complete(bin);
  return bins;
}

}  // namespace tetravox::optics
