/// The look-ups of the kernels are those of optics: one formula, held together here for every instruction set.

#include "src/cpu/kernels/kernels.h"
#include "tests/common/functions.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>
#include <random>
#include <string>
#include <vector>

namespace tetravox::cpu {
namespace {

constexpr ValueRange kRange{-2.0, 6.0};
constexpr optics::ScalarMap kMap{1.5, 2.5};

/// Segments at random, and those at ends, edges and beyond.
struct TestSegments {
  std::vector<float> front, back, length;

  TestSegments() {
    std::mt19937 random(3);
    std::uniform_real_distribution<float> scalar(-1.6f, 2.0f), unit(0.0f, 1.0f);
    for (int i = 0; i < 4001; ++i) {
      front.push_back(scalar(random));
      back.push_back(i % 5 == 0 ? front.back() : front.back() + 0.7f * (unit(random) - 0.5f));
      length.push_back(i % 7 == 0 ? 0.0f : 4.4f * std::pow(unit(random), 4.0f));
    }
    for (const float a : {-9.0f, -1.4f, 1.8f, 9.0f})
      for (const float b : {-9.0f, -1.4f, 1.8f, 9.0f})
        for (const float l : {0.0f, 1e-30f, 1e-6f, 4.0f, 100.0f}) {
          front.push_back(a);
          back.push_back(b);
          length.push_back(l);
        }
  }
};

using Eval = std::function<optics::SegmentColor(float front, float back, float length)>;

void expect_kernels_do_the_same(const IntegratorTables& tables, const Eval& eval, const std::string& name) {
  const TestSegments segments;
  const std::size_t count = segments.front.size();
  std::vector<float> first;
  for (const std::string& instruction_set : available_instruction_sets()) {
    std::vector<float> colors(4 * count);
    kernels_for(instruction_set)
        .tables.look_up(tables, {segments.front.data(), segments.back.data(), segments.length.data(), count},
                        colors.data());
    for (std::size_t i = 0; i < count; ++i) {
      const optics::SegmentColor wanted = eval(segments.front[i], segments.back[i], segments.length[i]);
      const std::array<float, 4> numbers{wanted.red, wanted.green, wanted.blue, wanted.opacity};
      for (std::size_t c = 0; c < 4; ++c)
        ASSERT_NEAR(colors[4 * i + c], numbers[c], 1e-5f + 1e-5f * numbers[c])
            << name << " " << instruction_set << " segment " << segments.front[i] << " " << segments.back[i] << " "
            << segments.length[i];
    }
    if (first.empty()) first = colors;
    EXPECT_EQ(colors, first) << name << " " << instruction_set;
  }
}

class TableKernels : public ::testing::Test {
 protected:
  template <class Body>
  void for_each_source(const Body& body) {
    for (const auto& named : tests::make_hard_functions(kRange, 4.0))
      body(optics::PreintegrationSource{named.function, kMap, kRange, 4.0}, named.name);
  }
};

TEST_F(TableKernels, FullPreintegration) {
  for_each_source([](const optics::PreintegrationSource& source, const std::string& name) {
    for (const LengthSpacing spacing : {LengthSpacing::kUniform, LengthSpacing::kLogarithmic}) {
      PreintegrationSettings settings;
      settings.scalars = 37;
      settings.lengths = 23;
      settings.length_spacing = spacing;
      settings.steps = 8;
      optics::PreintegrationTable table;
      optics::build_preintegration_table(source, settings, table);
      IntegratorTables tables;
      tables.preintegration = &table;
      const auto eval = [&](float a, float b, float l) { return optics::eval_preintegration_table(table, a, b, l); };
      expect_kernels_do_the_same(tables, eval, name + " " + name_of(spacing));
    }
  });
}

TEST_F(TableKernels, Polynomial) {
  for_each_source([](const optics::PreintegrationSource& source, const std::string& name) {
    for (int degree = 0; degree <= kLargestDegree; ++degree) {
      PreintegrationSettings settings;
      settings.scalars = 41;
      settings.degree = degree;
      settings.steps = 8;
      settings.opacity = degree == 1 ? OpacityModel::kLinear : OpacityModel::kExponential;
      settings.bits = degree == 3 ? 12 : 32;
      optics::PolynomialTable table;
      optics::build_polynomial_table(source, settings, table);
      IntegratorTables tables;
      tables.polynomial = &table;
      const auto eval = [&](float a, float b, float l) { return optics::eval_polynomial_table(table, a, b, l); };
      expect_kernels_do_the_same(tables, eval, name + " " + std::to_string(degree));
    }
  });
}

TEST_F(TableKernels, Cylindrical) {
  for_each_source([](const optics::PreintegrationSource& source, const std::string& name) {
    for (const int planes : {2, 13, 33}) {
      PreintegrationSettings settings;
      settings.planes = planes;
      settings.tile = 29;
      settings.steps = 8;
      optics::CylindricalAtlas atlas;
      optics::build_cylindrical_atlas(source, settings, atlas);
      IntegratorTables tables;
      tables.atlas = &atlas;
      const auto eval = [&](float a, float b, float l) { return optics::eval_cylindrical_atlas(atlas, a, b, l); };
      expect_kernels_do_the_same(tables, eval, name + " " + std::to_string(planes));
    }
  });
}

}  // namespace
}  // namespace tetravox::cpu
