#pragma once

/// Tetrahedra as triangles of the picture, on the CPU; knows nothing of OpenGL.
///
/// A tetrahedron's picture is cut at its thick vertex, the place where the pictures of two opposite edges cross, or of
/// a vertex and the face opposite (Shirley and Tuchman 1990; Wilhelms and Van Gelder 1991). In each triangle the ray
/// enters through one face and leaves through another, so that on an orthographic picture the depths and scalars of
/// both ends are linear. Of a perspective, 1 / depth and scalar / depth are; they are carried instead, and every pixel
/// divides.
///
/// Places in the picture are whole numbers of the rasterizer's own steps. So classes and coverage are exact, all cells
/// of a face or edge agree about it, and what is interpolated is never carried beyond the triangle it belongs to.

#include "src/mesh/cell_vertices.h"
#include "src/scene/camera_frame.h"
#include "tetravox/mesh.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace tetravox::gl {

/// Where and how a mesh is seen.
struct ScreenView {
  scene::CameraFrame frame;
  int subpixels = 256;  ///< steps of the rasterizer in a pixel
  float z_near = 0.0f;  ///< rays start at this depth
};

/// A vertex of the mesh in the picture.
struct ScreenVertex {
  // The device reads it so, too (shaders/decompose.comp).
  std::int32_t x = 0, y = 0;  ///< steps from the picture's corner, y downwards; kOffScreen: see below
  float scalar = 0.0f;
  double depth = 0.0;  ///< what is linear in the picture: of a perspective 1 / (z - eye), otherwise z
};
static_assert(sizeof(ScreenVertex) == 24);
/// `ScreenVertex::x` of a vertex that is behind the eye or the near plane, or far outside the picture.
inline constexpr std::int32_t kOffScreen = INT32_MIN;

/// Of all vertices, [vertices][4] in the camera's frame; in parallel.
void project_vertices(std::span<const float> seen, const ScreenView& view, std::vector<ScreenVertex>& vertices);

/// What is linear in a triangle of the picture.
struct Carried {
  float depth = 0.0f;       ///< where the ray enters: see ScreenVertex
  float difference = 0.0f;  ///< of the depths of both ends, >= 0
  float front = 0.0f;       ///< scalars of both ends, of a perspective times the depths
  float back = 0.0f;
};

/// The picture of one tetrahedron.
struct ProjectedCell {
  int triangle_count = 0;  ///< 0 to 4; 0: seen as a line or less
  std::array<std::uint8_t, 12>
      corners{};                          ///< of the triangles: vertices 0 to 3, 4 is the thick vertex, always the last
  int outline_count = 0;                  ///< 3 or 4; 0: seen as a line or less
  std::array<std::uint8_t, 4> outline{};  ///< vertices of the outline, in turn
  std::int32_t x = 0, y = 0;  ///< the thick vertex; at the others the ray enters and leaves at the same place
  Carried thick;
};

ProjectedCell decompose_cell(const std::array<const ScreenVertex*, 4>& vertices, bool is_orthographic);

/// As vertices go to the device.
struct ProjectedVertex {
  float x = 0.0f, y = 0.0f;  ///< clip space
  Carried carried;
};
static_assert(sizeof(ProjectedVertex) == 24);

/// A corner of what covers a cell in the picture.
struct OutlineVertex {
  float x = 0.0f, y = 0.0f;  ///< clip space
  std::uint32_t place = 0;   ///< in the order
};
static_assert(sizeof(OutlineVertex) == 12);

/// Four corners round the cell in the picture, in turn, moved out so that every pixel centre that may be in it is
/// covered however places are rounded (Hasselgren, Akenine-Moeller, Ohlsson 2005). The last is the third where there
/// are three.
std::array<std::array<double, 2>, 4> find_outline(const std::array<const ScreenVertex*, 4>& vertices,
                                                  const ProjectedCell& cell, int subpixels);

/// A part of the order that is drawn in one go.
struct ProjectedRange {
  bool is_at_eye = false;
  std::size_t first = 0, count = 0;  ///< indices; at the eye: places in the order
};

/// A frame's cells as triangles in order.
struct Projection {
  std::vector<ScreenVertex> vertices;   ///< of the mesh
  std::vector<ProjectedVertex> drawn;   ///< vertices of the mesh, then the thick vertex of each place in the order
  std::vector<OutlineVertex> outlines;  ///< four a place in the order, instead of `drawn`
  std::vector<std::vector<std::uint32_t>> indices;  ///< to be drawn one after the other
  std::vector<ProjectedRange> ranges;
  std::uint64_t cells = 0, cells_at_eye = 0;  ///< that may be in the picture

  std::uint64_t bytes() const;
};

/// Fills what concerns vertices of the mesh, reusing memory; makes room for the thick vertices of `cell_count` cells.
/// `use_outlines`: for `Projection::outlines`.
void project_mesh(std::span<const float> seen, std::size_t cell_count, bool use_outlines, const ScreenView& view,
                  Projection& projection);

/// Fills `projection`, reusing its memory. `cell_scalars`: with cell data, otherwise empty. In parallel; the same for
/// any number of threads.
void decompose(std::span<const float> seen, std::span<const mesh::CellVertices> cells,
               std::span<const float> cell_scalars, std::span<const std::uint32_t> order, bool use_outlines,
               const ScreenView& view, Projection& projection);

/// Fills the ranges alone, for triangles that the device makes: `indices` a cell.
void find_ranges(std::span<const float> seen, std::span<const mesh::CellVertices> cells,
                 std::span<const std::uint32_t> order, std::size_t indices, const ScreenView& view,
                 Projection& projection);

/// Whether the cell is certainly outside the picture or behind the eye. For cells with vertices off the screen.
bool is_out_of_sight(const std::array<const float*, 4>& seen, const ScreenView& view);

}  // namespace tetravox::gl
