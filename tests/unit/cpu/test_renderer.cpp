#include "tests/unit/cpu/test_mesh.h"
#include "tetravox/error.h"
#include "tetravox/render.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>

namespace tetravox {
namespace {

/// Gentle: the extinction grows slowly. Steep: shells a hundredth of the range thick, and a step.
OpticalFunction make_gentle() {
  return {{{0.0, 0.1, {0.1, 0.2, 0.9}}, {0.5, 0.6, {0.9, 0.8, 0.2}}, {1.0, 1.5, {1.0, 0.2, 0.1}}}};
}
OpticalFunction make_steep() {
  return {{{0.0, 0.0, {0, 0, 0}},
           {0.30, 0.0, {1, 0, 0}},
           {0.31, 40.0, {1, 0, 0}},
           {0.32, 0.0, {0, 1, 0}},
           {0.7, 0.0, {0, 0, 1}},
           {0.7, 3.0, {0, 0, 1}},
           {1.0, 3.0, {1, 1, 1}}}};
}
const Camera kCamera{{2.0, -4.0, 1.5}, {0, 0, 0}, {0, 0, 1}, 30.0, {}};

class SmallPictures : public testing::Test {
 protected:
  PreparedMesh mesh_ = cpu::make_test_mesh("sphere");

  Image draw(const OpticalFunction& function, RenderSettings settings, RenderStatistics* statistics = nullptr) {
    settings.width = 75;
    settings.height = 61;
    Renderer renderer(mesh_);
    renderer.set_transfer_function(function);
    return renderer.render(kCamera, settings, statistics);
  }
};

TEST_F(SmallPictures, AreTheSameBytesForAnyInstructionSetAndNumberOfThreads) {
  for (const OpticalFunction& function : {make_gentle(), make_steep()})
    for (const Integrator integrator : {Integrator::kAntiderivative, Integrator::kPartial, Integrator::kPost}) {
      RenderSettings settings;
      settings.integrator = integrator;
      const Image expected = draw(function, settings);
      for (const std::string& name : instruction_sets())
        for (const int threads : {1, 2, 3}) {
          settings.instruction_set = name;
          settings.threads = threads;
          EXPECT_EQ(draw(function, settings).pixels, expected.pixels)
              << name_of(integrator) << " " << name << " " << threads;
        }
    }
}

TEST_F(SmallPictures, CountSegmentsAndRays) {
  RenderStatistics statistics;
  draw(make_gentle(), {}, &statistics);
  EXPECT_GT(statistics.rays, 500u);
  EXPECT_GT(statistics.segments, statistics.rays);
  EXPECT_EQ(statistics.stopped_rays, 0u);
  EXPECT_EQ(statistics.instruction_set, instruction_sets().front());
}

TEST_F(SmallPictures, AgreeBetweenIntegrators) {
  RenderSettings settings;
  for (const OpticalFunction& function : {make_gentle(), make_steep()}) {
    settings.integrator = Integrator::kPartial;
    const Image exact = draw(function, settings);
    settings.integrator = Integrator::kAntiderivative;
    const Image image = draw(function, settings);
    for (std::size_t i = 0; i < exact.pixels.size(); ++i) EXPECT_NEAR(image.pixels[i], exact.pixels[i], 2e-3) << i;
  }
}

TEST_F(SmallPictures, AreRightWhereTheFieldCreepsFromNodeToNode) {
  // Steep towards the largest value, and all but level elsewhere: in most cells it changes by less than a node.
  const auto [least, most] = mesh_.scalar_range;
  for (Vertex& vertex : mesh_.vertices) {
    const double value = mesh_.scalar_offset + mesh_.scalar_scale * vertex.scalar;
    const double creeping = least + (most - least) * std::pow(std::max(value - least, 0.0) / (most - least), 12.0);
    vertex.scalar = static_cast<float>((creeping - mesh_.scalar_offset) / mesh_.scalar_scale);
  }
  const OpticalFunction function{
      {{0.0, 0.5, {0.1, 0.2, 0.9}}, {0.5, 3.0, {0.9, 0.8, 0.2}}, {1.0, 0.5, {1.0, 0.2, 0.1}}}};
  RenderSettings settings;
  settings.integrator = Integrator::kPartial;
  const Image exact = draw(function, settings);
  settings.integrator = Integrator::kAntiderivative;
  const Image image = draw(function, settings);
  for (std::size_t i = 0; i < exact.pixels.size(); ++i) EXPECT_NEAR(image.pixels[i], exact.pixels[i], 5e-4) << i;
}

TEST_F(SmallPictures, StopWhenCancelled) {
  const std::atomic<bool> cancelled{true};
  Renderer renderer(mesh_);
  renderer.set_transfer_function(make_gentle());
  EXPECT_THROW(renderer.render(kCamera, {}, nullptr, {.report = {}, .cancelled = &cancelled}), Error);
}

TEST_F(SmallPictures, AreOpaqueForAnyLargeExtinction) {
  for (const double extinction : {1e4, 1e30, 1e40, 1e300})
    for (const Integrator integrator : {Integrator::kAntiderivative, Integrator::kPartial, Integrator::kPost}) {
      RenderSettings settings;
      settings.integrator = integrator;
      const Image image = draw(
          {{{0.0, extinction, {0, 0, 1}}, {0.5, 0.5 * extinction, {0, 1, 0}}, {1.0, extinction, {1, 0, 0}}}}, settings);
      EXPECT_GT(image.pixel(37, 30)[3], 0.999f) << extinction << " " << name_of(integrator);
      for (const float value : image.pixels) EXPECT_TRUE(value >= 0.0f && value <= 1.0f) << value;
    }
}

TEST_F(SmallPictures, NeedASensibleFunction) {
  Renderer renderer(mesh_);
  const auto fails = [&](const OpticalFunction& function) {
    EXPECT_THROW(renderer.set_transfer_function(function), Error);
  };
  fails({});
  fails({{{1.0, 1.0, {0, 0, 0}}, {0.0, 1.0, {0, 0, 0}}}});
  fails({{{0.0, -1.0, {0, 0, 0}}}});
  fails({{{0.0, std::nan(""), {0, 0, 0}}}});
  fails({{{0.0, 1.0, {0, 2.0, 0}}}});
}

TEST_F(SmallPictures, NeedSensibleSettings) {
  const auto fails = [&](auto change) {
    RenderSettings settings;
    change(settings);
    Renderer renderer(mesh_);
    renderer.set_transfer_function(make_gentle());
    EXPECT_THROW(renderer.render(kCamera, settings), Error);
  };
  fails([](RenderSettings& s) { s.width = 0; });
  fails([](RenderSettings& s) { s.height = kLargestResolution + 1; });
  fails([](RenderSettings& s) { s.samples = 0; });
  fails([](RenderSettings& s) { s.tolerance = 0.0; });
  fails([](RenderSettings& s) { s.threads = -1; });
  fails([](RenderSettings& s) { s.instruction_set = "MMX"; });
  Renderer renderer(mesh_);
  EXPECT_THROW(renderer.render(kCamera, {}), Error) << "no transfer function yet";
}

class TablesOfRayIntegrals : public testing::Test {
 protected:
  PreparedMesh mesh_ = cpu::make_test_mesh("sphere");
  Renderer renderer_{mesh_};
  RenderSettings settings_;

