/// Tables made by the device are those of the CPU, as far as blended samples go.

#include "src/gl/table_maker.h"

#include "src/optics/cylindrical_atlas.h"
#include "src/optics/polynomial_table.h"
#include "src/optics/preintegration_table.h"
#include "src/optics/segment_integral.h"
#include "tests/common/functions.h"
#include "tests/common/gl.h"
#include "tetravox/error.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace tetravox::gl {
namespace {

constexpr ValueRange kRange{-2.0, 3.0};
constexpr double kLongest = 0.7;
constexpr Integrator kTableIntegrators[] = {Integrator::kTable3d, Integrator::kPolynomial, Integrator::kCylindrical};

/// Extinction and colour linear over the range; the longest segment is as deep as 6.
OpticalFunction make_linear() {
  return {{{kRange.min, 0.0, {1.0, 0.2, 0.0}}, {kRange.max, 6.0 / kLongest, {0.0, 0.6, 1.0}}}};
}

OpticalFunction make_smooth() { return tests::make_hard_functions(kRange, 20.0 / 6.0 * kLongest)[0].function; }

RenderSettings make_settings(Integrator integrator, int steps, int bits = 32) {
  RenderSettings settings;
  settings.integrator = integrator;
  PreintegrationSettings& tables = settings.preintegration;
  tables.scalars = 24;
  tables.lengths = 10;
  tables.degree = 3;
  tables.planes = 13;
  tables.tile = 12;
  tables.steps = steps;
  tables.bits = bits;
  return settings;
}

struct Difference {
  double largest = 0.0, rms = 0.0;
};

Difference compare(std::span<const float> a, std::span<const float> b) {
  EXPECT_EQ(a.size(), b.size());
  Difference found;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const double difference = std::abs(static_cast<double>(a[i]) - static_cast<double>(b[i]));
    EXPECT_TRUE(std::isfinite(difference));
    found.largest = std::max(found.largest, difference);
    found.rms += difference * difference / static_cast<double>(a.size());
  }
  found.rms = std::sqrt(found.rms);
  return found;
}

class TableMakerTest : public ::testing::Test {
 protected:
  void SetUp() override {
    TETRAVOX_REQUIRE_GL();
    context_ = Context::open({});
    current_.emplace(*context_);
    maker_.emplace();
  }
  void TearDown() override {
    if (context_) context_->require_no_error("the test");
    maker_.reset();
    current_.reset();
  }

  static optics::PreintegrationSource source_of(const OpticalFunction& function) {
    return {function, {0.5, 2.0}, kRange, kLongest};
  }
  DeviceTable make(const OpticalFunction& function, const RenderSettings& settings) {
    return maker_->make(source_of(function), settings);
  }
  static std::vector<float> read(const TextureName& texture) {
    std::array<GLint, 3> size{};
    glGetTextureLevelParameteriv(texture.get(), 0, GL_TEXTURE_WIDTH, &size[0]);
    glGetTextureLevelParameteriv(texture.get(), 0, GL_TEXTURE_HEIGHT, &size[1]);
    glGetTextureLevelParameteriv(texture.get(), 0, GL_TEXTURE_DEPTH, &size[2]);
    std::vector<float> numbers(4 * static_cast<std::size_t>(size[0]) * static_cast<std::size_t>(size[1]) *
                               static_cast<std::size_t>(size[2]));
    glGetTextureImage(texture.get(), 0, GL_RGBA, GL_FLOAT, static_cast<GLsizei>(numbers.size() * sizeof(float)),
                      numbers.data());
    return numbers;
  }
  static std::vector<float> read_ratios(const DeviceTable& table) {
    std::vector<float> ratios(optics::PolynomialTable::kDepths);
    glGetTextureImage(table.ratios.get(), 0, GL_RED, GL_FLOAT, static_cast<GLsizei>(ratios.size() * sizeof(float)),
                      ratios.data());
    return ratios;
  }
  /// The texels that planes have; the last tiles of an atlas may be left over.
  static std::vector<float> without_rest(std::vector<float> texels, const PreintegrationSettings& settings) {
    const auto columns = static_cast<std::size_t>(optics::count_atlas_columns(settings.planes));
    const auto tile = static_cast<std::size_t>(settings.tile), planes = static_cast<std::size_t>(settings.planes);
    for (std::size_t i = 0; i < texels.size(); ++i) {
      const std::size_t x = i / 4 % (columns * tile) / tile, y = i / 4 / (columns * tile) / tile;
      if (y * columns + x >= planes) texels[i] = 0.0f;
    }
    return texels;
  }
  /// The numbers of the device's table, and of the CPU's.
  std::vector<float> of_device(const OpticalFunction& function, const RenderSettings& settings) {
    const DeviceTable table = make(function, settings);
    return settings.integrator == Integrator::kCylindrical ? without_rest(read(table.table), settings.preintegration)
                                                           : read(table.table);
  }
  static std::vector<float> of_cpu(const OpticalFunction& function, const RenderSettings& settings) {
    if (settings.integrator == Integrator::kTable3d) {
      optics::PreintegrationTable table;
      build_preintegration_table(source_of(function), settings.preintegration, table);
      return table.entries;
    }
    if (settings.integrator == Integrator::kPolynomial) {
      optics::PolynomialTable table;
      build_polynomial_table(source_of(function), settings.preintegration, table);
      return table.maps;
    }
    optics::CylindricalAtlas atlas;
    build_cylindrical_atlas(source_of(function), settings.preintegration, atlas);
    return without_rest(atlas.texels, settings.preintegration);
  }

