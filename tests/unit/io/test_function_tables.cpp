// Tables of functions of several variables: arrays and pictures, which way up they are, and damaged ones.

#include "tests/unit/io/sample_files.h"
#include "tetravox/error.h"
#include "tetravox/image.h"
#include "tetravox/io.h"
#include "tetravox/multidimensional.h"

#include <gtest/gtest.h>

#include <cstring>
#include <random>
#include <string>
#include <vector>

namespace tetravox {

namespace {

using test::TemporaryDirectory;

/// An .npy file of version 1 with this dictionary.
std::string npy_file(const std::string& dictionary, const std::string& bytes) {
  std::string text = "\x93NUMPY\x01";
  text += '\0';
  text += static_cast<char>(dictionary.size() & 0xFF);
  text += static_cast<char>(dictionary.size() >> 8);
  return text + dictionary + bytes;
}

std::string dictionary(const std::string& type, const std::string& shape, const std::string& order = "False") {
  return "{'descr': '" + type + "', 'fortran_order': " + order + ", 'shape': " + shape + ", }\n";
}

template <class T>
std::string bytes_of(const std::vector<T>& values) {
  std::string bytes(values.size() * sizeof(T), '\0');
  std::memcpy(bytes.data(), values.data(), bytes.size());
  return bytes;
}

/// i / count for `count` numbers.
template <class T>
std::vector<T> ramp(std::size_t count) {
  std::vector<T> values;
  for (std::size_t i = 0; i < count; ++i)
    values.push_back(static_cast<T>(static_cast<double>(i) / static_cast<double>(count)));
  return values;
}

struct Tables : testing::Test {
  TemporaryDirectory directory;

