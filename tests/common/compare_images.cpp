/// compare_images FIRST SECOND [DIFFERENCE.png [GAIN]]: how far two pictures (.npy, .png) are apart, and where.
///
/// Prints the maximum, the RMS and how many values lie above some bounds; writes a picture of the differences,
/// brightened by GAIN (default: so that the largest is white). Exit 0 where the pictures have the same size, 1
/// otherwise.

#include "tests/common/image_compare.h"
#include "tests/common/image_file.h"

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <exception>

namespace {

using namespace tetravox;

void print_counts(const Image& first, const Image& second) {
  for (const double bound : {1e-6, 1e-5, 1e-4, 1e-3, 1e-2, 1e-1}) {
    std::size_t count = 0;
    for (std::size_t i = 0; i < first.pixels.size(); ++i)
      count += !(std::abs(static_cast<double>(first.pixels[i]) - second.pixels[i]) <= bound);
    std::printf("values that differ by more than %g: %zu of %zu\n", bound, count, first.pixels.size());
  }
}

int compare(int count, char** arguments) {
  const Image first = tests::read_picture(arguments[1]);
  const Image second = tests::read_picture(arguments[2]);
  if (first.width != second.width || first.height != second.height) {
    std::printf("%s is %d x %d, %s is %d x %d\n", arguments[1], first.width, first.height, arguments[2], second.width,
                second.height);
    return 1;
  }
  const tests::ImageDifference difference = tests::compare_images(first, second);
  std::printf("%s\n", tests::describe(difference).c_str());
  print_counts(first, second);
  if (count > 3) {
    const double largest = std::isfinite(difference.max) && difference.max > 0.0 ? difference.max : 1.0;
    const double gain = count > 4 ? std::atof(arguments[4]) : 1.0 / largest;
    tests::write_picture(arguments[3], tests::make_difference_picture(first, second, static_cast<float>(gain)));
    std::printf("differences times %g written to %s\n", gain, arguments[3]);
  }
  return 0;
}

}  // namespace

int main(int count, char** arguments) {
  if (count < 3 || count > 5) {
    std::fprintf(stderr, "usage: compare_images FIRST SECOND [DIFFERENCE.png [GAIN]]  (.npy or .png)\n");
    return 2;
  }
  try {
    return compare(count, arguments);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "compare_images: %s\n", error.what());
    return 1;
  }
}