  std::shared_ptr<Context> context_;
  std::optional<Context::Current> current_;
  std::optional<TableMaker> maker_;
};

TEST_F(TableMakerTest, TablesAreThoseOfTheCpu) {
  for (const OpticalFunction& function : {make_linear(), make_smooth()})
    for (const Integrator integrator : kTableIntegrators)
      for (const LengthSpacing spacing : {LengthSpacing::kUniform, LengthSpacing::kLogarithmic}) {
        RenderSettings settings = make_settings(integrator, 256);
        settings.preintegration.length_spacing = spacing;
        const Difference found = compare(of_device(function, settings), of_cpu(function, settings));
        EXPECT_LE(found.largest, 1e-4) << name_of(integrator) << " " << name_of(spacing);
        EXPECT_LE(found.rms, 1e-5) << name_of(integrator) << " " << name_of(spacing);
      }
}

/// Samples in the middle of steps: of second order.
TEST_F(TableMakerTest, ErrorsFallAsStepsGrow) {
  for (const Integrator integrator : kTableIntegrators) {
    const std::vector<float> exact = of_cpu(make_smooth(), make_settings(integrator, 2048));
    double before = 1.0;
    for (const int steps : {4, 16, 64, 256}) {
      const double rms = compare(of_device(make_smooth(), make_settings(integrator, steps)), exact).rms;
      EXPECT_LE(rms, before / 8.0) << name_of(integrator) << ", steps: " << steps;
      before = rms;
    }
  }
}

/// The middle of a step has the mean of what is linear.
TEST_F(TableMakerTest, OpacitiesOfLinearFunctionsNeedOneStep) {
  for (const Integrator integrator : {Integrator::kTable3d, Integrator::kCylindrical}) {
    const std::vector<float> made = of_device(make_linear(), make_settings(integrator, 1)),
                             exact = of_cpu(make_linear(), make_settings(integrator, 64));
    for (std::size_t i = 3; i < made.size(); i += 4) ASSERT_NEAR(made[i], exact[i], 2e-6) << i / 4;
  }
}

