#pragma once

/// How far two pictures are apart.

#include "tetravox/image.h"

#include <gtest/gtest.h>

#include <string>

namespace tetravox::tests {

/// Absolute differences over all pixels and channels.
struct ImageDifference {
  double max = 0.0;  ///< infinite where a value is not finite or sizes differ
  double rms = 0.0;
  int x = 0, y = 0, channel = 0;  ///< where the maximum is
  float first = 0, second = 0;    ///< the two values there
};

ImageDifference compare_images(const Image& first, const Image& second);

/// "max 1.2e-3 at pixel (3, 4) channel 0: 0.5 and 0.5012; RMS 1e-5".
std::string describe(const ImageDifference& difference);

/// Holds when the pictures differ by at most `max` and `rms`.
::testing::AssertionResult images_agree(const Image& actual, const Image& expected, double max, double rms);
::testing::AssertionResult images_agree(const Image& actual, const Image& expected, double max);

/// Holds when both have the same bytes.
::testing::AssertionResult images_equal(const Image& actual, const Image& expected);

/// Holds when every value is finite, opacity is in [0, 1], and each colour in [0, opacity] up to rounding.
::testing::AssertionResult is_valid_picture(const Image& image);

/// Pixels of pictures of one size that differ by more than `max` in some channel.
int count_apart(const Image& first, const Image& second, double max);

/// Pixels with an opacity above 0.
std::size_t count_covered(const Image& image);

/// Largest absolute difference of the two as floats turned into 8 bits over a grey background, in steps.
int largest_8bit_step(const Image& first, const Image& second, float background);

}  // namespace tetravox::tests
