#pragma once

#include "tetravox/error.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace tetravox::testing {

/// Expects that `action` throws `Error` with this code, whose message has one line and holds all `words`.
template <class Action, class... Words>
void expect_error(ErrorCode code, const Action& action, const Words&... words) {
  try {
    action();
    ADD_FAILURE() << "no error; expected one that says "
                  << ::testing::PrintToString(std::vector<std::string>{std::string(words)...});
  } catch (const Error& error) {
    const std::string message = error.what();
    EXPECT_EQ(static_cast<int>(error.code()), static_cast<int>(code)) << message;
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
    for (const std::string& word : {std::string(words)...})
      EXPECT_NE(message.find(word), std::string::npos) << "'" << word << "' is not in: " << message;
  }
}

}  // namespace tetravox::testing
