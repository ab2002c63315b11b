#pragma once

/// Contracts inside the library: TETRAVOX_CHECK(a < b) throws an internal error that prints both operands.

#include "tetravox/error.h"

#include <sstream>
#include <string>

namespace tetravox::support {

template <class A, class B>
[[noreturn]] void fail_check(const char* expression, const A& a, const B& b, const char* file, int line) {
  std::ostringstream text;
  text << "internal error: " << expression << " does not hold (" << +a << " and " << +b << ") at " << file << ":"
       << line << "; please report this";
  throw Error(ErrorCode::kInternal, text.str());
}

}  // namespace tetravox::support

#define TETRAVOX_CHECK_OP(a, op, b)                                                                   \
  do {                                                                                                \
    const auto& tetravox_a = (a);                                                                     \
    const auto& tetravox_b = (b);                                                                     \
    if (!(tetravox_a op tetravox_b))                                                                  \
      ::tetravox::support::fail_check(#a " " #op " " #b, tetravox_a, tetravox_b, __FILE__, __LINE__); \
  } while (false)
#define TETRAVOX_CHECK_EQ(a, b) TETRAVOX_CHECK_OP(a, ==, b)
#define TETRAVOX_CHECK_LT(a, b) TETRAVOX_CHECK_OP(a, <, b)
#define TETRAVOX_CHECK_LE(a, b) TETRAVOX_CHECK_OP(a, <=, b)
