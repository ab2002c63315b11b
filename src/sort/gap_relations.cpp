#include "src/sort/gap_relations.h"

#include "src/sort/gap_test.h"
#include "src/support/threads.h"

#include <tbb/parallel_sort.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>

namespace tetravox::sort {
namespace {

constexpr std::size_t kFewPairs = 64;  // that are compared without dividing further
constexpr int kSharedLevels = 3;       // after which parts of the picture are given to threads
constexpr int kMostLevels = 18;
constexpr std::size_t kGapsPerChunk = 1 << 10;
constexpr double kDepthSlack = 1e-6;  // more than faces of a seam may lie apart

/// A part of the picture with the faces that may be in it.
struct Part {
  Point2 lower, upper;  ///< half open
  std::vector<std::uint32_t> exits, entries;
};

bool meets(const PicturePolygon& polygon, const Point2& lower, const Point2& upper) {
  return polygon.lower.x <= upper.x && polygon.upper.x >= lower.x && polygon.lower.y <= upper.y &&
         polygon.upper.y >= lower.y;
}

/// Finds the pairs in a part of the picture.
class PairSearch {
 public:
  PairSearch(const PreparedMesh& mesh, const BoundaryPicture& picture, const GapTest& test, const Progress& progress,
             std::vector<GapRelation>& found)
      : mesh_(mesh), picture_(picture), test_(test), progress_(progress), found_(found) {}

  void search(Part& part, int level) {
    support::throw_if_cancelled(progress_);
    if (!drop_ordered(part)) return;
    const std::size_t pairs = part.exits.size() * part.entries.size();
    if (pairs <= kFewPairs || level >= kMostLevels) {
      compare(part);
      return;
    }
    // Where most faces are larger than the quarters, dividing only repeats them.
    std::array<Part, 4> quarters;
    std::size_t pairs_of_quarters = 0;
    for (int i = 0; i < 4; ++i) {
      quarters[i] = divide(part, i);
      pairs_of_quarters += quarters[i].exits.size() * quarters[i].entries.size();
    }
    if (pairs_of_quarters >= pairs) {
      compare(part);
      return;
    }
    for (Part& quarter : quarters) search(quarter, level + 1);
  }

  /// Leaves out exits behind all entries, and entries before all exits; false where nothing is left.
  bool drop_ordered(Part& part) const {
    double farthest = std::numeric_limits<double>::lowest(), nearest = std::numeric_limits<double>::max();
    for (const std::uint32_t i : part.entries) farthest = std::max(farthest, picture_.entries[i].farthest);
    std::erase_if(part.exits, [&](std::uint32_t i) { return picture_.exits[i].nearest > farthest + kDepthSlack; });
    for (const std::uint32_t i : part.exits) nearest = std::min(nearest, picture_.exits[i].nearest);
    std::erase_if(part.entries, [&](std::uint32_t i) { return picture_.entries[i].farthest + kDepthSlack < nearest; });
    return !part.exits.empty() && !part.entries.empty();
  }

  Part divide(const Part& part, int quarter) const {
    const Point2 middle{0.5 * (part.lower.x + part.upper.x), 0.5 * (part.lower.y + part.upper.y)};
    Part child;
    child.lower = {quarter & 1 ? middle.x : part.lower.x, quarter & 2 ? middle.y : part.lower.y};
    child.upper = {quarter & 1 ? part.upper.x : middle.x, quarter & 2 ? part.upper.y : middle.y};
    const auto collect = [&](const std::vector<std::uint32_t>& from, const std::vector<PicturePolygon>& polygons,
                             std::vector<std::uint32_t>& to) {
      for (const std::uint32_t i : from)
        if (meets(polygons[i], child.lower, child.upper)) to.push_back(i);
    };
    collect(part.exits, picture_.exits, child.exits);
    collect(part.entries, picture_.entries, child.entries);
    return child;
  }

