#include "apps/tetravox/histogram_picture.h"

#include "apps/tetravox/text.h"

#include "tetravox/transfer_function.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace tetravox::tool {
namespace {

constexpr Color kPaper{0.07, 0.07, 0.08}, kInk{0.78, 0.78, 0.80}, kGridLine{0.16, 0.16, 0.18}, kBar{0.36, 0.68, 0.95};
constexpr int kLeft = 112, kRight = 40, kTop = 24, kBottom = 56;  // pixels beside the plot
constexpr int kTickLength = 7;
constexpr int kWantedWidth = 768, kWantedHeight = 512, kMostColumns = 1536;
constexpr double kMostDecades = 7.0;  // that a logarithm shows

/// Digits three pixels wide and five high: a bit for each pixel, the top left one first.
constexpr char kGlyphNames[] = "0123456789.-+e";
constexpr std::array<std::uint16_t, 14> kGlyphs{
    0b010'101'101'101'010, 0b010'110'010'010'111, 0b111'001'111'100'111, 0b111'001'111'001'111, 0b101'101'111'001'001,
    0b111'100'111'001'111, 0b111'100'111'101'111, 0b111'001'010'010'010, 0b111'101'111'101'111, 0b111'101'111'001'111,
    0b000'000'000'000'010, 0b000'000'111'000'000, 0b000'010'111'010'000, 0b010'101'111'100'011};
constexpr int kGlyphScale = 2, kGlyphStep = 4 * kGlyphScale, kGlyphHeight = 5 * kGlyphScale;

/// Pixels of a plot's axis for that many bins: whole pixels a bin while there are few.
int axis_pixels(int bins, int wanted) { return bins > kMostColumns ? kMostColumns : bins * std::max(1, wanted / bins); }

/// Where numbers on an axis are written: multiples of 1, 2 or 5 times a power of ten.
std::vector<double> make_ticks(const ValueRange& range) {
  constexpr double kMostTicks = 8.0;
  const double width = range.max - range.min;
  if (!(width > 0.0) || !std::isfinite(width)) return {range.min};
  const double decade = std::pow(10.0, std::floor(std::log10(width / kMostTicks)));
  double step = 10.0 * decade;
  for (const double factor : {5.0, 2.0, 1.0})
    if (width / (factor * decade) <= kMostTicks) step = factor * decade;
  std::vector<double> ticks;
  for (double n = std::ceil(range.min / step - 1e-9); n * step <= range.max + 1e-9 * width && ticks.size() < 20; ++n)
    ticks.push_back(n * step + 0.0);  // never -0
  return ticks;
}

/// A picture with a plot in it; plot coordinates count pixels from its lower left corner.
class Plot {
 public:
  Plot(int width, int height) : width_(width), height_(height) {
    image_.width = kLeft + width + kRight;
    image_.height = kTop + height + kBottom;
    image_.pixels.resize(4 * static_cast<std::size_t>(image_.width) * static_cast<std::size_t>(image_.height));
    for (int y = 0; y < image_.height; ++y)
      for (int x = 0; x < image_.width; ++x) set(x, y, kPaper);
  }

  int width() const { return width_; }
  int height() const { return height_; }
  void paint(int x, int y, const Color& color) { set(kLeft + x, kTop + height_ - 1 - y, color); }

  /// A tick with its number below the plot, at `share` of the way to the right; likewise at its left.
  void add_tick_below(double share, double value, bool with_line) {
    const int x = kLeft + static_cast<int>(std::lround(share * (width_ - 1))), y = kTop + height_;
    if (with_line) fill(x, kTop, 1, height_, kGridLine);
    fill(x, y + 1, 1, kTickLength, kInk);
    const std::string text = format_number(value, 4);
    write(x - text_width(text) / 2, y + kTickLength + 6, text);
  }
  void add_tick_left(double share, double value, bool with_line) {
    const int x = kLeft - 1, y = kTop + height_ - 1 - static_cast<int>(std::lround(share * (height_ - 1)));
    if (with_line) fill(kLeft, y, width_, 1, kGridLine);
    fill(x - kTickLength, y, kTickLength, 1, kInk);
    const std::string text = format_number(value, 4);
    write(x - kTickLength - 6 - text_width(text), y - kGlyphHeight / 2, text);
  }
  Image finish() {
    fill(kLeft - 1, kTop, 1, height_ + 1, kInk);
    fill(kLeft - 1, kTop + height_, width_ + 1, 1, kInk);
    return std::move(image_);
  }

 private:
  static int text_width(const std::string& text) { return kGlyphStep * static_cast<int>(text.size()) - kGlyphScale; }

