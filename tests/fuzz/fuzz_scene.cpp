/// Any text is either a scene that survives writing and reading, or an error of the file in one line.

#include "tetravox/error.h"
#include "tetravox/scene.h"

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace tetravox;
  const std::string text(reinterpret_cast<const char*>(data), size);
  std::string written;
  try {
    written = format_scene(parse_scene(text, "scene"));
  } catch (const Error& error) {
    const std::string message = error.what();
    if (error.code() != ErrorCode::kBadFile || message.find('\n') != std::string::npos) std::abort();
    return 0;
  }
  if (format_scene(parse_scene(written, "written")) != written) std::abort();
  return 0;
}
