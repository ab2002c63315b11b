// The source `walk`: rays go from tetrahedron to tetrahedron, a vector of rays at a time.

#if defined(TETRAVOX_CPU_WALK_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef TETRAVOX_CPU_WALK_INL
#undef TETRAVOX_CPU_WALK_INL
#else
#define TETRAVOX_CPU_WALK_INL
#endif

#include "src/cpu/kernels/effects-inl.h"
#include "src/cpu/kernels/kernels.h"
#include "src/cpu/kernels/rasterize-inl.h"
#include "src/cpu/kernels/segments-inl.h"
#include "src/cpu/kernels/tetrahedron_stretch-inl.h"
#include "src/cpu/kernels/vector_math-inl.h"
#include "src/cpu/kernels/walk_lanes-inl.h"

#include <algorithm>

HWY_BEFORE_NAMESPACE();
namespace tetravox::cpu {
namespace HWY_NAMESPACE {

template <class Integrator, bool kCellData, bool kHasEffects = false>
class Walker : WalkLanes {
 public:
  explicit Walker(const WalkJob& job) : WalkLanes(job, kHasEffects), integrator_(*job.tables) {}

  WalkStatistics run() {
    for (std::size_t i = 0; i < kLanes; ++i) clear(i);
    while (fill()) march();
    return statistics_;
  }

 private:
  using RayState = State<Integrator>;

  // ---- between memory and registers ----

  HWY_INLINE RayState load() const {
    RayState s;
    for (int k = 0; k < 3; ++k) {
      s.id[k] = hn::Load(kUint, lanes_.id[k]);
      s.x[k] = hn::Load(kFloat, lanes_.x[k]);
      s.y[k] = hn::Load(kFloat, lanes_.y[k]);
      s.z[k] = hn::Load(kFloat, lanes_.z[k]);
      s.scalar[k] = hn::Load(kFloat, lanes_.scalar[k]);
      s.weight[k] = hn::Load(kFloat, lanes_.weight[k]);
    }
    s.cell = hn::Load(kUint, lanes_.cell);
    s.z_front = hn::Load(kFloat, lanes_.z_front);
    s.scalar_front = hn::Load(kFloat, lanes_.scalar_front);
    s.sum = {hn::Load(kFloat, lanes_.red), hn::Load(kFloat, lanes_.green), hn::Load(kFloat, lanes_.blue),
             hn::Load(kFloat, lanes_.transmittance)};
    s.front = integrator_.front_at(s.scalar_front);
    s.alive = float_mask(hn::Ne(hn::Load(kUint, lanes_.alive), hn::Zero(kUint)));
    return s;
  }

  HWY_INLINE void store(const RayState& s) {
    for (int k = 0; k < 3; ++k) {
      hn::Store(s.id[k], kUint, lanes_.id[k]);
      hn::Store(s.x[k], kFloat, lanes_.x[k]);
      hn::Store(s.y[k], kFloat, lanes_.y[k]);
      hn::Store(s.z[k], kFloat, lanes_.z[k]);
      hn::Store(s.scalar[k], kFloat, lanes_.scalar[k]);
      hn::Store(s.weight[k], kFloat, lanes_.weight[k]);
    }
    hn::Store(s.cell, kUint, lanes_.cell);
    hn::Store(s.z_front, kFloat, lanes_.z_front);
    hn::Store(s.scalar_front, kFloat, lanes_.scalar_front);
    hn::Store(s.sum.red, kFloat, lanes_.red);
    hn::Store(s.sum.green, kFloat, lanes_.green);
    hn::Store(s.sum.blue, kFloat, lanes_.blue);
    hn::Store(s.sum.transmittance, kFloat, lanes_.transmittance);
    hn::Store(hn::IfThenElseZero(uint_mask(s.alive), hn::Set(kUint, 0xFFFFFFFFu)), kUint, lanes_.alive);
  }

  // ---- walking ----

  /// Walks until a quarter of the lanes is idle (or all are), then puts everything back into memory.
  void march() {
    constexpr std::size_t kIdle = std::max<std::size_t>(1, kLanes / 4);
    RayState s = load();
    if constexpr (kHasEffects) {
      note_face(s, entered_);
      if (is_followed()) light_.set_out(effects(), view_rays().direction());
    }
    const std::size_t wanted = hn::CountTrue(kFloat, s.alive);
    const std::size_t enough = next_ray_ < job_.tile->rays.size() ? (wanted > kIdle ? wanted - kIdle : 0) : 0;
    for (;;) {
      const std::size_t walking = hn::CountTrue(kFloat, s.alive);
      if (walking <= enough) break;
      statistics_.segments += walking;
      step(s);
      if (HWY_UNLIKELY(++steps_ % kCheckedSteps == 0)) stop_stuck_rays(s);
    }
    store(s);
  }

