#pragma once

/// Gradients of the field of a prepared mesh, in cells and at vertices.

#include "tetravox/mesh.h"

#include <array>
#include <vector>

namespace tetravox::mesh {

/// (gx, gy, gz, 0): 16 bytes, to be loaded at once. Stored scalar per local length, along the axes of the local frame,
/// which are parallel to the world's. In values per world length it is `gradient_scale` times that. Always finite;
/// where a cell is so thin that a gradient could not be squared as a float, it is shortened, and keeps its direction.
using Gradient = std::array<float, 4>;
static_assert(sizeof(Gradient) == 16);

/// World gradient (value per world length) / stored gradient.
inline double gradient_scale(const PreparedMesh& mesh) { return mesh.scalar_scale / mesh.world_per_local; }

/// The gradient of every cell, [cells]: constant, since the field is linear there. With cell data: of the field that is
/// linear between `vertex_scalars`. 0 in a cell without volume.
/// In parallel; the same bytes for any number of threads, as for the functions below.
std::vector<Gradient> cell_gradients(const PreparedMesh& mesh);

/// The gradient at every vertex, [vertices]: the mean of the gradients of the cells around it, weighted by their
/// volumes (Correa, Hero, Ma 2011 compare such means). First order at the boundary, second inside regular meshes.
/// 0 at a vertex whose cells have no volume.
std::vector<Gradient> vertex_gradients(const PreparedMesh& mesh);

/// The field at every vertex, [vertices], as stored scalars: with cell data the mean of the values of the cells around
/// it, weighted by their volumes.
std::vector<float> vertex_scalars(const PreparedMesh& mesh);

/// Gradients at vertices of another field on them: `scalars` is [vertices]; the result is in its units per local
/// length.
std::vector<Gradient> vertex_gradients(const PreparedMesh& mesh, const std::vector<float>& scalars);

}  // namespace tetravox::mesh
