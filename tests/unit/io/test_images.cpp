#include "tetravox/error.h"
#include "tetravox/io.h"

#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputFile.h>
#include <gtest/gtest.h>
#include <png.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>

#include <cmath>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <limits>
#include <string>
#include <vector>

namespace tetravox {
namespace {

namespace fs = std::filesystem;

const std::string kScene = "{ \"tetravox\": 1, \"data\": { \"file\": \"f\xC3\xB6hn.vtu\" } }\n";

/// A directory of its own for each test.
class Images : public testing::Test {
 protected:
  void SetUp() override {
    const auto* info = testing::UnitTest::GetInstance()->current_test_info();
    directory_ = fs::path(testing::TempDir()) /
                 (std::string("tetravox_images_") + info->name() + "_" + std::to_string(::getpid()));
    fs::create_directories(directory_);
  }
  void TearDown() override { fs::remove_all(directory_); }
  std::string path(const std::string& name) const { return (directory_ / name).string(); }
  std::size_t file_count() const {
    return static_cast<std::size_t>(std::distance(fs::directory_iterator(directory_), fs::directory_iterator{}));
  }
  fs::path directory_;
};

/// Premultiplied colours that differ from pixel to pixel.
Image make_image(int width, int height) {
  Image image{width, height, std::vector<float>(4 * static_cast<std::size_t>(width) * height)};
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const float alpha = static_cast<float>(x + 1) / static_cast<float>(width);
      float* pixel = image.pixel(x, y);
      pixel[0] = alpha * static_cast<float>(y) / static_cast<float>(height);
      pixel[1] = alpha * 0.25f;
      pixel[2] = alpha * 1.0f / 3.0f;
      pixel[3] = alpha;
    }
  return image;
}

/// Samples of a PNG, 16 bits wide whatever its depth, and its channels.
struct PngSamples {
  png_uint_32 width = 0, height = 0;
  int channels = 0, bit_depth = 0;
  std::vector<std::uint32_t> samples;
};

PngSamples read_png(const std::string& path) {
  PngSamples result;
  std::FILE* file = std::fopen(path.c_str(), "rb");
  png_structp png = png_create_read_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
  png_infop info = png_create_info_struct(png);
  png_init_io(png, file);
  png_read_png(png, info, PNG_TRANSFORM_IDENTITY, nullptr);
  result.width = png_get_image_width(png, info);
  result.height = png_get_image_height(png, info);
  result.channels = png_get_channels(png, info);
  result.bit_depth = png_get_bit_depth(png, info);
  png_bytepp rows = png_get_rows(png, info);
  for (png_uint_32 y = 0; y < result.height; ++y)
    for (png_uint_32 i = 0; i < result.width * static_cast<png_uint_32>(result.channels); ++i)
      result.samples.push_back(result.bit_depth == 16 ? rows[y][2 * i] * 256u + rows[y][2 * i + 1] : rows[y][i]);
  png_destroy_read_struct(&png, &info, nullptr);
  std::fclose(file);
  return result;
}

std::string read_bytes(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

void write_bytes(const std::string& path, const std::string& bytes) { std::ofstream(path, std::ios::binary) << bytes; }

ErrorCode code_of(const std::function<void()>& action) {
  try {
    action();
  } catch (const Error& error) {
    EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << error.what();
    return error.code();
  }
  ADD_FAILURE() << "nothing was thrown";
  return ErrorCode::kInternal;
}

TEST_F(Images, PngIsCompositedOverTheBackground) {
  const Image image = make_image(7, 5);
  for (int depth : {8, 16}) {
    WriteOptions options;
    options.background = {1.0, 0.5, 0.0};
    options.bit_depth = depth;
    write_image(path("a.png"), image, options);
    const PngSamples png = read_png(path("a.png"));
    ASSERT_EQ(png.width, 7u);
    ASSERT_EQ(png.height, 5u);
    ASSERT_EQ(png.channels, 3);
    ASSERT_EQ(png.bit_depth, depth);
    const double largest = depth == 8 ? 255.0 : 65535.0;
    for (int y = 0; y < 5; ++y)
      for (int x = 0; x < 7; ++x)
        for (std::size_t c = 0; c < 3; ++c) {
          const float* pixel = image.pixel(x, y);
          const double expected = pixel[c] + (1.0 - pixel[3]) * options.background[c];
          EXPECT_EQ(png.samples[3 * (7 * static_cast<std::size_t>(y) + x) + c], std::lround(expected * largest));
        }
  }
}

TEST_F(Images, PngWithAlphaIsUnpremultiplied) {
  Image image = make_image(6, 4);
  image.pixel(0, 0)[3] = 0.0f;  // light without opacity cannot be held: it is dropped
  WriteOptions options;
  options.use_alpha = true;
  options.bit_depth = 16;
  write_image(path("a.png"), image, options);
  const PngSamples png = read_png(path("a.png"));
  ASSERT_EQ(png.channels, 4);
  for (std::size_t c = 0; c < 4; ++c) EXPECT_EQ(png.samples[c], 0u);
  for (std::size_t i = 1; i < 24; ++i) {
    const float* pixel = image.pixels.data() + 4 * i;
    EXPECT_EQ(png.samples[4 * i + 3], std::lround(pixel[3] * 65535.0));
    EXPECT_EQ(png.samples[4 * i + 1], std::lround(0.25 * 65535.0));
    EXPECT_EQ(png.samples[4 * i], std::lround(static_cast<double>(pixel[0]) / pixel[3] * 65535.0));
  }
}

TEST_F(Images, ValuesThatAreNoColourAreClamped) {
  Image image{3, 1, {2.0f, -1.0f, NAN, 1.0f, INFINITY, -INFINITY, 0.0f, 1.0f, 0.0f, 0.0f, 0.0f, NAN}};
  write_image(path("a.png"), image);
  const PngSamples png = read_png(path("a.png"));
  EXPECT_EQ(png.samples, (std::vector<std::uint32_t>{255, 0, 0, 255, 0, 0, 0, 0, 0}));
}

TEST_F(Images, ExrKeepsEveryFloat) {
  const Image image = make_image(9, 33);
  WriteOptions options;
  options.scene = kScene;
  write_image(path("a.exr"), image, options);
  Imf::InputFile file(path("a.exr").c_str());
  ASSERT_EQ(file.header().dataWindow().max.x, 8);
  ASSERT_EQ(file.header().dataWindow().max.y, 32);
  std::vector<float> pixels(image.pixels.size());
  Imf::FrameBuffer frame;
  const char* channels[] = {"R", "G", "B", "A"};
  for (std::size_t c = 0; c < 4; ++c)
    frame.insert(channels[c], Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(pixels.data() + c), 16, 16 * 9));
  file.setFrameBuffer(frame);
  file.readPixels(0, 32);
  EXPECT_EQ(pixels, image.pixels);
}

TEST_F(Images, NpyIsWhatNumpyReads) {
  const Image image = make_image(3, 2);
  write_image(path("a.npy"), image);
  const std::string bytes = read_bytes(path("a.npy"));
  ASSERT_GT(bytes.size(), 10u);
  EXPECT_EQ(bytes.substr(0, 8), std::string("\x93NUMPY\x01\x00", 8));
  const std::size_t header = static_cast<unsigned char>(bytes[8]) + 256u * static_cast<unsigned char>(bytes[9]);
  EXPECT_EQ((header + 10) % 64, 0u);
  EXPECT_NE(bytes.find("'shape': (2, 3, 4)"), std::string::npos);
  ASSERT_EQ(bytes.size(), 10 + header + 24 * sizeof(float));
  EXPECT_EQ(std::memcmp(bytes.data() + 10 + header, image.pixels.data(), 24 * sizeof(float)), 0);
}

TEST_F(Images, ArraysOfAnyShape) {
  const std::vector<double> values{1.0, 2.0, 3.0, 4.0, 5.0, 6.0};
  for (const auto& [shape, text] : {std::pair<std::vector<std::size_t>, std::string>{{6}, "'shape': (6,)"},
                                    std::pair<std::vector<std::size_t>, std::string>{{2, 3}, "'shape': (2, 3)"}}) {
    write_array(path("values.npy"), values, shape);
    const std::string bytes = read_bytes(path("values.npy"));
    EXPECT_NE(bytes.find(text), std::string::npos);
    EXPECT_NE(bytes.find("'<f8'"), std::string::npos);
    ASSERT_EQ(bytes.size() % 64, 6 * sizeof(double));
    EXPECT_EQ(std::memcmp(bytes.data() + bytes.size() - 6 * sizeof(double), values.data(), 6 * sizeof(double)), 0);
  }
  EXPECT_THROW(write_array(path("values.npy"), values, {4}), Error);
}

TEST_F(Images, SceneComesBack) {
  WriteOptions options;
  options.scene = kScene;
  options.bit_depth = 16;
  options.use_alpha = true;
  for (const char* name : {"a.png", "b.EXR"}) {
    write_image(path(name), make_image(4, 4), options);
    EXPECT_EQ(read_image_scene(path(name)), kScene);
  }
  EXPECT_TRUE(read_image_options(path("a.png")).use_alpha);
  EXPECT_EQ(read_image_options(path("a.png")).bit_depth, 16);

  // A long one, too.
  options.scene.assign(3'000'000, 'x');
  for (const char* name : {"a.png", "b.exr"}) {
    write_image(path(name), make_image(4, 4), options);
    EXPECT_EQ(read_image_scene(path(name)), options.scene);
  }

  options.scene.clear();
  for (const char* name : {"a.png", "b.exr"}) {
    write_image(path(name), make_image(4, 4), options);
    EXPECT_EQ(read_image_scene(path(name)), "");
  }
}

TEST_F(Images, SameBytesEveryTime) {
  WriteOptions options;
  options.scene = kScene;
  for (const char* ending : {".png", ".exr", ".npy"}) {
    write_image(path("a") + ending, make_image(40, 30), options);
    write_image(path("b") + ending, make_image(40, 30), options);
    EXPECT_EQ(read_bytes(path("a") + ending), read_bytes(path("b") + ending)) << ending;
  }
}

TEST_F(Images, WrongArgumentsAreRefused) {
  const Image image = make_image(2, 2);
  EXPECT_EQ(code_of([&] { write_image(path("a.jpg"), image); }), ErrorCode::kInvalidArgument);
  EXPECT_EQ(code_of([&] { write_image(path("picture"), image); }), ErrorCode::kInvalidArgument);
  EXPECT_EQ(code_of([&] { write_image(path("a.png"), Image{}); }), ErrorCode::kInvalidArgument);
  EXPECT_EQ(code_of([&] { write_image(path("a.png"), Image{2, 2, {1.0f}}); }), ErrorCode::kInvalidArgument);
  WriteOptions options;
  options.bit_depth = 12;
  EXPECT_EQ(code_of([&] { write_image(path("a.png"), image, options); }), ErrorCode::kInvalidArgument);
  EXPECT_EQ(code_of([&] { read_image_scene(path("a.jpg")); }), ErrorCode::kInvalidArgument);
  EXPECT_EQ(file_count(), 0u);
}

TEST_F(Images, FailureLeavesNothingBehind) {
  const Image image = make_image(200, 200);
  EXPECT_EQ(code_of([&] { write_image(path("missing/a.png"), image); }), ErrorCode::kCannotWrite);
  fs::create_directory(path("d.png"));
  EXPECT_EQ(code_of([&] { write_image(path("d.png"), image); }), ErrorCode::kCannotWrite);
  fs::remove(path("d.png"));

  // Interrupted in the middle: the older file stays as it was.
  std::atomic<bool> cancelled = true;
  for (const char* name : {"a.png", "a.exr", "a.npy"}) {
    write_bytes(path(name), "older");
    EXPECT_EQ(code_of([&] { write_image(path(name), image, {}, {{}, &cancelled}); }), ErrorCode::kCancelled);
    EXPECT_EQ(read_bytes(path(name)), "older");
    fs::remove(path(name));
  }
  EXPECT_EQ(file_count(), 0u);
}

TEST_F(Images, FullDiskIsAnError) {
  if (::access("/dev/full", W_OK) != 0) GTEST_SKIP() << "no /dev/full here";
  fs::create_symlink("/dev/full", path("full.png"));
  EXPECT_EQ(code_of([&] { write_image(path("full.png"), make_image(4, 4)); }), ErrorCode::kCannotWrite);
}

TEST_F(Images, LinksAndPermissionsAreKept) {
  const mode_t mask = ::umask(027);
  write_image(path("new.png"), make_image(2, 2));
  ::umask(mask);
  struct stat status {};
  ASSERT_EQ(::stat(path("new.png").c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & 0777u, 0640u);

  ASSERT_EQ(::chmod(path("new.png").c_str(), 0604), 0);
  fs::create_symlink("new.png", path("link.png"));
  write_image(path("link.png"), make_image(3, 3));
  EXPECT_TRUE(fs::is_symlink(path("link.png")));
  EXPECT_EQ(read_png(path("new.png")).width, 3u);
  ASSERT_EQ(::stat(path("new.png").c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & 0777u, 0604u);
  EXPECT_EQ(file_count(), 2u);
}

TEST_F(Images, CorruptPicturesNeverCrash) {
  WriteOptions options;
  options.scene = kScene;
  std::uint32_t state = 12345;
  const auto random = [&state] { return state = state * 1664525u + 1013904223u, state >> 8; };
  for (const char* name : {"a.png", "a.exr"}) {
    write_image(path(name), make_image(8, 8), options);
    const std::string good = read_bytes(path(name));
    for (int round = 0; round < 600; ++round) {
      std::string bad = good;
      if (round % 3 == 0) bad.resize(random() % bad.size());
      for (int flip = 0; flip < 1 + round % 4 && !bad.empty() && round % 3 != 0; ++flip)
        bad[random() % std::min<std::size_t>(bad.size(), 700)] ^= static_cast<char>(1u << (random() % 8));
      write_bytes(path(name), bad);
      try {
        read_image_scene(path(name));
      } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::kBadFile) << error.what();
      }
    }
  }
}

TEST_F(Images, FalseLengthsCostNothing) {
  // An attribute that claims four thousand million bytes, and a header without end.
  const std::string start("\x76\x2f\x31\x01\x02\x00\x00\x00", 8);
  const std::string name("tetravox_scene\0string\0", 22);
  write_bytes(path("a.exr"), start + name + std::string("\xff\xff\xff\xff", 4));
  EXPECT_EQ(code_of([&] { read_image_scene(path("a.exr")); }), ErrorCode::kBadFile);
  write_bytes(path("a.exr"), start + name + std::string("\xff\xff\xff\x03", 4) + "short");
  EXPECT_EQ(code_of([&] { read_image_scene(path("a.exr")); }), ErrorCode::kBadFile);
  write_bytes(path("a.exr"), start + std::string(100000, 'n'));
  EXPECT_EQ(code_of([&] { read_image_scene(path("a.exr")); }), ErrorCode::kBadFile);
  EXPECT_EQ(code_of([&] { read_image_scene(path("none.exr")); }), ErrorCode::kFileNotFound);
  EXPECT_EQ(code_of([&] { read_image_scene(path("none.png")); }), ErrorCode::kFileNotFound);
}

TEST_F(Images, TextFilesAppearWhole) {
  write_text_file(path("a.json"), "first");
  write_text_file(path("a.json"), "second");
  EXPECT_EQ(read_bytes(path("a.json")), "second");
  EXPECT_EQ(file_count(), 1u);
  EXPECT_GT(available_memory(), 1u << 20);
}

TEST(Depth, IsWrittenAsItIs) {
  const std::filesystem::path directory = std::filesystem::temp_directory_path() / "tetravox-depth";
  std::filesystem::create_directories(directory);
  Image image{2, 1, std::vector<float>(8), {1.5f, INFINITY}};
  write_depth((directory / "a.npy").string(), image);
  std::ifstream file(directory / "a.npy", std::ios::binary);
  const std::string bytes((std::istreambuf_iterator<char>(file)), {});
  ASSERT_EQ(bytes.size(), 128u + 8u);
  EXPECT_NE(bytes.find("(1, 2)"), std::string::npos);
  float depths[2];
  std::memcpy(depths, bytes.data() + 128, sizeof depths);
  EXPECT_EQ(depths[0], 1.5f);
  EXPECT_EQ(depths[1], INFINITY);
  write_depth((directory / "a.exr").string(), image);
  EXPECT_GT(std::filesystem::file_size(directory / "a.exr"), 100u);
  EXPECT_THROW(write_depth((directory / "a.png").string(), image), Error);
  image.depth.clear();
  EXPECT_THROW(write_depth((directory / "a.npy").string(), image), Error);
  std::filesystem::remove_all(directory);
}

}  // namespace
}  // namespace tetravox
