// Surroundings from pictures: what PNG and EXR of any kind become, cubes, and what is wrong with files.

#include "tests/unit/io/sample_files.h"
#include "tests/unit/optics/expect_error.h"
#include "tetravox/error.h"
#include "tetravox/io.h"

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfOutputFile.h>
#include <gtest/gtest.h>
#include <png.h>

#include <cmath>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <string>
#include <vector>

namespace tetravox {
namespace {

namespace fs = std::filesystem;
using test::TemporaryDirectory;
using testing::expect_error;

std::string read_bytes(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}
void write_bytes(const fs::path& path, const std::string& bytes) { std::ofstream(path, std::ios::binary) << bytes; }

/// Opaque pixels that differ from each other, in [0, 1].
Image make_image(int width, int height) {
  Image image{width, height, {}};
  for (int i = 0; i < width * height; ++i)
    image.pixels.insert(image.pixels.end(), {0.01f * static_cast<float>(i % 100), 0.5f, 0.25f, 1.0f});
  return image;
}

Image make_uniform(int size, float value) {
  Image image{size, size, {}};
  for (int i = 0; i < size * size; ++i) image.pixels.insert(image.pixels.end(), {value, value, value, 1.0f});
  return image;
}

/// A PNG of any kind: `row(y)` has its bytes.
template <class Row>
void write_raw_png(const fs::path& path, png_uint_32 width, png_uint_32 height, int depth, int color, int interlace,
                   const Row& row) {
  std::FILE* file = std::fopen(path.c_str(), "wb");
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
  png_infop info = png_create_info_struct(png);
  png_init_io(png, file);
  png_set_IHDR(png, info, width, height, depth, color, interlace, PNG_COMPRESSION_TYPE_DEFAULT,
               PNG_FILTER_TYPE_DEFAULT);
  const png_color palette[3] = {{255, 0, 0}, {0, 255, 0}, {0, 0, 51}};
  if (color == PNG_COLOR_TYPE_PALETTE) png_set_PLTE(png, info, palette, 3);
  png_write_info(png, info);
  const int passes = png_set_interlace_handling(png);
  for (int pass = 0; pass < passes; ++pass)
    for (png_uint_32 y = 0; y < height; ++y) {
      std::vector<png_byte> bytes = row(y);
      png_write_row(png, bytes.data());
    }
  png_write_end(png, nullptr);
  png_destroy_write_struct(&png, &info);
  std::fclose(file);
}

/// An EXR with one float channel for each name, all with the same values.
void write_channels(const fs::path& path, int width, int height, const std::vector<const char*>& names,
                    std::vector<float> values) {
  Imf::Header header(width, height);
  for (const char* name : names) header.channels().insert(name, Imf::Channel(Imf::FLOAT));
  Imf::OutputFile file(path.c_str(), header);
  Imf::FrameBuffer frame;
  for (const char* name : names)
    frame.insert(name, Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(values.data()), sizeof(float),
                                  sizeof(float) * static_cast<std::size_t>(width)));
  file.setFrameBuffer(frame);
  file.writePixels(height);
}

TEST(EnvironmentFiles, PngIsTakenAsDisplayed) {
  const TemporaryDirectory directory;
  const std::string path = (directory.path() / "a.PNG").string();
  const Image image = make_image(8, 4);
  for (const int depth : {8, 16}) {
    WriteOptions options;
    options.bit_depth = depth;
    write_image(path, image, options);
    const Environment environment = read_environment(path);
    EXPECT_EQ(environment.layout, EnvironmentLayout::kEquirectangular);
    ASSERT_EQ(environment.width, 8);
    ASSERT_EQ(environment.height, 4);
    ASSERT_EQ(environment.radiance.size(), 96u);
    for (std::size_t i = 0; i < 96; ++i)
      EXPECT_NEAR(environment.radiance[i], image.pixels[i / 3 * 4 + i % 3], 0.5001 / (depth == 8 ? 255 : 65535));
    EXPECT_NO_THROW(validate_environment(environment));
  }
}

TEST(EnvironmentFiles, PngOfEveryKind) {
  const TemporaryDirectory directory;
  const fs::path path = directory.path() / "a.png";
  const auto expect_red = [&](const std::vector<float>& wanted) {
    const Environment environment = read_environment(path.string());
    ASSERT_EQ(environment.radiance.size(), 3 * wanted.size());
    for (std::size_t i = 0; i < wanted.size(); ++i) EXPECT_FLOAT_EQ(environment.radiance[3 * i], wanted[i]) << i;
  };
  using Bytes = std::vector<png_byte>;
  write_raw_png(path, 4, 2, 1, PNG_COLOR_TYPE_GRAY, PNG_INTERLACE_NONE,
                [](auto y) { return Bytes{static_cast<png_byte>(y ? 0x50 : 0xF0)}; });
  expect_red({1, 1, 1, 1, 0, 1, 0, 1});
  write_raw_png(path, 2, 1, 2, PNG_COLOR_TYPE_PALETTE, PNG_INTERLACE_NONE, [](auto) { return Bytes{0x20}; });
  EXPECT_EQ(read_environment(path.string()).radiance, (std::vector<float>{1, 0, 0, 0, 0, 0.2f}));
  write_raw_png(path, 2, 1, 8, PNG_COLOR_TYPE_GRAY_ALPHA, PNG_INTERLACE_NONE, [](auto) {
    return Bytes{51, 0, 102, 255};  // alpha does not matter
  });
  expect_red({0.2f, 0.4f});
  write_raw_png(path, 2, 1, 16, PNG_COLOR_TYPE_RGB_ALPHA, PNG_INTERLACE_NONE,
                [](auto) { return Bytes{0x80, 0x01, 0, 0, 0, 0, 0, 0, 0xFF, 0xFF, 0, 0, 0, 0, 0, 0}; });
  expect_red({32769.0f / 65535.0f, 1.0f});
  write_raw_png(path, 16, 8, 8, PNG_COLOR_TYPE_GRAY, PNG_INTERLACE_ADAM7, [](png_uint_32 y) {
    Bytes bytes;
    for (png_uint_32 x = 0; x < 16; ++x) bytes.push_back(static_cast<png_byte>(16 * y + x));
    return bytes;
  });
  std::vector<float> ramp;
  for (int i = 0; i < 128; ++i) ramp.push_back(static_cast<float>(i) / 255.0f);
  expect_red(ramp);
}

TEST(EnvironmentFiles, ExrIsTakenAsItIs) {
  const TemporaryDirectory directory;
  const std::string path = (directory.path() / "a.exr").string();
  Image image = make_image(8, 4);
  image.pixels[4] = 12345.678f;
  image.pixels[8] = -0.5f;  // counts as nothing
  write_image(path, image);
  const Environment environment = read_environment(path);
  EXPECT_EQ(environment.radiance[3], 12345.678f);
  EXPECT_EQ(environment.radiance[6], 0.0f);
  EXPECT_EQ(environment.radiance[7], 0.5f);
  EXPECT_NO_THROW(validate_environment(environment));

  write_channels(path, 2, 1, {"Y"}, {0.5f, 7.0f});
  EXPECT_EQ(read_environment(path).radiance, (std::vector<float>{0.5f, 0.5f, 0.5f, 7.0f, 7.0f, 7.0f}));
  write_channels(path, 2, 1, {"R", "G"}, {0.5f, 7.0f});
  expect_error(
      ErrorCode::kUnsupported, [&] { read_environment(path); }, "a.exr", "R, G and B");
  for (const float bad : {NAN, INFINITY, 2e9f}) {
    write_channels(path, 2, 1, {"R", "G", "B"}, {0.5f, bad});
    expect_error(
        ErrorCode::kBadFile, [&] { read_environment(path); }, "a.exr", "column 1, row 0");
  }
}

TEST(EnvironmentFiles, CubesAreSixFaces) {
  const TemporaryDirectory directory;
  const std::vector<std::string> names{"px", "nx", "py", "ny", "pz", "nz"};
  for (std::size_t i = 0; i < 6; ++i) {
    const Image face = make_uniform(4, 0.1f * static_cast<float>(i + 1));
    write_image((directory.path() / (names[i] + (i % 2 ? ".exr" : ".png"))).string(), face);
    write_image((directory.path() / ("sky_" + names[i] + "_4.exr")).string(), face);
  }
  for (const std::string& path : {directory.path().string(), (directory.path() / "sky_*_4.exr").string()}) {
    const Environment environment = read_environment(path);
    EXPECT_EQ(environment.layout, EnvironmentLayout::kCube);
    EXPECT_EQ(environment.width, 4);
    EXPECT_NO_THROW(validate_environment(environment));
    for (std::size_t i = 0; i < environment.radiance.size(); ++i)
      EXPECT_NEAR(environment.radiance[i], 0.1 * static_cast<double>(i / 48 + 1), 2e-3) << path << " " << i;
  }
  const auto expect_bad = [&](ErrorCode code, const std::string& path, const char* what, const char* why) {
    expect_error(
        code, [&] { read_environment(path); }, what, why);
  };
  write_image((directory.path() / "sky_ny_4.exr").string(), make_uniform(5, 0.4f));
  expect_bad(ErrorCode::kBadFile, (directory.path() / "sky_*_4.exr").string(), "sky_ny_4.exr", "one size");
  write_image((directory.path() / "sky_px_4.exr").string(), make_image(8, 4));
  expect_bad(ErrorCode::kBadFile, (directory.path() / "sky_*_4.exr").string(), "sky_px_4.exr", "square");
  fs::remove(directory.path() / "py.png");
  expect_bad(ErrorCode::kFileNotFound, directory.path().string(), directory.path().c_str(), "py.exr");
  expect_bad(ErrorCode::kFileNotFound, (directory.path() / "none_*.png").string(), "none_px.png", "cannot open");
}

TEST(EnvironmentFiles, WhatIsWrongIsNamed) {
  const TemporaryDirectory directory;
  const auto file = [&](const char* name) { return (directory.path() / name).string(); };
  const auto expect_bad = [&](ErrorCode code, const char* name, const char* why) {
    expect_error(
        code, [&] { read_environment(file(name)); }, name, why);
  };
  expect_bad(ErrorCode::kFileNotFound, "none.png", "cannot open");
  expect_bad(ErrorCode::kFileNotFound, "none.exr", "cannot open");
  expect_bad(ErrorCode::kInvalidArgument, "a.jpg", "neither .png nor .exr");
  expect_error(
      ErrorCode::kFileNotFound, [] { read_environment("sky"); }, "'sky'", "'builtin:sky'");
  write_bytes(directory.path() / "text.png", "this is no picture");
  write_bytes(directory.path() / "text.exr", "this is no picture");
  write_bytes(directory.path() / "empty.exr", "");
  expect_bad(ErrorCode::kBadFile, "text.png", "not a PNG");
  expect_bad(ErrorCode::kBadFile, "text.exr", "not an EXR");
  expect_bad(ErrorCode::kBadFile, "empty.exr", "not an EXR");
  write_image(file("square.png"), make_image(4, 4));
  expect_bad(ErrorCode::kUnsupported, "square.png", "twice as wide");
  write_raw_png(directory.path() / "large.png", 8200, 4100, 1, PNG_COLOR_TYPE_GRAY, PNG_INTERLACE_NONE,
                [](auto) { return std::vector<png_byte>(1025); });
  expect_bad(ErrorCode::kUnsupported, "large.png", "at most");
  expect_error(
      ErrorCode::kInvalidArgument, [] { read_environment("builtin:moon"); }, "'moon'", "studio");
  EXPECT_EQ(read_environment("builtin:room").layout, EnvironmentLayout::kCube);
}

TEST(EnvironmentFiles, DamagedPicturesAreErrorsOrPictures) {
  const TemporaryDirectory directory;
  std::uint32_t state = 4711;
  const auto random = [&state] { return state = state * 1664525u + 1013904223u, state >> 8; };
  for (const char* name : {"a.png", "a.exr"}) {
    const fs::path path = directory.path() / name;
    write_image(path.string(), make_image(16, 8));
    const std::string good = read_bytes(path);
    int refused = 0;
    for (int round = 0; round < 300; ++round) {
      std::string bad = good;
      if (round % 3 == 0) bad.resize(random() % bad.size());
      for (int flip = 0; flip < 1 + round % 4 && round % 3 != 0; ++flip)
        bad[random() % bad.size()] ^= static_cast<char>(1u << (random() % 8));
      write_bytes(path, bad);
      try {
        validate_environment(read_environment(path.string()));
      } catch (const Error& error) {
        ++refused;
        EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << error.what();
        EXPECT_NE(std::string(error.what()).find(name), std::string::npos) << error.what();
      }
    }
    EXPECT_GT(refused, 120) << name;
  }
}

}  // namespace
}  // namespace tetravox