TEST_F(TableMakerTest, SegmentsOfNoLengthHaveTheMeanDensity) {
  const RenderSettings settings = make_settings(Integrator::kTable3d, 512);
  const std::vector<float> made = of_device(make_smooth(), settings);
  const optics::SegmentIntegral exact(make_smooth(), kRange);
  const int scalars = settings.preintegration.scalars;
  for (int back = 0; back < scalars; ++back)
    for (int front = 0; front < scalars; ++front) {
      const optics::OpticalDensity mean =
          exact.mean(static_cast<double>(front) / (scalars - 1), static_cast<double>(back) / (scalars - 1));
      const float* entry = made.data() + 4 * (back * scalars + front);
      for (int channel = 0; channel < 4; ++channel)
        ASSERT_NEAR(entry[channel], mean[(channel + 1) % 4] / exact.largest_extinction(), 2e-5) << front << " " << back;
    }
  // Along the axis of the atlas, too, whatever the plane.
  const std::vector<float> texels = of_device(make_smooth(), make_settings(Integrator::kCylindrical, 512));
  const PreintegrationSettings& tables = settings.preintegration;
  for (int u = 0; u < tables.tile; ++u) {
    const optics::OpticalDensity density = exact.density(static_cast<double>(u) / (tables.tile - 1));
    EXPECT_NEAR(texels[4 * static_cast<std::size_t>(u) + 3], density[0] / exact.largest_extinction(), 2e-5) << u;
  }
}

/// Each step rounds by at most half a unit; what comes behind is only weakened. A colour has the errors of the opacity
/// before it as well.
TEST_F(TableMakerTest, BitsRoundEachStepAndWhatIsStored) {
  constexpr int kSteps = 16;
  RenderSettings settings = make_settings(Integrator::kTable3d, kSteps);
  settings.preintegration.length_spacing = LengthSpacing::kUniform;
  const std::vector<float> floats = of_device(make_smooth(), settings);
  const optics::SegmentDomain domain = optics::make_segment_domain(source_of(make_smooth()));
  const std::size_t layer = floats.size() / static_cast<std::size_t>(settings.preintegration.lengths);
  double before = 1.0;
  for (const int bits : {8, 12, 16}) {
    settings.preintegration.bits = bits;
    const double most = (1 << bits) - 1;
    const std::vector<float> rounded = of_device(make_smooth(), settings);
    for (std::size_t i = 0; i < rounded.size(); ++i) {
      const double number = static_cast<double>(rounded[i]);
      ASSERT_TRUE(number >= 0.0 && number <= 1.0);
      ASSERT_NEAR(number * most, std::round(number * most), 1e-2) << "bits: " << bits;
      const auto share = static_cast<float>(i / layer) / static_cast<float>(settings.preintegration.lengths - 1);
      const float bound = optics::eval_opacity_bound(domain, share * domain.longest);
      const double allowed = 0.51 / most + (bound > 0.0f ? kSteps / most / static_cast<double>(bound) : 0.0);
      ASSERT_NEAR(rounded[i], floats[i], allowed) << "bits: " << bits << ", share: " << share;
    }
    const double rms = compare(rounded, floats).rms;
    EXPECT_LE(rms, before / 8.0) << "bits: " << bits;
    before = rms;
  }
}

TEST_F(TableMakerTest, BitsHoldTexelsAndCoefficients) {
  for (const int bits : {8, 12, 16}) {
    const double most = (1 << bits) - 1;
    for (const float number : of_device(make_smooth(), make_settings(Integrator::kCylindrical, 16, bits)))
      ASSERT_NEAR(number * most, std::round(number * most), 1e-2) << "bits: " << bits;
    const RenderSettings settings = make_settings(Integrator::kPolynomial, 16, bits);
    const std::vector<float> maps = of_device(make_smooth(), settings);
    const double unit = optics::make_segment_domain(source_of(make_smooth())).largest_extinction / most;
    const std::size_t size = maps.size() / static_cast<std::size_t>(settings.preintegration.degree + 1);
    for (std::size_t begin = 0; begin < maps.size(); begin += size) {
      std::vector<float> colors;
      for (std::size_t i = begin; i < begin + size; ++i) {
        const double number = static_cast<double>(maps[i]);
        if (i % 4 == 3)
          ASSERT_NEAR(number / unit, std::round(number / unit), 1e-2) << "bits: " << bits;
        else
          colors.push_back(maps[i]);
      }
      const auto [least, largest] = std::ranges::minmax(colors);
      const double step = (static_cast<double>(largest) - static_cast<double>(least)) / most;
      for (const float color : colors) {
        const double place = (static_cast<double>(color) - static_cast<double>(least)) / step;
        ASSERT_NEAR(place, std::round(place), 2e-2) << "bits: " << bits << ", map at " << begin;
      }
    }
    EXPECT_EQ(read_ratios(make(make_smooth(), settings)), optics::make_absorbed_ratios(bits));
  }
}

