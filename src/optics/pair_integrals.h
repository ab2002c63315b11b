#pragma once

/// The integrals of all segments between scalars at equal distances, of some lengths: how tables are filled.

#include "src/optics/segment_integral.h"

#include <functional>
#include <span>

namespace tetravox::optics {

struct PairLattice {
  int scalars = 2;                  ///< s = 0 ... 1
  std::span<const double> lengths;  ///< world lengths
  int steps = 64;                   ///< of each segment, at least
};

/// Takes the integrals of the segments between two scalars: one for each length.
using StorePair = std::function<void(int front, int back, std::span<const Slab> by_length)>;

/// Calls `store` once for every pair, from many threads at a time: each segment in `steps` steps.
void integrate_pairs_anew(const SegmentIntegral& function, const PairLattice& lattice, const StorePair& store);

/// The same incrementally; see `build_preintegration_table`.
void integrate_pairs_incrementally(const SegmentIntegral& function, const PairLattice& lattice, const StorePair& store);

/// Either.
void integrate_pairs(const SegmentIntegral& function, const PairLattice& lattice, bool use_incremental,
                     const StorePair& store);

/// `value` as so many bits of fixed point hold it, which is cut to [0, 1]; as it is for 32.
float store_in_bits(double value, int bits);

}  // namespace tetravox::optics
