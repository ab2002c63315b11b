#pragma once

/// The cube [-1, 1]^3 with several fields, as a mesh or a grid.

#include "tests/analytic/cube.h"
#include "tests/common/draw.h"
#include "tests/common/grid_builder.h"
#include "tests/common/mesh_builder.h"
#include "tetravox/multidimensional.h"
#include "tetravox/render.h"

#include <cstddef>
#include <functional>
#include <optional>
#include <vector>

namespace tetravox::analytic {

class SeveralFields {
 public:
  /// Point data. `cells`: see `make_cube`.
  SeveralFields(bool is_grid, int cells, const tests::Field& value, const std::vector<tests::Field>& others) {
    if (is_grid) {
      tests::GridOptions options;
      const auto points = static_cast<std::uint32_t>(cells + 1);
      options.dimensions = {points, points, points};
      grid_ = prepare_grid(tests::make_grid(options, value));
      for (const tests::Field& other : others) grid_->others.push_back(prepare_grid(tests::make_grid(options, other)));
      return;
    }
    tests::BoxOptions options;
    options.bricks = {cells, cells, cells};
    options.type = CellType::kTetrahedron;
    mesh_ = prepare_mesh(tests::make_box(options, value));
    mesh_->others.clear();
    for (const tests::Field& other : others) {
      OtherScalars& stored = mesh_->others.emplace_back();
      stored.offset = 0.25;
      stored.scale = 2.0;
      for (const Vertex& vertex : mesh_->vertices) {
        const double local[3] = {vertex.x, vertex.y, vertex.z};
        Vector3 place{};
        for (int axis = 0; axis < 3; ++axis) place[axis] = mesh_->origin[axis] + local[axis] * mesh_->world_per_local;
        stored.scalars.push_back(static_cast<float>((other(place) - stored.offset) / stored.scale));
      }
    }
  }

  /// Cell data; the other field is a function of the value.
  SeveralFields(bool is_grid, int cells, const tests::Field& value, const std::function<double(double)>& other) {
    if (is_grid) {
      tests::GridOptions options;
      const auto points = static_cast<std::uint32_t>(cells + 1);
      options.dimensions = {points, points, points};
      options.association = Association::kCell;
      grid_ = prepare_grid(tests::make_grid(options, value));
      grid_->others.push_back(
          prepare_grid(tests::make_grid(options, [&](const Vector3& place) { return other(value(place)); })));
      return;
    }
    tests::BoxOptions options;
    options.bricks = {cells, cells, cells};
    options.type = CellType::kTetrahedron;
    options.association = Association::kCell;
    mesh_ = prepare_mesh(tests::make_box(options, value));
    mesh_->others.assign(1, {});
    for (const float stored : mesh_->cell_scalars)
      mesh_->others[0].scalars.push_back(
          static_cast<float>(other(mesh_->scalar_offset + stored * mesh_->scalar_scale)));
  }

  const std::array<ValueRange, 3>& bounds() const { return grid_ ? grid_->bounds : mesh_->bounds; }

  /// This must outlive it.
  Renderer make_renderer() const { return grid_ ? Renderer(*grid_) : Renderer(*mesh_); }

  Image draw(const OpticalFunction& function, const Camera& camera, const RenderSettings& settings) const {
    Renderer renderer = make_renderer();
    renderer.set_transfer_function(function);
    return renderer.render(camera, settings);
  }
  Image draw(const OpticalTable& table, const Camera& camera, const RenderSettings& settings) const {
    Renderer renderer = make_renderer();
    renderer.set_multidimensional_function(table);
    return renderer.render(camera, settings);
  }
  /// Colours from the first of the others.
  Image draw(const OpticalFunction& function, const OpticalFunction& colors, const Camera& camera,
             const RenderSettings& settings) const {
    Renderer renderer = make_renderer();
    renderer.set_transfer_function(function);
    renderer.set_color_function(0, colors);
    return renderer.render(camera, settings);
  }

 private:
  std::optional<PreparedMesh> mesh_;
  std::optional<PreparedGrid> grid_;
};

}  // namespace tetravox::analytic
