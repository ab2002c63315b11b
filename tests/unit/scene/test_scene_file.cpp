#include "tests/unit/optics/expect_error.h"
#include "tetravox/scene.h"
#include "tetravox/slicing.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <random>
#include <sstream>

namespace tetravox {
namespace {

using testing::expect_error;

const std::string kHead = R"({"tetravox":1,"data":{"file":"a.vtu"})";

Scene parse(const std::string& text) { return parse_scene(text, "scene.json"); }

void expect_bad(const std::string& text, const char* where, const char* what) {
  expect_error(
      ErrorCode::kBadFile, [&] { parse(text); }, "scene.json", where, what);
}

void expect_same(const Scene& a, const Scene& b) {
  EXPECT_EQ(a.data.file, b.data.file);
  EXPECT_EQ(a.data.solution_file, b.data.solution_file);
  EXPECT_EQ(a.data.array.name, b.data.array.name);
  EXPECT_EQ(a.data.array.association, b.data.array.association);
  EXPECT_EQ(a.data.array.component, b.data.array.component);
  EXPECT_EQ(a.data.time.index, b.data.time.index);
  EXPECT_EQ(a.data.time.value, b.data.time.value);
  EXPECT_EQ(a.data.raw.dimensions, b.data.raw.dimensions);
  EXPECT_EQ(a.data.raw.type, b.data.raw.type);
  EXPECT_EQ(a.data.raw.components, b.data.raw.components);
  EXPECT_EQ(a.data.raw.spacing, b.data.raw.spacing);
  EXPECT_EQ(a.data.raw.is_big_endian, b.data.raw.is_big_endian);
  EXPECT_EQ(a.data.raw.header_bytes, b.data.raw.header_bytes);
  ASSERT_EQ(a.transfer_function.has_value(), b.transfer_function.has_value());
  if (a.transfer_function) {
    EXPECT_EQ(a.transfer_function->absorption, b.transfer_function->absorption);
    EXPECT_EQ(a.transfer_function->unit_distance, b.transfer_function->unit_distance);
    ASSERT_EQ(a.transfer_function->points.size(), b.transfer_function->points.size());
    for (std::size_t i = 0; i < a.transfer_function->points.size(); ++i) {
      EXPECT_EQ(a.transfer_function->points[i].value, b.transfer_function->points[i].value);
      EXPECT_EQ(a.transfer_function->points[i].color, b.transfer_function->points[i].color);
      EXPECT_EQ(a.transfer_function->points[i].absorption, b.transfer_function->points[i].absorption);
    }
  }
  ASSERT_EQ(a.camera.has_value(), b.camera.has_value());
  if (a.camera) {
    EXPECT_EQ(a.camera->position, b.camera->position);
    EXPECT_EQ(a.camera->focal_point, b.camera->focal_point);
    EXPECT_EQ(a.camera->view_up, b.camera->view_up);
    EXPECT_EQ(a.camera->parallel_scale, b.camera->parallel_scale);
    if (!a.camera->parallel_scale) {
      EXPECT_EQ(a.camera->view_angle, b.camera->view_angle);
    }
  }
  EXPECT_EQ(a.background, b.background);
  EXPECT_EQ(a.settings.width, b.settings.width);
  EXPECT_EQ(a.settings.height, b.settings.height);
  EXPECT_EQ(a.settings.source, b.settings.source);
  EXPECT_EQ(a.settings.integrator, b.settings.integrator);
  EXPECT_EQ(a.settings.filter, b.settings.filter);
  EXPECT_EQ(a.settings.samples_per_voxel, b.settings.samples_per_voxel);
  EXPECT_EQ(a.settings.projection, b.settings.projection);
  EXPECT_EQ(a.settings.slicing.kind, b.settings.slicing.kind);
  EXPECT_EQ(a.settings.slicing.slices, b.settings.slicing.slices);
  EXPECT_EQ(a.settings.slicing.slabs, b.settings.slicing.slabs);
  EXPECT_EQ(a.settings.slicing.slices_per_voxel, b.settings.slicing.slices_per_voxel);
  EXPECT_EQ(a.settings.tolerance, b.settings.tolerance);
  EXPECT_EQ(a.settings.samples, b.settings.samples);
  EXPECT_EQ(a.settings.use_early_ray_termination, b.settings.use_early_ray_termination);
}

/// A layout of bytes with about half of its keys.
RawLayout random_layout(std::mt19937& random) {
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  const auto below = [&](double end) { return static_cast<std::uint32_t>(unit(random) * end); };
  RawLayout raw;
  if (unit(random) < 0.5) raw.dimensions = {1 + below(1e6), 1 + below(1e3), 1 + below(10)};
  if (unit(random) < 0.5) raw.type = static_cast<ScalarType>(below(10));
  if (unit(random) < 0.5) raw.components = 1 + static_cast<int>(below(4));
  if (unit(random) < 0.5) raw.spacing = {1e-9 + unit(random), 1.0 / 3, 1e12 * (1e-9 + unit(random))};
  if (unit(random) < 0.5) raw.is_big_endian = unit(random) < 0.5;
  if (unit(random) < 0.5) raw.header_bytes = below(4e9);
  return raw;
}

Scene random_scene(std::mt19937& random) {
  std::uniform_real_distribution<double> unit(0.0, 1.0), exponent(-300.0, 300.0);
  const auto number = [&] { return (unit(random) - 0.5) * std::pow(10.0, exponent(random)); };
  Scene scene;
  scene.data.file = "dir \"x\"/\xC3\xA9\t.vtu";
  scene.data.raw = random_layout(random);
  if (unit(random) < 0.3) scene.data.solution_file = "q.bin";
  if (unit(random) < 0.7) scene.data.array.name = "Density \\ (kg)";
  if (unit(random) < 0.7) scene.data.array.association = unit(random) < 0.5 ? Association::kPoint : Association::kCell;
  if (unit(random) < 0.7) scene.data.array.component = static_cast<int>(unit(random) * 4) - 1;
  if (unit(random) < 0.5)
    scene.data.time.index = static_cast<std::size_t>(unit(random) * 1e9);
  else
    scene.data.time.value = number();
  if (unit(random) < 0.8) {
    TransferFunction function;
    function.absorption = unit(random) < 0.5 ? Absorption::kOpacity : Absorption::kExtinction;
    if (unit(random) < 0.5) function.unit_distance = std::abs(number()) + 1e-300;
    double value = number();
    for (int i = 0; i < 20; ++i) {
      const double next = value + std::abs(number());
      if (std::isfinite(next)) value = next;
      function.points.push_back({value, {unit(random), unit(random), unit(random)}, unit(random)});
    }
    scene.transfer_function = function;
  }
  if (unit(random) < 0.8) {
    Camera camera;
    camera.position = {unit(random), -unit(random), 1.0 / 3};
    camera.focal_point = {unit(random) * 1e-5, 7.0, unit(random)};
    camera.view_up = {unit(random), unit(random), 3.0};
    camera.view_angle = 1.0 + 170.0 * unit(random);
    if (unit(random) < 0.5) camera.parallel_scale = std::abs(number()) + 1e-300;
    scene.camera = camera;
  }
  scene.background = {unit(random), unit(random), unit(random)};
  scene.settings.width = 1 + static_cast<int>(unit(random) * 16383);
  scene.settings.height = 1 + static_cast<int>(unit(random) * 16383);
  scene.settings.integrator = static_cast<Integrator>(static_cast<int>(unit(random) * 4));
  const auto pick = [&](int count) { return std::min(count - 1, static_cast<int>(unit(random) * count)); };
  if (unit(random) < 0.5)
    scene.settings.projection = {static_cast<CellSort>(pick(5)), static_cast<Decomposition>(pick(2)),
                                 unit(random) < 0.5, static_cast<MeshTransfer>(pick(2))};
  if (unit(random) < 0.7) scene.settings.source = unit(random) < 0.5 ? Source::kWalk : Source::kMarch;
  if (unit(random) < 0.3) {
    scene.settings.source = Source::kSlices;
    scene.settings.slicing.kind = static_cast<SlicingKind>(static_cast<int>(5.0 * unit(random)));
  }
  if (unit(random) < 0.5) scene.settings.slicing.slices = 1 + static_cast<int>(kMostSlices * 0.99 * unit(random));
  if (unit(random) < 0.5) scene.settings.slicing.slabs = SlabShape::kLinear;
  if (unit(random) < 0.5) scene.settings.slicing.slices_per_voxel = 0.01 + 63.0 * unit(random);
  scene.settings.filter.kind = static_cast<FilterKind>(static_cast<int>(unit(random) * 7));
  if (scene.settings.filter.kind == FilterKind::kLanczos)
    scene.settings.filter.radius = 2 + static_cast<int>(unit(random) * 7);
  if (unit(random) < 0.5) scene.settings.samples_per_voxel = 64.0 * (1.0 - unit(random));
  scene.settings.tolerance = 1e-6 + 0.9 * unit(random);
  scene.settings.samples = 1 + static_cast<int>(unit(random) * 4095);
  scene.settings.use_early_ray_termination = unit(random) < 0.5;
  return scene;
}

TEST(SceneFile, RoundTripsExactly) {
  std::mt19937 random(11);
  for (int round = 0; round < 300; ++round) {
    const Scene scene = random_scene(random);
    const std::string text = format_scene(scene);
    const Scene again = parse(text);
    expect_same(scene, again);
    EXPECT_EQ(text, format_scene(again));
  }
}

TEST(SceneFile, ReadsTheLeastThereCanBe) {
  const Scene scene = parse(kHead + "}");
  EXPECT_EQ(scene.data.file, "a.vtu");
  EXPECT_FALSE(scene.transfer_function);
  EXPECT_FALSE(scene.camera);
  EXPECT_EQ(scene.settings.width, 512);
}

TEST(SceneFile, ReadsEverything) {
  const Scene scene = parse(R"({"tetravox":1,
    "data":{"file":"builtin:duct","solution_file":"q","array":"V","association":"cell","component":"magnitude","time":{"index":3}},
    "transfer_function":{"points":[{"value":0,"color":[0,0,0],"opacity":0.5}],"unit_distance":2},
    "camera":{"position":[0,0,5],"focal_point":[0,0,0],"view_up":[0,1,0],"parallel_scale":3},
    "image":{"resolution":[300,200],"background":[0.1,0.2,0.3]},
    "render":{"source":"walk","integrator":"partial","tolerance":0.001,"samples":5,"early_ray_termination":false}})");
  EXPECT_EQ(scene.data.array.association, Association::kCell);
  EXPECT_EQ(scene.data.array.component, kMagnitude);
  EXPECT_EQ(scene.data.time.index, 3u);
  EXPECT_EQ(scene.transfer_function->unit_distance, 2.0);
  EXPECT_EQ(scene.camera->parallel_scale, 3.0);
  EXPECT_EQ(scene.settings.width, 300);
  EXPECT_EQ(scene.settings.height, 200);
  EXPECT_EQ(scene.background, (Color{0.1, 0.2, 0.3}));
  EXPECT_EQ(scene.settings.integrator, Integrator::kPartial);
  EXPECT_EQ(scene.settings.samples, 5);
  EXPECT_FALSE(scene.settings.use_early_ray_termination);
}

TEST(SceneFile, ReadsWhatGridsNeed) {
  const Scene scene = parse(R"({"tetravox":1,
    "data":{"file":"a.raw","dimensions":[4,5,6],"scalar_type":"uint16","components":3,"spacing":[1,1,2.5],
            "big_endian":true,"header_bytes":512},
    "render":{"source":"march","integrator":"pre","filter":"lanczos=4","samples_per_voxel":2.5}})");
  const RawLayout& raw = scene.data.raw;
  EXPECT_EQ(raw.dimensions, (std::array<std::uint32_t, 3>{4, 5, 6}));
  EXPECT_EQ(raw.type, ScalarType::kUint16);
  EXPECT_EQ(raw.components, 3);
  EXPECT_EQ(raw.spacing, (std::array<double, 3>{1, 1, 2.5}));
  EXPECT_EQ(raw.is_big_endian, true);
  EXPECT_EQ(raw.header_bytes, 512u);
  EXPECT_EQ(scene.settings.source, Source::kMarch);
  EXPECT_EQ(scene.settings.integrator, Integrator::kPre);
  EXPECT_EQ(scene.settings.filter, (Filter{FilterKind::kLanczos, 4}));
  EXPECT_EQ(scene.settings.samples_per_voxel, 2.5);

