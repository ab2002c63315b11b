/// Embedded environments: what formulas say of each direction.

#include "src/optics/environment_texels.h"
#include "src/support/threads.h"
#include "tetravox/environment.h"
#include "tetravox/error.h"
#include "tetravox/transfer_function.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <string_view>

namespace tetravox {
namespace {

constexpr double kPi = std::numbers::pi;

Color mix(double t, const Color& a, const Color& b) {
  return {a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1]), a[2] + t * (b[2] - a[2])};
}
Color scaled(const Color& a, double by) { return {a[0] * by, a[1] * by, a[2] * by}; }
Color sum_of(const Color& a, const Color& b) { return {a[0] + b[0], a[1] + b[1], a[2] + b[2]}; }
double dot(const Vector3& a, const Vector3& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

Vector3 normalized(const Vector3& a) {
  const double length = std::sqrt(dot(a, a));
  return {a[0] / length, a[1] / length, a[2] / length};
}

/// From 0 at `from` to 1 at `to`, smooth at both.
double smooth_step(double from, double to, double x) {
  const double t = std::clamp((x - from) / (to - from), 0.0, 1.0);
  return t * t * (3.0 - 2.0 * t);
}

// ---- white, gradient ----

Color eval_white(const Vector3&) { return {1.0, 1.0, 1.0}; }

Color eval_gradient(const Vector3& d) {
  const Color below{0.30, 0.22, 0.18}, horizon{0.60, 0.56, 0.54}, above{1.0, 1.02, 1.10};
  return d[1] < 0.0 ? mix(-d[1], horizon, below) : mix(d[1], horizon, above);
}

// ---- studio ----

/// A soft box: a lit rectangle before the middle, upright, with soft edges.
struct SoftBox {
  Vector3 towards;                 ///< its centre, any length
  double half_width, half_height;  ///< at distance 1
  Color radiance;
};

/// Somebody stands behind (the usual eye), the key light to the left of them and above.
const std::array<SoftBox, 4> kSoftBoxes{{{{-0.45, 0.75, -0.75}, 0.55, 0.45, {3.3, 3.2, 3.0}},
                                         {{1.0, 0.05, -0.15}, 0.22, 0.90, {0.9, 1.1, 1.4}},
                                         {{-0.55, 0.35, 0.85}, 0.50, 0.30, {2.4, 2.3, 2.1}},
                                         {{0.25, -0.75, -0.60}, 0.60, 0.25, {0.45, 0.40, 0.36}}}};

double cover(const SoftBox& box, const Vector3& d) {
  const Vector3 ahead = normalized(box.towards);
  const double before = dot(d, ahead);
  if (before <= 0.0) return 0.0;
  const Vector3 right = normalized({ahead[2], 0.0, -ahead[0]});
  const Vector3 up{ahead[1] * right[2] - ahead[2] * right[1], ahead[2] * right[0] - ahead[0] * right[2],
                   ahead[0] * right[1] - ahead[1] * right[0]};
  const auto inside = [](double x, double half) { return 1.0 - smooth_step(0.85 * half, 1.1 * half, std::abs(x)); };
  return inside(dot(d, right) / before, box.half_width) * inside(dot(d, up) / before, box.half_height);
}

Color eval_studio(const Vector3& d) {
  Color color = mix(0.5 + 0.5 * d[1], {0.07, 0.07, 0.08}, {0.26, 0.26, 0.28});
  for (const SoftBox& box : kSoftBoxes) color = mix(cover(box, d), color, box.radiance);
  return color;
}

// ---- room ----

Color eval_room(const Vector3& d) {
  std::size_t axis = 0;
  for (std::size_t i = 1; i < 3; ++i)
    if (std::abs(d[i]) > std::abs(d[axis])) axis = i;
  const double s = d[(axis + 1) % 3] / std::abs(d[axis]), t = d[(axis + 2) % 3] / std::abs(d[axis]);
  const auto window = [&](double half_s, double half_t) {
    return (1.0 - smooth_step(half_s - 0.04, half_s, std::abs(s))) *
           (1.0 - smooth_step(half_t - 0.04, half_t, std::abs(t)));
  };
  const bool is_positive = d[axis] > 0.0;
  if (axis == 0) return is_positive ? Color{0.22, 0.38, 0.62} : Color{0.68, 0.26, 0.20};
  if (axis == 1)
    return is_positive ? mix(window(0.55, 0.55), {0.62, 0.60, 0.57}, {2.4, 2.3, 2.15}) : Color{0.33, 0.27, 0.21};
  return is_positive ? Color{0.55, 0.53, 0.50} : mix(window(0.6, 0.6), {0.55, 0.53, 0.50}, {1.0, 1.12, 1.3});
}

// ---- sky ----

/// The clear sky of Preetham, Shirley and Smits (1999), appendix A.2: luminance and chromaticity after Perez, Seals and
/// Michalsky (1993), coefficients linear in the turbidity.
class ClearSky {
 public:
  ClearSky(double turbidity, const Vector3& to_sun) : to_sun_(to_sun) {
    const double t = turbidity, s = std::acos(to_sun[1]);
    const double chi = (4.0 / 9.0 - t / 120.0) * (kPi - 2.0 * s);
    const std::array<double, 3> zenith{
        (4.0453 * t - 4.9710) * std::tan(chi) - 0.2155 * t + 2.4192,
        cubic(s, {0.00166, -0.00375, 0.00209, 0.0}) * t * t + cubic(s, {-0.02903, 0.06377, -0.03202, 0.00394}) * t +
            cubic(s, {0.11693, -0.21196, 0.06052, 0.25886}),
        cubic(s, {0.00275, -0.00610, 0.00317, 0.0}) * t * t + cubic(s, {-0.04214, 0.08970, -0.04153, 0.00516}) * t +
            cubic(s, {0.15346, -0.26756, 0.06670, 0.26688})};
    const double slopes[3][5] = {{0.1787, -0.3554, -0.0227, 0.1206, -0.0670},
                                 {-0.0193, -0.0665, -0.0004, -0.0641, -0.0033},
                                 {-0.0167, -0.0950, -0.0079, -0.0441, -0.0109}};
    const double offsets[3][5] = {{-1.4630, 0.4275, 5.3251, -2.5771, 0.3703},
                                  {-0.2592, 0.0008, 0.2125, -0.8989, 0.0452},
                                  {-0.2608, 0.0092, 0.2102, -1.6537, 0.0529}};
    for (std::size_t i = 0; i < 3; ++i) {
      for (std::size_t k = 0; k < 5; ++k) perez_[i][k] = slopes[i][k] * t + offsets[i][k];
      scale_[i] = zenith[i] / perez(i, 1.0, s);
    }
  }

  /// Luminance (thousands of candela a square metre) and chromaticity x, y of a direction above the horizon.
  std::array<double, 3> eval(const Vector3& d) const {
    const double angle = std::acos(std::clamp(dot(d, to_sun_), -1.0, 1.0));
    const double height = std::max(d[1], 0.05);  // at the horizon the formula ends, and reddens before
    return {scale_[0] * perez(0, height, angle), scale_[1] * perez(1, height, angle),
            scale_[2] * perez(2, height, angle)};
  }

 private:
  static double cubic(double x, const std::array<double, 4>& c) { return ((c[0] * x + c[1]) * x + c[2]) * x + c[3]; }
  double perez(std::size_t i, double cosine, double angle) const {
    const std::array<double, 5>& c = perez_[i];
    const double towards = std::cos(angle);
    return (1.0 + c[0] * std::exp(c[1] / cosine)) * (1.0 + c[2] * std::exp(c[3] * angle) + c[4] * towards * towards);
  }

  Vector3 to_sun_;
  std::array<std::array<double, 5>, 3> perez_{};
  std::array<double, 3> scale_{};
};

/// Red, green, blue (primaries of sRGB, linear) of luminance and chromaticity (IEC 61966-2-1).
Color color_from_chromaticity(const std::array<double, 3>& luminance_xy) {
  const auto [luminance, x, y] = luminance_xy;
  const double large_x = x / y * luminance, large_z = (1.0 - x - y) / y * luminance;
  const Color color{3.2406 * large_x - 1.5372 * luminance - 0.4986 * large_z,
                    -0.9689 * large_x + 1.8758 * luminance + 0.0415 * large_z,
                    0.0557 * large_x - 0.2040 * luminance + 1.0570 * large_z};
  return {std::max(0.0, color[0]), std::max(0.0, color[1]), std::max(0.0, color[2])};
}

/// The sun is spread over a few degrees, so that it shines as it does, and no texel decides where it is.
Color eval_sky(const Vector3& d) {
  static const Vector3 to_sun = normalized({-0.55, 0.75, -0.80});
  static const ClearSky sky(2.5, to_sun);
  constexpr double kExposure = 0.055, kDeviation = 0.045;  // radians
  constexpr double kSunlight = 0.75;                       // that of a light of this strength
  const Color ground{0.24, 0.21, 0.18};
  const double off = 2.0 - 2.0 * dot(d, to_sun);  // square of the angle, about
  const double sun = kSunlight / (2.0 * kDeviation * kDeviation) * std::exp(-0.5 * off / (kDeviation * kDeviation));
  const Color above = sum_of(scaled(color_from_chromaticity(sky.eval(d)), kExposure), scaled({1.0, 0.94, 0.82}, sun));
  return mix(smooth_step(-0.02, 0.02, d[1]), ground, above);
}

// ---- by name ----

struct BuiltinEnvironment {
  std::string_view name, description;
  EnvironmentLayout layout;
  int height;
  Color (*eval)(const Vector3& direction);
};

constexpr std::array<BuiltinEnvironment, 5> kBuiltins{
    {{"white", "the same from everywhere", EnvironmentLayout::kEquirectangular, 2, &eval_white},
     {"gradient", "bright and cool above, dim and warm below", EnvironmentLayout::kEquirectangular, 64, &eval_gradient},
     {"studio", "dark, with four soft boxes", EnvironmentLayout::kEquirectangular, 256, &eval_studio},
     {"room", "six coloured walls with a lamp and a window", EnvironmentLayout::kCube, 128, &eval_room},
     {"sky", "a clear sky with its sun over grey ground (Preetham, Shirley, Smits 1999)",
      EnvironmentLayout::kEquirectangular, 256, &eval_sky}}};

Environment eval_builtin(const BuiltinEnvironment& builtin) {
  Environment environment;
  environment.layout = builtin.layout;
  environment.height = builtin.height;
  environment.width = builtin.layout == EnvironmentLayout::kCube ? builtin.height : 2 * builtin.height;
  const auto width = static_cast<std::size_t>(environment.width), height = static_cast<std::size_t>(builtin.height);
  const std::size_t rows = height * static_cast<std::size_t>(environment.face_count());
  environment.radiance.resize(3 * rows * width);
  support::parallel_chunks(rows, 8, [&](std::size_t begin, std::size_t end) {
    for (std::size_t row = begin; row < end; ++row)
      for (std::size_t column = 0; column < width; ++column) {
        const optics::FacePlace place{static_cast<int>(row / height),
                                      (static_cast<double>(column) + 0.5) / static_cast<double>(width),
                                      (static_cast<double>(row % height) + 0.5) / static_cast<double>(height)};
        const Color color = builtin.eval(optics::direction_of(builtin.layout, place));
        for (std::size_t c = 0; c < 3; ++c)
          environment.radiance[3 * (row * width + column) + c] = static_cast<float>(color[c]);
      }
  });
  return environment;
}

}  // namespace

Environment make_builtin_environment(const std::string& name) {
  constexpr std::string_view kPrefix = "builtin:";
  std::string_view wanted = name;
  if (wanted.starts_with(kPrefix)) wanted.remove_prefix(kPrefix.size());
  std::string names;
  for (const BuiltinEnvironment& builtin : kBuiltins) {
    if (wanted == builtin.name) return eval_builtin(builtin);
    names += (names.empty() ? "" : ", ") + std::string(builtin.name);
  }
  throw Error(ErrorCode::kInvalidArgument,
              "there is no embedded environment '" + std::string(wanted) + "'; there are: " + names);
}

std::vector<std::pair<std::string, std::string>> builtin_environment_names() {
  std::vector<std::pair<std::string, std::string>> names;
  for (const BuiltinEnvironment& builtin : kBuiltins)
    names.emplace_back(std::string(builtin.name), std::string(builtin.description));
  return names;
}

}  // namespace tetravox