TEST_F(TableMakerTest, NothingIsNothing) {
  OpticalFunction nothing = make_smooth();
  for (OpticalPoint& point : nothing.points) point.extinction = 0.0;
  for (const Integrator integrator : {Integrator::kTable3d, Integrator::kCylindrical})
    for (const float number : of_device(nothing, make_settings(integrator, 8))) ASSERT_EQ(number, 0.0f);
  // Colours stay, for what is beside them.
  const RenderSettings settings = make_settings(Integrator::kPolynomial, 256);
  EXPECT_LE(compare(of_device(nothing, settings), of_cpu(nothing, settings)).largest, 1e-4);
}

TEST_F(TableMakerTest, TablesDoNotDependOnThoseBefore) {
  std::vector<std::vector<float>> first;
  for (const Integrator integrator : kTableIntegrators) {
    first.push_back(of_device(make_smooth(), make_settings(integrator, 40)));
    maker_.emplace();
  }
  for (const std::size_t i : {2, 0, 1, 0, 2}) {
    RenderSettings other = make_settings(kTableIntegrators[(i + 1) % 3], 7, 8);
    other.preintegration.scalars = 60;
    make(make_linear(), other);
    EXPECT_EQ(of_device(make_smooth(), make_settings(kTableIntegrators[i], 40)), first[i])
        << name_of(kTableIntegrators[i]);
  }
}

TEST_F(TableMakerTest, LeavesTheViewportAndTheFramebufferToFrames) {
  glViewport(3, 5, 70, 90);
  for (const Integrator integrator : kTableIntegrators) {
    make(make_smooth(), make_settings(integrator, 4));
    std::array<GLint, 4> viewport{};
    glGetIntegerv(GL_VIEWPORT, viewport.data());
    EXPECT_EQ(viewport, (std::array<GLint, 4>{3, 5, 70, 90}));
    GLint framebuffer = -1;
    glGetIntegerv(GL_DRAW_FRAMEBUFFER_BINDING, &framebuffer);
    EXPECT_EQ(framebuffer, 0);
    EXPECT_FALSE(glIsEnabled(GL_BLEND));
  }
}

TEST_F(TableMakerTest, RefusesWhatTheDeviceCannotHold) {
  const OpticalFunction function = make_smooth();
  Limits small = context_->limits();
  small.texture_size = small.volume_size = 20;
  for (const Integrator integrator : kTableIntegrators) try {
      require_table_size(make_settings(integrator, 4), small);
      ADD_FAILURE() << name_of(integrator);
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::kUnsupported);
      EXPECT_NE(std::string(error.what()).find("at most 20"), std::string::npos) << error.what();
    }
}

TEST_F(TableMakerTest, StopsWhereItIsTold) {
  const OpticalFunction function = make_smooth();
  const std::atomic<bool> stop{true};
  optics::PreintegrationSource source = source_of(function);
  source.progress.cancelled = &stop;
  for (const Integrator integrator : {Integrator::kTable3d, Integrator::kPolynomial}) try {
      maker_->make(source, make_settings(integrator, 4));
      ADD_FAILURE() << name_of(integrator);
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::kCancelled);
    }
  // What was left half done disturbs nothing.
  const RenderSettings settings = make_settings(Integrator::kCylindrical, 256);
  EXPECT_LE(compare(of_device(function, settings), of_cpu(function, settings)).largest, 1e-4);
}

}  // namespace
}  // namespace tetravox::gl
