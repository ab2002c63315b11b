/// Light, surfaces and clipping go into scene files and come back, whatever their numbers.

#include "tests/unit/optics/expect_error.h"
#include "tests/unit/scene/scene_text.h"
#include "tetravox/scene.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <random>
#include <string>
#include <type_traits>
#include <variant>
#include <vector>

namespace tetravox {
namespace {

using testing::expect_bad;
using testing::expect_error;
using testing::parse;

/// Numbers of any size, that no rounding on the way would leave as they are.
class Dice {
 public:
  double unit() { return std::uniform_real_distribution<double>(0.0, 1.0)(random_); }
  double number() { return (unit() - 0.5) * std::pow(10.0, 200.0 * (unit() - 0.5)); }
  double above_zero() { return 1e-300 + std::abs(number()); }
  bool coin() { return unit() < 0.5; }
  int below(int end) { return static_cast<int>(unit() * end); }
  Color color() { return {unit(), unit(), unit()}; }
  Vector3 vector() { return {number(), number(), number()}; }
  ValueRange range() {
    const double a = number(), b = number();
    return {std::min(a, b), std::max(a, b)};
  }
  std::uint64_t word() { return std::uniform_int_distribution<std::uint64_t>()(random_); }

 private:
  std::mt19937 random_{17};
};

Lighting random_lighting(Dice& dice) {
  Lighting lighting;
  for (int i = dice.below(4); i > 0; --i) {
    Light light;
    light.kind = static_cast<LightKind>(dice.below(3));
    light.direction = dice.vector();
    light.position = dice.vector();
    light.color = dice.color();
    light.intensity = dice.above_zero();
    lighting.lights.push_back(light);
  }
  if (dice.coin()) lighting.environment = {"sky/*.exr", 1e6 * dice.unit(), dice.number(), dice.vector()};
  lighting.material = {dice.unit(), dice.unit(), dice.unit(), 1.0 + 999.0 * dice.unit()};
  lighting.gradient = static_cast<GradientMethod>(dice.below(5));
  lighting.gradient_threshold = 100.0 * dice.unit();
  lighting.is_two_sided = dice.coin();
  lighting.shadows = static_cast<ShadowKind>(dice.below(3));
  lighting.shadow_resolution = 8 + dice.below(505);
  lighting.ambient_occlusion = dice.below(1025);
  lighting.occlusion_seed = dice.word();
  return lighting;
}

std::vector<Isosurface> random_surfaces(Dice& dice) {
  std::vector<Isosurface> surfaces;
  for (int i = dice.below(4); i > 0; --i) {
    Isosurface surface{dice.number(), dice.color(), dice.color(), dice.unit(), dice.coin()};
    if (dice.coin()) surface.back_color = surface.front_color;
    surfaces.push_back(surface);
  }
  return surfaces;
}

Clipping random_clipping(Dice& dice) {
  Clipping clipping;
  const int count = dice.below(6);
  clipping.use_union = count > 0 && dice.coin();
  for (int i = 0; i < count; ++i) {
    ClipShape shape;
    shape.keeps_inside = dice.coin();
    switch (dice.below(4)) {
      case 0:
        shape.shape = ClipPlane{dice.vector(), dice.vector()};
        break;
      case 1:
        shape.shape = ClipBox{{dice.range(), dice.range(), dice.range()}};
        break;
      case 2:
        shape.shape = ClipSphere{dice.vector(), dice.above_zero()};
        break;
      default:
        shape.shape = ClipVolume{"../mask.nrrd", dice.coin() ? "" : "label", dice.number()};
    }
    clipping.shapes.push_back(shape);
  }
  return clipping;
}

void expect_same(const Lighting& a, const Lighting& b) {
  ASSERT_EQ(a.lights.size(), b.lights.size());
  for (std::size_t i = 0; i < a.lights.size(); ++i) {
    const Light &one = a.lights[i], &other = b.lights[i];
    EXPECT_EQ(one.kind, other.kind);
    if (one.kind == LightKind::kDirectional) {
      EXPECT_EQ(one.direction, other.direction);
    }
    if (one.kind == LightKind::kPoint) {
      EXPECT_EQ(one.position, other.position);
    }
    EXPECT_EQ(one.color, other.color);
    EXPECT_EQ(one.intensity, other.intensity);
  }
  ASSERT_EQ(a.environment.has_value(), b.environment.has_value());
  if (a.environment) {
    EXPECT_EQ(a.environment->file, b.environment->file);
    EXPECT_EQ(a.environment->intensity, b.environment->intensity);
    EXPECT_EQ(a.environment->rotation, b.environment->rotation);
    EXPECT_EQ(a.environment->up, b.environment->up);
  }
  EXPECT_EQ(a.material.ambient, b.material.ambient);
  EXPECT_EQ(a.material.diffuse, b.material.diffuse);
  EXPECT_EQ(a.material.specular, b.material.specular);
  EXPECT_EQ(a.material.shininess, b.material.shininess);
  EXPECT_EQ(a.gradient, b.gradient);
  EXPECT_EQ(a.gradient_threshold, b.gradient_threshold);
  EXPECT_EQ(a.is_two_sided, b.is_two_sided);
  EXPECT_EQ(a.shadows, b.shadows);
  EXPECT_EQ(a.shadow_resolution, b.shadow_resolution);
  EXPECT_EQ(a.ambient_occlusion, b.ambient_occlusion);
  EXPECT_EQ(a.occlusion_seed, b.occlusion_seed);
}

void expect_same(const std::vector<Isosurface>& a, const std::vector<Isosurface>& b) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(a[i].value, b[i].value);
    EXPECT_EQ(a[i].front_color, b[i].front_color);
    EXPECT_EQ(a[i].back_color, b[i].back_color);
    EXPECT_EQ(a[i].opacity, b[i].opacity);
    EXPECT_EQ(a[i].is_two_sided, b[i].is_two_sided);
  }
}

