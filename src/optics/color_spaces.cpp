#include "src/optics/color_spaces.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

namespace tetravox::optics {
namespace {

constexpr Color kWhiteD65{0.9505, 1.0, 1.089};

Color clamp(const Color& c) {
  return {std::clamp(c[0], 0.0, 1.0), std::clamp(c[1], 0.0, 1.0), std::clamp(c[2], 0.0, 1.0)};
}

Color lerp(const Color& a, const Color& b, double t) {
  return {std::lerp(a[0], b[0], t), std::lerp(a[1], b[1], t), std::lerp(a[2], b[2], t)};
}

Color hsv_from_rgb(const Color& c) {
  const double largest = std::max({c[0], c[1], c[2]}), smallest = std::min({c[0], c[1], c[2]});
  const double range = largest - smallest;
  if (!(range > 0.0)) return {0.0, 0.0, largest};
  double hue = 0.0;
  if (c[0] == largest)
    hue = (c[1] - c[2]) / (6.0 * range);
  else if (c[1] == largest)
    hue = 1.0 / 3 + (c[2] - c[0]) / (6.0 * range);
  else
    hue = 2.0 / 3 + (c[0] - c[1]) / (6.0 * range);
  return {hue < 0.0 ? hue + 1.0 : hue, range / largest, largest};
}

Color rgb_from_hsv(const Color& hsv) {
  const auto channel = [&](double n) {
    const double k = std::fmod(n + 6.0 * hsv[0], 6.0);
    return hsv[2] * (1.0 - hsv[1] * std::clamp(std::min(k, 4.0 - k), 0.0, 1.0));
  };
  return {channel(5), channel(3), channel(1)};
}

double linear_from_display(double c) { return c > 0.04045 ? std::pow((c + 0.055) / 1.055, 2.4) : c / 12.92; }
double display_from_linear(double c) { return c > 0.0031308 ? 1.055 * std::pow(c, 1.0 / 2.4) - 0.055 : 12.92 * c; }

Color lab_from_rgb(const Color& c) {
  const double r = linear_from_display(c[0]), g = linear_from_display(c[1]), b = linear_from_display(c[2]);
  const Color xyz{0.4124 * r + 0.3576 * g + 0.1805 * b, 0.2126 * r + 0.7152 * g + 0.0722 * b,
                  0.0193 * r + 0.1192 * g + 0.9505 * b};
  Color f;
  for (int i = 0; i < 3; ++i) {
    const double ratio = xyz[i] / kWhiteD65[i];
    f[i] = ratio > 0.008856 ? std::cbrt(ratio) : 7.787 * ratio + 16.0 / 116.0;
  }
  return {116.0 * f[1] - 16.0, 500.0 * (f[0] - f[1]), 200.0 * (f[1] - f[2])};
}

Color rgb_from_lab(const Color& lab) {
  const double y = (lab[0] + 16.0) / 116.0;
  Color xyz{lab[1] / 500.0 + y, y, y - lab[2] / 200.0};
  for (int i = 0; i < 3; ++i) {
    const double cube = xyz[i] * xyz[i] * xyz[i];
    xyz[i] = kWhiteD65[i] * (cube > 0.008856 ? cube : (xyz[i] - 16.0 / 116.0) / 7.787);
  }
  const Color rgb{3.2406 * xyz[0] - 1.5372 * xyz[1] - 0.4986 * xyz[2],
                  -0.9689 * xyz[0] + 1.8758 * xyz[1] + 0.0415 * xyz[2],
                  0.0557 * xyz[0] - 0.2040 * xyz[1] + 1.0570 * xyz[2]};
  // Bring colours out of gamut back by dimming all channels alike, as VTK does.
  const Color display{display_from_linear(rgb[0]), display_from_linear(rgb[1]), display_from_linear(rgb[2])};
  const double largest = std::max({1.0, display[0], display[1], display[2]});
  return {display[0] / largest, display[1] / largest, display[2] / largest};
}

/// Polar L*a*b*: magnitude, saturation angle, hue angle.
Color msh_from_lab(const Color& lab) {
  const double magnitude = std::hypot(lab[0], lab[1], lab[2]);
  return {magnitude, magnitude > 0.001 ? std::acos(lab[0] / magnitude) : 0.0, std::atan2(lab[2], lab[1])};
}

Color lab_from_msh(const Color& msh) {
  const double chroma = msh[0] * std::sin(msh[1]);
  return {msh[0] * std::cos(msh[1]), chroma * std::cos(msh[2]), chroma * std::sin(msh[2])};
}

double angle_between(double a, double b) {
  const double difference = std::abs(a - b);
  return difference > std::numbers::pi ? 2.0 * std::numbers::pi - difference : difference;
}

/// Hue for an unsaturated end, such that the path to the saturated one looks straight (Moreland 2009, section 4).
double adjusted_hue(const Color& saturated, double unsaturated_magnitude) {
  if (saturated[0] >= unsaturated_magnitude - 0.1) return saturated[2];
  const double spin = saturated[1] *
                      std::sqrt(unsaturated_magnitude * unsaturated_magnitude - saturated[0] * saturated[0]) /
                      (saturated[0] * std::sin(saturated[1]));
  return saturated[2] > -0.3 * std::numbers::pi ? saturated[2] + spin : saturated[2] - spin;
}

/// Diverging colour map between two colours (Moreland, "Diverging Color Maps for Scientific Visualization", 2009).
Color mix_diverging(const Color& a, const Color& b, double t) {
  constexpr double kSaturated = 0.05;
  Color msh_a = msh_from_lab(lab_from_rgb(a)), msh_b = msh_from_lab(lab_from_rgb(b));

  // Put white in the middle where both ends are saturated and their hues differ.
  if (msh_a[1] > kSaturated && msh_b[1] > kSaturated && angle_between(msh_a[2], msh_b[2]) > 0.33 * std::numbers::pi) {
    const double white = std::max({msh_a[0], msh_b[0], 88.0});
    if (t < 0.5) {
      msh_b = {white, 0.0, 0.0};
      t *= 2.0;
    } else {
      msh_a = {white, 0.0, 0.0};
      t = 2.0 * t - 1.0;
    }
  }
  if (msh_a[1] < kSaturated && msh_b[1] > kSaturated)
    msh_a[2] = adjusted_hue(msh_b, msh_a[0]);
  else if (msh_b[1] < kSaturated && msh_a[1] > kSaturated)
    msh_b[2] = adjusted_hue(msh_a, msh_b[0]);
  return rgb_from_lab(lab_from_msh(lerp(msh_a, msh_b, t)));
}

Color mix_hsv(const Color& a, const Color& b, double t, bool use_wrap) {
  Color hsv_a = hsv_from_rgb(a), hsv_b = hsv_from_rgb(b);
  if (use_wrap && std::abs(hsv_a[0] - hsv_b[0]) > 0.5) (hsv_a[0] > hsv_b[0] ? hsv_a : hsv_b)[0] -= 1.0;
  Color hsv = lerp(hsv_a, hsv_b, t);
  if (hsv[0] < 0.0) hsv[0] += 1.0;
  return rgb_from_hsv(hsv);
}

}  // namespace

std::optional<ColorSpace> color_space_from_name(const std::string& name) {
  constexpr std::array<std::pair<const char*, ColorSpace>, 11> kNames{{{"RGB", ColorSpace::kRgb},
                                                                       {"HSV", ColorSpace::kHsv},
                                                                       {"HSVNoWrap", ColorSpace::kHsv},
                                                                       {"HSVWrap", ColorSpace::kHsvWrapped},
                                                                       {"Wrapped", ColorSpace::kHsvWrapped},
                                                                       {"Lab", ColorSpace::kLab},
                                                                       {"LAB", ColorSpace::kLab},
                                                                       {"CIELAB", ColorSpace::kLab},
                                                                       {"Lab/CIEDE2000", ColorSpace::kLab},
                                                                       {"Diverging", ColorSpace::kDiverging},
                                                                       {"Step", ColorSpace::kStep}}};
  for (const auto& [known, space] : kNames)
    if (name == known) return space;
  return std::nullopt;
}

Color mix_colors(ColorSpace space, const Color& a, const Color& b, double t) {
  switch (space) {
    case ColorSpace::kRgb:
      break;
    case ColorSpace::kHsv:
      return clamp(mix_hsv(a, b, t, false));
    case ColorSpace::kHsvWrapped:
      return clamp(mix_hsv(a, b, t, true));
    case ColorSpace::kLab:
      return clamp(rgb_from_lab(lerp(lab_from_rgb(a), lab_from_rgb(b), t)));
    case ColorSpace::kDiverging:
      return clamp(mix_diverging(a, b, t));
    case ColorSpace::kStep:
      return b;
  }
  return lerp(a, b, t);
}

}  // namespace tetravox::optics
