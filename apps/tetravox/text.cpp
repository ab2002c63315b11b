#include "apps/tetravox/text.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <filesystem>

namespace tetravox::tool {

std::string format_count(std::uint64_t count) {
  const std::string digits = std::to_string(count);
  std::string text;
  for (std::size_t i = 0; i < digits.size(); ++i) {
    if (i > 0 && (digits.size() - i) % 3 == 0) text.push_back(',');
    text.push_back(digits[i]);
  }
  return text;
}

std::string format_number(double value, int digits) {
  std::array<char, 64> text{};
  const auto result = std::to_chars(text.data(), text.data() + text.size(), value, std::chars_format::general, digits);
  return {text.data(), result.ptr};
}

std::string format_range(const ValueRange& range) {
  return format_number(range.min) + " .. " + format_number(range.max);
}

std::string format_bounds(const std::array<ValueRange, 3>& bounds) {
  return "x " + format_range(bounds[0]) + ", y " + format_range(bounds[1]) + ", z " + format_range(bounds[2]);
}

std::string format_bytes(std::uint64_t bytes) {
  constexpr std::array<const char*, 5> kUnits{"bytes", "KiB", "MiB", "GiB", "TiB"};
  double value = static_cast<double>(bytes);
  std::size_t unit = 0;
  for (; value >= 1024.0 && unit + 1 < kUnits.size(); ++unit) value /= 1024.0;
  const double shown = value < 10.0 && unit > 0 ? std::round(value * 10.0) / 10.0 : std::round(value);
  return format_number(shown, 6) + " " + kUnits[unit];
}

std::string format_seconds(double seconds) {
  if (seconds >= 60.0) {
    const auto whole = static_cast<std::uint64_t>(seconds);
    return std::to_string(whole / 60) + " min " + std::to_string(whole % 60) + " s";
  }
  return format_number(seconds, seconds < 0.1 ? 2 : 3) + " s";
}

std::string single_line(const std::string& text) {
  std::string line = text;
  for (char& letter : line)
    if (static_cast<unsigned char>(letter) < 0x20 || letter == 0x7F) letter = ' ';
  return line;
}

std::string format_table(const std::vector<std::pair<std::string, std::string>>& rows) {
  std::size_t width = 0;
  for (const auto& row : rows) width = std::max(width, row.first.size());
  std::string text;
  for (const auto& row : rows)
    text += "  " + row.first + (row.second.empty() ? "" : std::string(width - row.first.size() + 2, ' ') + row.second) +
            "\n";
  return text;
}

std::string closest_word(const std::string& word, const std::vector<std::string>& candidates) {
  std::string best;
  std::size_t best_distance = word.size() / 3 + 2;
  for (const std::string& candidate : candidates) {
    // Edit distance (Levenshtein 1966), one row at a time.
    std::vector<std::size_t> row(candidate.size() + 1);
    for (std::size_t j = 0; j < row.size(); ++j) row[j] = j;
    for (std::size_t i = 0; i < word.size(); ++i) {
      std::size_t diagonal = row[0];
      row[0] = i + 1;
      for (std::size_t j = 0; j < candidate.size(); ++j) {
        const std::size_t changed = diagonal + (word[i] == candidate[j] ? 0 : 1);
        diagonal = row[j + 1];
        row[j + 1] = std::min({changed, row[j] + 1, row[j + 1] + 1});
      }
    }
    if (row.back() < best_distance) {
      best_distance = row.back();
      best = candidate;
    }
  }
  if (!best.empty()) return best;
  // Or a part of it: --parallel-scale of --camera-parallel-scale.
  const std::string part = word.substr(std::min(word.find_first_not_of('-'), word.size()));
  constexpr std::size_t kShortestPart = 4;
  for (const std::string& candidate : candidates)
    if (part.size() >= kShortestPart && candidate.find(part) != std::string::npos) return candidate;
  return best;
}

std::string ending_of(const std::string& path) {
  std::string ending = std::filesystem::path(path).extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](char letter) { return letter >= 'A' && letter <= 'Z' ? static_cast<char>(letter + 32) : letter; });
  return ending;
}

}  // namespace tetravox::tool
