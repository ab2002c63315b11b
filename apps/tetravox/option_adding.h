#pragma once

/// How options are added to the parser: their text goes through our own strict parsers (option_values.h).
///
/// Include it only where options are defined: CLI11 compiles slowly.

#include "apps/tetravox/option_values.h"

#include "tetravox/error.h"

#include <CLI/CLI.hpp>

#include <cstdint>
#include <functional>
#include <string>
#include <utility>
#include <vector>

namespace tetravox::tool {

using Setter = std::function<void(const std::string& option, const std::string& text)>;

/// The name that messages show: "--output" of "-o,--output", "--clip-box" of "--clip-box,--crop".
inline std::string shown_name(const std::string& names) {
  const std::string name = names.substr(names.find("--"));
  return name.substr(0, name.find(','));
}

/// Adds an option whose text goes through one of our own strict parsers.
inline void add(CLI::App& app, const std::string& names, const std::string& type, const std::string& help, Setter set) {
  const std::string shown = shown_name(names);
  app.add_option_function<std::string>(
         names, [shown, set = std::move(set)](const std::string& text) { set(shown, text); }, help)
      ->type_name(type);
}

/// A setter that stores what `parse` makes of the text.
template <class T, class Parse>
Setter store(T& target, Parse parse) {
  return [&target, parse](const std::string& option, const std::string& text) { target = parse(option, text); };
}

inline Setter store_text(std::string& target) {
  return [&target](const std::string& option, const std::string& text) {
    if (text.empty()) throw UsageError(option + ": the text is empty");
    target = text;
  };
}

/// A parser of whole numbers in a range.
inline auto integer(std::int64_t smallest, std::int64_t largest) {
  return [=](const std::string& option, const std::string& text) {
    return static_cast<int>(parse_integer(option, text, smallest, largest));
  };
}

/// A parser of names that the library knows; its error becomes a usage error.
template <class FromName>
auto named(FromName from_name) {
  return [=](const std::string& option, const std::string& text) {
    try {
      return from_name(text);
    } catch (const Error& error) {
      throw UsageError(option + ": " + error.what());
    }
  };
}

inline bool parse_switch(const std::string& option, const std::string& text) {
  return parse_choice(option, text, {"on", "off"}) == 0;
}

/// Adds an option that may be given several times, each time with one text.
inline void add_repeatable(CLI::App& app, const std::string& names, const std::string& type, const std::string& help,
                           Setter set) {
  const std::string shown = shown_name(names);
  app.add_option_function<std::vector<std::string>>(
         names,
         [shown, set = std::move(set)](const std::vector<std::string>& texts) {
           for (const std::string& text : texts) set(shown, text);
         },
         help)
      ->type_name(type)
      ->allow_extra_args(false);
}

}  // namespace tetravox::tool