  TablesOfRayIntegrals() {
    settings_.width = settings_.height = 16;
    settings_.integrator = Integrator::kTable3d;
    settings_.preintegration.scalars = 96;
    renderer_.set_transfer_function(make_gentle());
  }
  /// Seconds of making tables in a frame.
  double plan() {
    RenderStatistics statistics;
    renderer_.render(kCamera, settings_, &statistics);
    return statistics.plan_seconds;
  }
};

TEST_F(TablesOfRayIntegrals, AreMadeAnewOnlyWhereSomethingHasChanged) {
  const double first = plan();
  const auto plan_again = [&] { return std::min({plan(), plan(), plan()}); };
  EXPECT_LT(plan_again(), 0.1 * first);
  settings_.preintegration.planes = 3;  // of another integrator
  EXPECT_LT(plan_again(), 0.1 * first);
  renderer_.set_transfer_function(make_steep());
  EXPECT_GT(plan(), 0.1 * first);
  settings_.preintegration.bits = 8;
  EXPECT_GT(plan(), 0.1 * first);
  settings_.integrator = Integrator::kAntiderivative;
  EXPECT_LT(plan_again(), 0.1 * first);
}

TEST_F(TablesOfRayIntegrals, CountInBytesAndEstimates) {
  const auto bytes_with = [&](Integrator integrator) {
    settings_.integrator = integrator;
    plan();
    return renderer_.bytes();
  };
  const std::uint64_t without = bytes_with(Integrator::kAntiderivative);
  EXPECT_EQ(bytes_with(Integrator::kTable3d) - without, 96u * 96 * 64 * 16);
  EXPECT_EQ(bytes_with(Integrator::kPolynomial) - without, 3u * 96 * 96 * 16 + 4096);
  EXPECT_EQ(bytes_with(Integrator::kCylindrical) - without, 9u * 8 * 64 * 64 * 16);

  RenderSettings plain;
  settings_.integrator = Integrator::kTable3d;
  plain.width = plain.height = 16;
  EXPECT_EQ(estimate_render_memory(10, 10, settings_) - estimate_render_memory(10, 10, plain), 96u * 96 * 64 * 16);
}

TEST_F(TablesOfRayIntegrals, OutOfRangeAreRefused) {
  settings_.preintegration.scalars = 600;
  const auto message = [&] {
    try {
      plan();
    } catch (const Error& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_EQ(message(), "scalars of a three-dimensional table: 600 is not between 2 and 512");
  settings_.integrator = Integrator::kPolynomial;
  EXPECT_EQ(message(), "");
  settings_.preintegration.degree = 9;
  EXPECT_EQ(message(), "degree of the chromaticity: 9 is not between 0 and 4");
}

}  // namespace
}  // namespace tetravox