  const Scene open = parse(kHead + "}");
  EXPECT_FALSE(open.settings.source);
  EXPECT_EQ(open.settings.filter, Filter{});
  EXPECT_EQ(open.settings.samples_per_voxel, 0.0);
  EXPECT_FALSE(open.data.raw.dimensions || open.data.raw.type || open.data.raw.spacing || open.data.raw.is_big_endian);
}

TEST(SceneFile, KeepsTablesOfRayIntegrals) {
  const Scene scene =
      parse(kHead + R"(,"render":{"integrator":"polynomial=3","preintegration":{"scalars":300,"lengths":40,
    "length_spacing":"uniform","opacity":"linear","planes":9,"tile":17,"steps":5,"bits":12,"incremental":false}}})");
  EXPECT_EQ(scene.settings.integrator, Integrator::kPolynomial);
  const PreintegrationSettings wanted{.scalars = 300,
                                      .lengths = 40,
                                      .length_spacing = LengthSpacing::kUniform,
                                      .degree = 3,
                                      .opacity = OpacityModel::kLinear,
                                      .planes = 9,
                                      .tile = 17,
                                      .steps = 5,
                                      .bits = 12,
                                      .use_incremental = false};
  EXPECT_EQ(scene.settings.preintegration, wanted);
  const Scene again = parse(format_scene(scene));
  EXPECT_EQ(again.settings.integrator, Integrator::kPolynomial);
  EXPECT_EQ(again.settings.preintegration, wanted);
  EXPECT_EQ(format_scene(parse(kHead + "}")).find("preintegration"), std::string::npos);

  const auto render = [](const std::string& members) { return kHead + R"(,"render":{)" + members + "}}"; };
  expect_bad(render(R"("integrator":"polynomial=5")"), "render.integrator", "0 to 4");
  expect_bad(render(R"("integrator":"partial=2")"), "render.integrator", "has no number");
  expect_bad(render(R"("preintegration":{"bits":9})"), "render.preintegration", "8, 12, 16 or 32");
  expect_bad(render(R"("preintegration":{"length_spacing":"cubic"})"), "length_spacing", "logarithmic");
  expect_bad(render(R"("preintegration":{"size":9})"), "render.preintegration", "size");
}

