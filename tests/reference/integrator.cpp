#include "tests/reference/integrator.h"

#include "tests/reference/segment.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace tetravox::reference {
namespace {

std::vector<Vec> camera_points(const Tetrahedra& tetrahedra, const Camera& camera) {
  const CameraAxes axes(camera);
  std::vector<Vec> points(tetrahedra.points.size());
  tbb::parallel_for(std::size_t{0}, points.size(),
                    [&](std::size_t i) { points[i] = axes.camera_from_world(tetrahedra.points[i] - camera.position); });
  return points;
}

/// Columns (or rows) that a tetrahedron may cover; `first > last` where none.
struct Reach {
  int first_column = 0, last_column = -1;
  int first_row = 0, last_row = -1;
};

/// Bounds of the vertices on the screen, widened by half a pixel; everything where a vertex is not in front of the eye.
Reach find_reach(const std::array<Vec, 4>& corners, const Screen& screen) {
  const View& view = screen.view;
  const int columns = view.drawn_width(), rows = view.drawn_height();
  double low[2] = {1e300, 1e300}, high[2] = {-1e300, -1e300}, nearest = 1e300, farthest = -1e300;
  for (const Vec& p : corners) {
    nearest = std::min(nearest, p[2]);
    farthest = std::max(farthest, p[2]);
  }
  if (farthest <= 0.0) return {};
  if (screen.is_perspective && nearest <= 1e-6 * farthest) return {0, columns - 1, 0, rows - 1};
  for (const Vec& p : corners) {
    const double scale = screen.is_perspective ? 1.0 / p[2] : 1.0;
    const double pixel[2] = {0.5 * view.width * (1.0 + p[0] * scale / screen.half_width),
                             0.5 * view.height * (1.0 - p[1] * scale / screen.half_height)};
    for (int k = 0; k < 2; ++k) {
      low[k] = std::min(low[k], pixel[k]);
      high[k] = std::max(high[k], pixel[k]);
    }
  }
  const auto drawn = [&](double pixel, int first, int count) {
    const double position = (pixel - 0.5 - first) / view.stride;
    return std::clamp(position, -1.0, static_cast<double>(count));
  };
  Reach reach;
  reach.first_column = std::max(0, static_cast<int>(std::floor(drawn(low[0] - 0.5, view.first_x, columns))));
  reach.last_column = std::min(columns - 1, static_cast<int>(std::ceil(drawn(high[0] + 0.5, view.first_x, columns))));
  reach.first_row = std::max(0, static_cast<int>(std::floor(drawn(low[1] - 0.5, view.first_y, rows))));
  reach.last_row = std::min(rows - 1, static_cast<int>(std::ceil(drawn(high[1] + 0.5, view.first_y, rows))));
  return reach;
}

/// A ray's stay in one tetrahedron: depths (z in camera space) and scalars at both ends.
struct Stay {
  double z_near, z_far;
  double scalar_front, scalar_back;
};

/// Barycentric coordinates along a ray are linear in z: coordinate k at depth z is at_zero[k] + z * slope[k].
struct BarycentricLine {
  std::array<double, 4> at_zero{}, slope{};
};

BarycentricLine make_line(const std::array<Vec, 4>& corners, const Ray& ray) {
  BarycentricLine line;
  for (int k = 0; k < 4; ++k) {
    const Vec& a = corners[(k + 1) % 4];
    const Vec normal = cross(corners[(k + 2) % 4] - a, corners[(k + 3) % 4] - a);
    const double height = dot(normal, corners[k] - a);
    line.at_zero[k] = dot(normal, ray.origin - a) / height;
    line.slope[k] = dot(normal, ray.direction) / height;
  }
  return line;
}

/// Part of the line inside all four planes and in front of the eye.
bool clip_line(const BarycentricLine& line, Stay& stay) {
  stay.z_near = 0.0;
  stay.z_far = std::numeric_limits<double>::infinity();
  for (int k = 0; k < 4; ++k) {
    if (line.slope[k] == 0.0) {
      if (line.at_zero[k] < 0.0) return false;
      continue;
    }
    const double z = -line.at_zero[k] / line.slope[k];
    if (line.slope[k] > 0.0) {
      stay.z_near = std::max(stay.z_near, z);
    } else {
      stay.z_far = std::min(stay.z_far, z);
    }
  }
  return stay.z_far > stay.z_near && std::isfinite(stay.z_far);
}

class RowDrawer {
 public:
  RowDrawer(const Tetrahedra& tetrahedra, const std::vector<Vec>& points, const OpticalFunction& function,
            const Screen& screen)
      : tetrahedra_(tetrahedra), points_(points), function_(function), screen_(screen) {}

