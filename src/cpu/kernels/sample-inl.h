// Grids at a fixed rate, and pre-classified: for comparison with the source `march` at its best.

#if defined(TETRAVOX_CPU_SAMPLE_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef TETRAVOX_CPU_SAMPLE_INL
#undef TETRAVOX_CPU_SAMPLE_INL
#else
#define TETRAVOX_CPU_SAMPLE_INL
#endif

#include "src/cpu/kernels/march-inl.h"

HWY_BEFORE_NAMESPACE();
namespace tetravox::cpu {
namespace HWY_NAMESPACE {

/// Densities at the eight corners of the cells that a vector of rays is in.
class DensityCorners {
 public:
  HWY_INLINE DensityCorners(const MarchBrick& brick, Int node) {
    const std::int32_t row = brick.cells[0] + 1, slice = row * (brick.cells[1] + 1);
    const std::int32_t offsets[8] = {0, 1, row, row + 1, slice, slice + 1, slice + row, slice + row + 1};
    for (int i = 0; i < 8; ++i)
      corners_[i] = load_table_records(brick.densities, hn::BitCast(kUint, hn::Add(node, hn::Set(kInt, offsets[i]))));
  }

  /// The densities at a depth, trilinear.
  HWY_INLINE Record eval(const LatticeRays& rays, Float depth) const {
    const Float x = rays.place(0, depth), y = rays.place(1, depth), z = rays.place(2, depth);
    const auto channel = [&](Float Record::*c) {
      const auto edge = [&](int i) { return mix(x, corners_[i].*c, corners_[i + 1].*c); };
      return mix(z, mix(y, edge(0), edge(2)), mix(y, edge(4), edge(6)));
    };
    return {channel(&Record::x), channel(&Record::y), channel(&Record::z), channel(&Record::w)};
  }

  /// Where a corner is missing, of some others or 0.
  HWY_INLINE Float largest_extinction() const {
    Float largest = corners_[0].x;
    for (int i = 1; i < 8; ++i) largest = hn::Max(largest, corners_[i].x);
    return hn::IfThenElseZero(hn::Eq(largest, largest), largest);
  }

 private:
  Record corners_[8];
};

/// Optical depth of a piece of a pre-classified cell, and how many pieces there are at most.
constexpr float kThinDensity = 0.05f, kMostDensityPieces = 64.0f;

/// Adds a piece with the mean densities `mean`.
HWY_INLINE void composite_densities(const Record& mean, Float length, Accumulated& sum) {
  const Mask valid = hn::Eq(mean.x, mean.x);  // a cell with a corner that is missing is transparent
  const auto over_length = [&](Float density) { return hn::IfThenElseZero(valid, hn::Mul(density, length)); };
  // Kernels with negative lobes may overshoot what is possible.
  const Float depth = hn::Max(over_length(mean.x), constant(0.0f));
  const auto inside = [&](Float density) { return hn::Min(hn::Max(over_length(density), constant(0.0f)), depth); };
  const Float emission[3] = {inside(mean.y), inside(mean.z), inside(mean.w)};
  composite_piece(depth, emission, absorbed_ratio(depth), sum);
}

/// Pre-classification: densities are interpolated instead of the scalar. Along a ray in a cell they are cubics, whose
/// mean Simpson's rule gives exactly.
inline std::uint64_t march_densities(const MarchJob& job, int count) {
  const MarchBrick& brick = *job.brick;
  std::uint64_t segments = 0;
  for (int first = 0; first < count; first += static_cast<int>(kLanes)) {
    const int lanes = std::min(count - first, static_cast<int>(kLanes));
    LatticeRays rays(*job.rays, brick, first, lanes, 1);
    Accumulated sum = load_accumulated(*job.rays, first);
    while (!hn::AllFalse(kFloat, rays.alive)) {
      segments += hn::CountTrue(kFloat, rays.alive);
      const DensityCorners corners(brick, rays.cell);
      const Float back = rays.back();
      const Float depth = hn::IfThenElseZero(rays.alive, hn::Sub(back, rays.front));
      // Pieces so thin that they hardly attenuate themselves.
      const Float cell_depth = hn::Mul(hn::Mul(depth, rays.world_per_z), corners.largest_extinction());
      const Float wanted = hn::Ceil(hn::Mul(cell_depth, constant(1.0f / kThinDensity)));
      const Float pieces = hn::Min(hn::Max(wanted, constant(1.0f)), constant(kMostDensityPieces));
      const Float share = hn::Div(depth, pieces);
      Record a = corners.eval(rays, rays.front);
      for (Float number = constant(0.0f);;) {
        const Mask busy = hn::Lt(number, pieces);
        if (hn::AllFalse(kFloat, busy)) break;
        const auto at = [&](float t) { return multiply_add(hn::Add(number, constant(t)), share, rays.front); };
        const Record b = corners.eval(rays, at(0.5f)), c = corners.eval(rays, at(1.0f));
        const auto mean = [](Float low, Float middle, Float high) {
          return hn::Mul(multiply_add(constant(4.0f), middle, hn::Add(low, high)), constant(1.0f / 6.0f));
        };
        composite_densities({mean(a.x, b.x, c.x), mean(a.y, b.y, c.y), mean(a.z, b.z, c.z), mean(a.w, b.w, c.w)},
                            hn::IfThenElseZero(busy, hn::Mul(share, rays.world_per_z)), sum);
        a = c;
        number = hn::Add(number, constant(1.0f));
      }
      rays.advance(back);
    }
    store_accumulated(sum, job, first, lanes);
  }
  return segments;
}

/// Samples of the scalar; what lies between two of them is up to the integrator.
template <class Integrator>
class ScalarSampler {
 public:
  using Corners = CellCorners;
  using Value = Float;
  static constexpr int kChannels = 1, kNodesMore = 0;

