#pragma once

/// Histograms as pictures, with axes.

#include "tetravox/analysis.h"
#include "tetravox/image.h"

namespace tetravox::tool {

/// Columns over the value, upwards by share of the volume; along a logarithm, tenfold from tick to tick.
Image draw_histogram(const Histogram& histogram, bool use_logarithm);

/// Value to the right, gradient magnitude or another array upwards, bright where much of the volume is.
Image draw_histogram(const Histogram2D& histogram, bool use_logarithm);

}  // namespace tetravox::tool
