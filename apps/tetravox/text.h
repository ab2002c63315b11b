#pragma once

/// Numbers and lines for people and for messages; independent of the locale.

#include "tetravox/dataset.h"

#include <array>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace tetravox::tool {

/// "1,234,567".
std::string format_count(std::uint64_t count);
/// At most `digits` significant digits: "0.1926", "1.5e-07".
std::string format_number(double value, int digits = 5);
/// "0.19 .. 4.98".
std::string format_range(const ValueRange& range);
/// "x 0 .. 1, y 0 .. 2, z -1 .. 1".
std::string format_bounds(const std::array<ValueRange, 3>& bounds);
/// "1.5 GiB", "312 MiB".
std::string format_bytes(std::uint64_t bytes);
/// "0.31 s", "2 min 5 s".
std::string format_seconds(double seconds);
/// The text with control characters (line ends, escape sequences) turned into spaces.
std::string single_line(const std::string& text);
/// Rows of name and description in two columns.
std::string format_table(const std::vector<std::pair<std::string, std::string>>& rows);
/// The candidate that is closest to `word` in letters to change, or that has it as a part; "" where none is close.
std::string closest_word(const std::string& word, const std::vector<std::string>& candidates);

/// Ending of a path in lower case, with its dot.
std::string ending_of(const std::string& path);

}  // namespace tetravox::tool
