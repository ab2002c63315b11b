#include "src/optics/cylindrical_atlas.h"
#include "src/optics/pair_integrals.h"
#include "src/optics/polynomial_table.h"
#include "src/optics/preintegration_table.h"
#include "src/optics/segment_integral.h"
#include "tests/common/functions.h"
#include "tetravox/error.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <functional>
#include <map>
#include <random>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace tetravox::optics {
namespace {

constexpr ValueRange kRange{-2.0, 6.0};
constexpr ScalarMap kMap{1.5, 2.5};

OpticalFunction constant_function() { return {{{0.0, 0.7, {0.9, 0.5, 0.1}}}}; }
OpticalFunction linear_function() { return {{{kRange.min, 0.1, {0.0, 0.4, 1.0}}, {kRange.max, 1.3, {1.0, 0.6, 0.2}}}}; }
OpticalFunction smooth_function() { return tests::make_hard_functions(kRange, 4.0).front().function; }

PreintegrationSource source_of(const OpticalFunction& function, double longest = 4.0) {
  return {function, kMap, kRange, longest};
}

/// A look-up of one of the methods.
using LookUp = std::function<SegmentColor(float front, float back, float length)>;

std::vector<std::pair<std::string, LookUp>> make_all(const PreintegrationSource& source,
                                                     const PreintegrationSettings& settings) {
  PreintegrationTable table;
  build_preintegration_table(source, settings, table);
  PolynomialTable polynomial;
  build_polynomial_table(source, settings, polynomial);
  CylindricalAtlas atlas;
  build_cylindrical_atlas(source, settings, atlas);
  return {
      {"table3d", [table](float a, float b, float l) { return eval_preintegration_table(table, a, b, l); }},
      {"polynomial", [polynomial](float a, float b, float l) { return eval_polynomial_table(polynomial, a, b, l); }},
      {"cylindrical", [atlas](float a, float b, float l) { return eval_cylindrical_atlas(atlas, a, b, l); }}};
}

std::array<double, 4> numbers_of(const SegmentColor& color) {
  return {static_cast<double>(color.red), static_cast<double>(color.green), static_cast<double>(color.blue),
          static_cast<double>(color.opacity)};
}

struct Errors {
  double largest = 0.0, rms = 0.0;
};

/// Against exact integrals, at random segments of which most are short.
Errors measure(const PreintegrationSource& source, const LookUp& look_up) {
  const SegmentIntegral exact(source.function, kRange);
  std::mt19937 random(7);
  std::uniform_real_distribution<double> unit;
  Errors errors;
  constexpr int kCount = 4000;
  for (int i = 0; i < kCount; ++i) {
    const double a = unit(random), b = std::clamp(a + 0.6 * (unit(random) - 0.5), 0.0, 1.0);
    const double length = source.longest * std::pow(unit(random), 3);
    const auto stored = [&](double s) { return kMap.stored_from_value(kRange.min + s * (kRange.max - kRange.min)); };
    const std::array<double, 4> found = numbers_of(look_up(stored(a), stored(b), static_cast<float>(length)));
    const Slab slab = exact.integrate(a, b, length);
    const std::array<double, 4> wanted{slab.color[0], slab.color[1], slab.color[2], slab.opacity};
    for (std::size_t c = 0; c < 4; ++c) {
      const double error = std::abs(found[c] - wanted[c]);
      errors.largest = std::max(errors.largest, error);
      errors.rms += error * error / (4 * kCount);
    }
  }
  errors.rms = std::sqrt(errors.rms);
  return errors;
}

TEST(SegmentIntegral, AgreesWithClosedFormsAndSteps) {
  const SegmentIntegral constant(constant_function(), kRange);
  const Slab slab = constant.integrate(0.2, 0.9, 3.0);
  EXPECT_NEAR(slab.opacity, 1.0 - std::exp(-2.1), 1e-14);
  EXPECT_NEAR(slab.color[1], 0.5 * slab.opacity, 1e-12);

  // Quadrature by many thin steps, of a function with steps and peaks too.
  for (const auto& named : tests::make_hard_functions(kRange, 4.0)) {
    const SegmentIntegral function(named.function, kRange);
    for (const auto& [a, b] : {std::pair{0.1, 0.8}, {0.9, 0.05}, {0.3, 0.300001}, {0.5, 0.5}}) {
      const Slab exact = function.integrate(a, b, 2.0), steps = function.integrate_in_steps(a, b, 2.0, 20000);
      EXPECT_NEAR(exact.opacity, steps.opacity, 1e-9) << named.name << " " << a << " " << b;
      for (std::size_t c = 0; c < 3; ++c)
        EXPECT_NEAR(exact.color[c], steps.color[c], 1e-6) << named.name << " " << a << " " << b;
    }
  }
}

TEST(SegmentIntegral, MeanOfALinearFunctionIsThatOfItsMiddle) {
  const SegmentIntegral function(linear_function(), kRange);
  EXPECT_NEAR(function.mean(0.2, 0.6)[0], 0.1 + 1.2 * 0.4, 1e-14);
  // Mean of (0.1 + 1.2 s) s over [0, 1].
  EXPECT_NEAR(function.mean(1.0, 0.0)[1], 0.05 + 0.4, 1e-14);
  EXPECT_NEAR(function.mean(0.3, 0.3)[0], 0.1 + 1.2 * 0.3, 1e-14);
}

TEST(PairIntegrals, IncrementalEqualsStraightforward) {
  for (const auto& named : tests::make_hard_functions(kRange, 4.0)) {
    const SegmentIntegral function(named.function, kRange);
    const std::vector<double> lengths{0.001, 0.5, 40.0};
    using Pairs = std::map<std::pair<int, int>, std::vector<Slab>>;
    const auto collect = [&](auto integrate, int steps) {
      std::vector<std::vector<Slab>> found(9 * 9);
      integrate(function, PairLattice{9, lengths, steps}, [&](int front, int back, std::span<const Slab> slabs) {
        auto& pair = found[static_cast<std::size_t>(front * 9 + back)];
        EXPECT_TRUE(pair.empty());
        pair.assign(slabs.begin(), slabs.end());
      });
      Pairs pairs;
      for (int i = 0; i < 81; ++i) pairs[{i / 9, i % 9}] = found[static_cast<std::size_t>(i)];
      return pairs;
    };
    // A number that all differences of scalars divide: the steps are the same ones.
    const Pairs anew = collect(integrate_pairs_anew, 840), incremental = collect(integrate_pairs_incrementally, 840);
    ASSERT_EQ(anew.size(), 81u);
    for (const auto& [pair, slabs] : anew) {
      const std::vector<Slab>& others = incremental.at(pair);
      ASSERT_EQ(others.size(), lengths.size());
      for (std::size_t k = 0; k < lengths.size(); ++k) {
        EXPECT_NEAR(slabs[k].opacity, others[k].opacity, 1e-11) << named.name << " " << pair.first << pair.second;
        for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(slabs[k].color[c], others[k].color[c], 1e-11) << named.name;
      }
    }
  }
}

TEST(PreintegrationTables, ConstantFunctionIsTheClosedForm) {
  const OpticalFunction function = constant_function();
  for (const auto& [name, look_up] : make_all(source_of(function), {}))
    for (const float length : {1e-6f, 0.01f, 0.7f, 3.99f}) {
      const SegmentColor color = look_up(-1.0f, 0.6f, length);
      const float opacity = -std::expm1(-0.7f * length);
      EXPECT_NEAR(color.opacity, opacity, 1e-5f * opacity) << name << " " << length;
      EXPECT_NEAR(color.red, 0.9f * opacity, 1e-5f * opacity) << name << " " << length;
      EXPECT_NEAR(color.blue, 0.1f * opacity, 1e-5f * opacity) << name << " " << length;
    }
}

TEST(PreintegrationTables, LinearFunctionAgreesWithQuadrature) {
  const OpticalFunction function = linear_function();
  const PreintegrationSource source = source_of(function);
  PreintegrationSettings settings;
  settings.degree = 4;
  settings.planes = 129;
  for (const auto& [name, look_up] : make_all(source, settings)) {
    const Errors errors = measure(source, look_up);
    EXPECT_LT(errors.largest, 1e-3) << name;
    EXPECT_LT(errors.rms, 1e-4) << name;
  }
}

TEST(PreintegrationTables, NoLengthIsTransparentAndShortOnesAreExactToFirstOrder) {
  const OpticalFunction function = smooth_function();
  const SegmentIntegral exact(function, kRange);
  for (const LengthSpacing spacing : {LengthSpacing::kUniform, LengthSpacing::kLogarithmic}) {
    PreintegrationSettings settings;
    settings.length_spacing = spacing;
    settings.scalars = 129;  // scalars of the test on its nodes
    settings.tile = 129;
    settings.steps = 8;
    for (const auto& [name, look_up] : make_all(source_of(function), settings))
      for (const auto& [a, b] : {std::pair{0.25, 0.75}, {0.75, 0.25}, {0.5, 0.5}, {0.0, 1.0}}) {
        const auto stored = [&](double s) {
          return kMap.stored_from_value(kRange.min + s * (kRange.max - kRange.min));
        };
        for (const double number : numbers_of(look_up(stored(a), stored(b), 0.0f))) EXPECT_EQ(number, 0.0) << name;
        const double length = 1e-7;
        const Slab thin = exact.integrate(a, b, length);
        const std::array<double, 4> found = numbers_of(look_up(stored(a), stored(b), static_cast<float>(length)));
        EXPECT_NEAR(found[3] / thin.opacity, 1.0, 1e-4) << name << " " << a << " " << b;
        for (std::size_t c = 0; c < 3; ++c)
          EXPECT_NEAR(found[c] / thin.opacity, thin.color[c] / thin.opacity, 1e-4) << name << " " << a << " " << b;
      }
  }
}

TEST(PreintegrationTables, OpacityIsSymmetricInFrontAndBack) {
  const OpticalFunction function = smooth_function();
  const auto all = make_all(source_of(function), {});
  for (std::size_t i = 0; i < 2; ++i)  // the atlas has its own texels for either way
    for (const float length : {0.01f, 1.0f, 4.0f})
      EXPECT_NEAR(all[i].second(-1.0f, 1.2f, length).opacity, all[i].second(1.2f, -1.0f, length).opacity, 2e-6f)
          << all[i].first;
  for (const float length : {0.01f, 1.0f, 4.0f})
    EXPECT_NEAR(all[2].second(-1.0f, 1.2f, length).opacity, all[2].second(1.2f, -1.0f, length).opacity, 2e-3f);
}

TEST(PreintegrationTables, TransparentFunctionsAreTransparent) {
  const OpticalFunction function{{{0.0, 0.0, {1.0, 1.0, 1.0}}}};
  for (const auto& [name, look_up] : make_all(source_of(function), {}))
    for (const double number : numbers_of(look_up(-1.0f, 0.6f, 2.0f))) EXPECT_EQ(number, 0.0) << name;
}

TEST(PreintegrationTables, ScalarsAndLengthsBeyondAreThoseAtTheEnd) {
  const OpticalFunction function = smooth_function();
  for (const auto& [name, look_up] : make_all(source_of(function), {})) {
    const float first = kMap.stored_from_value(kRange.min), last = kMap.stored_from_value(kRange.max);
    const auto expect_same = [&, &name = name](const SegmentColor& a, const SegmentColor& b) {
      for (std::size_t i = 0; i < 4; ++i) EXPECT_NEAR(numbers_of(a)[i], numbers_of(b)[i], 1e-6) << name;
    };
    expect_same(look_up(first - 3.0f, last + 2.0f, 1.0f), look_up(first, last, 1.0f));
    expect_same(look_up(0.1f, 0.2f, 50.0f), look_up(0.1f, 0.2f, 4.0f));
  }
}

TEST(PreintegrationTables, ASingleValueWillDo) {
  const OpticalFunction function = linear_function();
  for (const auto& [name, look_up] : make_all({function, kMap, {2.0, 2.0}, 4.0}, {})) {
    const float stored = kMap.stored_from_value(2.0);
    EXPECT_NEAR(look_up(stored, stored, 1.0f).opacity, -std::expm1(-0.7f), 1e-4f) << name;
  }
  const OpticalFunction around_nothing{{{-1.0, 0.0, {1, 1, 1}}, {1.0, 1.4, {1, 1, 1}}}};
  for (const auto& [name, look_up] : make_all({around_nothing, {}, {0.0, 0.0}, 4.0}, {}))
    EXPECT_NEAR(look_up(0.0f, 0.0f, 1.0f).opacity, -std::expm1(-0.7f), 1e-4f) << name;
}

TEST(PreintegrationTables, ErrorsFallAsTablesGrow) {
  const OpticalFunction function = smooth_function();
  const PreintegrationSource source = source_of(function);
  PreintegrationSettings coarse, fine;
  coarse.scalars = 32, coarse.lengths = 16, coarse.planes = 17, coarse.tile = 32, coarse.degree = 1;
  fine.scalars = 128, fine.lengths = 64, fine.planes = 65, fine.tile = 128, fine.degree = 4;
  const auto coarse_ones = make_all(source, coarse), fine_ones = make_all(source, fine);
  for (std::size_t i = 0; i < coarse_ones.size(); ++i) {
    const Errors before = measure(source, coarse_ones[i].second), after = measure(source, fine_ones[i].second);
    EXPECT_LT(after.rms, 0.25 * before.rms) << coarse_ones[i].first;
    EXPECT_LT(after.largest, 0.5 * before.largest) << coarse_ones[i].first;
  }
}

TEST(PreintegrationTables, AreGivenUpWhenToldTo) {
  const OpticalFunction function = smooth_function();
  std::atomic<bool> cancelled{true};
  PreintegrationSource source = source_of(function);
  source.progress.cancelled = &cancelled;
  for (const bool use_incremental : {false, true}) {
    PreintegrationSettings settings;
    settings.use_incremental = use_incremental;
    EXPECT_THROW(make_all(source, settings), Error);
  }
  // Parts are told until nearly all is done.
  cancelled = false;
  double part = 0.0;
  source.progress.report = [&](std::string_view, double done) { part = std::max(part, done); };
  CylindricalAtlas atlas;
  build_cylindrical_atlas(source, {}, atlas);
  EXPECT_GT(part, 0.5);
}

TEST(PolynomialTable, HigherDegreesAreBetter) {
  for (const double depth : {1.0, 4.0, 30.0}) {
    const OpticalFunction function = smooth_function();
    const PreintegrationSource source = source_of(function, depth);
    double last = 1.0;
    for (const int degree : {0, 1, 2, 4}) {
      PreintegrationSettings settings;
      settings.scalars = 256;
      settings.degree = degree;
      PolynomialTable table;
      build_polynomial_table(source, settings, table);
      const double rms =
          measure(source, [&](float a, float b, float l) { return eval_polynomial_table(table, a, b, l); }).rms;
      EXPECT_LT(rms, last) << "degree " << degree << ", longest " << depth;
      last = rms;
    }
  }
}

TEST(PolynomialTable, LinearOpacityIsTheOpticalDepth) {
  const OpticalFunction function = constant_function();
  PreintegrationSettings settings;
  settings.opacity = OpacityModel::kLinear;
  PolynomialTable table;
  build_polynomial_table(source_of(function), settings, table);
  EXPECT_NEAR(eval_polynomial_table(table, 0.0f, 0.1f, 1.0f).opacity, 0.7f, 1e-6f);
  EXPECT_EQ(eval_polynomial_table(table, 0.0f, 0.1f, 2.0f).opacity, 1.0f);
}

TEST(PreintegrationTables, FewerBitsAreWorse) {
  const OpticalFunction function = smooth_function();
  const PreintegrationSource source = source_of(function);
  std::vector<double> last(3, 0.0);
  for (const int bits : {32, 12, 8}) {
    PreintegrationSettings settings;
    settings.bits = bits;
    const auto all = make_all(source, settings);
    for (std::size_t i = 0; i < all.size(); ++i) {
      const double rms = measure(source, all[i].second).rms;
      EXPECT_GE(rms, 0.99 * last[i]) << all[i].first << " " << bits;
      EXPECT_LT(rms, last[i] + (bits < 32 ? std::ldexp(1.0, -bits) : 5e-3)) << all[i].first << " " << bits;
      last[i] = rms;
    }
  }
  EXPECT_EQ(store_in_bits(0.5, 8), 128.0f / 255.0f);
  EXPECT_EQ(store_in_bits(2.0, 12), 1.0f);
}

TEST(PreintegrationSettings, AreValidated) {
  const auto message = [](const PreintegrationSettings& settings) {
    try {
      validate_preintegration(settings);
    } catch (const Error& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_EQ(message({}), "");
  PreintegrationSettings settings;
  settings.bits = 10;
  EXPECT_EQ(message(settings), "bits of pre-integration tables: 10 is not 8, 12, 16 or 32");
  settings = {};
  settings.degree = 5;
  EXPECT_EQ(message(settings), "degree of the chromaticity: 5 is not between 0 and 4");
}

}  // namespace
}  // namespace tetravox::optics
