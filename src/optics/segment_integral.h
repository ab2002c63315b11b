#pragma once

/// Ray integrals of linear segments in double precision: exactly, or in steps. What tables are made from and measured
/// against.

#include "tetravox/transfer_function.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace tetravox::optics {

/// What a segment emits (premultiplied colour) and how opaque it is.
struct Slab {
  std::array<double, 3> color{};
  double opacity = 0.0;
};

/// `front` before `back`.
inline Slab composite(const Slab& front, const Slab& back) {
  const double through = 1.0 - front.opacity;
  return {{front.color[0] + through * back.color[0], front.color[1] + through * back.color[1],
           front.color[2] + through * back.color[2]},
          front.opacity + through * back.opacity};
}

/// rho, rho * red, rho * green, rho * blue, per world length.
using OpticalDensity = std::array<double, 4>;

/// A piece with these mean densities, taken as homogeneous.
Slab eval_homogeneous(const OpticalDensity& mean, double length);

/// A function over scalars s in [0, 1], which count `range` (values). Safe to use from many threads.
class SegmentIntegral {
 public:
  SegmentIntegral(const OpticalFunction& function, const ValueRange& range);

  /// At a step the limit from above.
  OpticalDensity density(double s) const { return density_in(pieces_[find(s)], s); }

  /// Mean over scalars between `a` and `b`: exact, whatever the function does in between.
  OpticalDensity mean(double a, double b) const;

  /// Over [0, 1].
  double largest_extinction() const { return largest_extinction_; }

  /// The segment whose scalar runs linearly from `a` to `b` over a world length: from control point to control point by
  /// Moreland and Angel's psi (2004), to about 1e-12.
  Slab integrate(double a, double b, double length) const;

  /// The same in equal steps, each homogeneous with its mean densities: the opacity is exact for any number.
  Slab integrate_in_steps(double a, double b, double length, int steps) const;

 private:
  /// Linear extinction and colour from `begin` on, and so quadratic densities; x = s - begin.
  struct Piece {
    double begin = 0.0;
    std::array<double, 4> rates{}, slopes{};        // rho, red, green, blue at `begin`, and for one unit of s
    OpticalDensity constant{}, linear{}, square{};  // density = constant + linear x + square x^2
    OpticalDensity integral{};                      // from 0 to `begin`
  };

  static std::array<double, 4> rates_in(const Piece& piece, double s);
  static OpticalDensity density_in(const Piece& piece, double s);
  static OpticalDensity integral_in(const Piece& piece, double s);
  std::size_t find(double s) const;
  void append(double begin, double end, const OpticalPoint& a, const OpticalPoint& b);
  void index_pieces();

  std::vector<Piece> pieces_;                // the first begins at 0, and holds before it; the last one, constant, at 1
  std::vector<std::uint32_t> first_pieces_;  // of the lower end of each of equal parts of [0, 1]
  double largest_extinction_ = 0.0;
};

}  // namespace tetravox::optics
