// RAW files: names, options, byte orders, mapping, and what is wrong with files that do not fit.

#include "src/io/raw_file.h"
#include "tests/unit/io/sample_files.h"
#include "tetravox/error.h"
#include "tetravox/grid.h"
#include "tetravox/io.h"

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/stat.h>

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>
#include <string>
#include <vector>

namespace tetravox {

namespace {

namespace fs = std::filesystem;
using test::TemporaryDirectory;

template <class T>
std::string bytes_of(const std::vector<T>& values, bool is_big_endian = false, std::size_t header_bytes = 0) {
  std::string bytes(header_bytes, 'h');
  for (const T& value : values) {
    std::string one(sizeof value, '\0');
    std::memcpy(one.data(), &value, sizeof value);
    if (is_big_endian != (std::endian::native == std::endian::big)) std::reverse(one.begin(), one.end());
    bytes += one;
  }
  return bytes;
}

/// `count` different values.
template <class T>
std::vector<T> ramp(std::size_t count) {
  std::vector<T> values;
  for (std::size_t i = 0; i < count; ++i) values.push_back(static_cast<T>(static_cast<T>(3 * i) - 5));
  return values;
}

template <class T>
std::vector<T> values_of(const GridData& grid) {
  std::vector<T> values(grid.values.size() / sizeof(T));
  std::memcpy(values.data(), grid.values.data(), grid.values.size());
  return values;
}

Error error_of(const std::string& path, const RawLayout& layout = {}) {
  ReadOptions options;
  options.raw = layout;
  try {
    read_dataset(path, options);
  } catch (const Error& error) {
    EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
    return error;
  }
  ADD_FAILURE() << path << " was read";
  return Error(ErrorCode::kInternal, "");
}

void expect_words(const Error& error, ErrorCode code, const std::vector<std::string>& words) {
  EXPECT_EQ(error.code(), code) << error.what();
  for (const std::string& word : words)
    EXPECT_NE(std::string(error.what()).find(word), std::string::npos) << word << ": " << error.what();
}

Dataset read(const std::string& path, const RawLayout& layout) {
  ReadOptions options;
  options.raw = layout;
  return read_dataset(path, options);
}

TEST(RawNames, FollowTheConvention) {
  using Dimensions = std::array<std::uint32_t, 3>;
  const RawLayout plain = io::parse_raw_name("data_x/my_big_tooth_103x94x161_uint8.raw");
  EXPECT_EQ(plain.dimensions, (Dimensions{103, 94, 161}));
  EXPECT_EQ(plain.type, ScalarType::kUint8);
  EXPECT_FALSE(plain.spacing || plain.components || plain.is_big_endian);
  EXPECT_EQ(io::parse_raw_name("2x2x2_float64.raw").type, ScalarType::kFloat64);
  EXPECT_EQ(io::parse_raw_name("a_512x512x512_int16.raw").type, ScalarType::kInt16);
  EXPECT_EQ(io::parse_raw_name("a_4x5x6_float32.bin").dimensions, (Dimensions{4, 5, 6}));
  const RawLayout spaced = io::parse_raw_name("stag_832x832x494_1x1x1.25_uint16.raw");
  EXPECT_EQ(spaced.dimensions, (Dimensions{832, 832, 494}));
  EXPECT_EQ(spaced.spacing, (std::array<double, 3>{1, 1, 1.25}));
  const RawLayout untyped = io::parse_raw_name("a_4x5x6.raw");
  EXPECT_EQ(untyped.dimensions, (Dimensions{4, 5, 6}));
  EXPECT_FALSE(untyped.type);
  EXPECT_EQ(io::parse_raw_name("a_4294967295x2x2_uint8.raw").dimensions, (Dimensions{4294967295u, 2, 2}));
}

TEST(RawNames, OthersSayNothing) {
  for (const char* name : {"",
                           ".raw",
                           "_",
                           "head.raw",
                           "a_256x256_uint8.raw",
                           "a_2x2x2x2_uint8.raw",
                           "a_2x2x2_uint12.raw",
                           "a_2x2xb_uint8.raw",
                           "a_2x-2x2_uint8.raw",
                           "a_2 x2x2_uint8.raw",
                           "a_4294967296x2x2_uint8.raw",
                           "a_99999999999999999999x2x2_uint8.raw",
                           "a_0x2x2_uint8.raw",
                           "a_2x2x_uint8.raw",
                           "a_x2x2_uint8.raw",
                           "a_xx_uint8.raw",
                           "a_2x2x2_uint8_be.raw",
                           "a_1.5x2x2_uint8.raw",
                           "2x2x2_uint8/a.raw",
                           "a_2x2x2uint8.raw",
                           "a_nanxnanxnan_uint8.raw"}) {
    const RawLayout layout = io::parse_raw_name(name);
    EXPECT_FALSE(layout.dimensions || layout.type || layout.spacing) << name;
  }
}

TEST(Raw, ReadsByItsName) {
  const TemporaryDirectory directory;
  const std::string path = directory.file("some_ramp_4x3x2_float32.raw");
  const std::vector<float> values = ramp<float>(24);
  test::write_text(path, bytes_of(values));
  const Dataset dataset = read_dataset(path);
  ASSERT_TRUE(dataset.is_grid());
  EXPECT_EQ(values_of<float>(dataset.grid), values);
  EXPECT_EQ(dataset.grid.type, ScalarType::kFloat32);
  EXPECT_EQ(dataset.grid.array_name, "values");
  EXPECT_EQ(dataset.grid.component, 0);
  EXPECT_EQ(dataset.info.source, path);
  EXPECT_EQ(dataset.info.format, "RAW");
  EXPECT_EQ(dataset.info.point_count, 24u);
  EXPECT_EQ(dataset.info.cell_count, 6u);
  EXPECT_EQ(dataset.info.bounds[0].max, 3.0);
  EXPECT_EQ(dataset.info.bounds[2].max, 1.0);
  ASSERT_EQ(dataset.info.arrays.size(), 1u);
  EXPECT_EQ(dataset.info.arrays[0].component_ranges.at(0).min, -5.0);
  EXPECT_EQ(dataset.info.arrays[0].component_ranges.at(0).max, 64.0);
  EXPECT_EQ(prepare_grid(dataset.grid).scalar_range.max, 64.0);
}

TEST(Raw, OptionsGoOverTheName) {
  const TemporaryDirectory directory;
  const std::string path = directory.file("some_ramp_4x3x2_2x2x2_float32.raw");
  test::write_text(path, bytes_of(ramp<std::int16_t>(48)));
  RawLayout layout;
  layout.dimensions = {6, 4, 2};
  layout.type = ScalarType::kInt16;
  EXPECT_EQ(read(path, layout).info.bounds[0].max, 10.0);
  layout.spacing = {0.5, 1, 3};
  const Dataset dataset = read(path, layout);
  EXPECT_EQ(values_of<std::int16_t>(dataset.grid), ramp<std::int16_t>(48));
  EXPECT_EQ(dataset.info.bounds[0].max, 2.5);
  EXPECT_EQ(dataset.info.bounds[2].max, 3.0);
  for (const char* ending : {"x.bin", "x.dat", "x.img", "x.vti", "x"}) {
    fs::copy_file(path, directory.file(ending));
    EXPECT_EQ(read(directory.file(ending), layout).info.format, "RAW");
  }
}

template <class T>
void expect_both_orders(ScalarType type) {
  const TemporaryDirectory directory;
  const std::vector<T> values = ramp<T>(27);
  RawLayout layout;
  layout.dimensions = {3, 3, 3};
  layout.type = type;
  for (const bool is_big_endian : {false, true})
    for (const std::size_t header_bytes : {0, 3, 16}) {
      test::write_text(directory.file("a.raw"), bytes_of(values, is_big_endian, header_bytes));
      layout.is_big_endian = is_big_endian;
      layout.header_bytes = header_bytes;
      const Dataset dataset = read(directory.file("a.raw"), layout);
      EXPECT_EQ(values_of<T>(dataset.grid), values) << is_big_endian << " " << header_bytes;
      EXPECT_EQ(reinterpret_cast<std::uintptr_t>(dataset.grid.values.data()) % sizeof(T), 0u);
    }
}

TEST(Raw, EveryTypeInBothOrdersBehindAnyHeader) {
  expect_both_orders<std::int8_t>(ScalarType::kInt8);
  expect_both_orders<std::uint8_t>(ScalarType::kUint8);
  expect_both_orders<std::int16_t>(ScalarType::kInt16);
  expect_both_orders<std::uint16_t>(ScalarType::kUint16);
  expect_both_orders<std::int32_t>(ScalarType::kInt32);
  expect_both_orders<std::uint32_t>(ScalarType::kUint32);
  expect_both_orders<std::int64_t>(ScalarType::kInt64);
  expect_both_orders<std::uint64_t>(ScalarType::kUint64);
  expect_both_orders<float>(ScalarType::kFloat32);
  expect_both_orders<double>(ScalarType::kFloat64);
}

TEST(Raw, ComponentsAndMissingValues) {
  const TemporaryDirectory directory;
  const std::string path = directory.file("flow_2x2x2_float64.raw");
  std::vector<double> values(3 * 8, 2.0);
  values[4] = std::nan("");
  test::write_text(path, bytes_of(values));
  RawLayout layout;
  layout.components = 3;
  const Dataset dataset = read(path, layout);
  EXPECT_EQ(dataset.grid.components, 3);
  EXPECT_EQ(dataset.grid.component, kMagnitude);
  EXPECT_EQ(dataset.info.arrays[0].nan_count, 1u);
  EXPECT_DOUBLE_EQ(dataset.info.arrays[0].magnitude_range.max, std::sqrt(12.0));
  ReadOptions options;
  options.raw = layout;
  options.array.component = 1;
  EXPECT_EQ(read_dataset(path, options).grid.component, 1);
  options.array.component = 3;
  EXPECT_THROW(read_dataset(path, options), Error);
  options.array = {"density", {}, {}};
  EXPECT_THROW(read_dataset(path, options), Error);
}

TEST(Raw, OnlyInfoKeepsNothing) {
  const TemporaryDirectory directory;
  const std::string path = directory.file("a_2x2x2_uint8.raw");
  test::write_text(path, "abcdefgh");
  ReadOptions options;
  options.only_info = true;
  const Dataset dataset = read_dataset(path, options);
  EXPECT_TRUE(dataset.is_grid());
  EXPECT_EQ(dataset.info.arrays[0].component_ranges.at(0).max, 'h');
  EXPECT_TRUE(dataset.grid.values.empty());
}

TEST(Raw, WrongSizesSayWhatWouldFit) {
  const TemporaryDirectory directory;
  const auto error_with = [&](const std::string& name, std::size_t bytes, const RawLayout& layout = {}) {
    test::write_text(directory.file(name), std::string(bytes, 'a'));
    return error_of(directory.file(name), layout);
  };
  expect_words(error_with("a_4x4x4_uint8.raw", 128), ErrorCode::kBadFile,
               {"a_4x4x4_uint8.raw", "128 bytes", "4 x 4 x 4 uint8 are 64", "--scalar-type uint16 or int16",
                "--components 2 --scalar-type uint8", "--header-bytes 64 would fit"});
  expect_words(error_with("a_4x4x4_uint16.raw", 64), ErrorCode::kBadFile, {"are 128", "--scalar-type uint8 or int8"});
  expect_words(error_with("a_4x4x4_uint16.raw", 100), ErrorCode::kBadFile, {"100 bytes", "that the file was written"});
  expect_words(error_with("a_4x4x4_uint8.raw", 65), ErrorCode::kBadFile, {"--header-bytes 1 would fit"});
  expect_words(error_with("a_4x4x4_float32.raw", 1), ErrorCode::kBadFile, {"has 1 bytes", "are 256"});
  RawLayout layout;
  layout.header_bytes = 100;
  expect_words(error_with("a_4x4x4_uint8.raw", 64, layout), ErrorCode::kBadFile,
               {"100 bytes of header and 4 x 4 x 4 uint8 are 164"});
  layout.header_bytes = std::numeric_limits<std::uint64_t>::max();
  expect_words(error_with("a_4x4x4_uint8.raw", 64, layout), ErrorCode::kBadFile, {"more than any file holds"});
  expect_words(error_with("a_4294967295x4294967295x4294967295_float64.raw", 64), ErrorCode::kBadFile,
               {"64 bytes", "more than any file holds"});
  // 2^22 * 2^21 * 2^21 bytes are 2^64.
  expect_words(error_with("a_4194304x2097152x2097152_uint8.raw", 64), ErrorCode::kBadFile,
               {"more than any file holds"});
  expect_words(error_with("a_100000x100000x100000_uint8.raw", 64), ErrorCode::kBadFile, {"are 1000000000000000"});
  expect_words(error_with("a_1x4x4_uint8.raw", 16), ErrorCode::kNothingToDraw, {"a_1x4x4_uint8.raw"});
}

TEST(Raw, WhatIsNotKnownIsAskedFor) {
  const TemporaryDirectory directory;
  const std::string path = directory.file("head.raw");
  test::write_text(path, std::string(64, 'a'));
  expect_words(error_of(path), ErrorCode::kInvalidArgument, {"head.raw", "--dimensions and --scalar-type", ".mhd"});
  test::write_text(directory.file("head.mhd"), "ObjectType = Image\n");
  expect_words(error_of(path), ErrorCode::kInvalidArgument, {"name its header '" + directory.file("head.mhd")});
  RawLayout layout;
  layout.type = ScalarType::kUint8;
  expect_words(error_of(path, layout), ErrorCode::kInvalidArgument, {"--dimensions"});
  layout.dimensions = {4, 4, 4};
  EXPECT_EQ(read(path, layout).info.point_count, 64u);
  layout.type.reset();
  expect_words(error_of(path, layout), ErrorCode::kInvalidArgument, {"--scalar-type uint8 or int8 would fit"});
  layout.dimensions = {5, 4, 4};
  expect_words(error_of(path, layout), ErrorCode::kInvalidArgument, {"give --scalar-type"});
}

TEST(Raw, LayoutsThatMakeNoSense) {
  const TemporaryDirectory directory;
  const std::string path = directory.file("a_4x4x4_uint8.raw");
  test::write_text(path, std::string(64, 'a'));
  for (const double spacing : {0.0, -1.0, std::nan(""), std::numeric_limits<double>::infinity()}) {
    RawLayout layout;
    layout.spacing = {1.0, spacing, 1.0};
    expect_words(error_of(path, layout), ErrorCode::kInvalidArgument, {path, "spacing"});
  }
  for (const int components : {-1, 0, 5, 64}) {
    RawLayout layout;
    layout.components = components;
    expect_words(error_of(path, layout), ErrorCode::kInvalidArgument, {path, "components"});
  }
  RawLayout layout;
  layout.dimensions = {0, 0, 0};
  expect_words(error_of(path, layout), ErrorCode::kNothingToDraw, {path});
  layout = {};
  layout.type = ScalarType::kUint8;
  expect_words(error_of("builtin:sphere", layout), ErrorCode::kInvalidArgument, {"RAW"});
  test::write_text(directory.file("a.vtu"), test::vtu_text());
  expect_words(error_of(directory.file("a.vtu"), layout), ErrorCode::kInvalidArgument, {"a.vtu", "RAW"});
}

TEST(Raw, FilesThatCannotBeRead) {
  const TemporaryDirectory directory;
  expect_words(error_of(directory.file("none_2x2x2_uint8.raw")), ErrorCode::kFileNotFound, {"none_2x2x2_uint8.raw"});
  test::write_text(directory.file("empty_2x2x2_uint8.raw"), "");
  expect_words(error_of(directory.file("empty_2x2x2_uint8.raw")), ErrorCode::kBadFile, {"is empty"});
  fs::create_directory(directory.file("folder_2x2x2_uint8.raw"));
  expect_words(error_of(directory.file("folder_2x2x2_uint8.raw")), ErrorCode::kUnsupported, {"is a directory"});
  ASSERT_EQ(mkfifo(directory.file("pipe_2x2x2_uint8.raw").c_str(), 0600), 0);
  expect_words(error_of(directory.file("pipe_2x2x2_uint8.raw")), ErrorCode::kBadFile, {"not a regular file"});
}

TEST(Raw, HasNoTimeSteps) {
  const TemporaryDirectory directory;
  const std::string path = directory.file("a_2x2x2_uint8.raw");
  test::write_text(path, "abcdefgh");
  ReadOptions options;
  options.time.index = 0;
  EXPECT_EQ(read_dataset(path, options).info.time_index, 0u);
  options.time.index = 3;
  EXPECT_THROW(read_dataset(path, options), Error);
}

TEST(Raw, TellsProgressAndStops) {
  const TemporaryDirectory directory;
  const std::string path = directory.file("a_32x32x32_uint16.raw");
  test::write_text(path, bytes_of(ramp<std::uint16_t>(32 * 32 * 32), true));
  ReadOptions options;
  for (const bool is_big_endian : {false, true}) {
    options.raw.is_big_endian = is_big_endian;
    double last = 0.0;
    std::atomic<bool> cancelled{false};
    Progress progress{[&](std::string_view, double fraction) { last = fraction; }, &cancelled};
    read_dataset(path, options, progress);
    EXPECT_EQ(last, 1.0);
    cancelled = true;
    try {
      read_dataset(path, options, progress);
      ADD_FAILURE() << "not cancelled";
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::kCancelled);
    }
  }
}

/// Bytes of memory of this process that no file stands behind.
std::uint64_t anonymous_memory() {
  std::ifstream status("/proc/self/status");
  std::string word;
  while (status >> word)
    if (word == "RssAnon:") {
      std::uint64_t kilobytes = 0;
      status >> kilobytes;
      return kilobytes * 1024;
    }
  return 0;
}

TEST(Raw, IsMappedNotCopied) {
  const TemporaryDirectory directory;
  const std::string path = directory.file("big_512x512x256_uint8.raw");
  {
    std::ofstream file(path, std::ios::binary);
    file << 'a';
  }
  fs::resize_file(path, 512 * 512 * 256);  // A hole: it takes no room.
  const std::uint64_t before = anonymous_memory();
  if (before == 0) GTEST_SKIP() << "/proc/self/status does not tell RssAnon";
  const Dataset dataset = read_dataset(path);
  EXPECT_LT(anonymous_memory(), before + (8u << 20));
  EXPECT_EQ(dataset.info.arrays[0].component_ranges.at(0).max, 'a');
  // What stands in the file is what one sees.
  std::fstream(path, std::ios::binary | std::ios::in | std::ios::out).put('z');
  EXPECT_EQ(static_cast<char>(dataset.grid.values[0]), 'z');
}

TEST(Raw, AFileThatShrinksReadsAsZeros) {
  const TemporaryDirectory directory;
  const std::string path = directory.file("a_64x64x64_uint8.raw");
  test::write_text(path, std::string(64 * 64 * 64, 'a'));
  const Dataset dataset = read_dataset(path);
  fs::resize_file(path, 64 * 64);
  std::size_t sum = 0;
  for (const std::byte value : dataset.grid.values) sum += static_cast<std::size_t>(value);
  EXPECT_EQ(sum, 64u * 64 * 'a');
  EXPECT_EQ(static_cast<char>(dataset.grid.values.front()), 'a');
  EXPECT_EQ(prepare_grid(dataset.grid).scalar_range.min, 0.0);
  // And others are what they were.
  const std::string other = directory.file("b_64x64x64_uint8.raw");
  test::write_text(other, std::string(64 * 64 * 64, 'b'));
  EXPECT_EQ(read_dataset(other).info.arrays[0].component_ranges.at(0).min, 'b');
}

TEST(RawDeathTest, OtherBusErrorsStillEndTheProgram) {
  const TemporaryDirectory directory;
  test::write_text(directory.file("a_2x2x2_uint8.raw"), "abcdefgh");
  read_dataset(directory.file("a_2x2x2_uint8.raw"));
  EXPECT_DEATH(raise(SIGBUS), "");
}

TEST(Raw, ManyAtATime) {
  const TemporaryDirectory directory;
  test::write_text(directory.file("a_2x2x2_uint8.raw"), "abcdefgh");
  std::vector<Dataset> datasets;
  for (int i = 0; i < 200; ++i) datasets.push_back(read_dataset(directory.file("a_2x2x2_uint8.raw")));
  for (const Dataset& dataset : datasets) EXPECT_EQ(static_cast<char>(dataset.grid.values[7]), 'h');
}

}  // namespace

}  // namespace tetravox