TEST(SceneFile, SaysWhatIsWrongAboutGrids) {
  const auto expect_bad_data = [](const std::string& members, const char* where, const char* what) {
    expect_bad(R"({"tetravox":1,"data":{"file":"a.raw",)" + members + "}}", where, what);
  };
  expect_bad_data(R"("dimension":[1,1,1])", "data", "did you mean 'dimensions'");
  expect_bad_data(R"("dimensions":[1,1])", "data.dimensions", "three numbers");
  expect_bad_data(R"("dimensions":[4,0,4])", "data.dimensions[1]", "whole number");
  expect_bad_data(R"("dimensions":[4,4,4294967296])", "data.dimensions[2]", "whole number");
  expect_bad_data(R"("scalar_type":"byte")", "data.scalar_type", "uint8");
  expect_bad_data(R"("components":5)", "data.components", "4");
  expect_bad_data(R"("spacing":[1,1,0])", "data.spacing", "above 0");
  expect_bad_data(R"("spacing":[1,1])", "data.spacing", "");
  expect_bad_data(R"("big_endian":1)", "data.big_endian", "true or false");
  expect_bad_data(R"("header_bytes":-1)", "data.header_bytes", "whole number");
  expect_bad(kHead + R"(,"render":{"filter":"box"}})", "render.filter", "catmull-rom");
  expect_bad(kHead + R"(,"render":{"filter":"lanczos=9"}})", "render.filter", "lanczos");
  expect_bad(kHead + R"(,"render":{"samples_per_voxel":0}})", "render.samples_per_voxel", "64");
  expect_bad(kHead + R"(,"render":{"samples_per_voxel":65}})", "render.samples_per_voxel", "64");
}

