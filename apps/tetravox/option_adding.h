#pragma once

/// How options are added to the parser: their text goes through our own strict parsers (option_values.h).
///
/// Only option_adding.cpp and options.cpp know CLI11, which compiles slowly.

#include "apps/tetravox/option_values.h"

#include "tetravox/error.h"

#include <cstdint>
#include <functional>
#include <string>

namespace CLI {
class App;
}

namespace tetravox::tool {

using Setter = std::function<void(const std::string& option, const std::string& text)>;

/// Options that are added from here on stand under this heading of the help text.
void begin_group(CLI::App& app, const std::string& heading);

/// Adds an option whose text goes through one of our own strict parsers. Messages call it by its long name.
void add(CLI::App& app, const std::string& names, const std::string& type, const std::string& help, Setter set);

/// Adds an option that may be given several times, each time with one text.
void add_repeatable(CLI::App& app, const std::string& names, const std::string& type, const std::string& help,
                    Setter set);

/// Adds an option without text that makes `value` true.
void add_flag(CLI::App& app, const std::string& name, bool& value, const std::string& help);
/// The same; `set` is called where the option is given.
void add_flag(CLI::App& app, const std::string& name, std::function<void()> set, const std::string& help);

/// Adds an argument that has no name in front of it.
void add_positional(CLI::App& app, const std::string& name, std::string& value, const std::string& help);

/// What stands below the options in the help text.
void set_footer(CLI::App& app, const std::string& text);

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

}  // namespace tetravox::tool
