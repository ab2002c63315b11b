#pragma once

/// Further fields of a prepared mesh or grid, alike.

#include "tetravox/error.h"
#include "tetravox/grid.h"
#include "tetravox/mesh.h"

#include <cstddef>
#include <string>

namespace tetravox::scene {

/// How a further field is stored, and which values it has.
struct OtherFrame {
  double scalar_offset = 0.0, scalar_scale = 1.0;
  ValueRange range;
};

inline OtherFrame frame_of(const OtherScalars& other) { return {other.offset, other.scale, other.range}; }
inline OtherFrame frame_of(const PreparedGrid& other) {
  return {other.scalar_offset, other.scalar_scale, other.scalar_range};
}

/// Of the further field `other`. @throws Error (kInvalidArgument) where there is none.
template <class Prepared>
OtherFrame frame_of_other(const Prepared& prepared, std::size_t other) {
  if (other >= prepared.others.size())
    throw Error(ErrorCode::kInvalidArgument, "there is no further field " + std::to_string(other) + ": " +
                                                 std::to_string(prepared.others.size()) + " were prepared");
  return frame_of(prepared.others[other]);
}

}  // namespace tetravox::scene