  /// One cell for every ray.
  HWY_INLINE void step(RayState& s) {
    // The vertex opposite the entry face: by exclusive or with the three that are known.
    const Uint five_cells = hn::Add(hn::ShiftLeft<2>(s.cell), s.cell);
    const auto* links = reinterpret_cast<const std::uint32_t*>(mesh_.cells);
    const Uint all = hn::GatherIndex(kUint, links, hn::BitCast(kInt, five_cells));
    const Uint d =
        hn::Min(hn::Xor(hn::Xor(all, s.id[0]), hn::Xor(s.id[1], s.id[2])), hn::Set(kUint, mesh_.last_vertex));
    const Record vertex = load_records(mesh_.vertices, d);
    const Float x_slope = hn::Load(kFloat, lanes_.x_slope), y_slope = hn::Load(kFloat, lanes_.y_slope);
    const Float x = hn::Sub(hn::Sub(vertex.x, hn::Mul(x_slope, vertex.z)), hn::Load(kFloat, lanes_.x_offset));
    const Float y = hn::Sub(hn::Sub(vertex.y, hn::Mul(y_slope, vertex.z)), hn::Load(kFloat, lanes_.y_offset));

    // On which side of the edges (a, d), (b, d), (c, d) does the ray pass? The same two vertices give the same product,
    // up to its sign, in every cell: the walk is watertight.
    Float product[3];
    Mask positive[3];
    for (int k = 0; k < 3; ++k) {
      product[k] = hn::Sub(hn::Mul(s.x[k], y), hn::Mul(s.y[k], x));
      positive[k] = hn::Gt(product[k], constant(0.0f));
    }
    const Float together = hn::Mul(hn::Mul(product[0], product[1]), product[2]);
    if (HWY_UNLIKELY(!hn::AllFalse(kFloat, hn::Eq(together, constant(0.0f))))) break_ties(s, x, y, product, positive);

    // The ray leaves through the face without a, b or c: that vertex is replaced by d.
    const Mask out_a = hn::AndNot(positive[1], positive[2]);
    const Mask out_c = hn::AndNot(positive[0], positive[1]);
    const Mask out_b = hn::Not(hn::Or(out_a, out_c));
    const Uint replaced = hn::IfThenElse(uint_mask(out_a), s.id[0], hn::IfThenElse(uint_mask(out_c), s.id[2], s.id[1]));

    // Neighbours are stored by rank of the vertex opposite to the face.
    Uint rank = hn::Set(kUint, 1);
    for (int k = 0; k < 3; ++k) rank = hn::Add(rank, hn::IfThenElseZero(hn::Lt(s.id[k], replaced), hn::Set(kUint, 1)));
    rank = hn::Add(rank, hn::IfThenElseZero(hn::Lt(d, replaced), hn::Set(kUint, 1)));
    const Uint neighbour = hn::GatherIndex(kUint, links, hn::BitCast(kInt, hn::Add(five_cells, rank)));

    if constexpr (kHasEffects)
      if (integrator_.wants_faces()) note_face(s, entered_);
    replace_vertex(s, out_a, out_b, out_c, d, x, y, vertex, product);

    // Depth and scalar where the ray leaves.
    const Float total = hn::Add(hn::Add(s.weight[0], s.weight[1]), s.weight[2]);
    const Float inverse = hn::Div(constant(1.0f), total);
    const Mask valid = hn::Gt(total, constant(0.0f));
    const auto interpolate = [&](const Float v[3]) {
      return hn::Mul(multiply_add(s.weight[2], v[2], multiply_add(s.weight[1], v[1], hn::Mul(s.weight[0], v[0]))),
                     inverse);
    };
    const Float z_back = hn::Max(hn::IfThenElse(valid, interpolate(s.z), s.z_front), s.z_front);
    Segments segment;
    if constexpr (kCellData) {
      segment.scalar_back = segment.scalar_front =
          hn::GatherIndex(kFloat, mesh_.cell_scalars, hn::BitCast(kInt, s.cell));
    } else {
      segment.scalar_front = s.scalar_front;
      segment.scalar_back = hn::IfThenElse(valid, interpolate(s.scalar), s.scalar_front);
    }
    segment.length = hn::Mul(hn::Sub(z_back, s.z_front), hn::Load(kFloat, lanes_.world_per_z));
    segment.length = hn::IfThenElseZero(s.alive, segment.length);

    // Of what is clipped away nothing is integrated.
    const Mask clipped =
        hn::Or(hn::Lt(s.z_front, hn::Load(kFloat, lanes_.z_near)), hn::Gt(z_back, hn::Load(kFloat, lanes_.z_far)));
    const Float one = constant(1.0f), zero = constant(0.0f);
    const bool is_cut = !hn::AllFalse(kFloat, clipped);
    if constexpr (kHasEffects) {
      const auto stretch_of = [&] {
        return make_stretch(s, entered_, d, {out_a, out_b, out_c}, hn::IfThenElseZero(valid, inverse), segment, z_back);
      };
      const auto integrate = [&](Float from, Float to, Float length_part) {
        TetrahedronStretch part = stretch_of();
        part.length = hn::IfThenElseZero(hn::Gt(length_part, zero), part.length);
        integrate_part(s, part, from, to);
      };
      if (is_followed())  // then nothing is cut or met
        integrate_followed(s, entered_, d, {out_a, out_b, out_c}, segment, stretch_of);
      else if (HWY_UNLIKELY(is_cut))
        integrate_intervals(s, z_back, segment, integrate);
      else if (HWY_LIKELY(integrator_.is_light_all(segment)))
        integrator_.integrate_lit_segment(
            segment, stretch_of, [&] { return view_rays(); }, s.front, s.sum);
      else if (HWY_LIKELY(integrator_.is_volume_all(segment)))
        integrator_.integrate_volume_segment(segment, s.front, s.sum);
      else
        integrate(zero, one, one);
    } else {
      const auto integrate = [&](Float from, Float to, Float length_part) {
        const Float rise = hn::Sub(segment.scalar_back, segment.scalar_front);
        const Float begin = multiply_add(from, rise, segment.scalar_front);
        const Segments part{
            begin, hn::IfThenElse(hn::Ge(to, one), segment.scalar_back, multiply_add(to, rise, segment.scalar_front)),
            hn::Mul(segment.length, length_part)};
        integrator_.integrate(part, s.front, s.sum);
      };
      if (HWY_UNLIKELY(is_cut))
        integrate_intervals(s, z_back, segment, integrate);
      else
        integrator_.integrate(segment, s.front, s.sum);
    }
    s.z_front = z_back;
    s.scalar_front = segment.scalar_back;

    // On to the neighbour. Idle lanes stay in a cell that exists.
    const hn::Mask<UintTag> outside = hn::Eq(neighbour, hn::Set(kUint, kNoCell));
    s.cell = hn::IfThenZeroElse(outside, neighbour);
    s.alive = hn::AndNot(float_mask(outside), s.alive);
    if (job_.use_early_ray_termination) terminate_early(s);
  }

