/// Light, surfaces and clipping in scene files.

#include "tests/unit/optics/expect_error.h"
#include "tetravox/scene.h"

#include <gtest/gtest.h>

#include <string>
#include <variant>

namespace tetravox {
namespace {

using testing::expect_error;

Scene parse(const std::string& members) {
  return parse_scene(R"({"tetravox":1,"data":{"file":"a.vtu"},)" + members + "}", "scene.json");
}

void expect_bad(const std::string& members, const char* where, const char* what) {
  expect_error(
      ErrorCode::kBadFile, [&] { parse(members); }, "scene.json", where, what);
}

Scene make_full_scene() {
  Scene scene;
  scene.data.file = "a.vtu";
  Lighting& lighting = scene.settings.lighting;
  lighting.lights.push_back({});
  lighting.lights.push_back({LightKind::kDirectional, {1, 0.25, -0.1}, {}, {1, 0.5, 0.25}, 2.5});
  lighting.lights.push_back({LightKind::kPoint, {0, 0, -1}, {3, 4, 1e-3}, {0.1, 0.2, 0.3}, 0.7});
  lighting.material = {0.1, 0.6, 0.2, 12.5};
  lighting.gradient = GradientMethod::kCell;
  lighting.gradient_threshold = 0.3;
  lighting.is_two_sided = false;
  lighting.shadows = ShadowKind::kVolume;
  lighting.shadow_resolution = 96;
  lighting.ambient_occlusion = 33;
  lighting.occlusion_seed = 7;
  scene.settings.surfaces = {{0.1, {1, 0, 0}, {0, 1, 0}, 0.3, false}, {2.5, {0.5, 0.5, 0.5}, {0, 0, 1}, 1.0, true}};
  scene.settings.clipping.shapes = {{ClipPlane{{1, 2, 3}, {0, 0, -1}}, true},
                                    {ClipBox{{{{0, 1}, {-1, 0.5}, {2, 3}}}}, false},
                                    {ClipSphere{{0.1, 0.2, 0.3}, 4.5}, true},
                                    {ClipVolume{"mask.nrrd", "labels", 1.5}, false}};
  scene.settings.clipping.use_union = true;
  scene.settings.opacity_weight = OpacityWeight::kGradient;
  scene.settings.opacity_weight_scale = 0.05;
  return scene;
}

TEST(SceneEffects, ComeBackAsTheyWere) {
  const std::string text = format_scene(make_full_scene());
  const Scene scene = parse_scene(text, "scene.json");
  EXPECT_EQ(format_scene(scene), text);
  const Lighting& lighting = scene.settings.lighting;
  ASSERT_EQ(lighting.lights.size(), 3u);
  EXPECT_EQ(lighting.lights[1].kind, LightKind::kDirectional);
  EXPECT_EQ(lighting.lights[1].direction, (Vector3{1, 0.25, -0.1}));
  EXPECT_EQ(lighting.lights[2].position, (Vector3{3, 4, 1e-3}));
  EXPECT_EQ(lighting.lights[2].intensity, 0.7);
  EXPECT_EQ(lighting.material.shininess, 12.5);
  EXPECT_EQ(lighting.gradient, GradientMethod::kCell);
  EXPECT_FALSE(lighting.is_two_sided);
  EXPECT_EQ(lighting.shadows, ShadowKind::kVolume);
  EXPECT_EQ(lighting.ambient_occlusion, 33);
  ASSERT_EQ(scene.settings.surfaces.size(), 2u);
  EXPECT_EQ(scene.settings.surfaces[0].back_color, (Color{0, 1, 0}));
  EXPECT_FALSE(scene.settings.surfaces[0].is_two_sided);
  const Clipping& clipping = scene.settings.clipping;
  ASSERT_EQ(clipping.shapes.size(), 4u);
  EXPECT_TRUE(clipping.use_union);
  EXPECT_EQ(std::get<ClipBox>(clipping.shapes[1].shape).bounds[1].max, 0.5);
  EXPECT_FALSE(clipping.shapes[1].keeps_inside);
  EXPECT_EQ(std::get<ClipVolume>(clipping.shapes[3].shape).array, "labels");
  EXPECT_EQ(scene.settings.opacity_weight, OpacityWeight::kGradient);
}

TEST(SceneEffects, AreLeftOutWhereTheySayNothing) {
  Scene scene;
  scene.data.file = "a.vtu";
  const std::string text = format_scene(scene);
  for (const char* key : {"lighting", "surfaces", "clipping", "opacity_weight"})
    EXPECT_EQ(text.find(key), std::string::npos) << key;
}

TEST(SceneEffects, OneColourServesBothSides) {
  const Scene scene = parse(R"("surfaces":[{"value":1,"color":[0.1,0.2,0.3]}])");
  EXPECT_EQ(scene.settings.surfaces.at(0).front_color, (Color{0.1, 0.2, 0.3}));
  EXPECT_EQ(scene.settings.surfaces.at(0).back_color, (Color{0.1, 0.2, 0.3}));
}

TEST(SceneEffects, MistakesAreNamed) {
  expect_bad(R"("lighting":{"light":[]})", "lighting", "light");
  expect_bad(R"("lighting":{"lights":[{"kind":"sun"}]})", "lighting.lights[0].kind", "headlight");
  expect_bad(R"("lighting":{"lights":[{"kind":"point"}]})", "lighting.lights[0]", "position");
  expect_bad(R"("lighting":{"lights":[{"kind":"directional","direction":[0,0,0]}]})", "lighting", "direction");
  expect_bad(R"("lighting":{"material":{"ambient":1.5}})", "lighting", "ambient");
  expect_bad(R"("lighting":{"shadows":"soft"})", "lighting.shadows", "volume");
  expect_bad(R"("lighting":{"shadow_resolution":4})", "lighting.shadow_resolution", "8");
  expect_bad(R"("surfaces":[{"colour":[1,1,1]}])", "surfaces[0]", "colour");
  expect_bad(R"("surfaces":[{"value":1,"opacity":2}])", "surfaces", "opacity");
  expect_bad(R"("clipping":{"shapes":[{}]})", "clipping.shapes[0]", "plane");
  expect_bad(R"("clipping":{"shapes":[{"sphere":{"center":[0,0,0],"radius":0}}]})", "clipping", "radius");
  expect_bad(R"("clipping":{"shapes":[{"box":[[0,1],[1,0],[0,1]]}]})", "clipping", "box");
  expect_bad(R"("clipping":{"shapes":[],"combine":"xor"})", "clipping.combine", "union");
  expect_bad(R"("render":{"opacity_weight":"heavy"})", "render.opacity_weight", "gradient");
}

}  // namespace
}  // namespace tetravox
