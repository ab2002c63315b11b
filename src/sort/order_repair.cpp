#include "src/sort/order_repair.h"

#include "src/support/threads.h"

#include <algorithm>
#include <cstddef>

namespace tetravox::sort {
namespace {

constexpr std::size_t kGrain = 1 << 14;
constexpr std::size_t kLargestShare = 2;  // of the order, as a fraction: beyond it sorting anew is as fast

/// Places [begin, end) of the order.
struct Stretch {
  std::uint32_t begin = 0, end = 0;

  bool operator<(const Stretch& other) const { return begin < other.begin; }
};

void find_places(const std::vector<std::uint32_t>& order, std::vector<std::uint32_t>& places) {
  places.resize(order.size());
  support::parallel_chunks(order.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) places[order[i]] = static_cast<std::uint32_t>(i);
  });
}

/// What the relations that are not kept span, in no fixed order; relations across gaps are looked at in one go.
std::vector<Stretch> find_broken(const Relations& relations, const std::vector<std::uint32_t>& places) {
  const std::size_t count = relations.cell_count();
  std::vector<std::vector<Stretch>> parts((count + kGrain - 1) / kGrain);
  support::parallel_chunks(parts.size(), 1, [&](std::size_t part, std::size_t last) {
    for (; part < last; ++part)
      for (std::size_t cell = part * kGrain; cell < std::min(count, (part + 1) * kGrain); ++cell)
        for (std::size_t rank = 0; rank < 4; ++rank) {
          const std::uint32_t front = relations.mesh->cells[cell].neighbours[rank];
          if (relations.sides[cell][rank] != Side::kFront || front == kNoCell) continue;
          if (places[front] < places[cell]) parts[part].push_back({places[front], places[cell] + 1});
        }
  });
  std::vector<Stretch> broken;
  for (const auto& part : parts) broken.insert(broken.end(), part.begin(), part.end());
  for (const GapRelation& gap : relations.gaps)
    if (places[gap.front] < places[gap.behind]) broken.push_back({places[gap.front], places[gap.behind] + 1});
  return broken;
}

/// Stretches that overlap as one, ascending.
std::vector<Stretch> merge(std::vector<Stretch> stretches) {
  std::sort(stretches.begin(), stretches.end());
  std::vector<Stretch> merged;
  for (const Stretch& stretch : stretches) {
    if (merged.empty() || stretch.begin >= merged.back().end)
      merged.push_back(stretch);
    else
      merged.back().end = std::max(merged.back().end, stretch.end);
  }
  return merged;
}

/// Sorts the cells of a stretch by the relations among them, as `sort_by_counting` does all cells.
class StretchSort {
 public:
  StretchSort(const Relations& relations, const RepairBuffers& repair, TopologicalBuffers& buffers)
      : relations_(relations), places_(repair.places), buffers_(buffers) {
    buffers_.gap_waits.resize(relations.cell_count());
  }

  /// Appends to `sorted`; false where there is a cycle.
  bool sort(const std::vector<std::uint32_t>& order, const Stretch& stretch, std::vector<std::uint32_t>& sorted) {
    auto& waits = buffers_.gap_waits;
    for (std::uint32_t place = stretch.begin; place < stretch.end; ++place) waits[order[place]] = 0;
    for (std::uint32_t place = stretch.begin; place < stretch.end; ++place)
      for_each_front_within(order[place], stretch, [&](std::uint32_t front) { ++waits[front]; });
    const std::size_t first = sorted.size();
    for (std::uint32_t place = stretch.begin; place < stretch.end; ++place) {
      if (waits[order[place]] != 0) continue;
      buffers_.stack.assign(1, order[place]);
      while (!buffers_.stack.empty()) {
        const std::uint32_t cell = buffers_.stack.back();
        buffers_.stack.pop_back();
        waits[cell] = kDone;
        sorted.push_back(cell);
        for_each_front_within(cell, stretch, [&](std::uint32_t front) {
          if (--waits[front] == 0) buffers_.stack.push_back(front);
        });
      }
    }
    return sorted.size() - first == stretch.end - stretch.begin;
  }

 private:
  static constexpr std::uint32_t kDone = 0xFFFFFFFFu;

  template <class Visit>
  void for_each_front_within(std::uint32_t cell, const Stretch& stretch, const Visit& visit) const {
    relations_.for_each_front(cell, [&](std::uint32_t front) {
      if (places_[front] >= stretch.begin && places_[front] < stretch.end) visit(front);
    });
  }

  const Relations& relations_;
  const std::vector<std::uint32_t>& places_;
  TopologicalBuffers& buffers_;
};

}  // namespace

std::optional<std::uint64_t> repair_order(const Relations& relations, RepairBuffers& repair,
                                          TopologicalBuffers& buffers, std::vector<std::uint32_t>& order) {
  find_places(order, repair.places);
  const std::vector<Stretch> stretches = merge(find_broken(relations, repair.places));
  std::uint64_t cells = 0;
  for (const Stretch& stretch : stretches) cells += stretch.end - stretch.begin;
  if (cells > order.size() / kLargestShare) return std::nullopt;
  repair.sorted.clear();
  StretchSort sort(relations, repair, buffers);
  for (const Stretch& stretch : stretches)
    if (!sort.sort(order, stretch, repair.sorted)) return std::nullopt;
  auto next = repair.sorted.begin();
  for (const Stretch& stretch : stretches) {
    const std::ptrdiff_t length = stretch.end - stretch.begin;
    std::copy(next, next + length, order.begin() + stretch.begin);
    next += length;
  }
  return cells;
}

}  // namespace tetravox::sort
