#pragma once

/// What a frame by slices is made of: what it refuses, which programs it takes, what its uniform block says.

#include "src/gl/blocks.h"
#include "src/gl/grid_textures.h"
#include "src/gl/slice_geometry.h"
#include "src/gl/slice_programs.h"
#include "src/grid/frame.h"
#include "src/scene/grid_view.h"
#include "tetravox/grid.h"
#include "tetravox/render.h"

#include <array>
#include <vector>

namespace tetravox::gl {

/// Light sources that a frame by slices knows.
inline constexpr int kMostSliceLights = 8;
/// Iso-surfaces; the table of their colours has one row and column more.
inline constexpr int kMostSliceSurfaces = 15;

/// @throws Error (kUnsupported) that names the first thing asked for that slices do not draw.
void require_sliceable(const PreparedGrid& grid, const RenderSettings& settings);

/// Whether the filter is a kernel, whose slices are filtered before they are drawn.
bool filters_slices(const RenderSettings& settings);

SliceVariant variant_of(const PreparedGrid& grid, const RenderSettings& settings);

SlicingRequest request_of(const PreparedGrid& grid, const grid::GridFrame& frame, const scene::GridView& view,
                          const RenderSettings& settings);

/// What the view and the settings say; slabs and the light's buffer are left out.
SliceBlock describe(const PreparedGrid& grid, const scene::GridView& view, const RenderSettings& settings,
                    const SlicingRequest& request, const TexelMap& map);
void describe(const SlabFamily& family, SliceBlock& block);

/// The way that the light of half-angle slices goes, a unit vector of the camera frame.
Point way_of_light(const scene::GridView& view, const Lighting& lighting);
/// Half way between the view (or the way against it) and the light's way.
Point half_way(const Point& light);

/// What is seen of iso-surfaces between two scalars, [back][front], each by the number of values below it;
/// premultiplied.
std::vector<std::array<float, 4>> make_surface_colors(const std::vector<Isosurface>& surfaces);

}  // namespace tetravox::gl
