#pragma once

/// Full pre-integration: colour and opacity over scalar front, scalar back and length (Roettger, Kraus, Ertl 2000).

#include "src/optics/segment_domain.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace tetravox::optics {

/// Entry (i, j, k) is at s_front = i / (scalars - 1), s_back = j / (scalars - 1) and the length whose place is
/// k / (lengths - 1) (`eval_length_place`). Trilinear in between, in these places.
struct PreintegrationTable {
  SegmentDomain domain;
  int scalars = 0, lengths = 0;
  LengthSpacing spacing = LengthSpacing::kUniform;
  /// [lengths][scalars back][scalars front][4]: premultiplied red, green, blue, and opacity, each divided by the
  /// opacity bound of the length; at length 0 the limit, mean density / largest extinction. In [0, 1].
  /// As a 3D texture: x front, y back, z length; texel centres at (index + 0.5) / size.
  std::vector<float> entries;

  std::uint64_t bytes() const { return entries.size() * sizeof(float); }
};

/// Bytes of a table of that size.
std::uint64_t preintegration_table_bytes(int scalars, int lengths);

/// Makes `table` anew, on all cores; the memory of an earlier one is used again. Each entry takes `steps` steps of
/// integration (of exact means of extinction and emission). Incrementally: the steps of a segment are those of its
/// intervals between neighbouring scalars, so that all segments with the same difference of scalars and the same length
/// share them. Windows over them are put together from what lies before and behind fixed borders.
///
/// Lum, Wilson, Ma 2004; how we differ: nothing is subtracted or divided by a transmittance, so that deep segments lose
/// no digits, and the result does not depend on the order.
/// @throws Error (kOutOfMemory) where it does not fit into memory.
void build_preintegration_table(const PreintegrationSource& source, const PreintegrationSettings& settings,
                                PreintegrationTable& table);

/// The look-up of `table3d`: the scalar reference of kernel and shader. Stored scalars, world length.
SegmentColor eval_preintegration_table(const PreintegrationTable& table, float scalar_front, float scalar_back,
                                       float length);

}  // namespace tetravox::optics
