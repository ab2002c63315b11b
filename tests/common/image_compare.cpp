#include "tests/common/image_compare.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <limits>

namespace tetravox::tests {

ImageDifference compare_images(const Image& first, const Image& second) {
  ImageDifference result;
  if (first.width != second.width || first.height != second.height || first.pixels.size() != second.pixels.size()) {
    result.max = result.rms = std::numeric_limits<double>::infinity();
    return result;
  }
  double sum = 0.0;
  for (std::size_t i = 0; i < first.pixels.size(); ++i) {
    double error = std::abs(static_cast<double>(first.pixels[i]) - second.pixels[i]);
    if (!std::isfinite(error)) error = std::numeric_limits<double>::infinity();
    sum += error * error;
    if (error > result.max) {
      result.max = error;
      result.channel = static_cast<int>(i % 4);
      result.x = static_cast<int>(i / 4 % first.width);
      result.y = static_cast<int>(i / 4 / first.width);
      result.first = first.pixels[i];
      result.second = second.pixels[i];
    }
  }
  result.rms = first.pixels.empty() ? 0.0 : std::sqrt(sum / static_cast<double>(first.pixels.size()));
  return result;
}

std::string describe(const ImageDifference& d) {
  char text[200];
  std::snprintf(text, sizeof text, "max %.3g at pixel (%d, %d) channel %d: %.7g and %.7g; RMS %.3g", d.max, d.x, d.y,
                d.channel, static_cast<double>(d.first), static_cast<double>(d.second), d.rms);
  return text;
}

::testing::AssertionResult images_agree(const Image& actual, const Image& expected, double max, double rms) {
  const ImageDifference difference = compare_images(actual, expected);
  if (difference.max <= max && difference.rms <= rms) return ::testing::AssertionSuccess();
  return ::testing::AssertionFailure() << describe(difference) << " (allowed: max " << max << ", RMS " << rms << ")";
}

::testing::AssertionResult images_agree(const Image& actual, const Image& expected, double max) {
  return images_agree(actual, expected, max, max);
}

::testing::AssertionResult images_equal(const Image& actual, const Image& expected) {
  if (actual.width == expected.width && actual.height == expected.height &&
      actual.pixels.size() == expected.pixels.size() &&
      std::memcmp(actual.pixels.data(), expected.pixels.data(), sizeof(float) * actual.pixels.size()) == 0)
    return ::testing::AssertionSuccess();
  return ::testing::AssertionFailure() << describe(compare_images(actual, expected)) << " (allowed: same bytes)";
}

::testing::AssertionResult is_valid_picture(const Image& image) {
  for (std::size_t i = 0; i < image.pixels.size(); i += 4) {
    const float* pixel = &image.pixels[i];
    const float alpha = pixel[3];
    bool is_valid = alpha >= 0.0f && alpha <= 1.0f;
    for (int k = 0; k < 3; ++k) is_valid = is_valid && pixel[k] >= 0.0f && pixel[k] <= alpha + 1e-5f;
    if (!is_valid)
      return ::testing::AssertionFailure() << "pixel (" << i / 4 % image.width << ", " << i / 4 / image.width << ") is "
                                           << pixel[0] << " " << pixel[1] << " " << pixel[2] << " " << pixel[3];
  }
  return ::testing::AssertionSuccess();
}

int count_apart(const Image& first, const Image& second, double max) {
  int count = 0;
  for (std::size_t pixel = 0; pixel < first.pixels.size(); pixel += 4) {
    float most = 0.0f;
    for (std::size_t i = pixel; i < pixel + 4; ++i) most = std::max(most, std::abs(first.pixels[i] - second.pixels[i]));
    count += most > max ? 1 : 0;
  }
  return count;
}

std::size_t count_covered(const Image& image) {
  std::size_t count = 0;
  for (std::size_t i = 3; i < image.pixels.size(); i += 4) count += image.pixels[i] > 0.0f;
  return count;
}

int largest_8bit_step(const Image& first, const Image& second, float background) {
  const auto quantise = [&](const Image& image, std::size_t i) {
    const float value = image.pixels[i] + (1.0f - image.pixels[i - i % 4 + 3]) * background;
    return static_cast<int>(std::lround(255.0f * std::clamp(value, 0.0f, 1.0f)));
  };
  int largest = 0;
  for (std::size_t i = 0; i < first.pixels.size(); ++i) {
    if (i % 4 == 3) continue;
    largest = std::max(largest, std::abs(quantise(first, i) - quantise(second, i)));
  }
  return largest;
}

}  // namespace tetravox::tests
