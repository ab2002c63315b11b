#include "src/grid/separable_kernel.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

namespace tetravox::grid {
namespace {

class Kernels : public testing::TestWithParam<Filter> {
 protected:
  std::unique_ptr<SeparableKernel> kernel_ = make_kernel(GetParam());
};

TEST_P(Kernels, WeightsAddUpToOne) {
  for (const double phase : {0.0, 0.1, 0.5, 0.75, 1.0}) {
    const std::vector<double> weights = weights_at(*kernel_, phase);
    EXPECT_EQ(weights.size(), 2u * static_cast<unsigned>(kernel_->radius()));
    EXPECT_NEAR(std::accumulate(weights.begin(), weights.end(), 0.0), 1.0, 1e-12) << phase;
  }
}

TEST_P(Kernels, DerivativeIsThatOfTheKernel) {
  constexpr double kStep = 1e-5;
  for (double x = -kernel_->radius() - 0.45; x < kernel_->radius() + 0.5; x += 0.1)
    EXPECT_NEAR(kernel_->eval_derivative(x), (kernel_->eval(x + kStep) - kernel_->eval(x - kStep)) / (2 * kStep), 1e-6)
        << "at " << x;
}

TEST_P(Kernels, IsSymmetricAndEndsAtItsRadius) {
  for (double x = 0.0; x < 10.0; x += 0.37) EXPECT_DOUBLE_EQ(kernel_->eval(x), kernel_->eval(-x));
  EXPECT_NEAR(kernel_->eval(kernel_->radius()), 0.0, 1e-12);
  EXPECT_EQ(kernel_->eval(kernel_->radius() + 0.01), 0.0);
}

INSTANTIATE_TEST_SUITE_P(All, Kernels,
                         testing::Values(Filter{FilterKind::kLinear}, Filter{FilterKind::kBspline},
                                         Filter{FilterKind::kInterpolatingBspline}, Filter{FilterKind::kCatmullRom},
                                         Filter{FilterKind::kMitchell}, Filter{FilterKind::kLanczos, 2},
                                         Filter{FilterKind::kLanczos, 3}, Filter{FilterKind::kLanczos, 8}));

TEST(SeparableKernel, KernelsThatInterpolateAreOneAtTheirValueAndNothingAtOthers) {
  for (const Filter& filter : {Filter{FilterKind::kCatmullRom}, Filter{FilterKind::kLanczos, 3}}) {
    const auto kernel = make_kernel(filter);
    EXPECT_NEAR(kernel->eval(0.0), 1.0, 1e-12);
    EXPECT_NEAR(kernel->eval(1.0), 0.0, 1e-12);
  }
}

TEST(SeparableKernel, OvershootIsOneForKernelsThatAreNowhereNegative) {
  EXPECT_DOUBLE_EQ(overshoot_of(*make_kernel({FilterKind::kBspline})), 1.0);
  EXPECT_NEAR(overshoot_of(*make_kernel({FilterKind::kCatmullRom})), std::pow(1.25, 3), 1e-9);
}

TEST(SeparableKernel, PrefilteredSplinePassesThroughTheValues) {
  const std::array<std::size_t, 3> dimensions{7, 5, 4};
  std::vector<float> values;
  for (int i = 0; i < 7 * 5 * 4; ++i) values.push_back(std::sin(1.7f * static_cast<float>(i * i)));
  std::vector<float> coefficients = values;
  prefilter_bspline(dimensions, coefficients);
  const auto mirrored = [](int i, std::size_t count) {
    const int last = static_cast<int>(count) - 1;
    i = std::abs(i);
    return static_cast<std::size_t>(i > last ? 2 * last - i : i);
  };
  const double weight[3] = {1.0 / 6, 2.0 / 3, 1.0 / 6};
  for (int k = 0; k < 4; ++k)
    for (int j = 0; j < 5; ++j)
      for (int i = 0; i < 7; ++i) {
        double sum = 0.0;
        for (int c = 0; c < 27; ++c)
          sum +=
              weight[c % 3] * weight[c / 3 % 3] * weight[c / 9] *
              static_cast<double>(coefficients[(mirrored(k + c / 9 - 1, 4) * 5 + mirrored(j + c / 3 % 3 - 1, 5)) * 7 +
                                               mirrored(i + c % 3 - 1, 7)]);
        EXPECT_NEAR(sum, static_cast<double>(values[static_cast<std::size_t>((k * 5 + j) * 7 + i)]), 1e-5);
      }
}

TEST(FilterNames, GoThereAndBack) {
  for (const char* name :
       {"linear", "nearest", "bspline", "bspline-interpolating", "catmull-rom", "mitchell", "lanczos=2", "lanczos=8"})
    EXPECT_EQ(name_of(filter_from_name(name)), name);
  EXPECT_EQ(filter_from_name("lanczos").radius, 3);
  for (const char* name : {"", "cubic", "lanczos=1", "lanczos=9", "lanczos=x", "linear=2", "lanczos="})
    EXPECT_ANY_THROW(filter_from_name(name)) << name;
}

}  // namespace
}  // namespace tetravox::grid
