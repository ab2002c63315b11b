#pragma once

/// The order in which the cells of a mesh can be composited one by one, for renderers that project cells.
///
///     VisibilitySorter sorter(mesh);
///     for (const std::uint32_t cell : sorter.sort(camera, {.method = SortMethod::kXmpvo})) blend(cell);
///
/// docs/methods/sorting.md says what each method costs, and where it errs.

#include "tetravox/camera.h"
#include "tetravox/mesh.h"
#include "tetravox/progress.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace tetravox {

enum class SortMethod {
  kCentroid,  ///< by the distance of centroids: fast, wrong now and then on every mesh
  kMpvo,      ///< by the faces that cells share (Williams 1992): exact for convex meshes
  kMpvonc,    ///< his heuristic for other meshes: starts from boundary faces, the farthest first
  kXmpvo      ///< exact for every mesh without cycles (after Silva, Mitchell, Williams 1998)
};

std::string name_of(SortMethod method);
/// @throws Error (kInvalidArgument), naming what there is.
SortMethod sort_method_from_name(const std::string& name);
/// Name and what it is, with the paper.
std::vector<std::pair<std::string, std::string>> sort_method_names();

enum class SortDirection { kBackToFront, kFrontToBack };

struct SortOptions {
  SortMethod method = SortMethod::kXmpvo;
  SortDirection direction = SortDirection::kBackToFront;
  bool use_last_order = true;  ///< begin with the last call's order where that is faster
  int threads = 0;             ///< 0: all cores
};

/// How much of the last order a call could use.
enum class OrderReuse {
  kNone,       ///< sorted anew
  kSameView,   ///< the eye (orthographic: the direction) is where it was: nothing was computed
  kSameSides,  ///< everything that the method looks at came out as before, so the order is the same
  kRepaired    ///< only stretches of the order were sorted anew (mpvo and xmpvo)
};

struct SortStatistics {
  double seconds = 0;           ///< of the whole call
  double relation_seconds = 0;  ///< of that: sides of faces, or keys of centroids
  double boundary_seconds = 0;  ///< of that: relations across gaps (xmpvo)
  std::uint64_t cells = 0;
  std::uint64_t boundary_relations = 0;  ///< pairs of cells ordered across gaps (xmpvo)
  /// Sets of cells that each hide one another in a circle (strongly connected), and the cells in them. Where the
  /// relations come from faces or gaps; 0 for centroid.
  std::uint64_t cycles = 0, cyclic_cells = 0;
  std::uint64_t broken_relations = 0;  ///< that the order does not keep, because of cycles
  OrderReuse reuse = OrderReuse::kNone;
  std::uint64_t sorted_cells = 0;  ///< that were sorted anew
  int threads = 0;
};

/// Sorts the cells of one mesh for one view after another; keeps what it needs for that.
///
/// The order depends only on where the eye is, or, for an orthographic camera, on the direction of its rays: turning or
/// zooming changes nothing. It holds in all directions round the eye, not only within the picture; the eye may be
/// inside the mesh. For the same mesh, view and options it is the same for any number of threads.
///
/// Views the mesh, which must live longer. Not for several threads at a time.
class VisibilitySorter {
 public:
  /// Recovers the vertices of all cells: 16 bytes a cell, and 12 to 24 more for buffers once it sorts.
  explicit VisibilitySorter(const PreparedMesh& mesh);
  ~VisibilitySorter();
  VisibilitySorter(VisibilitySorter&&) noexcept;
  VisibilitySorter& operator=(VisibilitySorter&&) noexcept;

  /// Every cell id of the mesh once, in visibility order, from the back to the front unless asked otherwise. Valid
  /// until the next call.
  ///
  /// Where cells hide one another in a circle there is no such order. Then the farthest cell of the circle, by its
  /// centroid, is put behind the others (mpvonc: the relation that closes the circle is left out); the statistics count
  /// what was broken.
  /// @throws Error: kInvalidArgument where the camera defines no view; kCancelled, and the next call sorts anew.
  std::span<const std::uint32_t> sort(const Camera& camera, const SortOptions& options = {},
                                      SortStatistics* statistics = nullptr, const Progress& progress = {});

  /// Bytes held, the mesh not counted.
  std::uint64_t bytes() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

struct OrderCheckOptions {
  SortDirection direction = SortDirection::kBackToFront;
  int width = 128, height = 128;  ///< rays, through the middles of pixels; 0: faces alone
  int threads = 0;
};

/// What a check of an order found.
struct OrderReport {
  bool is_permutation = false;  ///< every cell occurs once; where not, nothing else was checked

  /// Pairs of cells with a common face that the eye does not see edge-on, both thicker than vertices are rounded.
  std::uint64_t face_pairs = 0;
  std::uint64_t face_violations = 0;  ///< of these, in the wrong order

  std::uint64_t rays = 0;               ///< that meet a cell
  std::uint64_t segments = 0;           ///< cells met by rays
  std::uint64_t wrong_segments = 0;     ///< composited on the wrong side of a cell that lies in front of them
  std::uint64_t wrong_rays = 0;         ///< with such a segment
  std::uint64_t thin_segments = 0;      ///< left out: not longer than rounding, or along a face
  std::uint64_t intersections = 0;      ///< neighbours along a ray that overlap: cells that intersect, not compared
  std::uint64_t intersecting_rays = 0;  ///< with such neighbours
};

/// Checks an order by brute force: all pairs of cells that share a face, and along every ray all cells that it meets,
/// by depth. Independent of how the order was made: sides of faces come from the places of vertices alone, and cells
/// are met by looking at all of them. Shared with the sorters is where the eye is, and how a ray is cut with one cell.
/// @throws Error (kInvalidArgument): the camera defines no view, or a negative size.
OrderReport check_order(const PreparedMesh& mesh, const Camera& camera, std::span<const std::uint32_t> order,
                        const OrderCheckOptions& options = {});

}  // namespace tetravox
