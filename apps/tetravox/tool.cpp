#include "apps/tetravox/tool.h"

#include "apps/tetravox/commands.h"
#include "apps/tetravox/interrupt.h"
#include "apps/tetravox/options.h"
#include "apps/tetravox/text.h"

#include "tetravox/error.h"

#include <cstdio>
#include <exception>
#include <iostream>
#include <new>
#include <string>
#include <variant>

namespace tetravox::tool {
namespace {

int report_error(const std::string& message, int code) {
  std::fprintf(stderr, "tetravox: %s\n", single_line(message).c_str());
  return code;
}

int run_command(const CommandLine& command_line) {
  if (const auto* text = std::get_if<TextOptions>(&command_line)) std::cout << text->text;
  if (const auto* options = std::get_if<RenderOptions>(&command_line)) run_render(*options);
  if (const auto* options = std::get_if<InfoOptions>(&command_line)) run_info(*options);
  if (const auto* options = std::get_if<HistogramCommandOptions>(&command_line)) run_histogram(*options);
  if (const auto* options = std::get_if<OrderCommandOptions>(&command_line)) run_order(*options);
  if (const auto* options = std::get_if<ListOptions>(&command_line)) run_list(*options);
  if (!std::cout.flush()) throw Error(ErrorCode::kCannotWrite, "cannot write to standard output");
  return kDone;
}

/// Where to read on after a wrong command line.
std::string help_hint(int argc, char** argv) {
  const std::string command = argc > 1 ? argv[1] : "";
  const bool is_command =
      command == "render" || command == "info" || command == "histogram" || command == "order" || command == "list";
  return " (see tetravox " + (is_command ? command + " " : "") + "--help)";
}

}  // namespace

int run_tool(int argc, char** argv) {
  install_interrupt_handlers();
  try {
    return run_command(parse_command_line(argc, argv));
  } catch (const UsageError& error) {
    return report_error(error.what() + help_hint(argc, argv), kUsage);
  } catch (const Error& error) {
    // Ctrl-C reaches the reader process too: then what failed is the reader, and the reason is still the signal.
    if (interrupt_signal() != 0) return report_error("interrupted; nothing was written", 128 + interrupt_signal());
    return report_error(error.what(), kFailed);
  } catch (const std::bad_alloc&) {
    return report_error("not enough memory: use a smaller --resolution or mesh, or a larger machine", kFailed);
  } catch (const std::exception& error) {
    return report_error(std::string("internal error: ") + error.what() + "; please report this", kFailed);
  }
}

}  // namespace tetravox::tool
