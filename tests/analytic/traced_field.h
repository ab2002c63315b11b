#pragma once

/// Fields and their smooth gradients along rays, cell by cell in double precision: what lit pictures of coarse data are
/// held against. Slow, and shares nothing with the renderer.

#include "tests/analytic/closed_form.h"
#include "tetravox/dataset.h"

#include <functional>
#include <vector>

namespace tetravox::analytic {

/// The field at a place, in values and world lengths.
struct FieldSample {
  double value = 0.0;
  Vector3 gradient{};
};

/// A part of a ray inside one cell. `eval(u)`: u in [0, 1] from front to back.
struct TracedSpan {
  double near = 0.0, far = 0.0;
  std::function<FieldSample(double)> eval;
};

/// Spans of a ray in a mesh of tetrahedra with point data, front to back; gradients are means of the cells' at the
/// points, weighted by volume, linear in between.
using TraceField = std::function<std::vector<TracedSpan>(const Ray&)>;
TraceField trace_tetrahedra(const MeshData& mesh);

/// The same in an even grid of float32 with axes along the world's; gradients are central differences at the points,
/// trilinear in between.
TraceField trace_grid(const GridData& grid);

/// What a ray shows: `medium_at(sample, place)` at `steps` places of each span.
Rgba integrate_traced(const TraceField& trace, const Ray& ray,
                      const std::function<Medium(const FieldSample&, const Vector3&)>& medium_at, int steps);

}  // namespace tetravox::analytic
