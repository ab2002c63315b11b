#pragma once

/// Separable opacity, and chromaticity as a polynomial of the length (Guthe, Roettger, Schieber, Strasser, Ertl 2002).
///
/// The optical depth of a segment is its mean extinction times its length; mean extinctions need two dimensions only.
/// Chromaticity, colour / opacity, depends on the length smoothly: a polynomial in t = min(length / longest, 1), whose
/// coefficients need two dimensions again.
///
/// How we differ: the look-up of the opacity holds (1 - exp(-x)) / x, so that thin segments keep their digits; and the
/// polynomial has the exact value at t = 0, where most segments are, and is fitted to the others by least squares.

#include "src/optics/segment_domain.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace tetravox::optics {

/// Entry (i, j) of a map is at s_front = i / (scalars - 1), s_back = j / (scalars - 1); bilinear in between.
struct PolynomialTable {
  SegmentDomain domain;
  int scalars = 0, degree = 0;
  OpacityModel opacity = OpacityModel::kExponential;
  /// [degree + 1][scalars back][scalars front][4]: red, green, blue of the coefficient of t^map; the fourth number is
  /// the mean extinction (per world length) in map 0, and 0 in the others. As textures: x front, y back.
  std::vector<float> maps;
  static constexpr int kDepths = 1024;      ///< entries of `absorbed_ratios`
  static constexpr float kDeepest = 12.0f;  ///< optical depth of the last one; beyond it the opacity is 1
  std::vector<float> absorbed_ratios;       ///< [kDepths]: (1 - exp(-x)) / x at x = i kDeepest / (kDepths - 1), linear
                                            ///< in between; of 16 bits where `bits` is less than 32

  std::uint64_t bytes() const { return (maps.size() + absorbed_ratios.size()) * sizeof(float); }
};

/// Bytes of a table of that size.
std::uint64_t polynomial_table_bytes(int scalars, int degree);

/// Makes `table` anew, on all cores. See `build_preintegration_table` for `steps` and `use_incremental`.
/// @throws Error (kOutOfMemory) where it does not fit into memory.
void build_polynomial_table(const PreintegrationSource& source, const PreintegrationSettings& settings,
                            PolynomialTable& table);

/// How the coefficients above 0 come from chromaticities: at lengths whose parts of the longest are `places`, denser
/// where short, by least squares; the polynomial's value at length 0 is exact.
struct PolynomialFit {
  std::vector<double> places;                ///< [2 degree + 1], none for degree 0
  std::vector<std::vector<double>> weights;  ///< [degree][places]: row i for the coefficient of t^(i + 1)
};
PolynomialFit make_polynomial_fit(int degree);

/// See `PolynomialTable::absorbed_ratios`; `bits`: of the table's numbers.
std::vector<float> make_absorbed_ratios(int bits);

/// Rounds maps to what so many bits hold: coefficients between the least and the largest of their map, extinctions
/// between 0 and the largest. Leaves them alone for 32. `maps`: [maps][scalars][scalars][4].
void store_maps_in_bits(int bits, double largest_extinction, int scalars, std::span<float> maps);

/// The look-up of `polynomial`: with x = mean extinction * min(length, longest), the opacity is x * ratio(x) (linear:
/// min(1, x)), and each channel is clamp(polynomial(t), 0, 1) * opacity, by Horner's rule from coefficients that are
/// interpolated first. Stored scalars, world length.
SegmentColor eval_polynomial_table(const PolynomialTable& table, float scalar_front, float scalar_back, float length);

}  // namespace tetravox::optics