  explicit ScalarSampler(const MarchJob& job) : integrator_(*job.tables) {}

  static Value pack(const Float channels[]) { return channels[0]; }
  static void unpack(const Value& value, Float channels[]) { channels[0] = value; }
  static HWY_INLINE Value select(Mask mask, const Value& yes, const Value& no) { return hn::IfThenElse(mask, yes, no); }

  HWY_INLINE void integrate(const Value& from, const Value& to, Float length, Accumulated& sum) const {
    const Mask valid = hn::And(hn::Eq(from, from), hn::Eq(to, to));
    const auto present = [&](Float value) { return hn::IfThenElseZero(valid, value); };
    auto front = integrator_.front_at(present(from));
    integrator_.integrate({present(from), present(to), present(length)}, front, sum);
  }

 private:
  Integrator integrator_;
};

/// Samples of the densities.
class DensitySampler {
 public:
  using Corners = DensityCorners;
  using Value = Record;
  static constexpr int kChannels = 4, kNodesMore = 1;

  explicit DensitySampler(const MarchJob&) {}

  static Value pack(const Float channels[]) { return {channels[0], channels[1], channels[2], channels[3]}; }
  static void unpack(const Value& value, Float channels[]) {
    channels[0] = value.x;
    channels[1] = value.y;
    channels[2] = value.z;
    channels[3] = value.w;
  }
  static HWY_INLINE Value select(Mask mask, const Value& yes, const Value& no) {
    return {hn::IfThenElse(mask, yes.x, no.x), hn::IfThenElse(mask, yes.y, no.y), hn::IfThenElse(mask, yes.z, no.z),
            hn::IfThenElse(mask, yes.w, no.w)};
  }

  HWY_INLINE void integrate(const Value&, const Value& to, Float length, Accumulated& sum) const {
    composite_densities(to, length, sum);
  }
};

/// Samples at equal distances along each ray, whatever cells lie between.
template <class Sampler>
class RateMarcher {
 public:
  explicit RateMarcher(const MarchJob& job) : job_(job), brick_(*job.brick), sampler_(job) {}

  std::uint64_t run(int count) {
    for (int first = 0; first < count; first += static_cast<int>(kLanes))
      march(first, std::min(count - first, static_cast<int>(kLanes)));
    return segments_;
  }

 private:
  using Value = typename Sampler::Value;

