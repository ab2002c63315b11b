#pragma once

/// Relations between cells across gaps: outside the mesh, in holes, between its parts.

#include "src/sort/relations.h"
#include "src/sort/view_point.h"
#include "tetravox/progress.h"

#include <span>
#include <vector>

namespace tetravox::sort {

/// All pairs of cells such that a ray leaves the mesh through a boundary face of the one and later enters it through
/// one of the other, ascending, without repetitions. In parallel; the same for any number of threads.
///
/// Pairs with further cells in between are included: they are true too, follow from the others, and cost less than to
/// tell them apart. Silva, Mitchell and Williams (1998) sweep a plane through space and find the pairs that see each
/// other; we divide the picture into quarters until few faces are left in each, or until all exits in it lie behind all
/// entries, and compare what is left pair by pair (in the way of Warnock 1969). There is no order of events to keep,
/// so rounding, faces that touch, and faces that lie in one another cannot upset it. @throws Error (kCancelled).
std::vector<GapRelation> find_gap_relations(const PreparedMesh& mesh, std::span<const SortedCell> cells,
                                            std::span<const CellSides> sides, const ViewPoint& view, double radius,
                                            const Progress& progress = {});

}  // namespace tetravox::sort
