#pragma once

/// The command line tool: `tetravox render | info | histogram | order | list`.

namespace tetravox::tool {

/// Exit codes; an interrupt gives 128 plus the signal's number, as shells do.
inline constexpr int kDone = 0;
inline constexpr int kFailed = 1;
inline constexpr int kUsage = 2;

/// Runs one command and returns its exit code. The one place where exceptions become messages: one line on stderr.
int run_tool(int argc, char** argv);

}  // namespace tetravox::tool