  void set(int x, int y, const Color& color) {
    if (x < 0 || y < 0 || x >= image_.width || y >= image_.height) return;
    float* pixel = image_.pixel(x, y);
    for (std::size_t c = 0; c < 3; ++c) pixel[c] = static_cast<float>(color[c]);
    pixel[3] = 1.0f;
  }
  void fill(int x, int y, int width, int height, const Color& color) {
    for (int j = y; j < y + height; ++j)
      for (int i = x; i < x + width; ++i) set(i, j, color);
  }
  void write(int x, int y, const std::string& text) {
    for (const char letter : text) {
      const std::size_t glyph = std::string(kGlyphNames).find(letter);
      for (int bit = 0; glyph < kGlyphs.size() && bit < 15; ++bit)
        if ((kGlyphs[glyph] >> (14 - bit)) & 1)
          fill(x + bit % 3 * kGlyphScale, y + bit / 3 * kGlyphScale, kGlyphScale, kGlyphScale, kInk);
      x += kGlyphStep;
    }
  }

  Image image_;
  int width_, height_;
};

/// From shares of the volume to [0, 1], and back to the numbers beside an axis.
struct ShareScale {
  ShareScale(const std::vector<double>& shares, bool logarithmic) : use_logarithm(logarithmic) {
    double least = 0.0;
    for (const double share : shares) {
      largest = std::max(largest, share);
      if (share > 0.0 && (least == 0.0 || share < least)) least = share;
    }
    if (!(largest > 0.0)) largest = 1.0;
    // The least share is to be seen: the axis begins below it.
    decades = std::clamp(std::log10(largest / std::max(least, 1e-300)) + 0.5, 1.0, kMostDecades);
  }

  double position(double share) const {
    if (!use_logarithm) return share / largest;
    return share > 0.0 ? std::clamp(1.0 + std::log10(share / largest) / decades, 0.0, 1.0) : 0.0;
  }
  std::vector<double> ticks() const {
    if (!use_logarithm) return make_ticks({0.0, largest});
    std::vector<double> ticks;
    for (double decade = std::floor(std::log10(largest)); decade >= std::log10(largest) - decades; --decade)
      ticks.push_back(std::pow(10.0, decade));
    return ticks;
  }

  bool use_logarithm;
  double largest = 0.0, decades = 1.0;
};

/// Bins that a column of pixels shows: one or more.
struct BinSpan {
  std::size_t begin, end;
};
BinSpan bins_at(int pixel, int pixels, int bins) {
  const auto at = [&](int p) { return static_cast<std::size_t>(std::int64_t{p} * bins / pixels); };
  return {at(pixel), std::max(at(pixel + 1), at(pixel) + 1)};
}

void add_value_ticks(Plot& plot, const ValueRange& range, bool with_lines) {
  const double width = range.max - range.min;
  for (const double tick : make_ticks(range))
    plot.add_tick_below(width > 0.0 ? (tick - range.min) / width : 0.5, tick, with_lines);
}

}  // namespace

Image draw_histogram(const Histogram& histogram, bool use_logarithm) {
  const int bins = static_cast<int>(histogram.counts.size());
  Plot plot(axis_pixels(bins, kWantedWidth), kWantedHeight);
  const ShareScale scale(histogram.counts, use_logarithm);
  add_value_ticks(plot, histogram.range, true);
  for (const double tick : scale.ticks()) plot.add_tick_left(scale.position(tick), tick, true);
  for (int x = 0; x < plot.width(); ++x) {
    const BinSpan span = bins_at(x, plot.width(), bins);
    double share = 0.0;
    for (std::size_t bin = span.begin; bin < span.end; ++bin) share = std::max(share, histogram.counts[bin]);
    const auto top = static_cast<int>(std::lround(scale.position(share) * plot.height()));
    for (int y = 0; y < top; ++y) plot.paint(x, y, kBar);
  }
  return plot.finish();
}

Image draw_histogram(const Histogram2D& histogram, bool use_logarithm) {
  Plot plot(axis_pixels(histogram.bins, kWantedWidth), axis_pixels(histogram.other_bins, kWantedHeight));
  const ShareScale scale(histogram.counts, use_logarithm);
  PresetOptions unit;
  unit.range = {0.0, 1.0};
  const OpticalFunction colors = make_optical_function(make_preset("inferno:constant=0.5", unit), 1.0);
  add_value_ticks(plot, histogram.range, false);
  const double height = histogram.other_range.max - histogram.other_range.min;
  for (const double tick : make_ticks(histogram.other_range))
    plot.add_tick_left(height > 0.0 ? (tick - histogram.other_range.min) / height : 0.5, tick, false);
  for (int y = 0; y < plot.height(); ++y)
    for (int x = 0; x < plot.width(); ++x) {
      const BinSpan rows = bins_at(y, plot.height(), histogram.other_bins);
      const BinSpan columns = bins_at(x, plot.width(), histogram.bins);
      double share = 0.0;
      for (std::size_t row = rows.begin; row < rows.end; ++row)
        for (std::size_t column = columns.begin; column < columns.end; ++column)
          share = std::max(share, histogram.counts[row * static_cast<std::size_t>(histogram.bins) + column]);
      plot.paint(x, y, eval_optical_function(colors, scale.position(share)).color);
    }
  return plot.finish();
}

}  // namespace tetravox::tool
