#include "src/sort/relations.h"

#include <algorithm>

namespace tetravox::sort {

std::span<const GapRelation> Relations::gaps_behind(std::uint32_t cell) const {
  if (gaps.empty()) return {};
  const auto first = std::lower_bound(gaps.begin(), gaps.end(), GapRelation{cell, 0});
  auto last = first;
  while (last != gaps.end() && last->behind == cell) ++last;
  return {first, last};
}

}  // namespace tetravox::sort
