#pragma once

/// Whether a ray leaves the mesh through one boundary face and later enters it through another.

#include "src/sort/boundary_picture.h"

namespace tetravox::sort {

/// Of one view, in one plane. Safe from many threads.
class GapTest {
 public:
  GapTest(const PreparedMesh& mesh, std::span<const SortedCell> cells, const BoundaryPicture& picture)
      : mesh_(mesh), cells_(cells), picture_(picture) {}

  /// Whether the two overlap in the picture and the exit is not behind the entry there. Faces that lie in one another,
  /// as at a seam whose points are doubled, count; also where rounding has pushed one a little through the other, as
  /// long as the cells do follow each other along a ray.
  bool is_gap(const PicturePolygon& exit, const PicturePolygon& entry) const;

 private:
  bool decide_by_depth(const PicturePolygon& exit, const PicturePolygon& entry) const;
  bool decide_by_cells(const PicturePolygon& exit, const PicturePolygon& entry) const;

  const PreparedMesh& mesh_;
  std::span<const SortedCell> cells_;
  const BoundaryPicture& picture_;
};

}  // namespace tetravox::sort
