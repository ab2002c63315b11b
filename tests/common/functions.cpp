#include "tests/common/functions.h"

#include <cmath>
#include <random>

namespace tetravox::tests {
namespace {

const Color kColors[9] = {{0.0, 0.0, 0.6},  {0.1, 0.3, 0.9}, {0.2, 0.7, 0.9}, {0.2, 0.9, 0.5}, {0.7, 0.9, 0.2},
                          {0.95, 0.8, 0.2}, {1.0, 0.5, 0.1}, {1.0, 0.2, 0.1}, {1.0, 1.0, 1.0}};

double value_at(const ValueRange& range, double u) { return range.min + u * (range.max - range.min); }

OpticalFunction make_smooth(const ValueRange& range, double largest_extinction) {
  OpticalFunction function;
  for (int i = 0; i < 9; ++i)
    function.points.push_back({value_at(range, i / 8.0), largest_extinction * i * i / 64.0, kColors[i]});
  return function;
}

OpticalFunction make_spikes(const ValueRange& range, double peak) {
  OpticalFunction function;
  for (int i = 0; i < 8; ++i) {
    const double middle = (i + 0.6) / 8.0;
    for (const double side : {-1.0, 0.0, 1.0})
      function.points.push_back({value_at(range, middle + 0.01 * side), side == 0.0 ? peak : 0.0, kColors[i + 1]});
  }
  return function;
}

OpticalFunction make_steps(const ValueRange& range, double unit) {
  return {{{value_at(range, 0.15), 0.0, kColors[1]},
           {value_at(range, 0.15), 2.0 * unit, kColors[3]},
           {value_at(range, 0.4), 2.0 * unit, kColors[5]},
           {value_at(range, 0.4), 0.2 * unit, kColors[6]},
           {value_at(range, 0.62), 8.0 * unit, kColors[7]},
           {value_at(range, 0.62), 0.0, kColors[7]},
           {value_at(range, 0.8), 0.0, kColors[2]},
           {value_at(range, 0.8), 25.0 * unit, kColors[8]}}};
}

OpticalFunction make_random(const ValueRange& range, double largest_extinction) {
  std::mt19937 random(20);
  const auto draw = [&] { return static_cast<double>(random()) / 4294967295.0; };
  OpticalFunction function;
  for (int i = 0; i < 64; ++i) {
    OpticalPoint point;
    point.value = value_at(range, i / 63.0);
    for (double& component : point.color) component = draw();
    point.extinction = largest_extinction * std::pow(draw(), 6.0);
    function.points.push_back(point);
  }
  return function;
}

}  // namespace

std::vector<NamedFunction> make_hard_functions(const ValueRange& range, double diagonal) {
  return {{"smooth", make_smooth(range, 20.0 / diagonal)},
          {"thick", make_smooth(range, 1500.0 / diagonal)},
          {"spikes", make_spikes(range, 300.0 / diagonal)},
          {"steps", make_steps(range, 3.0 / diagonal)},
          {"random", make_random(range, 30.0 / diagonal)}};
}

double diagonal_of(const std::array<ValueRange, 3>& bounds) {
  return std::hypot(bounds[0].max - bounds[0].min, bounds[1].max - bounds[1].min, bounds[2].max - bounds[2].min);
}

}  // namespace tetravox::tests
