#pragma once

/// What part of space is drawn. Rays are cut exactly where they meet a shape: no cell or voxel is dropped whole.

#include "tetravox/camera.h"
#include "tetravox/dataset.h"

#include <string>
#include <variant>
#include <vector>

namespace tetravox {

/// The half space that `normal` points into.
struct ClipPlane {
  Vector3 origin{};
  Vector3 normal{1, 0, 0};  ///< any length but 0
};

/// Along the world's axes.
struct ClipBox {
  std::array<ValueRange, 3> bounds{};
};

struct ClipSphere {
  Vector3 center{};
  double radius = 1.0;
};

/// Where another grid's field, linear between its values, is at least `value`: a mask (0.5), or a distance that grows
/// inwards (0). Outside the grid: not.
struct ClipVolume {
  std::string file;  ///< a path, relative to the scene file or absolute, or "builtin:NAME"
  std::string array;
  double value = 0.5;
};

struct ClipShape {
  std::variant<ClipPlane, ClipBox, ClipSphere, ClipVolume> shape;
  bool keeps_inside = true;  ///< otherwise what lies outside the shape is kept
};

/// What is kept: where all shapes agree, or where any does. Without shapes: everything.
struct Clipping {
  std::vector<ClipShape> shapes;
  bool use_union = false;
};

/// @throws Error (kInvalidArgument) that names the shape's index and member.
void validate_clipping(const Clipping& clipping);

}  // namespace tetravox
