#pragma once

/// Embedded datasets, prepared, with the functions and cameras that conformance tests draw them with.

#include "tests/common/cameras.h"
#include "tests/common/draw.h"
#include "tests/common/functions.h"
#include "tests/common/image_compare.h"
#include "tests/common/mesh_builder.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

namespace tetravox::conformance {

struct Subject {
  Dataset dataset;
  PreparedMesh mesh;
  std::vector<tests::NamedFunction> functions;
  std::vector<tests::NamedCamera> cameras;

  const OpticalFunction& function(const std::string& name) const {
    return std::find_if(functions.begin(), functions.end(), [&](const auto& f) { return f.name == name; })->function;
  }
  const Camera& camera(const std::string& name) const {
    return std::find_if(cameras.begin(), cameras.end(), [&](const auto& c) { return c.name == name; })->camera;
  }
};

/// The bounds that the exact integrators promise: `antiderivative` half an 8-bit step, `partial` a twentieth.
inline ::testing::AssertionResult agrees(const Image& actual, const Image& expected, Integrator integrator) {
  return tests::images_agree(actual, expected, integrator == Integrator::kPartial ? 2e-4 : 2e-3, 2e-4);
}

inline Subject make_subject(const MeshData& data) {
  Subject subject;
  subject.dataset.mesh = data;
  subject.mesh = prepare_mesh(data);
  subject.functions = tests::make_hard_functions(subject.mesh.scalar_range, tests::diagonal_of(subject.mesh.bounds));
  subject.cameras = tests::make_cameras(subject.mesh.bounds);
  return subject;
}

inline Subject make_subject(const std::string& builtin) { return make_subject(make_builtin(builtin).mesh); }

/// Cells of every linear kind in one mesh with cell data that jump from cell to cell.
inline MeshData make_cell_data_mesh() {
  tests::MeshBuilder builder;
  const CellType types[] = {CellType::kHexahedron, CellType::kTetrahedron, CellType::kWedge,
                            CellType::kPyramid,    CellType::kVoxel,       CellType::kPolyhedron};
  for (int i = 0; i < 6; ++i) {
    tests::BoxOptions options;
    options.bricks = {2, 6, 5};
    options.lower = {-1.0 + i / 3.0, -1, -1};
    options.upper = {-1.0 + (i + 1) / 3.0, 1, 1};
    options.type = types[i];
    tests::add_box(builder, options, [](const Vector3& p) {
      const double x = 43.7 * p[0] + 91.3 * p[1] + 17.9 * p[2];
      return x - std::floor(x);
    });
  }
  return builder.build(Association::kCell);
}

/// Thin plates one behind the other, and a camera that looks through all of them.
inline MeshData make_comb(int plates) {
  tests::MeshBuilder builder;
  for (int i = 0; i < plates; ++i) {
    tests::BoxOptions options;
    options.bricks = {1, 1, 1};
    options.lower = {-1, -1 + 2.0 * i / plates, -1};
    options.upper = {1, -1 + 2.0 * (i + 0.5) / plates, 1};
    tests::add_box(builder, options, [](const Vector3& p) { return p[0] + 2 * p[1]; });
  }
  return builder.build(Association::kPoint);
}
inline const Camera kAlongComb{{0.3, -9, 0.2}, {0, 0, 0}, {0, 0, 1}, 30.0, {}};

}  // namespace tetravox::conformance