  void draw_row(int row, const std::vector<std::uint32_t>& candidates, Image& image) const {
    std::vector<std::vector<Stay>> stays(image.width);
    for (std::uint32_t cell : candidates) gather(cell, row, stays);
    for (int column = 0; column < image.width; ++column) integrate(column, row, stays[column], image);
  }

 private:
  std::array<Vec, 4> corners(std::uint32_t cell) const {
    const auto& v = tetrahedra_.cells[cell].vertices;
    return {points_[v[0]], points_[v[1]], points_[v[2]], points_[v[3]]};
  }

  /// True where the plane of the row's rays has the whole tetrahedron on one side.
  bool misses_row(const std::array<Vec, 4>& corners, double y) const {
    double low = 1e300, high = -1e300;
    for (const Vec& p : corners) {
      const double distance = p[1] - (screen_.is_perspective ? y * p[2] : y);
      low = std::min(low, distance);
      high = std::max(high, distance);
    }
    return low > 0.0 || high < 0.0;
  }

  void gather(std::uint32_t cell, int row, std::vector<std::vector<Stay>>& stays) const {
    const std::array<Vec, 4> corner = corners(cell);
    if (misses_row(corner, screen_.y(row))) return;
    const Reach reach = find_reach(corner, screen_);
    for (int column = reach.first_column; column <= reach.last_column; ++column) {
      const BarycentricLine line = make_line(corner, screen_.ray(column, row));
      Stay stay{};
      if (!clip_line(line, stay)) continue;
      stay.scalar_front = scalar_at(cell, line, stay.z_near);
      stay.scalar_back = scalar_at(cell, line, stay.z_far);
      stays[column].push_back(stay);
    }
  }

  double scalar_at(std::uint32_t cell, const BarycentricLine& line, double z) const {
    const Tetrahedron& tetrahedron = tetrahedra_.cells[cell];
    if (!tetrahedra_.cell_scalars.empty()) return tetrahedra_.cell_scalars[tetrahedron.input_cell];
    double sum = 0.0, low = 1e300, high = -1e300;
    for (int k = 0; k < 4; ++k) {
      const double scalar = tetrahedra_.point_scalars[tetrahedron.vertices[k]];
      sum += scalar * (line.at_zero[k] + z * line.slope[k]);
      low = std::min(low, scalar);
      high = std::max(high, scalar);
    }
    return std::clamp(sum, low, high);
  }

  void integrate(int column, int row, std::vector<Stay>& stays, Image& image) const {
    std::sort(stays.begin(), stays.end(),
              [](const Stay& a, const Stay& b) { return a.z_near + a.z_far < b.z_near + b.z_far; });
    const Vec direction = screen_.ray(column, row).direction;
    const double length_per_z = std::sqrt(dot(direction, direction));
    RayIntegral ray;
    for (const Stay& stay : stays)
      append_segment(function_, stay.scalar_front, stay.scalar_back, (stay.z_far - stay.z_near) * length_per_z, ray);
    float* pixel = image.pixel(column, row);
    for (int k = 0; k < 3; ++k) pixel[k] = static_cast<float>(ray.color[k]);
    pixel[3] = static_cast<float>(-std::expm1(-ray.optical_depth));
  }

  const Tetrahedra& tetrahedra_;
  const std::vector<Vec>& points_;
  const OpticalFunction& function_;
  const Screen& screen_;
};

}  // namespace

Image draw(const Tetrahedra& tetrahedra, const OpticalFunction& function, const View& view) {
  const Screen screen(view);
  const std::vector<Vec> points = camera_points(tetrahedra, view.camera);
  Image image{view.drawn_width(), view.drawn_height(), {}};
  image.pixels.assign(4 * static_cast<std::size_t>(image.width) * image.height, 0.0f);

  std::vector<std::vector<std::uint32_t>> candidates(image.height);
  for (std::uint32_t cell = 0; cell < tetrahedra.cells.size(); ++cell) {
    const auto& v = tetrahedra.cells[cell].vertices;
    const Reach reach = find_reach({points[v[0]], points[v[1]], points[v[2]], points[v[3]]}, screen);
    for (int row = reach.first_row; row <= reach.last_row; ++row) candidates[row].push_back(cell);
  }
  const RowDrawer drawer(tetrahedra, points, function, screen);
  tbb::parallel_for(0, image.height, [&](int row) { drawer.draw_row(row, candidates[row], image); });
  return image;
}

}  // namespace tetravox::reference
