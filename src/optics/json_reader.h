#pragma once

/// Strict reading of JSON: every error names the file, the place in it and what to do; hostile text is bounded.
///
/// Include it only where a file is parsed: nlohmann's JSON compiles slowly.

#include "tetravox/error.h"

#include <nlohmann/json.hpp>

#include <cstddef>
#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>

namespace tetravox::optics {

inline constexpr std::size_t kLargestJsonBytes = std::size_t{64} << 20;
inline constexpr std::size_t kLargestJsonValues = 4'000'000;
inline constexpr int kLargestJsonDepth = 32;
inline constexpr std::size_t kLargestPointCount = 100'000;  ///< control points of one transfer function

/// Parses text within the limits above. Comments are not JSON; a key that occurs twice in one object is an error.
/// @throws Error (kBadFile) in one line.
nlohmann::json parse_json(const std::string& text, const std::string& source_name);

/// One value of a parsed file together with the place where it stands. Views the value and the name.
class JsonPlace {
 public:
  JsonPlace(const nlohmann::json& value, const std::string& source_name) : value_(&value), source_(&source_name) {}

  const nlohmann::json& value() const { return *value_; }
  const std::string& path() const { return path_; }

  /// @throws Error (kBadFile) "source: path: what".
  [[noreturn]] void fail(const std::string& what) const;

  /// The member `key`; nothing where the object has none. @throws Error where this is no object.
  std::optional<JsonPlace> find(const char* key) const;
  /// The member `key`. @throws Error that names the key that is missing.
  JsonPlace at(const char* key) const;
  /// The element `index` of an array.
  JsonPlace at(std::size_t index) const;
  /// Elements of an array. @throws Error where this is no array.
  std::size_t size() const;

  double number() const;
  long long integer(long long smallest, long long largest) const;
  bool boolean() const;
  const std::string& string() const;
  /// An array of exactly `count` numbers, written to `out`.
  void numbers(double* out, std::size_t count) const;

  /// @throws Error that names the first key that is not in `known`, with the nearest one that is.
  void require_keys(std::initializer_list<std::string_view> known) const;

 private:
  const nlohmann::json* value_;
  const std::string* source_;
  std::string path_;
};

/// Calls `action`; what it throws is told as an error of the file, at `place`.
template <class Action>
auto at_place(const JsonPlace& place, const Action& action) {
  try {
    return action();
  } catch (const Error& error) {
    if (error.code() != ErrorCode::kInvalidArgument) throw;
    place.fail(error.what());
  }
}

/// The word of `known` that is at most two edits from `word`; empty where there is none.
std::string_view nearest_word(std::string_view word, std::initializer_list<std::string_view> known);

/// `text` fit for one line of an error message: at most 80 characters, control characters replaced.
std::string printable(std::string_view text);

}  // namespace tetravox::optics
