#include "src/optics/color_spaces.h"
#include "tests/unit/optics/expect_error.h"
#include "tetravox/transfer_function.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace tetravox {
namespace {

using testing::expect_error;

constexpr PresetOptions kUnitRange{{0.0, 1.0}, false, false};

TransferFunction parse(const std::string& text, const std::string& preset = "", bool rescale = false,
                       const PresetOptions& options = kUnitRange) {
  return parse_transfer_function(text, "colors.json", preset, options, rescale);
}

void expect_bad(const std::string& text, const char* where, const char* what) {
  expect_error(
      ErrorCode::kBadFile, [&] { parse(text); }, "colors.json", where, what);
}

/// Opacity and colour as the points say, linear in between.
ControlPoint eval(const TransferFunction& function, double value) {
  OpticalFunction linear;
  for (const ControlPoint& point : function.points)
    linear.points.push_back({point.value, point.absorption, point.color});
  const OpticalPoint point = eval_optical_function(linear, value);
  return {value, point.color, point.extinction};
}

TEST(SceneFunction, ReadsExtinctionsAndOpacities) {
  const auto extinction = parse(R"({"points":[{"value":1,"color":[0,0.5,1],"extinction":2.5}]})");
  EXPECT_EQ(extinction.absorption, Absorption::kExtinction);
  ASSERT_EQ(extinction.points.size(), 1u);
  EXPECT_EQ(extinction.points[0].color, (Color{0, 0.5, 1}));
  EXPECT_EQ(extinction.points[0].absorption, 2.5);
  const auto opacity = parse(
      R"({"points":[{"value":1,"color":[0,0,0],"opacity":0.5},{"value":1,"color":[1,1,1],"opacity":1}],"unit_distance":3})");
  EXPECT_EQ(opacity.absorption, Absorption::kOpacity);
  EXPECT_EQ(opacity.unit_distance, 3.0);
}

TEST(SceneFunction, IsFoundInsideAScene) {
  const auto function = parse(
      R"({"tetravox":1,"data":{"file":"a"},"transfer_function":{"points":[{"value":1,"color":[0,0,0],"opacity":0.5}]}})");
  EXPECT_EQ(function.points.size(), 1u);
}

TEST(SceneFunction, InvertMirrorsColorsAndKeepsExtinctions) {
  const std::string text =
      R"({"points":[{"value":0,"color":[0,0,0],"extinction":1},{"value":1,"color":[1,0,0],"extinction":7},{"value":4,"color":[1,1,0],"extinction":2}]})";
  const auto plain = parse(text), inverted = parse(text, "", false, {{0, 1}, false, true});
  for (const double value : {0.0, 0.5, 1.0, 2.2, 3.0, 3.7, 4.0}) {
    EXPECT_NEAR(eval(inverted, value).absorption, eval(plain, value).absorption, 1e-9);
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(eval(inverted, value).color[c], eval(plain, 4 - value).color[c], 1e-9);
  }
}

TEST(SceneFunction, SaysWhatIsWrongAndWhere) {
  expect_bad(R"({"points":[]})", "points", "expected");
  expect_bad(R"({"points":{}})", "points", "expected an array");
  expect_bad(R"({})", "'points'", "missing");
  expect_bad(R"({"points":[{"value":1,"color":[0,0,0]}]})", "points[0]", "either 'extinction' or 'opacity'");
  expect_bad(R"({"points":[{"value":1,"color":[0,0,0],"opacity":0,"extinction":1}]})", "points[0]", "either");
  expect_bad(R"({"points":[{"value":1,"color":[0,0],"opacity":0}]})", "points[0].color", "3 numbers");
  expect_bad(R"({"points":[{"value":1,"color":[0,0,"x"],"opacity":0}]})", "points[0].color[2]", "a number");
  expect_bad(R"({"points":[{"value":"1","color":[0,0,0],"opacity":0}]})", "points[0].value", "a number");
  expect_bad(R"({"points":[{"value":1,"color":[0,0,0],"opacity":2}]})", "point 0", "opacity");
  expect_bad(R"({"points":[{"value":1,"colour":[0,0,0],"opacity":0}]})", "points[0]", "did you mean 'color'");
  expect_bad(R"({"points":[{"value":1,"color":[0,0,0],"opacity":0},{"value":2,"color":[0,0,0],"extinction":0}]})",
             "points[1]", "same key");
  expect_bad(R"({"points":[{"value":2,"color":[0,0,0],"opacity":0},{"value":1,"color":[0,0,0],"opacity":0}]})",
             "point 1", "ascend");
  expect_bad(R"({"points":[{"value":1,"color":[0,0,0],"opacity":0}],"unit_distance":0})", "unit_distance", "above 0");
}

TEST(HostileText, EndsInAnErrorAndNothingElse) {
  expect_bad("", "not JSON", "line 1");
  expect_bad("{", "not JSON", "line 1");
  expect_bad("nonsense", "not JSON", "");
  expect_bad("3", "expected a transfer function", "");
  expect_bad("null", "expected a transfer function", "");
  expect_bad("// comment\n{}", "not JSON", "");
  expect_bad(R"({"points":[{"value":1e400,"color":[0,0,0],"opacity":0}]})", "not JSON", "1e400");
  expect_bad(R"({"points":[{"value":NaN,"color":[0,0,0],"opacity":0}]})", "not JSON", "");
  expect_bad(R"({"a":1,"a":2})", "'a'", "twice");
  expect_bad(R"([{"Name":"x","RGBPoints":[0,0,0,0],"b":{"c":1,"c":2}}])", "'c'", "twice");
  expect_bad("\xff\xfe", "not JSON", "");
  expect_bad(std::string("{\"points\0\":1}", 13), "not JSON", "");
  expect_bad(std::string(100'000, '['), "deeper", "32");
  expect_bad("[" + std::string(9'000'000, ' '), "not JSON", "");
  std::string many = "[0";
  for (int i = 0; i < 4'100'000; ++i) many += ",0";
  expect_bad(many + "]", "4 million", "");
  expect_bad(std::string((std::size_t{64} << 20) + 1, ' '), "64 MiB", "");
}

TEST(HostileText, TooManyPointsAreRefused) {
  std::string text = R"({"Name":"x","RGBPoints":[0,0,0,0)";
  for (int i = 0; i < 100'000; ++i) text += ",0,0,0,0";
  expect_bad(text + "]}", "RGBPoints", "100000 points");
}

TEST(ParaView, ReadsASingleObjectAndAList) {
  const std::string object = R"({"Name":"a","ColorSpace":"RGB","NanColor":[1,1,0],"Creator":"x",
    "RGBPoints":[0,0,0,0, 10,1,1,1],"Points":[0,0,0.5,0, 10,1,0.5,0]})";
  for (const std::string& text : {object, "[" + object + "]"}) {
    const auto function = parse(text);
    EXPECT_EQ(function.absorption, Absorption::kOpacity);
    ASSERT_EQ(function.points.size(), 3u);  // the ends and the midpoint of the opacity
    EXPECT_NEAR(eval(function, 2.5).absorption, 0.25, 1e-12);
    EXPECT_NEAR(eval(function, 2.5).color[1], 0.25, 1e-12);
  }
}

TEST(ParaView, PicksByNameAndListsNames) {
  const std::string list = R"([{"Name":"first","RGBPoints":[0,1,0,0]},{"Name":"second","RGBPoints":[0,0,1,0]}])";
  EXPECT_EQ(parse(list, "second").points[0].color, (Color{0, 1, 0}));
  expect_error(
      ErrorCode::kBadFile, [&] { parse(list, "third"); }, "'third'", "first, second");
  expect_error(
      ErrorCode::kBadFile, [&] { parse(list); }, "2 presets", "first, second");
  expect_error(
      ErrorCode::kBadFile, [&] { parse("[]"); }, "empty");
}

TEST(ParaView, MergesColorsAndOpacitiesAtTheUnionOfTheirValues) {
  const auto function = parse(R"({"RGBPoints":[0,0,0,0, 4,1,0,0],"Points":[1,0.2,0.5,0, 3,0.6,0.5,0]})");
  EXPECT_NEAR(eval(function, 0.5).absorption, 0.2, 1e-12);
  EXPECT_NEAR(eval(function, 0.5).color[0], 0.125, 1e-12);
  EXPECT_NEAR(eval(function, 2.0).absorption, 0.4, 1e-12);
  EXPECT_NEAR(eval(function, 3.5).absorption, 0.6, 1e-12);
  EXPECT_NEAR(eval(function, 3.5).color[0], 0.875, 1e-12);
}

TEST(ParaView, RescalesColorsAndOpacitiesFromTheirOwnRanges) {
  const std::string text = R"({"RGBPoints":[-1,0,0,0, 3,1,0,0],"Points":[0,0,0.5,0, 255,1,0.5,0]})";
  const auto function = parse(text, "", true, {{10, 20}, false, false});
  EXPECT_EQ(function.points.front().value, 10);
  EXPECT_EQ(function.points.back().value, 20);
  EXPECT_NEAR(eval(function, 12).absorption, 0.2, 1e-9);
  EXPECT_NEAR(eval(function, 12).color[0], 0.2, 1e-9);
  const auto logarithmic = parse(text, "", true, {{1, 10000}, true, false});
  EXPECT_NEAR(eval(logarithmic, 100).absorption, 0.5, 1.0 / 1024);
  EXPECT_NEAR(eval(logarithmic, 10).color[0], 0.25, 1.0 / 512);
  const auto inverted = parse(text, "", true, {{0, 1}, false, true});
  EXPECT_NEAR(eval(inverted, 0.2).color[0], 0.8, 1e-9);
  EXPECT_NEAR(eval(inverted, 0.2).absorption, 0.2, 1e-9);
}

TEST(ParaView, RefinesColorSpacesWithinTheirTolerance) {
  const Color a{0.9, 0.1, 0.3}, b{0.1, 0.2, 0.6};
  for (const char* name : {"RGB", "HSV", "Lab", "CIELAB", "Lab/CIEDE2000", "Diverging"}) {
    const auto function =
        parse(std::string(R"({"RGBPoints":[0,0.9,0.1,0.3, 1,0.1,0.2,0.6],"ColorSpace":")") + name + "\"}");
    const auto space = *optics::color_space_from_name(name);
    EXPECT_LT(function.points.size(), 300u) << name;
    for (int i = 0; i <= 1000; ++i) {
      const Color exact = optics::mix_colors(space, a, b, i / 1000.0), found = eval(function, i / 1000.0).color;
      for (int c = 0; c < 3; ++c) EXPECT_NEAR(found[c], exact[c], 1.0 / 512) << name << " at " << i;
    }
  }
}

TEST(ParaView, HonoursHsvWrap) {
  const std::string head = R"({"RGBPoints":[0,0.9,0.1,0.3, 1,0.9,0.8,0.1],"ColorSpace":"HSV")";
  EXPECT_NEAR(eval(parse(head + "}"), 0.5).color[0], 0.1, 0.003);
  EXPECT_NEAR(eval(parse(head + R"(,"HSVWrap":0})"), 0.5).color[0], 0.1, 0.003);
  EXPECT_NEAR(eval(parse(head + R"(,"HSVWrap":1})"), 0.5).color[0], 0.9, 0.003);
  EXPECT_NEAR(eval(parse(head + R"(,"HSVWrap":true})"), 0.5).color[0], 0.9, 0.003);
}

TEST(ParaView, StepsHaveTheColorOfTheirUpperEnd) {
  const auto function = parse(R"({"RGBPoints":[0,1,0,0, 1,0,1,0, 2,0,0,1],"ColorSpace":"Step"})");
  EXPECT_EQ(eval(function, -1).color, (Color{1, 0, 0}));
  EXPECT_EQ(eval(function, 0.01).color, (Color{0, 1, 0}));
  EXPECT_EQ(eval(function, 0.99).color, (Color{0, 1, 0}));
  EXPECT_EQ(eval(function, 1.01).color, (Color{0, 0, 1}));
  EXPECT_EQ(eval(function, 3).color, (Color{0, 0, 1}));
  const auto inverted =
      parse(R"({"RGBPoints":[0,1,0,0, 1,0,1,0, 2,0,0,1],"ColorSpace":"Step"})", "", false, {{0, 1}, false, true});
  EXPECT_EQ(eval(inverted, 0.99).color, (Color{0, 0, 1}));
  EXPECT_EQ(eval(inverted, 1.99).color, (Color{0, 1, 0}));
  EXPECT_EQ(eval(inverted, 3).color, (Color{1, 0, 0}));
}

TEST(ParaView, KeepsStepsOfRepeatedValues) {
  const auto function = parse(
      R"({"RGBPoints":[0,1,0,0, 1,1,0,0, 1,0,0,1, 2,0,0,1],"Points":[0,0,0.5,0, 1,0,0.5,0, 1,1,0.5,0, 2,1,0.5,0]})");
  EXPECT_EQ(eval(function, 0.999).color, (Color{1, 0, 0}));
  EXPECT_EQ(eval(function, 1.001).color, (Color{0, 0, 1}));
  EXPECT_EQ(eval(function, 0.999).absorption, 0.0);
  EXPECT_EQ(eval(function, 1.001).absorption, 1.0);
}

// Expected: vtkPiecewiseFunction of VTK 9.1 from (0, 0.1) to (1, 0.9).
TEST(ParaView, HonoursMidpointAndSharpnessAsVtk) {
  struct Case {
    double midpoint, sharpness;
    double opacities[5];
  };
  const double values[5] = {0.1, 0.25, 0.45, 0.75, 0.9};
  for (const Case& c : {Case{0.5, 0, {0.180000, 0.300000, 0.460000, 0.700000, 0.820000}},
                        Case{0.2, 0, {0.300000, 0.525000, 0.625000, 0.775000, 0.850000}},
                        Case{0.7, 0.5, {0.100002, 0.100416, 0.115576, 0.803130, 0.899725}},
                        Case{0.3, 0.2, {0.112014, 0.317621, 0.721113, 0.885178, 0.899066}},
                        Case{0.5, 1, {0.100000, 0.100000, 0.100000, 0.900000, 0.900000}},
                        Case{0.9, 0.98, {0.100000, 0.100000, 0.100005, 0.112040, 0.500000}}}) {
    const auto function = parse(R"({"RGBPoints":[0,0,0,0, 1,1,1,1],"Points":[0,0.1,)" + std::to_string(c.midpoint) +
                                "," + std::to_string(c.sharpness) + ",1,0.9,0.5,0]}");
    for (int i = 0; i < 5; ++i)
      EXPECT_NEAR(eval(function, values[i]).absorption, c.opacities[i], 1.0 / 2048)
          << c.midpoint << " " << c.sharpness << " at " << values[i];
  }
}

TEST(ParaView, SortsPointsThatAreOutOfOrder) {
  const auto function = parse(R"({"RGBPoints":[1,1,1,1, 0,0,0,0],"Points":[1,1,0.5,0, 0,0,0.5,0]})");
  EXPECT_NEAR(eval(function, 0.25).color[0], 0.25, 1e-12);
  EXPECT_NEAR(eval(function, 0.25).absorption, 0.25, 1e-12);
}

TEST(ParaView, SurvivesASinglePoint) {
  for (const bool rescale : {false, true}) {
    const auto function = parse(R"({"RGBPoints":[3,1,0.5,0]})", "", rescale);
    EXPECT_NO_THROW(make_optical_function(function, 1.0));
    EXPECT_EQ(function.points[0].color, (Color{1, 0.5, 0}));
  }
}

TEST(ParaView, SaysWhatIsWrongAndWhere) {
  expect_bad(R"({"RGBPoints":[0,0,0]})", "RGBPoints", "four numbers");
  expect_bad(R"({"RGBPoints":[]})", "RGBPoints", "four numbers");
  expect_bad(R"({"RGBPoints":[0,0,300,0]})", "RGBPoints[2]", "[0, 1]");
  expect_bad(R"({"RGBPoints":[0,0,null,0]})", "RGBPoints[2]", "a number");
  expect_bad(R"({"RGBPoints":[0,0,0,0],"Points":[0,0,0]})", "Points", "four numbers");
  expect_bad(R"({"RGBPoints":[0,0,0,0],"Points":[0,0,0,7]})", "Points[3]", "sharpness");
  expect_bad(R"({"RGBPoints":[0,0,0,0],"ColorSpace":"CMYK"})", "ColorSpace", "CMYK");
  expect_bad(R"({"RGBPoints":[0,0,0,0],"ColorSpace":3})", "ColorSpace", "a string");
  expect_bad(R"({"IndexedColors":[0,0,0]})", "IndexedColors", "RGBPoints");
  expect_bad(R"([{"Name":"a"}])", "[0]", "'RGBPoints' is missing");
  expect_bad(R"([3])", "[0]", "an object");
}

}  // namespace
}  // namespace tetravox