TEST(SceneFile, WritesOnlyWhatTheDataNeeds) {
  const std::string text = format_scene(parse(kHead + "}"));
  for (const char* key : {"source", "filter", "samples_per_voxel", "dimensions", "header_bytes"})
    EXPECT_EQ(text.find(key), std::string::npos) << key;
}

TEST(SceneFile, ReadsTheScenesOfTheExactImages) {
  const std::filesystem::path directory = std::filesystem::path(TETRAVOX_SHARED_DIR) / "truth";
  if (!std::filesystem::is_directory(directory)) GTEST_SKIP() << "no exact images at " << directory;
  int count = 0;
  for (const auto& entry : std::filesystem::directory_iterator(directory)) {
    if (entry.path().extension() != ".json") continue;
    std::stringstream text;
    text << std::ifstream(entry.path()).rdbuf();
    const Scene scene = parse_scene(text.str(), entry.path().string());
    EXPECT_TRUE(scene.transfer_function && scene.camera) << entry.path();
    expect_same(scene, parse(format_scene(scene)));
    ++count;
  }
  EXPECT_GT(count, 0);
}

TEST(SceneFile, NamesUnknownKeysAndTheNearestKnownOne) {
  expect_bad(kHead + R"(,"camra":{}})", "'camra'", "did you mean 'camera'");
  expect_bad(kHead + R"(,"zzzzzz":{}})", "'zzzzzz'", "transfer_function");
  expect_bad(R"({"tetravox":1,"data":{"file":"a","aray":"b"}})", "data", "did you mean 'array'");
  expect_bad(kHead + R"(,"image":{"resolutoin":[1,1]}})", "image", "did you mean 'resolution'");
  expect_bad(kHead + R"(,"render":{"threads":3}})", "render", "'threads'");
  expect_bad(kHead + R"(,"camera":{"position":[0,0,1],"focal_point":[0,0,0],"viewup":[0,1,0]}})", "camera",
             "did you mean 'view_up'");
}

