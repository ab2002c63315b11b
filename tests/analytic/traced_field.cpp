#include "tests/analytic/traced_field.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <memory>

namespace tetravox::analytic {
namespace {

Vector3 difference(const Vector3& a, const Vector3& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
Vector3 mixed(double t, const Vector3& a, const Vector3& b) {
  return {a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1]), a[2] + t * (b[2] - a[2])};
}
FieldSample mixed(double t, const FieldSample& a, const FieldSample& b) {
  return {a.value + t * (b.value - a.value), mixed(t, a.gradient, b.gradient)};
}
double dot(const Vector3& a, const Vector3& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
Vector3 cross(const Vector3& a, const Vector3& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

/// A tetrahedron as four linear functions: barycentric coordinate i of p is slopes[i] . (p - corner).
struct Tetrahedron {
  std::array<std::uint32_t, 4> ids{};
  Vector3 corner{};
  std::array<Vector3, 4> slopes{};
  double volume = 0.0;

  std::array<double, 4> weights(const Vector3& p) const {
    std::array<double, 4> w{};
    for (int i = 1; i < 4; ++i) w[i] = dot(slopes[i], difference(p, corner));
    w[0] = 1.0 - w[1] - w[2] - w[3];
    return w;
  }
};

struct TracedMesh {
  std::vector<Tetrahedron> cells;
  std::vector<FieldSample> points;

  explicit TracedMesh(const MeshData& mesh) : points(mesh.point_count()) {
    const auto point = [&](std::uint32_t id) {
      return Vector3{mesh.points[3 * id], mesh.points[3 * id + 1], mesh.points[3 * id + 2]};
    };
    for (std::size_t i = 0; i < points.size(); ++i) points[i].value = mesh.scalars[i];
    std::vector<double> volumes(points.size());
    for (std::size_t c = 0; c < mesh.cell_count(); ++c) {
      Tetrahedron cell;
      for (int i = 0; i < 4; ++i) cell.ids[i] = mesh.connectivity[mesh.cell_offsets[c] + i];
      cell.corner = point(cell.ids[0]);
      std::array<Vector3, 4> edges{};
      for (int i = 1; i < 4; ++i) edges[i] = difference(point(cell.ids[i]), cell.corner);
      const double determinant = dot(edges[1], cross(edges[2], edges[3]));
      for (int i = 1; i < 4; ++i) {
        cell.slopes[i] = cross(edges[i % 3 + 1], edges[(i + 1) % 3 + 1]);
        for (double& component : cell.slopes[i]) component /= determinant;
      }
      cell.volume = std::abs(determinant);
      for (int axis = 0; axis < 3; ++axis)
        cell.slopes[0][axis] = -cell.slopes[1][axis] - cell.slopes[2][axis] - cell.slopes[3][axis];
      Vector3 gradient{};
      for (int i = 0; i < 4; ++i)
        for (int axis = 0; axis < 3; ++axis) gradient[axis] += mesh.scalars[cell.ids[i]] * cell.slopes[i][axis];
      for (const std::uint32_t id : cell.ids) {
        volumes[id] += cell.volume;
        for (int axis = 0; axis < 3; ++axis) points[id].gradient[axis] += cell.volume * gradient[axis];
      }
      cells.push_back(cell);
    }
    for (std::size_t i = 0; i < points.size(); ++i)
      for (double& component : points[i].gradient) component /= volumes[i];
  }

  FieldSample eval(const Tetrahedron& cell, const Vector3& p) const {
    const std::array<double, 4> weights = cell.weights(p);
    FieldSample sample;
    for (int i = 0; i < 4; ++i) {
      const FieldSample& at = points[cell.ids[i]];
      sample.value += weights[i] * at.value;
      for (int axis = 0; axis < 3; ++axis) sample.gradient[axis] += weights[i] * at.gradient[axis];
    }
    return sample;
  }

  Chord intersect(const Tetrahedron& cell, const Ray& ray) const {
    Chord chord{0.0, std::numeric_limits<double>::infinity()};
    const std::array<double, 4> start = cell.weights(ray.origin);
    for (int i = 0; i < 4; ++i) {
      const double slope = dot(cell.slopes[i], ray.direction);
      if (slope == 0.0 && start[i] < 0.0) return {};
      if (slope > 0.0) chord.near = std::max(chord.near, -start[i] / slope);
      if (slope < 0.0) chord.far = std::min(chord.far, -start[i] / slope);
    }
    return chord;
  }
};

struct TracedGrid {
  GridShape shape;
  std::vector<FieldSample> points;

  explicit TracedGrid(const GridData& grid) : shape(grid.shape) {
    const auto& n = shape.dimensions;
    points.resize(static_cast<std::size_t>(n[0]) * n[1] * n[2]);
    std::vector<float> values(points.size());
    std::memcpy(values.data(), grid.values.data(), values.size() * sizeof(float));
    const std::array<std::size_t, 3> strides{1, n[0], static_cast<std::size_t>(n[0]) * n[1]};
    for (std::size_t i = 0; i < points.size(); ++i) {
      points[i].value = values[i];
      for (int axis = 0; axis < 3; ++axis) {
        const std::size_t along = i / strides[axis] % n[axis];
        const std::size_t low = along > 0 ? i - strides[axis] : i;
        const std::size_t high = along + 1 < n[axis] ? i + strides[axis] : i;
        const double steps = static_cast<double>((high - low) / strides[axis]);
        points[i].gradient[axis] = (static_cast<double>(values[high]) - values[low]) / (steps * shape.spacing[axis]);
      }
    }
  }

  Vector3 lattice(const Vector3& p) const {
    Vector3 at{};
    for (int axis = 0; axis < 3; ++axis) at[axis] = (p[axis] - shape.origin[axis]) / shape.spacing[axis];
    return at;
  }

  std::array<std::size_t, 3> cell_of(const Vector3& p) const {
    std::array<std::size_t, 3> cell{};
    const Vector3 at = lattice(p);
    for (int axis = 0; axis < 3; ++axis)
      cell[axis] = static_cast<std::size_t>(std::clamp(std::floor(at[axis]), 0.0, shape.dimensions[axis] - 2.0));
    return cell;
  }

  FieldSample eval(const std::array<std::size_t, 3>& cell, const Vector3& p) const {
    const Vector3 at = lattice(p);
    const auto& n = shape.dimensions;
    const auto node = [&](std::size_t i, std::size_t j, std::size_t k) {
      return points[(cell[0] + i) + n[0] * ((cell[1] + j) + n[1] * (cell[2] + k))];
    };
    const auto along = [&](int axis) { return at[axis] - static_cast<double>(cell[axis]); };
    const auto edge = [&](std::size_t j, std::size_t k) { return mixed(along(0), node(0, j, k), node(1, j, k)); };
    const auto square = [&](std::size_t k) { return mixed(along(1), edge(0, k), edge(1, k)); };
    return mixed(along(2), square(0), square(1));
  }

  std::vector<double> borders(const Ray& ray) const {
    Vector3 upper = shape.origin;
    for (int axis = 0; axis < 3; ++axis) upper[axis] += shape.spacing[axis] * (shape.dimensions[axis] - 1.0);
    const Chord chord = intersect_box(ray, shape.origin, upper);
    if (chord.length() == 0.0) return {};
    std::vector<double> depths{chord.near, chord.far};
    for (int axis = 0; axis < 3; ++axis)
      for (std::uint32_t i = 0; i < shape.dimensions[axis]; ++i) {
        const double t = (shape.origin[axis] + i * shape.spacing[axis] - ray.origin[axis]) / ray.direction[axis];
        if (t > chord.near && t < chord.far) depths.push_back(t);
      }
    std::sort(depths.begin(), depths.end());
    return depths;
  }
};

}  // namespace

TraceField trace_tetrahedra(const MeshData& mesh) {
  const auto traced = std::make_shared<const TracedMesh>(mesh);
  return [traced](const Ray& ray) {
    std::vector<TracedSpan> spans;
    for (const Tetrahedron& cell : traced->cells) {
      const Chord chord = traced->intersect(cell, ray);
      if (chord.length() <= 0.0) continue;
      const FieldSample front = traced->eval(cell, ray.at(chord.near)), back = traced->eval(cell, ray.at(chord.far));
      spans.push_back({chord.near, chord.far, [front, back](double u) { return mixed(u, front, back); }});
    }
    std::sort(spans.begin(), spans.end(), [](const TracedSpan& a, const TracedSpan& b) { return a.near < b.near; });
    return spans;
  };
}

TraceField trace_grid(const GridData& grid) {
  const auto traced = std::make_shared<const TracedGrid>(grid);
  return [traced](const Ray& ray) {
    std::vector<TracedSpan> spans;
    const std::vector<double> borders = traced->borders(ray);
    for (std::size_t i = 1; i < borders.size(); ++i) {
      const double near = borders[i - 1], far = borders[i];
      const auto cell = traced->cell_of(ray.at(0.5 * (near + far)));
      spans.push_back({near, far, [traced, cell, ray, near, far](double u) {
                         return traced->eval(cell, ray.at(near + u * (far - near)));
                       }});
    }
    return spans;
  };
}

Rgba integrate_traced(const TraceField& trace, const Ray& ray,
                      const std::function<Medium(const FieldSample&, const Vector3&)>& medium_at, int steps) {
  Rgba sum{};
  for (const TracedSpan& span : trace(ray)) {
    const double length = span.far - span.near;
    const auto at = [&](double u) { return medium_at(span.eval(u), ray.at(span.near + u * length)); };
    sum = over(sum, integrate(length, at, steps));
  }
  return sum;
}

}  // namespace tetravox::analytic