  /// A ray that meets an edge exactly passes it as if it were moved by an infinitesimal: see `edge_product`.
  static HWY_NOINLINE void break_ties(const RayState& s, Float x, Float y, const Float product[3], Mask positive[3]) {
    for (int k = 0; k < 3; ++k)
      positive[k] = hn::Or(positive[k], hn::And(hn::Eq(product[k], constant(0.0f)), passes_tie(s.x[k], s.y[k], x, y)));
  }

  HWY_INLINE void replace_vertex(RayState& s, Mask out_a, Mask out_b, Mask out_c, Uint d, Float x, Float y,
                                 const Record& vertex, const Float product[3]) {
    const Mask out[3] = {out_a, out_b, out_c};
    // Edge products of the new face; those that keep their edge keep their weight.
    const Float zero = constant(0.0f);
    const auto clamp = [&](Float value) { return hn::Max(value, zero); };
    const Float minus_a = hn::Sub(zero, product[0]), minus_b = hn::Sub(zero, product[1]),
                minus_c = hn::Sub(zero, product[2]);
    s.weight[0] = hn::IfThenElse(out_a, s.weight[0], clamp(hn::IfThenElse(out_b, minus_c, product[1])));
    s.weight[1] = hn::IfThenElse(out_b, s.weight[1], clamp(hn::IfThenElse(out_c, minus_a, product[2])));
    s.weight[2] = hn::IfThenElse(out_c, s.weight[2], clamp(hn::IfThenElse(out_a, minus_b, product[0])));
    for (int k = 0; k < 3; ++k) {
      s.id[k] = hn::IfThenElse(uint_mask(out[k]), d, s.id[k]);
      s.x[k] = hn::IfThenElse(out[k], x, s.x[k]);
      s.y[k] = hn::IfThenElse(out[k], y, s.y[k]);
      s.z[k] = hn::IfThenElse(out[k], vertex.z, s.z[k]);
      s.scalar[k] = hn::IfThenElse(out[k], vertex.w, s.scalar[k]);
    }
  }