TEST(SceneFile, RefusesOtherVersions) {
  expect_bad(R"({"data":{"file":"a"}})", "'tetravox'", "missing");
  expect_bad(R"({"tetravox":2,"data":{"file":"a"}})", "version 1", "not 2");
  expect_bad(R"({"tetravox":"1","data":{"file":"a"}})", "version 1", "not");
  expect_bad(R"({"tetravox":1.0,"data":{"file":"a"}})", "version 1", "not");
}

TEST(SceneFile, SaysWhatIsWrongAndWhere) {
  expect_bad(R"({"tetravox":1})", "'data'", "missing");
  expect_bad(R"({"tetravox":1,"data":{}})", "data", "'file'");
  expect_bad(R"({"tetravox":1,"data":{"file":""}})", "data.file", "file name");
  expect_bad(R"({"tetravox":1,"data":{"file":"a\u0000b"}})", "data.file", "file name");
  expect_bad(R"({"tetravox":1,"data":{"file":3}})", "data.file", "a string");
  expect_bad(R"({"tetravox":1,"data":[]})", "data", "an object");
  expect_bad(R"({"tetravox":1,"data":{"file":"a","association":"both"}})", "data.association", "\"cell\"");
  expect_bad(R"({"tetravox":1,"data":{"file":"a","component":-1}})", "data.component", "whole number");
  expect_bad(R"({"tetravox":1,"data":{"file":"a","component":"x"}})", "data.component", "magnitude");
  expect_bad(R"({"tetravox":1,"data":{"file":"a","time":{}}})", "data.time", "either");
  expect_bad(R"({"tetravox":1,"data":{"file":"a","time":{"index":1,"value":2}}})", "data.time", "either");
  expect_bad(R"({"tetravox":1,"data":{"file":"a","time":{"index":1.5}}})", "data.time.index", "whole number");
  expect_bad(R"({"tetravox":1,"data":{"file":"a","time":{"index":18446744073709551615}}})", "data.time.index",
             "whole number");
  expect_bad(kHead + R"(,"image":{"resolution":[0,5]}})", "image.resolution[0]", "16384");
  expect_bad(kHead + R"(,"image":{"resolution":[5,16385]}})", "image.resolution[1]", "16384");
  expect_bad(kHead + R"(,"image":{"resolution":[5]}})", "image.resolution", "two numbers");
  expect_bad(kHead + R"(,"image":{"background":[0,0,2]}})", "image.background", "[0, 1]");
  expect_bad(kHead + R"(,"camera":{"focal_point":[0,0,0]}})", "camera", "'position'");
  expect_bad(kHead + R"(,"camera":{"position":[0,0,0],"focal_point":[0,0,0]}})", "camera", "the same");
  expect_bad(kHead + R"(,"camera":{"position":[0,0,1],"focal_point":[0,0,0],"view_angle":30,"parallel_scale":1}})",
             "camera", "not both");
  expect_bad(kHead + R"(,"camera":{"position":[0,0,1],"focal_point":[0,0,0],"view_angle":190}})", "camera",
             "view_angle");
  expect_bad(kHead + R"(,"render":{"integrator":"magic"}})", "render.integrator", "antiderivative");
  expect_bad(kHead + R"(,"render":{"source":"magic"}})", "render.source", "march");
  expect_bad(kHead + R"(,"render":{"tolerance":0}})", "render.tolerance", "[1e-7, 1]");
  expect_bad(kHead + R"(,"render":{"samples":5000}})", "render.samples", "4096");
  expect_bad(kHead + R"(,"render":{"early_ray_termination":1}})", "render.early_ray_termination", "true or false");
  expect_bad(kHead + R"(,"transfer_function":{"points":[{"value":0,"color":[0,0,0]}]}})", "transfer_function.points[0]",
             "either");
}

