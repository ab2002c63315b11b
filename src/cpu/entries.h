#pragma once

/// Where rays enter the mesh: faces are binned into tiles, then found in the tile's pixels and sorted by depth.

#include "src/cpu/kernels/kernels.h"
#include "src/scene/camera_frame.h"

#include <cstdint>
#include <span>
#include <vector>

namespace tetravox::cpu {

/// The faces that each tile may meet.
struct TileBins {
  int columns = 0, rows = 0;         ///< of tiles
  std::vector<std::uint32_t> begin;  ///< [columns * rows + 1] into faces
  std::vector<BinnedFace> faces;

  std::size_t tile_count() const { return static_cast<std::size_t>(columns) * rows; }
  std::span<const BinnedFace> faces_of(std::size_t tile) const {
    return std::span(faces).subspan(begin[tile], begin[tile + 1] - begin[tile]);
  }
};

/// Bins the faces that may be seen from their outer side. Faces from `first_eye_face` on belong to cells that
/// hold the eye: rays start inside, so these may be met anywhere, also behind the eye.
TileBins bin_faces(const FrameMesh& mesh, std::size_t face_count, std::size_t first_eye_face,
                   const scene::CameraFrame& frame);

/// Memory that a thread uses again from tile to tile.
struct TileScratch {
  std::vector<FaceHit> hits;
  std::vector<std::uint32_t> first;
  std::vector<ClipInterval> intervals;
  TileRays rays;
};

/// Fills `scratch.rays` with the rays of a tile that meet the mesh, neighbours in the picture close to each other.
void collect_rays(const Kernels& kernels, const FrameMesh& mesh, const scene::RayGrid& grid, const TileBins& bins,
                  std::size_t tile, std::size_t first_eye_face, bool is_orthographic, TileScratch& scratch);

}  // namespace tetravox::cpu