  /// Calls `integrate(from, to, part)` for each part of a segment that is drawn, and ends rays behind the last one.
  template <class Integrate>
  HWY_NOINLINE void integrate_intervals(RayState& s, Float z_back, const Segments& segment,
                                        const Integrate& integrate) {
    const Float zero = constant(0.0f), one = constant(1.0f);
    const Float depth = hn::Sub(z_back, s.z_front);
    const Float inverse = hn::Div(one, hn::IfThenElse(hn::Gt(depth, zero), depth, one));
    Mask taking = s.alive;  // first all rays, then those with a further interval here
    for (;;) {
      const Float near = hn::Load(kFloat, lanes_.z_near), far = hn::Load(kFloat, lanes_.z_far);
      const Mask cuts_front = hn::Gt(near, s.z_front), cuts_back = hn::Lt(far, z_back);
      const auto place_of = [&](Float z) {
        return hn::Min(hn::Max(hn::Mul(hn::Sub(z, s.z_front), inverse), zero), one);
      };
      Float from = hn::IfThenElse(cuts_front, place_of(near), zero);
      const Float to = hn::Max(hn::IfThenElse(cuts_back, place_of(far), one), from);
      from = hn::IfThenElse(taking, from, to);
      const Float begin = multiply_add(from, hn::Sub(segment.scalar_back, segment.scalar_front), segment.scalar_front);
      s.front = integrator_.front_at(begin);
      integrate(from, to, hn::Sub(to, from));
      taking = hn::And(taking, cuts_back);
      if (!leave_intervals(s, taking, z_back)) break;
      taking = hn::And(taking, s.alive);
    }
    s.front = integrator_.front_at(segment.scalar_back);
  }

  /// Moves the rays of `ended` on to their next interval; those without one are done. Whether any interval begins
  /// before `z_back`.
  HWY_NOINLINE bool leave_intervals(RayState& s, Mask ended, Float z_back) {
    if (hn::AllFalse(kFloat, ended)) return false;
    HWY_ALIGN float back[kLanes];
    HWY_ALIGN std::uint32_t lane[kLanes], done[kLanes];
    hn::Store(z_back, kFloat, back);
    hn::Store(hn::IfThenElseZero(uint_mask(ended), hn::Set(kUint, 1)), kUint, lane);
    bool is_any_near = false;
    for (std::size_t i = 0; i < kLanes; ++i) {
      done[i] = 0;
      if (!lane[i] || lanes_.ray[i] == kNoRay) continue;
      if (lanes_.next_clip[i] < job_.tile->rays[lanes_.ray[i]].clip_end) {
        next_interval(i);
        is_any_near |= lanes_.z_near[i] < back[i];
      } else {
        done[i] = 1;
        lanes_.z_far[i] = kEndless;  // asks no more
      }
    }
    const Mask finished = float_mask(hn::Ne(hn::Load(kUint, done), hn::Zero(kUint)));
    s.alive = hn::AndNot(finished, s.alive);
    forget_entries(finished);
    return is_any_near;
  }

  // ---- effects ----

  struct Replaced {
    Mask a, b, c;
  };

  static HWY_INLINE void note_face(const RayState& s, PassedFace& face) {
    for (int k = 0; k < 3; ++k) {
      face.id[k] = s.id[k];
      face.weights[k] = s.weight[k];
    }
  }

  /// Whether the light of the eye is taken from cell to cell.
  HWY_INLINE bool is_followed() const {
    return !kCellData && !mesh_.has_cell_gradients && integrator_.is_light_followed();
  }

