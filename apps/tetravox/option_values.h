#pragma once

/// Strict parsing of option values: all of the text counts, whatever the locale. Every function throws `UsageError`
/// that names the option.

#include "tetravox/dataset.h"
#include "tetravox/scene.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <vector>

namespace tetravox::tool {

/// A wrong command line: exit code 2.
class UsageError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// A finite number.
double parse_number(const std::string& option, const std::string& text);
double parse_positive_number(const std::string& option, const std::string& text);
/// Samples a voxel; 0 for "auto".
double parse_rate(const std::string& option, const std::string& text);
/// A whole number in [smallest, largest].
std::int64_t parse_integer(const std::string& option, const std::string& text, std::int64_t smallest,
                           std::int64_t largest);
/// "x,y,z".
std::array<double, 3> parse_vector(const std::string& option, const std::string& text);
/// "r,g,b", each in [0, 1].
Color parse_color(const std::string& option, const std::string& text);
/// "a,b" with a < b.
ValueRange parse_range(const std::string& option, const std::string& text);
/// "W,H" (or "WxH"), each in [1, kLargestResolution].
std::array<int, 2> parse_resolution(const std::string& option, const std::string& text);
/// Whole number: an index; with a decimal point or exponent: a value.
TimeRequest parse_time(const std::string& option, const std::string& text);
/// 0, 1, 2, ... or "magnitude".
int parse_component(const std::string& option, const std::string& text);
/// "X,Y,Z", whole numbers above 0.
std::array<std::uint32_t, 3> parse_dimensions(const std::string& option, const std::string& text);
/// "X,Y,Z", numbers above 0.
std::array<double, 3> parse_spacing(const std::string& option, const std::string& text);
/// "NAME" or "NAME:COMPONENT"; a colon is part of the name where neither a number nor "magnitude" follows.
ArrayRequest parse_array(const std::string& option, const std::string& text);
/// Exactly `count` numbers with commas between; `what` says what they are.
std::vector<double> parse_numbers(const std::string& option, const std::string& text, std::size_t count,
                                  const std::string& what);
/// The parts of a text between `separator`s.
std::vector<std::string> split(const std::string& text, char separator);
/// One of `names`: its index.
std::size_t parse_choice(const std::string& option, const std::string& text, const std::vector<std::string>& names);

}  // namespace tetravox::tool
