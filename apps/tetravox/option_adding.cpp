#include "apps/tetravox/option_adding.h"

#include <CLI/CLI.hpp>

#include <utility>
#include <vector>

namespace tetravox::tool {
namespace {

/// The name that messages show: "--output" of "-o,--output", "--clip-box" of "--clip-box,--crop".
std::string shown_name(const std::string& names) {
  const std::string name = names.substr(names.find("--"));
  return name.substr(0, name.find(','));
}

}  // namespace

void begin_group(CLI::App& app, const std::string& heading) { app.option_defaults()->group(heading); }

void add(CLI::App& app, const std::string& names, const std::string& type, const std::string& help, Setter set) {
  const std::string shown = shown_name(names);
  app.add_option_function<std::string>(
         names, [shown, set = std::move(set)](const std::string& text) { set(shown, text); }, help)
      ->type_name(type);
}

void add_repeatable(CLI::App& app, const std::string& names, const std::string& type, const std::string& help,
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

void add_flag(CLI::App& app, const std::string& name, bool& value, const std::string& help) {
  app.add_flag(name, value, help);
}

void add_flag(CLI::App& app, const std::string& name, std::function<void()> set, const std::string& help) {
  app.add_flag_callback(name, std::move(set), help);
}

void add_positional(CLI::App& app, const std::string& name, std::string& value, const std::string& help) {
  app.add_option(name, value, help)->type_name("");
}

void set_footer(CLI::App& app, const std::string& text) { app.footer(text); }

}  // namespace tetravox::tool
