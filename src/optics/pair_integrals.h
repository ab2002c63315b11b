#pragma once

/// The integrals of all segments between scalars at equal distances, of some lengths: how tables are filled.

#include "src/optics/segment_integral.h"
#include "tetravox/progress.h"

#include <atomic>
#include <cstddef>
#include <functional>
#include <span>

namespace tetravox::optics {

struct PairLattice {
  int scalars = 2;                  ///< s = 0 ... 1
  std::span<const double> lengths;  ///< world lengths
  int steps = 64;                   ///< of each segment, at least
  const Progress* progress = nullptr;
};

/// Says how much of a table is made, and stops where it is told to. Safe to call from many threads.
class TableProgress {
 public:
  TableProgress(const Progress* progress, std::size_t count) : progress_(progress), count_(count) {}

  /// A part is about to be made, and another one is done. @throws Error (kCancelled).
  void next();

 private:
  const Progress* progress_;
  std::size_t count_;
  std::atomic<std::size_t> done_{0};
  std::atomic_flag busy_;
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
