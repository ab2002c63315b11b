#pragma once

/// How cells of a mesh are projected (sources `project` and `vicp` of the OpenGL backend; docs/methods/opengl.md).

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace tetravox {

/// What puts cells, or what they leave in a pixel, in visibility order.
enum class CellSort {
  kCentroid,  ///< cells by the distance of centroids
  kMpvo,      ///< cells by shared faces (Williams 1992)
  kMpvonc,    ///< his heuristic for non-convex meshes
  kXmpvo,     ///< exact for every mesh without cycles (after Silva, Mitchell, Williams 1998)
  kExact      ///< the segments of each pixel by their depth, on the device: right for cyclic meshes, too
};

/// Where tetrahedra become triangles.
enum class Decomposition {
  kCpu,  ///< threads
  kGpu   ///< a compute shader
};

/// What of the mesh is sent to the device for a frame: of `vicp`, and of `project` where pixels or cells at the eye ask
/// for the cells themselves.
enum class MeshTransfer {
  kOrder,  ///< the order of cells alone, the mesh stays in graphics memory (VICP-GPU of Espinha and Celes 2005)
  kCells   ///< vertices and cells, in order (Weiler, Kraus, Merz, Ertl 2003)
};

struct ProjectionSettings {
  CellSort sort = CellSort::kXmpvo;
  Decomposition decomposition = Decomposition::kCpu;  ///< `project`
  /// `project`: pixels take their segments from the cell itself, by the products of ray casting, instead of from what
  /// its triangles carry; pictures are exact then, and a cell is one or two triangles.
  bool use_pixel_correction = true;
  MeshTransfer transfer = MeshTransfer::kOrder;

  bool operator==(const ProjectionSettings&) const = default;
};

/// What a frame of projected cells cost, and how well its order holds.
struct ProjectionStatistics {
  // Of the frame's seconds. What is left: the camera's vertices, tables, reading the picture back, and sending cells
  // that pixels look up.
  double sort_seconds = 0.0;  ///< 0 for `exact`, whose sorting is part of the drawing
  /// `project`: what the CPU makes of the cells, and sending it; with `Decomposition::kGpu` until the device is told to
  /// make triangles. 0 for `vicp`.
  double decompose_seconds = 0.0;
  double draw_seconds = 0.0;  ///< from an empty picture until the device has drawn the last segment
  std::uint64_t cells = 0;    ///< `project`: that may be in the picture; `vicp`: all
  /// `project`: of these, that reach behind the eye or far beyond the picture, and so are drawn as `vicp` draws all.
  std::uint64_t cells_at_eye = 0;
  std::uint64_t cycles = 0;  ///< sets of cells that hide one another in a circle; see SortStatistics
  std::uint64_t cyclic_cells = 0, broken_relations = 0;
};

/// Names as on the command line and in scene files: "centroid", "mpvo", "mpvonc", "xmpvo", "exact"; "cpu", "gpu";
/// "order", "cells".
std::string name_of(CellSort sort);
std::string name_of(Decomposition decomposition);
std::string name_of(MeshTransfer transfer);
/// @throws Error (kInvalidArgument) that lists the names there are.
CellSort cell_sort_from_name(const std::string& name);
Decomposition decomposition_from_name(const std::string& name);
MeshTransfer mesh_transfer_from_name(const std::string& name);
/// Names, one-line descriptions with the paper.
std::vector<std::pair<std::string, std::string>> cell_sort_names();
std::vector<std::pair<std::string, std::string>> decomposition_names();
std::vector<std::pair<std::string, std::string>> mesh_transfer_names();

}  // namespace tetravox
