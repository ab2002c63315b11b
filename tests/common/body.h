#pragma once

/// A mesh or a grid, prepared: what holds for both is tested with both.

#include "tetravox/render.h"

#include <optional>

namespace tetravox::tests {

class Body {
 public:
  Body(const MeshData& mesh) : mesh_(prepare_mesh(mesh)) {}
  Body(const GridData& grid) : grid_(prepare_grid(grid)) {}

  bool is_grid() const { return grid_.has_value(); }
  const std::array<ValueRange, 3>& bounds() const { return grid_ ? grid_->bounds : mesh_->bounds; }
  const ValueRange& scalar_range() const { return grid_ ? grid_->scalar_range : mesh_->scalar_range; }

  /// The body must outlive it.
  Renderer make_renderer() const { return grid_ ? Renderer(*grid_) : Renderer(*mesh_); }

  Image draw(const OpticalFunction& function, const Camera& camera, const RenderSettings& settings) const {
    return grid_ ? render(*grid_, function, camera, settings) : render(*mesh_, function, camera, settings);
  }

 private:
  std::optional<PreparedMesh> mesh_;
  std::optional<PreparedGrid> grid_;
};

}  // namespace tetravox::tests
