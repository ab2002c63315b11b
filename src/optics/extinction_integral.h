#pragma once

/// The integral of the extinction over the scalar, in double precision: exact means between any two scalars.

#include "src/optics/antiderivative_table.h"
#include "tetravox/transfer_function.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace tetravox::optics {

/// Piecewise parabolas, one for each linear piece of the extinction. Stored scalars; safe to use from many threads.
///
/// The tables of the integrators hold the same (Max, Hanrahan, Crawfis 1990) in fixed point at equally spaced nodes,
/// as vector code wants it; this is for the few who ask one ray at a time, and is exact for steps and narrow peaks.
class ExtinctionIntegral {
 public:
  ExtinctionIntegral() = default;
  ExtinctionIntegral(const OpticalFunction& function, const ScalarMap& map);

  /// Per world length; at a step the limit from above. `scalar`: finite.
  double extinction(double scalar) const { return at(pieces_[find(scalar)], scalar); }

  /// What is known of a scalar: for those who ask for means of adjoining segments.
  struct Mark {
    double scalar = 0.0, integral = 0.0;  ///< the integral up to there
    std::size_t piece = 0;
  };
  Mark mark(double scalar) const {
    const std::size_t piece = find(scalar);
    return {scalar, integral(pieces_[piece], scalar), piece};
  }

  /// Mean extinction of a segment whose scalar runs linearly from `a` to `b`.
  double mean(const Mark& a, const Mark& b) const {
    if (a.piece == b.piece) return at(pieces_[a.piece], 0.5 * (a.scalar + b.scalar));
    const double difference = b.scalar - a.scalar;
    if (!(difference > kSmallestDifference || difference < -kSmallestDifference))
      return 0.5 * (at(pieces_[a.piece], a.scalar) + at(pieces_[b.piece], b.scalar));
    return (b.integral - a.integral) / difference;
  }
  double mean(double a, double b) const { return mean(mark(a), mark(b)); }

  std::uint64_t bytes() const { return pieces_.size() * sizeof(Piece) + first_pieces_.size() * sizeof(std::uint32_t); }

 private:
  /// Stored scalars lie in about [-2, 2]: what differs by less tells rounding, not integrals.
  static constexpr double kSmallestDifference = 1e-13;

  struct Piece {
    double begin = 0.0;  ///< the first one begins at -infinity, and has its `begin` at its end
    double extinction = 0.0, slope = 0.0, integral = 0.0;
  };

  static double at(const Piece& piece, double scalar) {
    return piece.extinction + piece.slope * (scalar - piece.begin);
  }
  static double integral(const Piece& piece, double scalar) {
    const double over = scalar - piece.begin;
    return piece.integral + over * (piece.extinction + 0.5 * piece.slope * over);
  }
  std::size_t find(double scalar) const {
    if (!(scalar >= first_)) return 0;
    if (scalar >= last_) return pieces_.size() - 1;
    std::size_t i = first_pieces_[static_cast<std::size_t>((scalar - first_) * buckets_per_scalar_)];
    while (scalar >= pieces_[i + 1].begin) ++i;
    return i;
  }

  std::vector<Piece> pieces_{Piece{}};
  std::vector<std::uint32_t> first_pieces_;  ///< of the lower end of each of equal parts from `first_` to `last_`
  double first_ = 0.0, last_ = 0.0, buckets_per_scalar_ = 0.0;
};

}  // namespace tetravox::optics