void expect_same(const ValueRange& a, const ValueRange& b) {
  EXPECT_EQ(a.min, b.min);
  EXPECT_EQ(a.max, b.max);
}

void expect_same(const ClipPlane& a, const ClipPlane& b) {
  EXPECT_EQ(a.origin, b.origin);
  EXPECT_EQ(a.normal, b.normal);
}
void expect_same(const ClipBox& a, const ClipBox& b) {
  for (std::size_t axis = 0; axis < 3; ++axis) expect_same(a.bounds[axis], b.bounds[axis]);
}
void expect_same(const ClipSphere& a, const ClipSphere& b) {
  EXPECT_EQ(a.center, b.center);
  EXPECT_EQ(a.radius, b.radius);
}
void expect_same(const ClipVolume& a, const ClipVolume& b) {
  EXPECT_EQ(a.file, b.file);
  EXPECT_EQ(a.array, b.array);
  EXPECT_EQ(a.value, b.value);
}

void expect_same(const Clipping& a, const Clipping& b) {
  EXPECT_EQ(a.use_union, b.use_union);
  ASSERT_EQ(a.shapes.size(), b.shapes.size());
  for (std::size_t i = 0; i < a.shapes.size(); ++i) {
    EXPECT_EQ(a.shapes[i].keeps_inside, b.shapes[i].keeps_inside);
    ASSERT_EQ(a.shapes[i].shape.index(), b.shapes[i].shape.index());
    std::visit(
        [&](const auto& shape) { expect_same(shape, std::get<std::decay_t<decltype(shape)>>(b.shapes[i].shape)); },
        a.shapes[i].shape);
  }
}

