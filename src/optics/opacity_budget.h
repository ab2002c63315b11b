#pragma once

/// What functions made from the data share: colours along them, and how much opacity there is to give away.
///
/// Shares are of the volume, [bins] over equal steps of the value, with the sum 1. Extinctions are for the unit
/// distance.

#include "tetravox/transfer_function.h"

#include <vector>

namespace tetravox::optics {

/// Extinction where all is alike.
inline constexpr double kBodyExtinction = 0.025;

double opacity_from_extinction(double extinction);

/// Colours at u in [0, 1]: the hues of turbo without its dark ends, which would not show on black.
Color color_at(double u, bool invert);

/// Smoothed by a Gaussian whose standard deviation is `sigma` bins; the sum stays.
std::vector<double> smoothed(const std::vector<double>& shares, double sigma);

/// Position of each bin in [0, 1]: in part by value, the rest by the square root of how frequent values are, so that
/// skewed data still has many colours.
std::vector<double> positions(const std::vector<double>& shares, double part_by_value = 0.5);

/// The largest share of each bin and its two neighbours: a value at the edge of a bin is drawn with both.
std::vector<double> widened(const std::vector<double>& shares);

/// Optical depth of a ray on which values are as frequent as in the data.
double mean_depth(const std::vector<double>& shares, const std::vector<double>& extinctions);

/// Scales extinctions to the budget of optical depth. Rare values may be nearly solid. The most frequent ones, by
/// `crowds`, stay below a body's extinction, which is raised only as far as it takes to see something at all.
std::vector<double> fit_budget(const std::vector<double>& shares, const std::vector<double>& crowds,
                               const std::vector<double>& extinctions);

/// Scales extinctions to the same budget by one factor, so that their shape stays; the largest is nearly solid at most.
std::vector<double> scale_to_budget(const std::vector<double>& shares, const std::vector<double>& extinctions);

}  // namespace tetravox::optics
