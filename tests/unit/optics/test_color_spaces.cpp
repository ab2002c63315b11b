#include "src/optics/color_spaces.h"

#include <gtest/gtest.h>

namespace tetravox::optics {
namespace {

struct Expected {
  double t;
  Color color;
};

void expect_colors(ColorSpace space, const std::vector<Expected>& list) {
  const Color colors[] = {{0.9, 0.1, 0.3}, {0.9, 0.8, 0.1}, {0.1, 0.2, 0.6}};
  for (const Expected& expected : list) {
    const int i = expected.t < 1.0 ? 0 : 1;
    const Color found = mix_colors(space, colors[i], colors[i + 1], expected.t - i);
    for (int c = 0; c < 3; ++c)
      EXPECT_NEAR(found[c], expected.color[c], 2e-5) << static_cast<int>(space) << " at " << expected.t << "[" << c;
  }
}

// Expected: vtkColorTransferFunction of VTK 9.1 through the same three colours at 0, 1 and 2.
TEST(ColorSpaces, AgreeWithVtk) {
  expect_colors(ColorSpace::kHsv, {{0.25, {0.525000, 0.100000, 0.900000}},
                                   {0.5, {0.100000, 0.650000, 0.900000}},
                                   {1.3, {0.278359, 0.810000, 0.103500}},
                                   {1.75, {0.103125, 0.635684, 0.675000}}});
  expect_colors(ColorSpace::kHsvWrapped, {{0.25, {0.900000, 0.125000, 0.100000}},
                                          {0.5, {0.900000, 0.350000, 0.100000}},
                                          {1.3, {0.278359, 0.810000, 0.103500}}});
  expect_colors(ColorSpace::kLab, {{0.25, {0.913668, 0.362589, 0.278662}},
                                   {0.5, {0.919034, 0.524440, 0.246473}},
                                   {1.3, {0.732853, 0.602962, 0.350239}},
                                   {1.75, {0.431381, 0.330333, 0.524261}}});
  expect_colors(ColorSpace::kDiverging, {{0.25, {1.000000, 0.646736, 0.523651}},
                                         {0.5, {0.999983, 1.000000, 0.999983}},
                                         {1.3, {1.000000, 0.932442, 0.704784}},
                                         {1.75, {0.000000, 0.726954, 1.000000}}});
}

TEST(ColorSpaces, KeepTheEndsAndStayInGamut) {
  for (const ColorSpace space :
       {ColorSpace::kRgb, ColorSpace::kHsv, ColorSpace::kHsvWrapped, ColorSpace::kLab, ColorSpace::kDiverging})
    for (int i = 0; i < 512; ++i) {
      const Color a{(i & 1) * 1.0, (i >> 1 & 1) * 1.0, (i >> 2 & 1) * 1.0};
      const Color b{(i >> 3 & 3) / 3.0, (i >> 5 & 3) / 3.0, (i >> 7 & 3) / 3.0};
      const Color begin = mix_colors(space, a, b, 0.0), end = mix_colors(space, a, b, 1.0);
      for (int c = 0; c < 3; ++c) {
        EXPECT_NEAR(begin[c], a[c], 1e-3);
        EXPECT_NEAR(end[c], b[c], 1e-3);
      }
      for (int k = 0; k <= 8; ++k)
        for (const double channel : mix_colors(space, a, b, k / 8.0)) EXPECT_TRUE(channel >= 0.0 && channel <= 1.0);
    }
}

TEST(ColorSpaces, HaveParaViewsNames) {
  EXPECT_EQ(color_space_from_name("CIELAB"), ColorSpace::kLab);
  EXPECT_EQ(color_space_from_name("Lab/CIEDE2000"), ColorSpace::kLab);
  EXPECT_EQ(color_space_from_name("Step"), ColorSpace::kStep);
  EXPECT_EQ(color_space_from_name("Diverging"), ColorSpace::kDiverging);
  EXPECT_FALSE(color_space_from_name("CMYK"));
}

}  // namespace
}  // namespace tetravox::optics