TEST(EffectRoundTrip, RoundTripExactly) {
  Dice dice;
  for (int round = 0; round < 300; ++round) {
    Scene scene;
    scene.data.file = "a.vtu";
    RenderSettings& settings = scene.settings;
    if (dice.coin()) settings.lighting = random_lighting(dice);
    settings.surfaces = random_surfaces(dice);
    settings.clipping = random_clipping(dice);
    settings.opacity_weight = static_cast<OpacityWeight>(dice.below(3));
    if (settings.opacity_weight != OpacityWeight::kNone) settings.opacity_weight_scale = dice.above_zero();

    const std::string text = format_scene(scene);
    const Scene again = parse_scene(text, "scene.json");
    expect_same(settings.lighting, again.settings.lighting);
    expect_same(settings.surfaces, again.settings.surfaces);
    expect_same(settings.clipping, again.settings.clipping);
    EXPECT_EQ(settings.opacity_weight, again.settings.opacity_weight);
    EXPECT_EQ(settings.opacity_weight_scale, again.settings.opacity_weight_scale);
    EXPECT_EQ(text, format_scene(again));
  }
}

TEST(EffectRoundTrip, AreWrittenOnlyWhenTheySaySomething) {
  Scene scene;
  scene.data.file = "a.vtu";
  EXPECT_EQ(format_scene(scene), R"({
  "tetravox": 1,
  "data": {
    "file": "a.vtu"
  },
  "image": {
    "resolution": [512,512],
    "background": [0.0,0.0,0.0]
  },
  "render": {
    "integrator": "antiderivative",
    "tolerance": 0.002,
    "samples": 8,
    "early_ray_termination": true
  }
}
)");
  scene.settings.lighting.ambient_occlusion = 8;
  EXPECT_NE(format_scene(scene).find("\"ambient_occlusion\": 8"), std::string::npos);
}

TEST(EffectRoundTrip, OneColourServesBothSides) {
  const Scene scene = parse(R"("surfaces":[{"value":1,"color":[0.1,0.2,0.3]}])");
  EXPECT_EQ(scene.settings.surfaces.at(0).front_color, (Color{0.1, 0.2, 0.3}));
  EXPECT_EQ(scene.settings.surfaces.at(0).back_color, (Color{0.1, 0.2, 0.3}));
}

TEST(EffectRoundTrip, SayWhatIsWrongAboutLighting) {
  const auto expect_bad_lighting = [](const std::string& members, const char* where, const char* what) {
    expect_bad("\"lighting\":{" + members + "}", where, what);
  };
  expect_bad_lighting(R"("light":[])", "lighting", "did you mean 'lights'");
  expect_bad_lighting(R"("lights":{})", "lighting.lights", "an array");
  expect_bad_lighting(R"("lights":[{}])", "lighting.lights[0]", "'kind'");
  expect_bad_lighting(R"("lights":[{"kind":"spot"}])", "lighting.lights[0].kind", "headlight, directional, point");
  expect_bad_lighting(R"("lights":[{"kind":"headlight","position":[0,0,0]}])", "lighting.lights[0]", "'position'");
  expect_bad_lighting(R"("lights":[{"kind":"directional"}])", "lighting.lights[0]", "'direction'");
  expect_bad_lighting(R"("lights":[{"kind":"directional","direction":[0,0,0]}])", "light 0, direction", "not all 0");
  expect_bad_lighting(R"("lights":[{"kind":"point"}])", "lighting.lights[0]", "'position'");
  expect_bad_lighting(R"("lights":[{"kind":"headlight","color":[0,0,2]}])", "light 0, color", "[0, 1]");
  expect_bad_lighting(R"("lights":[{"kind":"headlight","intensity":-1}])", "light 0, intensity", "from 0 up");
  expect_bad_lighting(R"("environment":{})", "lighting.environment", "'file'");
  expect_bad_lighting(R"("environment":{"file":""})", "lighting.environment.file", "file name");
  expect_bad_lighting(R"("environment":{"file":"a.exr","turn":1})", "lighting.environment", "'turn'");
  expect_bad_lighting(R"("environment":{"file":"a.exr","intensity":-1})", "environment, intensity",
                      "from 0 to 1000000");
  expect_bad_lighting(R"("environment":{"file":"a.exr","up":[0,0,0]})", "environment, up", "not all 0");
  expect_bad_lighting(R"("material":{"shiny":1})", "lighting.material", "'shiny'");
  expect_bad_lighting(R"("material":{"ambient":2})", "material, ambient", "from 0 to 1");
  expect_bad_lighting(R"("gradient":"sobel")", "lighting.gradient", "central");
  expect_bad_lighting(R"("gradient_threshold":-1)", "gradient threshold", "from 0 up");
  expect_bad_lighting(R"("two_sided":1)", "lighting.two_sided", "true or false");
  expect_bad_lighting(R"("shadows":"soft")", "lighting.shadows", "none, volume, exact");
  expect_bad_lighting(R"("shadow_resolution":4)", "lighting.shadow_resolution", "8");
  expect_bad_lighting(R"("ambient_occlusion":2000)", "lighting.ambient_occlusion", "1024");
  expect_bad_lighting(R"("occlusion_seed":-1)", "lighting.occlusion_seed", "whole number");
}