 private:
  void compare(const Part& part) {
    for (const std::uint32_t i : part.exits)
      for (const std::uint32_t k : part.entries) {
        const PicturePolygon& exit = picture_.exits[i];
        const PicturePolygon& entry = picture_.entries[k];
        // A pair belongs to the part that holds the lower corner of what their boxes share.
        const double x = std::max(exit.lower.x, entry.lower.x), y = std::max(exit.lower.y, entry.lower.y);
        if (x < part.lower.x || x >= part.upper.x || y < part.lower.y || y >= part.upper.y) continue;
        if (test_.is_gap(exit, entry))
          found_.push_back({mesh_.boundary[entry.face].cell, mesh_.boundary[exit.face].cell});
      }
  }

  const PreparedMesh& mesh_;
  const BoundaryPicture& picture_;
  const GapTest& test_;
  const Progress& progress_;
  std::vector<GapRelation>& found_;
};

Part whole_picture(const BoundaryPicture& picture) {
  Part part;
  double extent = 0.0;
  const auto collect = [&extent](const std::vector<PicturePolygon>& polygons, std::vector<std::uint32_t>& indices) {
    for (std::uint32_t i = 0; i < polygons.size(); ++i) {
      indices.push_back(i);
      for (const Point2& p : {polygons[i].lower, polygons[i].upper})
        extent = std::max({extent, std::abs(p.x), std::abs(p.y)});
    }
  };
  collect(picture.exits, part.exits);
  collect(picture.entries, part.entries);
  extent *= 1.0 + 1e-9;
  part.lower = {-extent, -extent};
  part.upper = {extent, extent};
  return part;
}

void search_picture(const PreparedMesh& mesh, std::span<const SortedCell> cells, const BoundaryPicture& picture,
                    const Progress& progress, std::vector<GapRelation>& relations) {
  const GapTest test(mesh, cells, picture);
  std::vector<Part> parts;
  parts.push_back(whole_picture(picture));
  for (int level = 0; level < kSharedLevels; ++level) {
    PairSearch search(mesh, picture, test, progress, relations);
    std::vector<Part> next;
    for (Part& part : parts)
      if (search.drop_ordered(part))
        for (int quarter = 0; quarter < 4; ++quarter) next.push_back(search.divide(part, quarter));
    parts.swap(next);
  }
  std::vector<std::vector<GapRelation>> found(parts.size());
  support::parallel_chunks(parts.size(), 1, [&](std::size_t i, std::size_t last) {
    for (; i < last; ++i) PairSearch(mesh, picture, test, progress, found[i]).search(parts[i], kSharedLevels);
  });
  for (const auto& part : found) relations.insert(relations.end(), part.begin(), part.end());
}

/// Two convex cells that do not intersect lie on two sides of a plane, so that only one of them can hide the other.
/// Where both seem to, across two gaps or across a gap and a face, they intersect, and gaps say nothing about them.
void remove_contradictions(const PreparedMesh& mesh, std::span<const SortedCell> cells,
                           std::span<const CellSides> sides, std::vector<GapRelation>& gaps) {
  const Relations relations{&mesh, cells, sides, gaps};
  std::vector<std::uint8_t> is_contradicted(gaps.size(), 0);
  support::parallel_chunks(gaps.size(), kGapsPerChunk, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      relations.for_each_front(gaps[i].front,
                               [&](std::uint32_t front) { is_contradicted[i] |= front == gaps[i].behind; });
  });
  std::size_t kept = 0;
  for (std::size_t i = 0; i < gaps.size(); ++i)
    if (!is_contradicted[i]) gaps[kept++] = gaps[i];
  gaps.resize(kept);
}

}  // namespace

std::vector<GapRelation> find_gap_relations(const PreparedMesh& mesh, std::span<const SortedCell> cells,
                                            std::span<const CellSides> sides, const ViewPoint& view, double radius,
                                            const Progress& progress) {
  std::vector<GapRelation> relations;
  for (const PicturePlane& plane : choose_planes(view, radius)) {
    const BoundaryPicture picture = project_boundary(mesh, cells, sides, plane);
    search_picture(mesh, cells, picture, progress, relations);
  }
  tbb::parallel_sort(relations.begin(), relations.end());
  relations.erase(std::unique(relations.begin(), relations.end()), relations.end());
  remove_contradictions(mesh, cells, sides, relations);
  return relations;
}

}  // namespace tetravox::sort
