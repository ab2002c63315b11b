#include "src/optics/color_maps.h"

#include "src/optics/color_spaces.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace tetravox::optics {
namespace {

using Table = std::array<std::uint32_t, 65>;

// Sixty-five equidistant colours (0xRRGGBB) of each map. Within 1/256 of matplotlib's tables of 256 colours
// (cividis, which is bent at its dark end: 1/116; plasma: 1/177). viridis, plasma, inferno, magma: van der Walt and
// Smith 2015, CC0. cividis: Nunez, Anderton, Renslow 2018. turbo: Mikhailov 2019.

constexpr Table kViridis{
    0x440154, 0x46065a, 0x470d60, 0x471365, 0x48186a, 0x481d6f, 0x482374, 0x482878, 0x472d7b, 0x46327e, 0x453681,
    0x443b84, 0x424086, 0x404587, 0x3f4989, 0x3d4e8a, 0x3b528b, 0x39568c, 0x375a8d, 0x355e8d, 0x33638d, 0x31668e,
    0x2f6a8e, 0x2e6e8e, 0x2c728e, 0x2b768e, 0x297a8e, 0x287d8e, 0x26818e, 0x25858e, 0x23898e, 0x228c8d, 0x21908c,
    0x20948c, 0x1f988b, 0x1e9b8a, 0x1f9f88, 0x20a387, 0x21a685, 0x24aa83, 0x28ae80, 0x2cb17e, 0x31b57b, 0x37b877,
    0x3ebc74, 0x45bf70, 0x4cc26c, 0x54c667, 0x5dc963, 0x65cc5d, 0x6ece58, 0x78d152, 0x82d34c, 0x8cd646, 0x96d83f,
    0xa0da39, 0xabdc32, 0xb5de2b, 0xc0df24, 0xcbe11f, 0xd5e21a, 0xe0e318, 0xeae51a, 0xf4e61e, 0xfde725};

constexpr Table kPlasma{
    0x0d0887, 0x19068b, 0x220690, 0x2a0593, 0x310596, 0x380499, 0x3f049c, 0x46039f, 0x4c02a1, 0x5302a3, 0x5901a5,
    0x5f01a6, 0x6600a7, 0x6c00a8, 0x7201a8, 0x7801a8, 0x7e03a8, 0x8405a7, 0x8909a6, 0x8f0da4, 0x9511a2, 0x9a169f,
    0x9f1a9c, 0xa41e99, 0xa92396, 0xae2792, 0xb22c8e, 0xb7308b, 0xbb3587, 0xbf3983, 0xc33e80, 0xc7427c, 0xcb4778,
    0xcf4b75, 0xd25071, 0xd6546d, 0xd9596a, 0xdc5e67, 0xe06263, 0xe36760, 0xe66c5c, 0xe87059, 0xeb7555, 0xee7a52,
    0xf07f4f, 0xf2844b, 0xf48a48, 0xf68f44, 0xf89441, 0xf99a3d, 0xfb9f3a, 0xfca537, 0xfdab33, 0xfdb130, 0xfeb72d,
    0xfebd2a, 0xfdc328, 0xfdca26, 0xfcd025, 0xfbd724, 0xf9dd25, 0xf7e426, 0xf5eb27, 0xf2f227, 0xf0f921};

constexpr Table kInferno{
    0x000004, 0x02010a, 0x040312, 0x07051b, 0x0b0724, 0x10092d, 0x150b37, 0x1a0c40, 0x210c4a, 0x270b53, 0x2e0a5a,
    0x360960, 0x3c0965, 0x430a68, 0x4a0c6b, 0x500e6c, 0x57106d, 0x5d126e, 0x63146e, 0x6a176e, 0x70196e, 0x761b6d,
    0x7d1e6d, 0x83206b, 0x89226a, 0x902468, 0x962766, 0x9c2964, 0xa32b61, 0xa92e5f, 0xaf315c, 0xb53458, 0xbb3755,
    0xc13a51, 0xc63e4d, 0xcc4149, 0xd14644, 0xd64a40, 0xdb4f3b, 0xdf5437, 0xe35932, 0xe75f2d, 0xeb6528, 0xee6b23,
    0xf1711e, 0xf47819, 0xf67f14, 0xf8860f, 0xf98d0a, 0xfa9407, 0xfb9c06, 0xfca309, 0xfcab0f, 0xfcb217, 0xfbba1f,
    0xfac228, 0xf9ca32, 0xf7d23d, 0xf5d949, 0xf3e156, 0xf2e865, 0xf1ef75, 0xf3f586, 0xf6fa96, 0xfcffa4};

constexpr Table kMagma{
    0x000004, 0x020109, 0x030311, 0x06051a, 0x0a0822, 0x0e0b2b, 0x130d33, 0x180f3d, 0x1d1146, 0x221150, 0x28115a,
    0x2f1163, 0x36106a, 0x3d0f71, 0x430f76, 0x4a1079, 0x50127c, 0x57147e, 0x5d177f, 0x631980, 0x691c81, 0x6f1e81,
    0x762181, 0x7c2382, 0x822681, 0x892881, 0x8f2a81, 0x952c80, 0x9c2e7f, 0xa2307e, 0xa9327d, 0xaf347b, 0xb63779,
    0xbc3977, 0xc33b75, 0xc93e72, 0xcf4170, 0xd6446d, 0xdb486a, 0xe14c66, 0xe65163, 0xea5661, 0xee5c5e, 0xf2635d,
    0xf5695c, 0xf7715c, 0xf9785d, 0xfa805e, 0xfb8761, 0xfc8f64, 0xfd9668, 0xfe9e6c, 0xfea571, 0xfead76, 0xfeb47b,
    0xfebb81, 0xfec387, 0xfeca8d, 0xfed194, 0xfed99b, 0xfde0a2, 0xfde7a9, 0xfceeb0, 0xfcf6b8, 0xfcfdbf};

constexpr Table kCividis{
    0x00224e, 0x002554, 0x00285b, 0x002b62, 0x002e6a, 0x003070, 0x043371, 0x113570, 0x1a386f, 0x213b6e, 0x273e6e,
    0x2d416d, 0x32436d, 0x36466c, 0x3b496c, 0x3f4c6c, 0x434e6c, 0x47516c, 0x4b546c, 0x4f576c, 0x52596d, 0x565c6d,
    0x5a5f6e, 0x5d626e, 0x61656f, 0x646770, 0x686a71, 0x6b6d72, 0x6f7073, 0x727374, 0x757676, 0x797877, 0x7c7b78,
    0x807e78, 0x848179, 0x878478, 0x8b8778, 0x8f8a78, 0x938d78, 0x979077, 0x9b9376, 0x9f9676, 0xa39a75, 0xa79d74,
    0xaba072, 0xafa371, 0xb3a670, 0xb7aa6e, 0xbbad6c, 0xbfb06b, 0xc3b469, 0xc8b766, 0xccba64, 0xd0be61, 0xd4c15f,
    0xd9c55c, 0xddc958, 0xe1cc55, 0xe6d051, 0xead44c, 0xefd748, 0xf4db42, 0xf8df3c, 0xfde334, 0xfee838};

constexpr Table kTurbo{
    0x30123b, 0x351e58, 0x392a73, 0x3d358b, 0x4040a1, 0x424bb5, 0x4456c7, 0x4661d6, 0x466be3, 0x4775ee, 0x467ff6,
    0x4589fc, 0x4293ff, 0x3d9dfe, 0x37a7fa, 0x30b1f4, 0x29bbec, 0x22c4e3, 0x1dcdd8, 0x19d5ce, 0x18dcc3, 0x19e3b9,
    0x1ee8b0, 0x26eda5, 0x31f299, 0x3ef68c, 0x4cf97e, 0x5cfb71, 0x6bfd64, 0x7bfe58, 0x8aff4d, 0x97fe43, 0xa3fd3c,
    0xadfa38, 0xb8f735, 0xc2f234, 0xcced34, 0xd5e635, 0xdee037, 0xe6d838, 0xedd03a, 0xf3c83a, 0xf8c03a, 0xfbb738,
    0xfdae35, 0xfea331, 0xfe982c, 0xfd8c27, 0xfb8022, 0xf9741d, 0xf56817, 0xf15d13, 0xec520f, 0xe6490b, 0xe04009,
    0xd93807, 0xd23105, 0xca2a04, 0xc02302, 0xb71d02, 0xac1701, 0xa11101, 0x950d01, 0x880802, 0x7a0403};

constexpr std::array<ColorMapEntry, 10> kMaps{{
    {"viridis", "dark violet, green, yellow; perceptually uniform (van der Walt and Smith 2015)"},
    {"plasma", "blue, magenta, yellow; perceptually uniform (van der Walt and Smith 2015)"},
    {"inferno", "black, red, yellow; perceptually uniform (van der Walt and Smith 2015)"},
    {"magma", "black, purple, pale yellow; perceptually uniform (van der Walt and Smith 2015)"},
    {"cividis", "blue to yellow, alike for the colour-blind (Nunez, Anderton, Renslow 2018)"},
    {"turbo", "a smooth rainbow (Mikhailov 2019)"},
    {"coolwarm", "blue, white, red; diverging (Moreland 2009)"},
    {"grayscale", "black to white"},
    {"rainbow", "blue, cyan, green, yellow, red: hues of HSV"},
    {"jet", "dark blue, cyan, yellow, dark red"},
}};

std::vector<ColorMapPoint> points_from_table(const Table& table) {
  std::vector<ColorMapPoint> points;
  for (std::size_t i = 0; i < table.size(); ++i) {
    const auto channel = [&](int shift) { return ((table[i] >> shift) & 255u) / 255.0; };
    points.push_back(
        {static_cast<double>(i) / static_cast<double>(table.size() - 1), {channel(16), channel(8), channel(0)}});
  }
  return points;
}

/// Moreland's blue and red, through white (2009, section 5).
std::vector<ColorMapPoint> coolwarm_points() {
  constexpr Color kCool{59 / 255.0, 76 / 255.0, 192 / 255.0}, kWarm{180 / 255.0, 4 / 255.0, 38 / 255.0};
  std::vector<ColorMapPoint> points;
  for (int i = 0; i <= 64; ++i)
    points.push_back({i / 64.0, mix_colors(ColorSpace::kDiverging, kCool, kWarm, i / 64.0)});
  return points;
}

}  // namespace

