#include "src/sort/topological_order.h"

#include "src/sort/centroid_order.h"
#include "src/sort/cycles.h"
#include "src/support/threads.h"

#include <algorithm>

namespace tetravox::sort {
namespace {

/// States of a cell while cells are counted: how many it waits for, and two marks.
constexpr std::uint8_t kDone = 0x80;
constexpr std::uint8_t kHasGapsInFront = 0x40;
constexpr std::size_t kGrain = 1 << 14;

class CountingSort {
 public:
  CountingSort(const Relations& relations, const ViewPoint& view, TopologicalBuffers& buffers,
               std::vector<std::uint32_t>& order)
      : relations_(relations), view_(view), buffers_(buffers), order_(order) {}

  CycleReport run() {
    const auto cells = static_cast<std::uint32_t>(relations_.cell_count());
    order_.clear();
    order_.reserve(cells);
    count_waits();
    for (std::uint32_t cell = 0; cell < cells; ++cell)
      if ((buffers_.states[cell] & ~kHasGapsInFront) == 0) go_on_from(cell);
    CycleReport report;
    if (order_.size() < cells) break_cycles(report);
    return report;
  }

 private:
  void count_waits() {
    auto& states = buffers_.states;
    states.resize(relations_.cell_count());
    support::parallel_chunks(states.size(), kGrain, [&](std::size_t begin, std::size_t end) {
      for (std::size_t cell = begin; cell < end; ++cell) {
        unsigned waits = 0;
        relations_.for_each_neighbour_behind(static_cast<std::uint32_t>(cell), [&](std::uint32_t) { ++waits; });
        states[cell] = static_cast<std::uint8_t>(waits);
      }
    });
    // All that a cell waits for across gaps counts as one.
    if (relations_.gaps.empty()) return;
    buffers_.gap_waits.assign(relations_.cell_count(), 0);
    for (const GapRelation& gap : relations_.gaps) {
      states[gap.behind] |= kHasGapsInFront;
      states[gap.front] = static_cast<std::uint8_t>(states[gap.front] + (buffers_.gap_waits[gap.front]++ == 0));
    }
  }

  /// Appends a cell and everything that it sets free.
  void go_on_from(std::uint32_t cell) {
    auto& stack = buffers_.stack;
    stack.assign(1, cell);
    while (!stack.empty()) {
      const std::uint32_t next = stack.back();
      stack.pop_back();
      append(next);
    }
  }

  void append(std::uint32_t cell) {
    auto& states = buffers_.states;
    const bool has_gaps = states[cell] & kHasGapsInFront;
    states[cell] |= kDone;
    order_.push_back(cell);
    const auto release = [&](std::uint32_t front) {
      if ((--states[front] & ~kHasGapsInFront) == 0) buffers_.stack.push_back(front);
    };
    const CellSides sides = relations_.sides[cell];
    const auto& neighbours = relations_.mesh->cells[cell].neighbours;
    for (std::size_t rank = 0; rank < 4; ++rank)
      if (sides[rank] == Side::kFront && neighbours[rank] != kNoCell) release(neighbours[rank]);
    if (!has_gaps) return;
    for (const GapRelation& gap : relations_.gaps_behind(cell))
      if (--buffers_.gap_waits[gap.front] == 0) release(gap.front);
  }

  bool is_done(std::uint32_t cell) const { return buffers_.states[cell] & kDone; }
  double depth_of(std::uint32_t cell) const {
    return view_.depth_key(centroid_of(*relations_.mesh, relations_.cells[cell]));
  }

  void break_cycles(CycleReport& report) {
    std::vector<std::uint8_t> is_left(relations_.cell_count());
    for (std::uint32_t cell = 0; cell < relations_.cell_count(); ++cell) is_left[cell] = !is_done(cell);
    CycleCount found = find_cycles(relations_, is_left);
    report.cycles = found.cycles;
    report.cyclic_cells = found.cells.size();
    std::sort(found.cells.begin(), found.cells.end(), [this](std::uint32_t a, std::uint32_t b) {
      const double depth_a = depth_of(a), depth_b = depth_of(b);
      return depth_a != depth_b ? depth_a > depth_b : a < b;
    });
    make_gaps_in_front();
    steps_left_ = kStepsForEachCell * relations_.cell_count();
    on_path_.assign(relations_.cell_count(), 0);
    for (const std::uint32_t cell : found.cells)
      while (!is_done(cell)) {
        const std::uint32_t released = find_farthest_of_cycle(cell);
        report.broken_relations += count_waits_of(released);
        go_on_from(released);
      }
  }