  FunctionTable read(const std::string& name, const std::string& content, std::size_t variables = 2) const {
    test::write_text(directory.file(name), content);
    return read_function_table(directory.file(name), variables);
  }
  void refuse(const std::string& name, const std::string& content, ErrorCode code, const std::string& words,
              std::size_t variables = 2) const {
    test::write_text(directory.file(name), content);
    refuse_file(name, code, words, variables);
  }
  void refuse_file(const std::string& name, ErrorCode code, const std::string& words, std::size_t variables = 2) const {
    try {
      read_function_table(directory.file(name), variables);
      ADD_FAILURE() << name << " was read; expected: " << words;
    } catch (const Error& error) {
      const std::string message = error.what();
      EXPECT_EQ(error.code(), code) << message;
      EXPECT_NE(message.find(words), std::string::npos) << message;
      EXPECT_NE(message.find(name), std::string::npos) << message;
      EXPECT_EQ(message.find('\n'), std::string::npos);
    }
  }
};

TEST_F(Tables, ArraysKeepTheirOrder) {
  const std::string shape = "(2, 3, 4)";
  const FunctionTable floats = read("f4.npy", npy_file(dictionary("<f4", shape), bytes_of(ramp<float>(24))));
  EXPECT_EQ(floats.sizes, (std::vector<std::size_t>{3, 2}));
  ASSERT_EQ(floats.rgba.size(), 24u);
  EXPECT_FLOAT_EQ(floats.rgba[13], 13.0f / 24.0f);
  EXPECT_EQ(read("f8.npy", npy_file(dictionary("<f8", shape), bytes_of(ramp<double>(24)))).rgba, floats.rgba);
  const std::vector<std::uint8_t> whole(24, 51);
  EXPECT_FLOAT_EQ(read("u1.npy", npy_file(dictionary("|u1", shape), bytes_of(whole))).rgba[5], 0.2f);
  const FunctionTable three =
      read("three.npy", npy_file(dictionary("<f4", "(2, 3, 5, 4)"), bytes_of(ramp<float>(120))), 3);
  EXPECT_EQ(three.sizes, (std::vector<std::size_t>{5, 3, 2}));
  EXPECT_FLOAT_EQ(three.rgba.back(), 119.0f / 120.0f);
}

TEST_F(Tables, WrittenByOthersInOtherWords) {
  const std::string bytes = bytes_of(ramp<float>(16));
  EXPECT_EQ(
      read("a.npy", npy_file("{\"shape\":(2,2,4),\"descr\":\"<f4\",\"fortran_order\":False}", bytes)).sizes.size(), 2u);
  std::string second = npy_file(dictionary("<f4", "(2, 2, 4)"), bytes);
  second[6] = 2;
  second.insert(10, 2, '\0');
  EXPECT_EQ(read("b.npy", second).rgba.size(), 16u);
}

/// 3 x 2 pixels: red grows to the right, the upper row is opaque.
Image make_picture() {
  Image image{3, 2, {}};
  for (int y = 0; y < 2; ++y)
    for (int x = 0; x < 3; ++x) {
      const float alpha = y == 0 ? 1.0f : 0.2f;
      for (const float channel : {alpha * static_cast<float>(x) / 2.0f, 0.0f, alpha, alpha})
        image.pixels.push_back(channel);
    }
  return image;
}

TEST_F(Tables, PicturesHaveTheSecondVariableUpwards) {
  WriteOptions options;
  options.use_alpha = true;
  for (const auto& [name, depth] : {std::pair("a.png", 8), std::pair("b.png", 16), std::pair("c.exr", 8)}) {
    options.bit_depth = depth;
    write_image(directory.file(name), make_picture(), options);
    const FunctionTable table = read_function_table(directory.file(name), 2);
    EXPECT_EQ(table.sizes, (std::vector<std::size_t>{3, 2}));
    ASSERT_EQ(table.rgba.size(), 24u);
    for (std::size_t row = 0; row < 2; ++row)
      for (std::size_t i = 0; i < 3; ++i) {
        const float* entry = table.rgba.data() + 4 * (3 * row + i);
        EXPECT_NEAR(entry[0], 0.5 * static_cast<double>(i), 0.005) << name;
        EXPECT_NEAR(entry[2], 1.0, 1e-6) << name;
        EXPECT_NEAR(entry[3], row == 0 ? 0.2 : 1.0, 1e-6) << name;
      }
    refuse_file(name, ErrorCode::kUnsupported, "(n3, n2, n1, 4)", 3);
  }
}

TEST_F(Tables, WhatIsNoTableIsRefused) {
  const std::string floats = bytes_of(ramp<float>(24));
  refuse_file("absent.npy", ErrorCode::kFileNotFound, "absent.npy");
  refuse_file("absent.png", ErrorCode::kFileNotFound, "absent.png");
  refuse_file("absent.exr", ErrorCode::kFileNotFound, "absent.exr");
  refuse("table.csv", "1,2", ErrorCode::kInvalidArgument, ".npy, .png or .exr");
  for (const char* name : {"text.npy", "text.png", "text.exr"}) refuse(name, "nothing", ErrorCode::kBadFile, "damaged");
  refuse("fortran.npy", npy_file(dictionary("<f4", "(2, 3, 4)", "True"), floats), ErrorCode::kUnsupported, "Fortran");
  refuse("type.npy", npy_file(dictionary("<i4", "(2, 3, 4)"), floats), ErrorCode::kUnsupported, "'<i4'");
  refuse("shape.npy", npy_file(dictionary("<f4", "(24,)"), floats), ErrorCode::kUnsupported, "(n2, n1, 4)");
  refuse("flat.npy", npy_file(dictionary("<f4", "(1, 6, 4)"), floats), ErrorCode::kUnsupported, "from 2 to 1024");
  refuse("three.npy", npy_file(dictionary("<f4", "(2, 3, 4)"), floats), ErrorCode::kUnsupported, "(n3, n2, n1, 4)", 3);
  refuse("short.npy", npy_file(dictionary("<f4", "(2, 3, 4)"), floats.substr(1)), ErrorCode::kBadFile, "bytes");
  refuse("long.npy", npy_file(dictionary("<f4", "(2, 3, 4)"), floats + "x"), ErrorCode::kBadFile, "bytes");
  refuse("huge.npy", npy_file(dictionary("<f4", "(99999999999, 99999999999, 4)"), floats), ErrorCode::kUnsupported,
         "more than");
  refuse("twice.npy", npy_file("{'descr': '<f4', 'descr': '<f4', 'shape': (2, 3, 4)}", floats), ErrorCode::kBadFile,
         "header");
  WriteOptions opaque;
  write_image(directory.file("opaque.png"), make_picture(), opaque);
  refuse_file("opaque.png", ErrorCode::kUnsupported, "no alpha");
  Image line{4, 1, std::vector<float>(16, 1.0f)};
  opaque.use_alpha = true;
  write_image(directory.file("line.png"), line, opaque);
  refuse_file("line.png", ErrorCode::kUnsupported, "4 x 1");
}

/// Cut anywhere, or with some bytes changed, a file is read or refused, and nothing else.
TEST_F(Tables, DamagedFilesAreReadOrRefused) {
  WriteOptions options;
  options.use_alpha = true;
  write_image(directory.file("a.png"), make_picture(), options);
  write_image(directory.file("a.exr"), make_picture(), options);
  test::write_text(directory.file("a.npy"), npy_file(dictionary("<f4", "(2, 3, 4)"), bytes_of(ramp<float>(24))));
  std::mt19937 random(5);
  for (const std::string ending : {".png", ".exr", ".npy"}) {
    const std::string whole = test::read_text(directory.file("a" + ending));
    const std::string victim = directory.file("b" + ending);
    std::size_t refused = 0;
    for (std::size_t trial = 0; trial < 600; ++trial) {
      std::string text = whole;
      if (trial < 200) {
        text.resize(trial * whole.size() / 200);
      } else {
        for (std::size_t i = 0; i <= trial % 4; ++i) text[random() % text.size()] = static_cast<char>(random());
      }
      test::write_text(victim, text);
      try {
        const FunctionTable table = read_function_table(victim, 2);
        EXPECT_EQ(table.rgba.size(), 4 * table.sizes.at(0) * table.sizes.at(1));
      } catch (const Error& error) {
        ++refused;
        EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
      }
    }
    EXPECT_GE(refused, 199u) << ending;
  }
}

}  // namespace

}  // namespace tetravox