std::span<const ColorMapEntry> color_maps() { return kMaps; }

std::vector<ColorMapPoint> color_map_points(std::string_view name) {
  if (name == "viridis") return points_from_table(kViridis);
  if (name == "plasma") return points_from_table(kPlasma);
  if (name == "inferno") return points_from_table(kInferno);
  if (name == "magma") return points_from_table(kMagma);
  if (name == "cividis") return points_from_table(kCividis);
  if (name == "turbo") return points_from_table(kTurbo);
  if (name == "coolwarm") return coolwarm_points();
  if (name == "grayscale") return {{0.0, {0, 0, 0}}, {1.0, {1, 1, 1}}};
  if (name == "rainbow")
    return {{0.0, {0, 0, 1}}, {0.25, {0, 1, 1}}, {0.5, {0, 1, 0}}, {0.75, {1, 1, 0}}, {1.0, {1, 0, 0}}};
  if (name == "jet")
    return {{0.0, {0, 0, 0.5}}, {0.125, {0, 0, 1}}, {0.375, {0, 1, 1}},
            {0.625, {1, 1, 0}}, {0.875, {1, 0, 0}}, {1.0, {0.5, 0, 0}}};
  return {};
}

Color eval_color_map(std::span<const ColorMapPoint> points, double t) {
  const auto above =
      std::upper_bound(points.begin(), points.end(), t, [](double v, const ColorMapPoint& p) { return v < p.t; });
  if (above == points.begin()) return points.front().color;
  if (above == points.end()) return points.back().color;
  const ColorMapPoint &a = *(above - 1), &b = *above;
  const double u = (t - a.t) / (b.t - a.t);
  return {std::lerp(a.color[0], b.color[0], u), std::lerp(a.color[1], b.color[1], u),
          std::lerp(a.color[2], b.color[2], u)};
}

}  // namespace tetravox::optics
