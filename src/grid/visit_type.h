#pragma once

#include "tetravox/dataset.h"

#include <cstdint>

namespace tetravox::grid {

/// Calls `visit` with a value of the C++ type that `type` stands for, and returns what it returns.
template <class Visit>
auto visit_type(ScalarType type, const Visit& visit) {
  switch (type) {
    case ScalarType::kInt8:
      return visit(std::int8_t{});
    case ScalarType::kUint8:
      return visit(std::uint8_t{});
    case ScalarType::kInt16:
      return visit(std::int16_t{});
    case ScalarType::kUint16:
      return visit(std::uint16_t{});
    case ScalarType::kInt32:
      return visit(std::int32_t{});
    case ScalarType::kUint32:
      return visit(std::uint32_t{});
    case ScalarType::kInt64:
      return visit(std::int64_t{});
    case ScalarType::kUint64:
      return visit(std::uint64_t{});
    case ScalarType::kFloat32:
      return visit(float{});
    case ScalarType::kFloat64:
      break;
  }
  return visit(double{});
}

}  // namespace tetravox::grid
