#include "src/optics/extinction_integral.h"

namespace tetravox::optics {

ExtinctionIntegral::ExtinctionIntegral(const OpticalFunction& function, const ScalarMap& map) {
  const auto& points = function.points;
  const auto stored = [&](std::size_t i) { return static_cast<double>(map.stored_from_value(points[i].value)); };
  first_ = stored(0);
  last_ = stored(points.size() - 1);
  pieces_ = {{first_, points.front().extinction, 0.0, 0.0}};
  double sum = 0.0;
  for (std::size_t i = 0; i + 1 < points.size(); ++i) {
    const double begin = stored(i), width = stored(i + 1) - begin;
    if (!(width > 0.0)) continue;
    pieces_.push_back({begin, points[i].extinction, (points[i + 1].extinction - points[i].extinction) / width, sum});
    sum += 0.5 * width * (points[i].extinction + points[i + 1].extinction);
  }
  pieces_.push_back({last_, points.back().extinction, 0.0, sum});

  // About four parts a piece, so that the search from a part's first piece is short.
  const std::size_t buckets = 4 * pieces_.size();
  buckets_per_scalar_ = last_ > first_ ? static_cast<double>(buckets) / (last_ - first_) : 0.0;
  std::uint32_t piece = 1;
  for (std::size_t bucket = 0; bucket <= buckets; ++bucket) {
    // A hair below the part's lower end: rounding must not begin a search behind its scalar.
    const double lower =
        first_ + (static_cast<double>(bucket) - 1e-6) / static_cast<double>(buckets) * (last_ - first_);
    while (piece + 2 < pieces_.size() && pieces_[piece + 1].begin <= lower) ++piece;
    first_pieces_.push_back(piece);
  }
}

}  // namespace tetravox::optics