  /// The farthest cell of a cycle that `start` waits for. When too many steps were made in all, of the path so far.
  std::uint32_t find_farthest_of_cycle(std::uint32_t start) {
    path_.clear();
    std::uint32_t cell = start;
    const std::size_t limit = path_limit();
    while (on_path_[cell] == 0 && path_.size() < limit) {
      path_.push_back(cell);
      on_path_[cell] = static_cast<std::uint32_t>(path_.size());
      cell = one_behind(cell);
    }
    steps_left_ -= std::min(steps_left_, path_.size());
    std::size_t best = on_path_[cell] != 0 ? on_path_[cell] - 1 : 0;
    for (std::size_t i = best + 1; i < path_.size(); ++i)
      if (depth_of(path_[i]) > depth_of(path_[best])) best = i;
    for (const std::uint32_t visited : path_) on_path_[visited] = 0;
    return path_[best];
  }

  std::size_t path_limit() const { return std::max<std::size_t>(steps_left_, kShortestPath); }

  /// A cell that `cell` still waits for.
  std::uint32_t one_behind(std::uint32_t cell) const {
    std::uint32_t found = kNoCell;
    relations_.for_each_neighbour_behind(cell, [&](std::uint32_t behind) {
      if (!is_done(behind)) found = behind;
    });
    if (found != kNoCell) return found;
    for_each_gap_behind(cell, [&](std::uint32_t behind) {
      if (!is_done(behind)) found = behind;
    });
    return found;
  }

  std::uint64_t count_waits_of(std::uint32_t cell) const {
    std::uint64_t count = 0;
    relations_.for_each_neighbour_behind(cell, [&](std::uint32_t behind) { count += !is_done(behind); });
    for_each_gap_behind(cell, [&](std::uint32_t behind) { count += !is_done(behind); });
    return count;
  }

  template <class Visit>
  void for_each_gap_behind(std::uint32_t front, const Visit& visit) const {
    // Here the pairs are turned round: `behind` holds the front one.
    for (auto gap = std::lower_bound(turned_gaps_.begin(), turned_gaps_.end(), GapRelation{front, 0});
         gap != turned_gaps_.end() && gap->behind == front; ++gap)
      visit(gap->front);
  }

  void make_gaps_in_front() {
    for (const GapRelation& gap : relations_.gaps) turned_gaps_.push_back({gap.front, gap.behind});
    std::sort(turned_gaps_.begin(), turned_gaps_.end());
  }

  static constexpr std::size_t kStepsForEachCell = 20, kShortestPath = 100;

  const Relations& relations_;
  const ViewPoint& view_;
  TopologicalBuffers& buffers_;
  std::vector<std::uint32_t>& order_;
  std::vector<GapRelation> turned_gaps_;
  std::vector<std::uint32_t> path_, on_path_;  ///< place on the path + 1
  std::size_t steps_left_ = 0;
};

/// States of a cell while going depth first.
constexpr std::uint8_t kNew = 0, kOnPath = 1, kInOrder = 2;

}  // namespace

CycleReport sort_by_counting(const Relations& relations, const ViewPoint& view, TopologicalBuffers& buffers,
                             std::vector<std::uint32_t>& order) {
  return CountingSort(relations, view, buffers, order).run();
}

CycleReport sort_depth_first(const Relations& relations, std::span<const std::uint32_t> roots,
                             TopologicalBuffers& buffers, std::vector<std::uint32_t>& order) {
  auto& states = buffers.states;
  auto& stack = buffers.stack;
  const auto cells = static_cast<std::uint32_t>(relations.cell_count());
  states.assign(cells, kNew);
  order.clear();
  order.reserve(cells);
  CycleReport report;
  // A cell on the stack is new until it is looked at; what it then pushes lies above it and is done before it.
  const auto visit = [&](std::uint32_t root) {
    stack.assign(1, root);
    while (!stack.empty()) {
      const std::uint32_t cell = stack.back();
      if (states[cell] == kNew) {
        states[cell] = kOnPath;
        relations.for_each_neighbour_behind(cell, [&](std::uint32_t behind) {
          if (states[behind] == kNew) stack.push_back(behind);
          report.broken_relations += states[behind] == kOnPath;
        });
        continue;
      }
      stack.pop_back();
      if (states[cell] == kInOrder) continue;
      states[cell] = kInOrder;
      order.push_back(cell);
    }
  };
  for (const std::uint32_t root : roots)
    if (states[root] == kNew) visit(root);
  for (std::uint32_t cell = 0; cell < cells; ++cell)
    if (states[cell] == kNew) visit(cell);
  if (report.broken_relations == 0) return report;
  const CycleCount found = find_cycles(relations, std::vector<std::uint8_t>(cells, 1));
  report.cycles = found.cycles;
  report.cyclic_cells = found.cells.size();
  return report;
}

}  // namespace tetravox::sort
