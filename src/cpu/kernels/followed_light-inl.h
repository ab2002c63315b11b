// The light of the eye along rays through a mesh with gradients at its vertices. What shines where a ray leaves a cell
// shines where it enters the next: one light a cell gives two.

#if defined(TETRAVOX_CPU_FOLLOWED_LIGHT_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef TETRAVOX_CPU_FOLLOWED_LIGHT_INL
#undef TETRAVOX_CPU_FOLLOWED_LIGHT_INL
#else
#define TETRAVOX_CPU_FOLLOWED_LIGHT_INL
#endif

#include "src/cpu/kernels/effects.h"
#include "src/cpu/kernels/shading-inl.h"
#include "src/cpu/kernels/triples-inl.h"
#include "src/cpu/kernels/vector_math-inl.h"

HWY_BEFORE_NAMESPACE();
namespace tetravox::cpu {
namespace HWY_NAMESPACE {

/// A place on the face between two cells: gradient, its square, and the light there.
struct LitFace {
  Triple gradient;
  Float square;
  EyeLight light;
};

/// A face that rays pass: its vertices, and where between them.
struct PassedFace {
  Uint id[3];
  Float weights[3];  ///< not normalised; all 0 where the face is seen edge on
};

/// What a vector of rays has seen on its way, from cell to cell.
class FollowedLight {
 public:
  /// Rays of this direction (camera frame) are where nothing is known of.
  HWY_INLINE void set_out(const Effects& effects, const Triple& direction) {
    is_known_ = false;
    // A mesh is turned into the camera's frame, not stretched: turning the direction back does as well.
    const float* m = effects.camera_from_gradient;
    const auto row = [&](int i) {
      return multiply_add(constant(m[6 + i]), direction.z,
                          multiply_add(constant(m[3 + i]), direction.y, hn::Mul(constant(m[i]), direction.x)));
    };
    direction_ = {row(0), row(1), row(2)};
    per_square_ = hn::Div(constant(1.0f), dot(direction, direction));
  }

  /// To be called where a cell is passed without `pass`.
  HWY_INLINE void lose() { is_known_ = false; }

  /// Goes on from face `from` of a cell to the one that `entering` has come into, instead of the vertex of `replaced`.
  /// `weights`: see PassedFace, of that face.
  HWY_INLINE void pass(const Effects& effects, const float* gradients, const PassedFace& from, Uint entering,
                       const Mask replaced[3], const Float weights[3]) {
    if (!is_known_) {
      for (int k = 0; k < 3; ++k) corners_[k] = load(gradients, from.id[k]);
      find_light(effects, from.weights, faces_[last_]);
      is_known_ = true;
    }
    const Triple corner = load(gradients, entering);
    for (int k = 0; k < 3; ++k)
      corners_[k] = {hn::IfThenElse(replaced[k], corner.x, corners_[k].x),
                     hn::IfThenElse(replaced[k], corner.y, corners_[k].y),
                     hn::IfThenElse(replaced[k], corner.z, corners_[k].z)};
    last_ = 1 - last_;
    find_light(effects, weights, faces_[last_]);
  }

  /// The faces of the cell that has been passed.
  HWY_INLINE const LitFace& front() const { return faces_[1 - last_]; }
  HWY_INLINE const LitFace& back() const { return faces_[last_]; }

 private:
  static HWY_INLINE Triple load(const float* gradients, Uint number) {
    const Record record = load_records(gradients, number);
    return {record.x, record.y, record.z};
  }

  HWY_INLINE void find_light(const Effects& effects, const Float given[3], LitFace& face) const {
    const Float one = constant(1.0f), total = hn::Add(hn::Add(given[0], given[1]), given[2]);
    const Mask valid = hn::Gt(total, constant(0.0f));
    const Float inverse = hn::Div(one, hn::IfThenElse(valid, total, constant(3.0f)));
    const Float weights[3] = {hn::IfThenElse(valid, given[0], one), hn::IfThenElse(valid, given[1], one),
                              hn::IfThenElse(valid, given[2], one)};
    const auto mean = [&](Float a, Float b, Float c) {
      return hn::Mul(multiply_add(weights[2], c, multiply_add(weights[1], b, hn::Mul(weights[0], a))), inverse);
    };
    face.gradient = {mean(corners_[0].x, corners_[1].x, corners_[2].x),
                     mean(corners_[0].y, corners_[1].y, corners_[2].y),
                     mean(corners_[0].z, corners_[1].z, corners_[2].z)};
    face.square = dot(face.gradient, face.gradient);
    const Float along = dot(face.gradient, direction_);
    face.light = light_from_eye(*effects.shading, face.square, hn::Mul(hn::Mul(along, along), per_square_));
  }

  bool is_known_ = false;
  Triple direction_;   // of the rays, in the frame of the gradients
  Float per_square_;   // 1 / its square
  Triple corners_[3];  // gradients at the vertices of the face that the rays have passed last
  LitFace faces_[2];
  int last_ = 0;  // of these
};

/// Where the light of a cell may be taken as the mean of that at its two faces: the gradient is linear in between, so
/// that it turns by no more than its change over its least length. Light linear along the ray then errs by its change
/// times how far the emission lies off the middle, and what bends by an eighth of the square of the angle times its
/// second derivative.
HWY_INLINE Mask is_light_even(const Effects& effects, const LitFace& front, const LitFace& back, Float absorbed) {
  const Triple change{hn::Sub(back.gradient.x, front.gradient.x), hn::Sub(back.gradient.y, front.gradient.y),
                      hn::Sub(back.gradient.z, front.gradient.z)};
  const Float square = dot(change, change);
  const Float least = hn::Sub(hn::Min(front.square, back.square), hn::Mul(constant(0.25f), square));
  const Float weakest = hn::Add(least, constant(effects.shading->half_strength));
  const Mask bent = hn::Gt(hn::Mul(hn::Mul(absorbed, constant(effects.light_change.second)), square), weakest);
  const Float diffuse =
      hn::Mul(hn::AbsDiff(front.light.diffuse, back.light.diffuse), constant(effects.light_change.diffuse));
  const Float shine = hn::Mul(hn::AbsDiff(front.light.shine, back.light.shine), constant(effects.light_change.shine));
  return hn::And(hn::Not(bent), hn::Le(hn::Mul(absorbed, hn::Add(diffuse, shine)), constant(1.0f)));
}

}  // namespace HWY_NAMESPACE
}  // namespace tetravox::cpu
HWY_AFTER_NAMESPACE();

#endif
