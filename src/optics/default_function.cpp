#include "src/optics/opacity_budget.h"
#include "tetravox/error.h"
#include "tetravox/transfer_function.h"

#include <algorithm>
#include <cmath>

namespace tetravox {
namespace {

using optics::color_at;
using optics::fit_budget;
using optics::opacity_from_extinction;

constexpr int kShellCount = 6;
constexpr double kShellWidth = 0.22;  // half width, in distances between shells
constexpr double kBodyShare = 0.10;   // extinction between the shells, relative to their peaks
constexpr double kRarity = 0.75;      // 0: alike; 1: every value has the same share of the optical depth
constexpr double kFadeWidth = 0.04;   // of the range, next to a background
constexpr std::size_t kLargestLabelCount = 40;
constexpr std::size_t kLargestBinCount = 1024;

std::vector<double> normalized(const std::vector<double>& counts) {
  std::vector<double> shares(counts.size());
  double total = 0.0;
  for (const double count : counts) total += std::isfinite(count) && count > 0.0 ? count : 0.0;
  if (!(total > 0.0) || !std::isfinite(total))
    return std::vector<double>(counts.size(), 1.0 / static_cast<double>(counts.size()));
  for (std::size_t i = 0; i < counts.size(); ++i)
    shares[i] = std::isfinite(counts[i]) && counts[i] > 0.0 ? counts[i] / total : 0.0;
  return shares;
}

/// The same shares in at most `kLargestBinCount` bins.
std::vector<double> rebinned(const std::vector<double>& shares) {
  if (shares.size() <= kLargestBinCount) return shares;
  std::vector<double> result(kLargestBinCount);
  for (std::size_t i = 0; i < shares.size(); ++i) result[i * kLargestBinCount / shares.size()] += shares[i];
  return result;
}

TransferFunction constant_function(const Histogram& histogram, bool invert) {
  TransferFunction function;
  function.unit_distance = histogram.unit_distance;
  function.absorption = Absorption::kOpacity;
  function.points = {{histogram.range.min, color_at(0.35, invert), opacity_from_extinction(optics::kBodyExtinction)}};
  return function;
}

/// How much of the extinction is left near a background: nothing in it, and all of it a little further on.
double fade_from_background(const Histogram& histogram, double value) {
  if (!histogram.background) return 1.0;
  const ValueRange& background = *histogram.background;
  const double fade = kFadeWidth * (histogram.range.max - histogram.range.min);
  return std::clamp(std::max(value - background.max, background.min - value) / fade, 0.0, 1.0);
}

/// Makes the background transparent, beyond the end of the function that it is at.
void end_at_background(const Histogram& histogram, TransferFunction& function) {
  if (!histogram.background || function.points.empty()) return;
  const ControlPoint &first = function.points.front(), &last = function.points.back();
  if (histogram.background->max <= first.value)
    function.points.insert(function.points.begin(), {histogram.background->max, first.color, 0.0});
  else if (histogram.background->min >= last.value)
    function.points.push_back({histogram.background->min, last.color, 0.0});
}

/// Few separate values (labels, materials): a flat piece for each, with a step half way to the next.
TransferFunction label_function(const Histogram& histogram, const std::vector<double>& shares,
                                const std::vector<std::size_t>& labels, bool invert) {
  std::vector<double> label_shares, extinctions;
  for (const std::size_t bin : labels) {
    label_shares.push_back(shares[bin]);
    extinctions.push_back(std::pow(shares[bin] + 1e-4, -kRarity));
  }
  extinctions = fit_budget(label_shares, label_shares, extinctions);
  const auto value_at = [&](double bin) {
    return std::lerp(histogram.range.min, histogram.range.max,
                     std::clamp(bin / static_cast<double>(shares.size()), 0.0, 1.0));
  };
  TransferFunction function;
  function.absorption = Absorption::kOpacity;
  function.unit_distance = histogram.unit_distance;
  for (std::size_t i = 0; i < labels.size(); ++i) {
    const double u = labels.size() > 1 ? static_cast<double>(i) / static_cast<double>(labels.size() - 1) : 0.35;
    const Color color = color_at(u, invert);
    const double opacity = opacity_from_extinction(extinctions[i]);
    const double bin = static_cast<double>(labels[i]);
    const double begin = i == 0 ? 0.0 : 0.5 * (bin + static_cast<double>(labels[i - 1]) + 1.0);
    const double end = i + 1 == labels.size() ? static_cast<double>(shares.size())
                                              : 0.5 * (bin + static_cast<double>(labels[i + 1]) + 1.0);
    function.points.push_back({value_at(begin), color, opacity});
    function.points.push_back({value_at(end), color, opacity});
  }
  end_at_background(histogram, function);
  return function;
}

/// Bins that hold something, if they are few and each stands alone; otherwise nothing.
std::vector<std::size_t> find_labels(const std::vector<double>& shares) {
  std::vector<std::size_t> labels;
  for (std::size_t i = 0; i < shares.size(); ++i) {
    if (!(shares[i] > 0.0)) continue;
    if (!labels.empty() && labels.back() + 1 == i) return {};
    if (labels.size() == kLargestLabelCount) return {};
    labels.push_back(i);
  }
  return labels;
}

}  // namespace

TransferFunction make_default_transfer_function(const Histogram& histogram, bool invert) {
  if (histogram.counts.empty() || !std::isfinite(histogram.range.min) || !std::isfinite(histogram.range.max) ||
      histogram.range.min > histogram.range.max)
    throw Error(ErrorCode::kInvalidArgument, "a histogram needs bins and a finite range");
  const std::vector<double> raw = rebinned(normalized(histogram.counts));
  if (!(histogram.range.max > histogram.range.min)) return constant_function(histogram, invert);
  if (const std::vector<std::size_t> labels = find_labels(raw); !labels.empty() && raw.size() > 2)
    return label_function(histogram, raw, labels, invert);

  // Follow the histogram, smoothed: shells at equal steps of position, on a faint body, the thinner the more frequent.
  const std::vector<double> shares = optics::smoothed(raw, static_cast<double>(raw.size()) / 128.0);
  const std::vector<double> u = optics::positions(shares);
  std::vector<double> extinctions(shares.size());
  for (std::size_t i = 0; i < shares.size(); ++i) {
    const double density = shares[i] * static_cast<double>(shares.size());
    const double phase = u[i] * kShellCount - std::floor(u[i] * kShellCount) - 0.5;
    const double shell = std::exp(-0.5 * phase * phase / (0.25 * kShellWidth * kShellWidth));
    extinctions[i] = (kBodyShare + shell) * std::pow(density + 0.02, -kRarity);
  }
  extinctions = fit_budget(raw, optics::widened(raw), extinctions);

  TransferFunction function;
  function.absorption = Absorption::kOpacity;
  function.unit_distance = histogram.unit_distance;
  for (std::size_t i = 0; i < shares.size(); ++i) {
    const double t = (static_cast<double>(i) + 0.5) / static_cast<double>(shares.size());
    const double value = std::lerp(histogram.range.min, histogram.range.max, t);
    function.points.push_back({value, color_at(u[i], invert),
                               opacity_from_extinction(extinctions[i] * fade_from_background(histogram, value))});
  }
  end_at_background(histogram, function);
  return function;
}

}  // namespace tetravox
