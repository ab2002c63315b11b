#include "src/sort/cycles.h"

#include <algorithm>

namespace tetravox::sort {
namespace {

/// Depth-first search that keeps its own stack.
class ComponentSearch {
 public:
  ComponentSearch(const Relations& relations, std::span<const std::uint8_t> is_left)
      : relations_(relations), is_left_(is_left), number_(relations.cell_count(), 0), low_(relations.cell_count(), 0) {}

  CycleCount run() {
    for (std::uint32_t cell = 0; cell < relations_.cell_count(); ++cell)
      if (is_left_[cell] && number_[cell] == 0) search(cell);
    return std::move(found_);
  }

 private:
  struct Visit {
    std::uint32_t cell = 0;
    std::size_t first = 0, next = 0;  ///< successors not yet looked at: [next, end of successors_)
  };

  static constexpr std::uint32_t kClosed = 0xFFFFFFFFu;  // as a low number: the component is complete

  void enter(std::uint32_t cell) {
    number_[cell] = low_[cell] = ++last_number_;
    open_.push_back(cell);
    const std::size_t first = successors_.size();
    relations_.for_each_front(cell, [&](std::uint32_t front) {
      if (is_left_[front]) successors_.push_back(front);
    });
    visits_.push_back({cell, first, first});
  }

  void search(std::uint32_t root) {
    enter(root);
    while (!visits_.empty()) {
      Visit& visit = visits_.back();
      if (visit.next < successors_.size()) {
        const std::uint32_t front = successors_[visit.next++];
        if (number_[front] == 0)
          enter(front);
        else if (low_[front] != kClosed)
          low_[visit.cell] = std::min(low_[visit.cell], number_[front]);
        continue;
      }
      leave();
    }
  }

  void leave() {
    const Visit visit = visits_.back();
    visits_.pop_back();
    successors_.resize(visit.first);
    if (low_[visit.cell] == number_[visit.cell]) close(visit.cell);
    if (visits_.empty() || low_[visit.cell] == kClosed) return;
    std::uint32_t& low = low_[visits_.back().cell];
    low = std::min(low, low_[visit.cell]);
  }

  void close(std::uint32_t root) {
    const bool is_cycle = open_.back() != root;
    found_.cycles += is_cycle;
    std::uint32_t cell = kNoCell;
    while (cell != root) {
      cell = open_.back();
      open_.pop_back();
      low_[cell] = kClosed;
      if (is_cycle) found_.cells.push_back(cell);
    }
  }

  const Relations& relations_;
  std::span<const std::uint8_t> is_left_;
  std::vector<std::uint32_t> number_, low_, open_, successors_;
  std::vector<Visit> visits_;
  std::uint32_t last_number_ = 0;
  CycleCount found_;
};

}  // namespace

CycleCount find_cycles(const Relations& relations, std::span<const std::uint8_t> is_left) {
  return ComponentSearch(relations, is_left).run();
}

}  // namespace tetravox::sort
