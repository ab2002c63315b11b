#include "src/mesh/cell_vertices.h"
#include "src/mesh/gradients.h"
#include "src/scene/differential_samples.h"
#include "src/support/threads.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>

namespace tetravox::scene {
namespace {

constexpr std::size_t kFewestPlaces = 4, kMostPlaces = 64;  // in a cell
constexpr std::size_t kCellGrain = 1 << 10;

using Vector = std::array<double, 3>;
using Weights = std::array<double, 4>;  // of a cell's vertices

/// Place number `n` of a sequence that fills the tetrahedron evenly: the additive recurrence of the generalised golden
/// ratio (Roberts 2018) in a cube, folded into a tetrahedron (Rocchini and Cignoni 2000).
Weights place_in_cell(std::uint64_t n) {
  constexpr Vector kSteps{0.8191725133961645, 0.6710436067037893, 0.5497004779019703};
  Vector u;
  for (std::size_t axis = 0; axis < 3; ++axis) u[axis] = std::fmod(0.5 + kSteps[axis] * static_cast<double>(n), 1.0);
  auto [s, t, r] = u;
  if (s + t > 1.0) {
    s = 1.0 - s;
    t = 1.0 - t;
  }
  if (t + r > 1.0) {
    const double last = r;
    r = 1.0 - s - t;
    t = 1.0 - last;
  } else if (s + t + r > 1.0) {
    const double last = r;
    r = s + t + r - 1.0;
    s = 1.0 - t - last;
  }
  return {1.0 - s - t - r, s, t, r};
}

Vector cross(const Vector& a, const Vector& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
double dot(const Vector& a, const Vector& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

float finite(double value) {
  constexpr double kLargest = std::numeric_limits<float>::max();
  return static_cast<float>(std::clamp(value, -kLargest, kLargest));
}

/// A further field at a place of a cell: linear (point data) or constant (cell data).
float sample_other(const PreparedMesh& mesh, const OtherScalars& other, std::size_t cell, const mesh::CellVertices& ids,
                   const Weights& weights) {
  if (mesh.association == Association::kCell) return other.scalars[cell];
  double value = 0.0;
  for (std::size_t i = 0; i < 4; ++i) value += weights[i] * other.scalars[ids[i]];
  return static_cast<float>(value);
}

/// A cell with gradients at its vertices, linear in between.
class CellField {
 public:
  CellField(const PreparedMesh& mesh, const mesh::CellVertices& ids, const std::vector<mesh::Gradient>& gradients) {
    std::array<Vector, 4> corners;
    for (std::size_t i = 0; i < 4; ++i) {
      const Vertex& vertex = mesh.vertices[ids[i]];
      corners[i] = {vertex.x, vertex.y, vertex.z};
      scalars_[i] = vertex.scalar;
      for (std::size_t axis = 0; axis < 3; ++axis) gradients_[i][axis] = gradients[ids[i]][axis];
    }
    std::array<Vector, 3> edges;
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t axis = 0; axis < 3; ++axis) edges[i][axis] = corners[i + 1][axis] - corners[0][axis];
    normals_ = {cross(edges[1], edges[2]), cross(edges[2], edges[0]), cross(edges[0], edges[1])};
    determinant_ = dot(edges[0], normals_[0]);
  }

  double volume() const { return std::abs(determinant_); }

  DifferentialSample sample(const Weights& weights) const {
    DifferentialSample sample;
    double value = 0.0;
    Vector gradient{};
    for (std::size_t i = 0; i < 4; ++i) {
      value += weights[i] * scalars_[i];
      for (std::size_t axis = 0; axis < 3; ++axis) gradient[axis] += weights[i] * gradients_[i][axis];
    }
    sample.value = static_cast<float>(value);
    const double magnitude = std::sqrt(dot(gradient, gradient));
    sample.gradient = finite(magnitude);
    if (magnitude > 0.0) sample.second = finite(change_along(gradient, magnitude));
    return sample;
  }

 private:
  /// How fast the part of the gradient along itself grows in its own direction.
  double change_along(const Vector& gradient, double magnitude) const {
    double change = 0.0;
    for (std::size_t i = 0; i < 3; ++i) {
      Vector rise;
      for (std::size_t axis = 0; axis < 3; ++axis) rise[axis] = gradients_[i + 1][axis] - gradients_[0][axis];
      change += dot(rise, gradient) / magnitude * (dot(normals_[i], gradient) / magnitude);
    }
    return change / determinant_;
  }

  std::array<double, 4> scalars_{};
  std::array<Vector, 4> gradients_{};
  std::array<Vector, 3> normals_{};
  double determinant_ = 0.0;
};

}  // namespace

DifferentialSamples sample_differentials(const PreparedMesh& mesh, std::size_t largest_count) {
  const std::vector<mesh::Gradient> gradients = mesh::vertex_gradients(mesh);
  const std::vector<mesh::CellVertices> cells = mesh::find_cell_vertices(mesh);
  const std::size_t stride =
      std::max<std::size_t>(1, (kFewestPlaces * cells.size() + largest_count - 1) / largest_count);
  const std::size_t count = (cells.size() + stride - 1) / stride;
  const std::size_t places = std::clamp(largest_count / std::max<std::size_t>(1, count), kFewestPlaces, kMostPlaces);
  const bool with_cell_data = mesh.association == Association::kCell;
  DifferentialSamples result;
  result.unit_length = mesh.world_per_local;
  result.samples.resize(count * places);
  result.others.assign(mesh.others.size(), std::vector<float>(count * places));
  support::parallel_chunks(count, kCellGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t n = begin; n < end; ++n) {
      const std::size_t cell = n * stride;
      if (cells[cell][0] == kNoCell) continue;
      const CellField field(mesh, cells[cell], gradients);
      if (!(field.volume() > 0.0)) continue;
      for (std::size_t i = 0; i < places; ++i) {
        DifferentialSample& sample = result.samples[n * places + i];
        const Weights weights = place_in_cell(n * places + i);
        sample = field.sample(weights);
        for (std::size_t other = 0; other < mesh.others.size(); ++other)
          result.others[other][n * places + i] = sample_other(mesh, mesh.others[other], cell, cells[cell], weights);
        if (with_cell_data) sample.value = mesh.cell_scalars[cell];
        sample.volume = static_cast<float>(field.volume());
      }
    }
  });
  return result;
}

}  // namespace tetravox::scene
