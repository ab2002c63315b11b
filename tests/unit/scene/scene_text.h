#pragma once

/// Scene files of one line, for tests.

#include "tests/unit/optics/expect_error.h"
#include "tetravox/scene.h"

#include <string>

namespace tetravox::testing {

/// How they begin; members and a brace follow.
inline const std::string kHead = R"({"tetravox":1,"data":{"file":"a.vtu"},)";

inline Scene parse(const std::string& members) { return parse_scene(kHead + members + "}", "scene.json"); }

/// Holds where the scene with these members is refused, with both texts in the message.
inline void expect_bad(const std::string& members, const char* where, const char* what) {
  expect_error(
      ErrorCode::kBadFile, [&] { parse(members); }, "scene.json", where, what);
}

}  // namespace tetravox::testing