TEST(SceneFile, SurvivesHostileText) {
  expect_bad("", "not JSON", "");
  expect_bad("[]", "an object", "");
  expect_bad("null", "an object", "");
  expect_bad(kHead + ",}", "not JSON", "");
  expect_bad(kHead + R"(,"data":{"file":"b"}})", "'data'", "twice");
  expect_bad("/* comment */" + kHead + "}", "not JSON", "");
  expect_bad(kHead + R"(,"camera":{"position":[0,0,1e999],"focal_point":[0,0,0]}})", "not JSON", "1e999");
  expect_bad(std::string(1'000'000, '{'), "not JSON", "");
  expect_bad(kHead + R"(,"image":)" + std::string(100'000, '['), "deeper", "");
  const std::string whole = format_scene(parse(kHead + R"(,"render":{"samples":5}})"));
  for (std::size_t length = 0; length + 2 < whole.size(); ++length)
    EXPECT_THROW(parse(whole.substr(0, length)), Error) << length;
}

TEST(SceneFile, BitFlipsEndInASceneOrAnError) {
  const std::string whole = format_scene(parse(kHead + R"(,"image":{"resolution":[300,200]}})"));
  for (std::size_t i = 0; i < whole.size(); ++i)
    for (int bit = 0; bit < 8; ++bit) {
      std::string text = whole;
      text[i] = static_cast<char>(text[i] ^ (1 << bit));
      try {
        parse(text);
      } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::kBadFile);
      }
    }
}

TEST(RenderNames, GoThereAndBack) {
  for (const auto& [name, description] : integrator_names()) {
    EXPECT_EQ(name_of(integrator_from_name(name)), name);
    EXPECT_FALSE(description.empty());
  }
  for (const auto& [name, description] : slab_shape_names()) EXPECT_EQ(name_of(slab_shape_from_name(name)), name);
  for (const auto& [name, description] : slicing_kind_names()) {
    EXPECT_EQ(name_of(slicing_kind_from_name(name)), name);
    EXPECT_EQ(name_of(source_choice_from_name("slices=" + name)), "slices=" + name);
  }
  EXPECT_EQ(source_choice_from_name("slices").slicing, SlicingKind::kView3d);
  EXPECT_EQ(name_of(source_choice_from_name("march")), "march");
  EXPECT_THROW(source_choice_from_name("slices=4d"), Error);
  for (const auto& [name, description] : source_names()) EXPECT_EQ(name_of(source_from_name(name)), name);
  expect_error(
      ErrorCode::kInvalidArgument, [] { integrator_from_name("magic"); }, "magic", "antiderivative, partial, post");
}

}  // namespace
}  // namespace tetravox
