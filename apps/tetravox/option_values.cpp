#include "apps/tetravox/option_values.h"

#include "apps/tetravox/text.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>
#include <system_error>

namespace tetravox::tool {
namespace {

constexpr double kLargestDimension = 0xFFFFFFFE;

[[noreturn]] void refuse(const std::string& option, const std::string& text, const std::string& wanted) {
  throw UsageError(option + ": '" + text + "' is not " + wanted);
}

/// The text as a number of type T, all of it, or nothing. A leading plus is allowed.
template <class T>
std::optional<T> parse_whole(std::string_view text) {
  if (text.size() > 1 && text[0] == '+' && text[1] != '-') text.remove_prefix(1);
  T value{};
  const auto result = std::from_chars(text.data(), text.data() + text.size(), value);
  if (result.ec != std::errc{} || result.ptr != text.data() + text.size()) return {};
  return value;
}

std::optional<double> parse_finite(std::string_view text) {
  const auto value = parse_whole<double>(text);
  return value && std::isfinite(*value) ? value : std::nullopt;
}

/// Exactly `count` finite numbers with commas between them, or nothing.
std::optional<std::vector<double>> parse_list(std::string_view text, std::size_t count) {
  std::vector<double> values;
  while (values.size() < count) {
    const std::size_t comma = std::min(text.find(','), text.size());
    const auto value = parse_finite(text.substr(0, comma));
    if (!value) return {};
    values.push_back(*value);
    if (comma == text.size()) break;
    text.remove_prefix(comma + 1);
    if (values.size() == count) return {};
  }
  if (values.size() != count) return {};
  return values;
}

}  // namespace

double parse_number(const std::string& option, const std::string& text) {
  const auto value = parse_finite(text);
  if (!value) refuse(option, text, "a number");
  return *value;
}

double parse_positive_number(const std::string& option, const std::string& text) {
  const auto value = parse_finite(text);
  if (!value || *value <= 0.0) refuse(option, text, "a number above 0");
  return *value;
}

double parse_rate(const std::string& option, const std::string& text) {
  if (text == "auto") return 0.0;
  const auto value = parse_finite(text);
  if (!value || !(*value >= kLowestRate && *value <= kHighestRate))
    refuse(option, text, "a number from 0.001 to 64, or auto");
  return *value;
}

std::int64_t parse_integer(const std::string& option, const std::string& text, std::int64_t smallest,
                           std::int64_t largest) {
  const auto value = parse_whole<std::int64_t>(text);
  if (!value || *value < smallest || *value > largest)
    refuse(option, text, "a whole number from " + std::to_string(smallest) + " to " + std::to_string(largest));
  return *value;
}

std::array<double, 3> parse_vector(const std::string& option, const std::string& text) {
  const auto values = parse_list(text, 3);
  if (!values) refuse(option, text, "three numbers 'x,y,z'");
  return {(*values)[0], (*values)[1], (*values)[2]};
}

Color parse_color(const std::string& option, const std::string& text) {
  const auto values = parse_list(text, 3);
  if (!values || std::any_of(values->begin(), values->end(), [](double v) { return v < 0.0 || v > 1.0; }))
    refuse(option, text, "a colour 'r,g,b' of three numbers from 0 to 1");
  return {(*values)[0], (*values)[1], (*values)[2]};
}

ValueRange parse_range(const std::string& option, const std::string& text) {
  const auto values = parse_list(text, 2);
  if (!values) refuse(option, text, "two numbers 'a,b'");
  if (!((*values)[0] < (*values)[1])) refuse(option, text, "a range 'a,b' with a below b");
  return {(*values)[0], (*values)[1]};
}

std::array<int, 2> parse_resolution(const std::string& option, const std::string& text) {
  const std::size_t separator = std::min(text.find_first_of(",x"), text.size());
  const auto width = parse_whole<int>(std::string_view(text).substr(0, separator));
  const auto height = parse_whole<int>(std::string_view(text).substr(std::min(separator + 1, text.size())));
  const auto is_valid = [](const std::optional<int>& size) {
    return size && *size >= 1 && *size <= kLargestResolution;
  };
  if (!is_valid(width) || !is_valid(height))
    refuse(option, text, "a resolution 'W,H' of whole numbers from 1 to " + std::to_string(kLargestResolution));
  return {*width, *height};
}

TimeRequest parse_time(const std::string& option, const std::string& text) {
  TimeRequest request;
  if (text.find_first_of(".eE") != std::string::npos) {
    request.value = parse_number(option, text);
    return request;
  }
  const auto index = parse_whole<std::uint32_t>(text);
  if (!index) refuse(option, text, "the index of a time step (0, 1, ...) or a time with a decimal point (2.0)");
  request.index = *index;
  return request;
}

int parse_component(const std::string& option, const std::string& text) {
  if (text == "magnitude") return kMagnitude;
  const auto index = parse_whole<int>(text);
  if (!index || *index < 0) refuse(option, text, "a component: 0, 1, 2, ... or 'magnitude'");
  return *index;
}

std::array<std::uint32_t, 3> parse_dimensions(const std::string& option, const std::string& text) {
  const auto values = parse_list(text, 3);
  std::array<std::uint32_t, 3> dimensions{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double value = values ? (*values)[axis] : 0.0;
    if (!(value >= 1.0 && value <= kLargestDimension) || value != std::floor(value))
      refuse(option, text, "three whole numbers 'x,y,z' of points, each from 1");
    dimensions[axis] = static_cast<std::uint32_t>(value);
  }
  return dimensions;
}

std::array<double, 3> parse_spacing(const std::string& option, const std::string& text) {
  const auto values = parse_list(text, 3);
  if (!values || std::any_of(values->begin(), values->end(), [](double v) { return !(v > 0.0); }))
    refuse(option, text, "three numbers 'x,y,z' above 0");
  return {(*values)[0], (*values)[1], (*values)[2]};
}

ArrayRequest parse_array(const std::string& option, const std::string& text) {
  ArrayRequest request{text, {}, {}};
  const std::size_t colon = text.rfind(':');
  if (colon != std::string::npos) {
    const std::string component = text.substr(colon + 1);
    if (component == "magnitude" || parse_whole<int>(component)) {
      request.name = text.substr(0, colon);
      request.component = parse_component(option, component);
    }
  }
  if (request.name.empty()) refuse(option, text, "the name of an array");
  return request;
}

std::vector<std::string> split(const std::string& text, char separator) {
  std::vector<std::string> parts;
  std::size_t begin = 0;
  for (std::size_t end = text.find(separator); end != std::string::npos; end = text.find(separator, begin)) {
    parts.push_back(text.substr(begin, end - begin));
    begin = end + 1;
  }
  parts.push_back(text.substr(begin));
  return parts;
}

std::vector<double> parse_numbers(const std::string& option, const std::string& text, std::size_t count,
                                  const std::string& what) {
  const std::vector<std::string> parts = split(text, ',');
  if (parts.size() != count)
    throw UsageError(option + ": '" + text + "' is not " + std::to_string(count) + " numbers: " + what);
  std::vector<double> numbers;
  for (const std::string& part : parts) numbers.push_back(parse_number(option, part));
  return numbers;
}

std::size_t parse_choice(const std::string& option, const std::string& text, const std::vector<std::string>& names) {
  const auto found = std::find(names.begin(), names.end(), text);
  if (found != names.end()) return static_cast<std::size_t>(found - names.begin());
  std::string list;
  for (const std::string& name : names) list += (list.empty() ? "" : ", ") + name;
  refuse(option, text, "one of " + list);
}

}  // namespace tetravox::tool