TEST(EffectRoundTrip, SayWhatIsWrongAboutSurfacesAndClipping) {
  expect_bad(R"("surfaces":{})", "surfaces", "an array");
  expect_bad(R"("surfaces":[{}])", "surfaces[0]", "'value'");
  expect_bad(R"("surfaces":[{"value":1,"colour":[0,0,0]}])", "surfaces[0]", "did you mean 'color'");
  expect_bad(R"("surfaces":[{"value":1,"color":[0,0,0],"back_color":[0,0,0]}])", "surfaces[0]", "both sides");
  expect_bad(R"("surfaces":[{"value":1},{"value":1,"opacity":1.5}])", "surface 1, opacity", "from 0 to 1");
  expect_bad(R"("surfaces":[{"value":1,"front_color":[0,0,-1]}])", "surface 0, front colour", "[0, 1]");

  const auto expect_bad_shape = [](const std::string& shape, const char* where, const char* what) {
    expect_bad("\"clipping\":{\"shapes\":[" + shape + "]}", where, what);
  };
  expect_bad(R"("clipping":{"combine":"xor"})", "clipping.combine", "\"union\"");
  expect_bad(R"("clipping":{"shape":[]})", "clipping", "did you mean 'shapes'");
  expect_bad(R"("clipping":{"combine":"union"})", "clipping", "'shapes'");
  expect_bad_shape("{}", "clipping.shapes[0]", "give one of");
  expect_bad_shape(R"({"box":[[0,1],[0,1],[0,1]],"sphere":{"center":[0,0,0],"radius":1}})", "clipping.shapes[0]",
                   "give one of");
  expect_bad_shape(R"({"cone":{}})", "clipping.shapes[0]", "'cone'");
  expect_bad_shape(R"({"box":[[0,1],[0,1],[0,1]],"keep":"both"})", "clipping.shapes[0].keep", "\"outside\"");
  expect_bad_shape(R"({"box":[[0,1],[0,1]]})", "clipping.shapes[0].box", "three pairs");
  expect_bad_shape(R"({"box":[[0,1],[0,1],[1,1]]})", "clip shape 0, box", "ascend");
  expect_bad_shape(R"({"box":[[0,1],[1,0],[0,1]]})", "clip shape 0, box", "ascend");
  expect_bad_shape(R"({"plane":{"origin":[0,0,0]}})", "clipping.shapes[0].plane", "'normal'");
  expect_bad_shape(R"({"plane":{"origin":[0,0,0],"normal":[0,0,0]}})", "clip shape 0, normal", "not all 0");
  expect_bad_shape(R"({"sphere":{"center":[0,0,0],"radius":0}})", "clip shape 0, radius", "above 0");
  expect_bad_shape(R"({"volume":{"array":"a"}})", "clipping.shapes[0].volume", "'file'");
  expect_bad_shape(R"({"volume":{"file":"a\u0000b"}})", "clipping.shapes[0].volume.file", "file name");
  expect_bad_shape(R"({"volume":{"file":""}})", "clipping.shapes[0].volume.file", "file name");
  expect_bad(R"("render":{"opacity_weight":"levoy"})", "render.opacity_weight", "scalar-difference");
  expect_bad(R"("render":{"opacity_weight_scale":0})", "render.opacity_weight_scale", "above 0");
}

}  // namespace
}  // namespace tetravox
