#include "src/optics/pair_integrals.h"

#include "src/support/threads.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace tetravox::optics {
namespace {

/// The diagonals on which the scalars of a segment differ by `difference` intervals, rising and falling, for all
/// lengths.
///
/// Segments of a length on a diagonal consist of the same intervals, each as long as the others. A window of intervals
/// is what is left of the block that it begins in, and the beginning of the next one (van Herk 1992; Gil and Werman
/// 1993): two composites a segment, however many intervals it has.
class Diagonal {
 public:
  Diagonal(const SegmentIntegral& function, const PairLattice& lattice, int difference)
      : function_(function),
        lattice_(lattice),
        difference_(difference),
        intervals_(lattice.scalars - 1),
        lengths_(lattice.lengths.size()),
        parts_((lattice.steps + difference - 1) / difference) {
    const std::size_t size = static_cast<std::size_t>(intervals_) * lengths_;
    rising_.resize(size);
    falling_.resize(size);
  }

  void store_all(const StorePair& store) {
    for (int i = 0; i < intervals_; ++i) fill_interval(i);
    fill_blocks();
    std::vector<Slab> found(lengths_);
    for (int i = 0; i + difference_ <= intervals_; ++i) {
      const int end = i + difference_;
      const bool is_block = i % difference_ == 0;
      for (std::size_t k = 0; k < lengths_; ++k)
        found[k] = is_block ? rising_to_[at(i, k)] : composite(rising_to_[at(i, k)], rising_from_[at(end, k)]);
      store(i, end, found);
      for (std::size_t k = 0; k < lengths_; ++k)
        found[k] = is_block ? falling_to_[at(i, k)] : composite(falling_from_[at(end, k)], falling_to_[at(i, k)]);
      store(end, i, found);
    }
  }

 private:
  std::size_t at(int interval, std::size_t k) const { return static_cast<std::size_t>(interval) * lengths_ + k; }

  /// One interval between neighbouring scalars, in as many steps as its segments need.
  void fill_interval(int interval) {
    means_.resize(static_cast<std::size_t>(parts_));
    const double width = 1.0 / intervals_;
    for (int part = 0; part < parts_; ++part) {
      const auto place = [&](int p) { return (interval + static_cast<double>(p) / parts_) * width; };
      means_[static_cast<std::size_t>(part)] = function_.mean(place(part), place(part + 1));
    }
    for (std::size_t k = 0; k < lengths_; ++k) {
      const double length = lattice_.lengths[k] / (static_cast<double>(difference_) * parts_);
      Slab rising, falling;
      for (const OpticalDensity& mean : means_) {
        const Slab step = eval_homogeneous(mean, length);
        rising = composite(rising, step);
        falling = composite(step, falling);
      }
      rising_[at(interval, k)] = rising;
      falling_[at(interval, k)] = falling;
    }
  }

  /// From each border of a block to everywhere in the block.
  void fill_blocks() {
    rising_to_ = rising_;  // from the interval to the block's end
    falling_to_ = falling_;
    rising_from_.assign(rising_.size() + lengths_, {});  // from the block's begin to before the interval
    falling_from_.assign(rising_.size() + lengths_, {});
    for (int i = intervals_ - 2; i >= 0; --i) {
      if ((i + 1) % difference_ == 0) continue;
      for (std::size_t k = 0; k < lengths_; ++k) {
        rising_to_[at(i, k)] = composite(rising_[at(i, k)], rising_to_[at(i + 1, k)]);
        falling_to_[at(i, k)] = composite(falling_to_[at(i + 1, k)], falling_[at(i, k)]);
      }
    }
    for (int i = 1; i <= intervals_; ++i) {
      const bool is_first = (i - 1) % difference_ == 0;
      for (std::size_t k = 0; k < lengths_; ++k) {
        const Slab &rising = rising_[at(i - 1, k)], &falling = falling_[at(i - 1, k)];
        rising_from_[at(i, k)] = is_first ? rising : composite(rising_from_[at(i - 1, k)], rising);
        falling_from_[at(i, k)] = is_first ? falling : composite(falling, falling_from_[at(i - 1, k)]);
      }
    }
  }

  const SegmentIntegral& function_;
  const PairLattice& lattice_;
  int difference_, intervals_;
  std::size_t lengths_;
  int parts_;                                                                                 // steps of an interval
  std::vector<OpticalDensity> means_;                                                         // of one interval
  std::vector<Slab> rising_, falling_, rising_to_, falling_to_, rising_from_, falling_from_;  // [intervals][lengths]
};

void store_level_pair(const SegmentIntegral& function, const PairLattice& lattice, int scalar, const StorePair& store) {
  const OpticalDensity density = function.density(static_cast<double>(scalar) / (lattice.scalars - 1));
  std::vector<Slab> found;
  for (const double length : lattice.lengths) found.push_back(eval_homogeneous(density, length));
  store(scalar, scalar, found);
}

}  // namespace

void TableProgress::next() {
  if (!progress_) return;
  support::throw_if_cancelled(*progress_);
  const std::size_t done = ++done_;
  if (!progress_->report || busy_.test_and_set()) return;
  progress_->report("integrate", static_cast<double>(done) / static_cast<double>(count_));
  busy_.clear();
}

void integrate_pairs_anew(const SegmentIntegral& function, const PairLattice& lattice, const StorePair& store) {
  const double last = lattice.scalars - 1;
  TableProgress progress(lattice.progress, static_cast<std::size_t>(lattice.scalars));
  support::parallel_chunks(static_cast<std::size_t>(lattice.scalars), 1, [&](std::size_t begin, std::size_t end) {
    std::vector<Slab> found(lattice.lengths.size());
    for (int back = static_cast<int>(begin); back < static_cast<int>(end); ++back) {
      progress.next();
      for (int front = 0; front < lattice.scalars; ++front) {
        for (std::size_t k = 0; k < found.size(); ++k)
          found[k] = function.integrate_in_steps(front / last, back / last, lattice.lengths[k], lattice.steps);
        store(front, back, found);
      }
    }
  });
}

void integrate_pairs_incrementally(const SegmentIntegral& function, const PairLattice& lattice,
                                   const StorePair& store) {
  TableProgress progress(lattice.progress, static_cast<std::size_t>(lattice.scalars));
  support::parallel_chunks(static_cast<std::size_t>(lattice.scalars), 1, [&](std::size_t begin, std::size_t end) {
    for (int difference = static_cast<int>(begin); difference < static_cast<int>(end); ++difference) {
      progress.next();
      if (difference > 0)
        Diagonal(function, lattice, difference).store_all(store);
      else
        for (int scalar = 0; scalar < lattice.scalars; ++scalar) store_level_pair(function, lattice, scalar, store);
    }
  });
}

void integrate_pairs(const SegmentIntegral& function, const PairLattice& lattice, bool use_incremental,
                     const StorePair& store) {
  if (use_incremental)
    integrate_pairs_incrementally(function, lattice, store);
  else
    integrate_pairs_anew(function, lattice, store);
}

float store_in_bits(double value, int bits) {
  if (bits >= 32) return static_cast<float>(value);
  const double steps = std::ldexp(1.0, bits) - 1.0;
  return static_cast<float>(std::round(std::clamp(value, 0.0, 1.0) * steps) / steps);
}

}  // namespace tetravox::optics
