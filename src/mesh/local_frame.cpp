#include "src/mesh/local_frame.h"

#include "src/support/threads.h"

#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

namespace tetravox::mesh {
namespace {

constexpr std::size_t kGrain = 1 << 16;
constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr ValueRange kEmptyRange{kInfinity, -kInfinity};

void include(ValueRange& range, double value) {
  value += 0.0;  // turns -0 into 0: which of the two comes first must not matter
  range.min = std::min(range.min, value);
  range.max = std::max(range.max, value);
}

ValueRange joined(ValueRange a, const ValueRange& b) {
  a.min = std::min(a.min, b.min);
  a.max = std::max(a.max, b.max);
  return a;
}

/// Exponents of the values' distances from `offset`, summed: integers add up to the same in any order.
struct ExponentSum {
  std::int64_t sum = 0, count = 0;
};

ExponentSum sum_exponents(const ListedField& field, double offset) {
  return tbb::parallel_reduce(
      tbb::blocked_range<std::size_t>(0, field.size(), kGrain), ExponentSum{},
      [&](const tbb::blocked_range<std::size_t>& range, ExponentSum part) {
        for (std::size_t i = range.begin(); i < range.end(); ++i) {
          const double distance = field.value(i) - offset;
          if (distance == 0.0) continue;
          part.sum += std::ilogb(distance);
          ++part.count;
        }
        return part;
      },
      [](const ExponentSum& a, const ExponentSum& b) {
        return ExponentSum{a.sum + b.sum, a.count + b.count};
      });
}

}  // namespace

std::array<ValueRange, 3> bounds_of_vertices(const MeshData& mesh, const TetrahedronList& list) {
  using Bounds = std::array<ValueRange, 3>;
  return tbb::parallel_reduce(
      tbb::blocked_range<std::size_t>(0, list.point_of_vertex.size(), kGrain),
      Bounds{kEmptyRange, kEmptyRange, kEmptyRange},
      [&](const tbb::blocked_range<std::size_t>& range, Bounds bounds) {
        for (std::size_t i = range.begin(); i < range.end(); ++i)
          for (std::size_t axis = 0; axis < 3; ++axis)
            include(bounds[axis], mesh.points[3 * std::size_t{list.point_of_vertex[i]} + axis]);
        return bounds;
      },
      [](const Bounds& a, const Bounds& b) {
        return Bounds{joined(a[0], b[0]), joined(a[1], b[1]), joined(a[2], b[2])};
      });
}

double half_extent(const std::array<ValueRange, 3>& bounds) {
  double extent = 0.0;
  for (const ValueRange& range : bounds) extent = std::max(extent, range.max * 0.5 - range.min * 0.5);
  return extent;
}

ValueRange scalar_range(const ListedField& field) {
  return tbb::parallel_reduce(
      tbb::blocked_range<std::size_t>(0, field.size(), kGrain), kEmptyRange,
      [&](const tbb::blocked_range<std::size_t>& part, ValueRange range) {
        for (std::size_t i = part.begin(); i < part.end(); ++i) include(range, field.value(i));
        return range;
      },
      joined);
}

ScalarFrame choose_scalar_frame(const ListedField& field, const ValueRange& range) {
  ScalarFrame frame;
  const double largest_value = std::max(std::abs(range.min), std::abs(range.max));
  if (range.max * 0.5 - range.min * 0.5 < 0.25 * largest_value) frame.offset = range.min * 0.5 + range.max * 0.5;
  const double largest = std::max(std::abs(range.min - frame.offset), std::abs(range.max - frame.offset));
  if (!(largest > 0.0)) return frame;  // a constant field: stored as 0
  // Find how far below the largest magnitude the values typically lie.
  constexpr int kFar = 40, kMostAboveOne = 60;
  int exponent = std::ilogb(largest);
  const ExponentSum exponents = sum_exponents(field, frame.offset);
  if (exponents.count > 0) {
    const int below = exponent - static_cast<int>(exponents.sum / exponents.count);
    if (below > kFar) exponent -= std::min(kMostAboveOne, below / 2);
  }
  frame.scale = std::ldexp(1.0, std::max(exponent, -1000));
  return frame;
}

namespace {

/// Range, frame and stored scalars of one field.
OtherScalars store_field(const ListedField& field) {
  OtherScalars stored;
  stored.range = scalar_range(field);
  const ScalarFrame frame = choose_scalar_frame(field, stored.range);
  stored.offset = frame.offset;
  stored.scale = frame.scale;
  stored.scalars.resize(field.size());
  support::parallel_chunks(field.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) stored.scalars[i] = frame.stored(field.value(i));
  });
  return stored;
}

}  // namespace

void write_vertices(const MeshData& mesh, const TetrahedronList& list, PreparedMesh& prepared) {
  prepared.bounds = bounds_of_vertices(mesh, list);
  for (int axis = 0; axis < 3; ++axis)
    prepared.origin[axis] = prepared.bounds[axis].min * 0.5 + prepared.bounds[axis].max * 0.5;
  prepared.world_per_local = half_extent(prepared.bounds);
  const ListedField field{list, mesh.association, mesh.scalars};
  prepared.scalar_range = scalar_range(field);
  const ScalarFrame frame = choose_scalar_frame(field, prepared.scalar_range);
  prepared.scalar_offset = frame.offset;
  prepared.scalar_scale = frame.scale;
  prepared.association = mesh.association;

  const bool with_point_data = mesh.association == Association::kPoint;
  prepared.vertices.resize(list.point_of_vertex.size());
  support::parallel_chunks(prepared.vertices.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const std::size_t point = list.point_of_vertex[i];
      const auto local = [&](int axis) {
        return static_cast<float>((mesh.points[3 * point + axis] - prepared.origin[axis]) / prepared.world_per_local);
      };
      prepared.vertices[i] = {local(0), local(1), local(2), with_point_data ? frame.stored(mesh.scalars[point]) : 0.0f};
    }
  });
  for (const OtherField& other : mesh.others)
    prepared.others.push_back(store_field({list, mesh.association, other.scalars}));
  if (with_point_data) return;
  prepared.cell_scalars.resize(list.count);
  support::parallel_chunks(list.count, kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) prepared.cell_scalars[i] = frame.stored(field.value(i));
  });
}

}  // namespace tetravox::mesh