  /// The sample before, and where the next one lies.
  struct Samples {
    Value value;
    Float depth, distance, number, exit;

    Float next() const { return hn::Min(hn::Mul(number, distance), exit); }
  };

  Samples load(const LatticeRays& rays, Int ray) const {
    const MarchRays& tile = *job_.rays;
    Samples samples;
    samples.depth = hn::GatherIndex(kFloat, tile.z_sample, ray);
    samples.distance = hn::Div(constant(job_.sample_distance), hn::Max(rays.world_per_z, constant(1e-30f)));
    samples.number = hn::GatherIndex(kFloat, tile.next_number, ray);
    samples.exit = hn::GatherIndex(kFloat, tile.z_exit, ray);
    Float channels[4];
    for (int i = 0; i < Sampler::kChannels; ++i) channels[i] = hn::GatherIndex(kFloat, tile.sample[i], ray);
    // A ray that enters the grid begins with a sample.
    const Mask fresh = hn::Lt(samples.depth, constant(-0.5f * kNever));
    const Value entered = typename Sampler::Corners(brick_, rays.cell).eval(rays, rays.front);
    samples.value = Sampler::select(fresh, entered, Sampler::pack(channels));
    samples.depth = hn::IfThenElse(fresh, rays.front, samples.depth);
    Float first = hn::Add(hn::Floor(hn::Div(rays.front, samples.distance)), constant(1.0f));
    const Mask is_here = hn::Le(hn::Mul(first, samples.distance), rays.front);  // by rounding
    first = hn::Add(first, hn::IfThenElseZero(is_here, constant(1.0f)));
    samples.number = hn::IfThenElse(fresh, first, samples.number);
    return samples;
  }

  void store(const Samples& samples, int first, int count) const {
    MarchRays& tile = *job_.rays;
    HWY_ALIGN float values[6][kLanes];
    Float channels[4];
    Sampler::unpack(samples.value, channels);
    for (int i = 0; i < Sampler::kChannels; ++i) hn::Store(channels[i], kFloat, values[i]);
    hn::Store(samples.depth, kFloat, values[4]);
    hn::Store(samples.number, kFloat, values[5]);
    for (int lane = 0; lane < count; ++lane) {
      const std::int32_t ray = tile.met.ray[first + lane];
      for (int i = 0; i < Sampler::kChannels; ++i) tile.sample[i][ray] = values[i][lane];
      tile.z_sample[ray] = values[4][lane];
      tile.next_number[ray] = values[5][lane];
    }
  }

  void march(int first, int count) {
    LatticeRays rays(*job_.rays, brick_, first, count, Sampler::kNodesMore);
    const Int ray = hn::LoadU(kInt, job_.rays->met.ray + first);
    Accumulated sum = load_accumulated(*job_.rays, first);
    Samples samples = load(rays, ray);
    while (!hn::AllFalse(kFloat, rays.alive)) {
      const typename Sampler::Corners corners(brick_, rays.cell);
      const Float back = rays.back();
      for (;;) {
        const Float depth = samples.next();
        const Mask here = hn::And(rays.alive, hn::And(hn::Le(depth, back), hn::Gt(depth, samples.depth)));
        if (hn::AllFalse(kFloat, here)) break;
        segments_ += hn::CountTrue(kFloat, here);
        const Value value = corners.eval(rays, depth);
        const Float length = hn::IfThenElseZero(here, hn::Mul(hn::Sub(depth, samples.depth), rays.world_per_z));
        sampler_.integrate(samples.value, value, length, sum);
        samples.value = Sampler::select(here, value, samples.value);
        samples.depth = hn::IfThenElse(here, depth, samples.depth);
        samples.number = hn::Add(samples.number, hn::IfThenElseZero(here, constant(1.0f)));
      }
      rays.advance(back);
    }
    store(samples, first, count);
    store_accumulated(sum, job_, first, count);
  }

  const MarchJob& job_;
  const MarchBrick& brick_;
  Sampler sampler_;
  std::uint64_t segments_ = 0;
};

}  // namespace HWY_NAMESPACE
}  // namespace tetravox::cpu
HWY_AFTER_NAMESPACE();

#endif