  template <class MakeStretch>
  HWY_INLINE void integrate_followed(RayState& s, const PassedFace& entered, Uint d, const Replaced& replaced,
                                     const Segments& segment, const MakeStretch& make_stretch) {
    const auto pass = [&]() -> const FollowedLight& {
      const Mask out[3] = {replaced.a, replaced.b, replaced.c};
      light_.pass(effects(), mesh_.gradients, entered, d, out, s.weight);
      return light_;
    };
    integrator_.integrate_followed_segment(
        segment, pass, [&] { light_.lose(); }, make_stretch, [&] { return view_rays(); }, s.front, s.sum);
  }
  const Effects& effects() const { return *job_.tables->effects; }

  /// `inverse`: of the sum of the weights of the exit face, or 0 where that has none.
  HWY_INLINE TetrahedronStretch make_stretch(const RayState& s, const PassedFace& entered, Uint d,
                                             const Replaced& replaced, Float inverse, const Segments& segment,
                                             Float z_back) const {
    TetrahedronStretch stretch{segment.scalar_front,
                               segment.scalar_back,
                               s.z_front,
                               z_back,
                               segment.length,
                               mesh_,
                               s.cell,
                               {entered.id[0], entered.id[1], entered.id[2]},
                               d,
                               {},
                               {},
                               {replaced.a, replaced.b, replaced.c}};
    const Float total = hn::Add(hn::Add(entered.weights[0], entered.weights[1]), entered.weights[2]);
    const Mask valid = hn::Gt(total, constant(0.0f)), flat = hn::Eq(inverse, constant(0.0f));
    const Float front_inverse = hn::Div(constant(1.0f), hn::IfThenElse(valid, total, constant(1.0f)));
    for (int k = 0; k < 3; ++k)
      stretch.front_weights[k] =
          hn::IfThenElse(valid, hn::Mul(entered.weights[k], front_inverse), constant(1.0f / 3.0f));
    for (int k = 0; k < 3; ++k)
      stretch.back_weights[k] = hn::IfThenElse(flat, constant(1.0f / 3.0f), hn::Mul(s.weight[k], inverse));
    return stretch;
  }

  HWY_INLINE RayView view_rays() const {
    return {hn::Load(kFloat, lanes_.x_offset), hn::Load(kFloat, lanes_.x_slope), hn::Load(kFloat, lanes_.y_offset),
            hn::Load(kFloat, lanes_.y_slope), lanes_.pixel};
  }

  HWY_INLINE void integrate_part(RayState& s, const TetrahedronStretch& stretch, Float from, Float to) {
    Float depth = hn::Load(kFloat, lanes_.depth);
    integrator_.integrate_stretch(stretch, view_rays(), from, to, s.front, s.sum, depth);
    hn::Store(depth, kFloat, lanes_.depth);
  }

  /// Stops rays of which no 8-bit pixel can change any more.
  HWY_INLINE void terminate_early(RayState& s) const {
    const Mask ended = hn::And(s.alive, is_settled(s.sum));
    if (HWY_LIKELY(hn::AllFalse(kFloat, ended))) return;
    s.alive = hn::AndNot(ended, s.alive);
    forget_entries(ended);  // A ray that is done has no further entry.
  }

  /// A ray that has not moved for many cells goes round in circles, which only damaged meshes allow: stop it.
  HWY_NOINLINE void stop_stuck_rays(RayState& s) {
    if (job_.cancelled && job_.cancelled->load(std::memory_order_relaxed)) {
      give_up(s);
      return;
    }
    const Mask stuck = hn::And(s.alive, hn::Le(s.z_front, hn::Load(kFloat, lanes_.z_checked)));
    hn::Store(s.z_front, kFloat, lanes_.z_checked);
    if (hn::AllFalse(kFloat, stuck)) return;
    statistics_.stopped_rays += hn::CountTrue(kFloat, stuck);
    s.alive = hn::AndNot(stuck, s.alive);
  }

  /// Nobody wants the picture any more.
  void give_up(RayState& s) {
    forget_entries(s.alive);
    s.alive = hn::FirstN(kFloat, 0);
    next_ray_ = job_.tile->rays.size();
  }

  static constexpr std::uint64_t kCheckedSteps = 1024;

  Integrator integrator_;
  FollowedLight light_;  // of rays with effects
  PassedFace entered_;   // of the step at hand, where the integrator wants it
  std::uint64_t steps_ = 0;
  WalkStatistics statistics_;
};

}  // namespace HWY_NAMESPACE
}  // namespace tetravox::cpu
HWY_AFTER_NAMESPACE();

#endif
