#include "src/io/time_steps.h"

#include "tetravox/error.h"

#include <algorithm>
#include <cmath>
#include <sstream>

namespace tetravox::io {

namespace {

[[noreturn]] void fail_time(const std::vector<double>& times, const std::string& asked, const std::string& file) {
  std::ostringstream text;
  text << "'" << file << "' has no time step " << asked << ": ";
  if (times.empty())
    text << "it holds a single state; leave the time out";
  else
    text << "it holds steps 0 to " << times.size() - 1 << ", times " << times.front() << " to " << times.back();
  throw Error(ErrorCode::kInvalidArgument, text.str());
}

std::size_t pick_nearest(const std::vector<double>& times, double value, const std::string& file) {
  std::ostringstream asked;
  asked << "at time " << value;
  if (times.empty() || !std::isfinite(value)) fail_time(times, asked.str(), file);
  // Allow for the rounding of a time that was typed.
  const double slack = 1e-6 * std::max({std::abs(times.front()), std::abs(times.back()), times.back() - times.front()});
  if (value < times.front() - slack || value > times.back() + slack) fail_time(times, asked.str(), file);
  const auto nearest = std::min_element(times.begin(), times.end(),
                                        [&](double a, double b) { return std::abs(a - value) < std::abs(b - value); });
  return static_cast<std::size_t>(nearest - times.begin());
}

}  // namespace

std::size_t pick_time(const std::vector<double>& times, const TimeRequest& request, const std::string& file) {
  if (request.index) {
    if (*request.index >= std::max<std::size_t>(times.size(), 1))
      fail_time(times, std::to_string(*request.index), file);
    return *request.index;
  }
  if (request.value) return pick_nearest(times, *request.value, file);
  return 0;
}

}  // namespace tetravox::io
