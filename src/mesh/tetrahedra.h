#pragma once

/// Cells -> a sorted list of valid tetrahedra.

#include "src/mesh/buffer.h"
#include "src/mesh/survey.h"
#include "src/mesh/weld.h"
#include "tetravox/dataset.h"

#include <array>
#include <cstdint>
#include <vector>

namespace tetravox::mesh {

/// A tetrahedron of positive volume, (v1 - v0) x (v2 - v0) . (v3 - v0) > 0, with v0 < v1 < v2, v3: of the even
/// permutations of its vertices the one that begins with the lowest two. So v2 > v3 tells that the ascending order
/// would have negative volume.
struct Tetrahedron {
  std::array<std::uint32_t, 4> v;
  std::uint32_t source;  ///< input cell

  std::uint32_t third() const { return v[2] < v[3] ? v[2] : v[3]; }
  std::uint32_t fourth() const { return v[2] < v[3] ? v[3] : v[2]; }
  bool is_ascending_negative() const { return v[2] > v[3]; }
};
static_assert(sizeof(Tetrahedron) == 20);

/// Tetrahedra in lexicographic order of their ascending vertex ids. As vertices are numbered along a curve, so are the
/// tetrahedra; and those with one lowest vertex follow each other, which finding neighbours makes use of.
struct TetrahedronList {
  Buffer<Tetrahedron> tetrahedra;  ///< the first `count` are valid
  std::size_t count = 0;
  std::vector<std::uint32_t> bucket_end;       ///< [vertices]: end of the tetrahedra whose lowest vertex this is
  std::vector<std::uint32_t> point_of_vertex;  ///< [vertices]: every vertex is used
  std::uint64_t degenerate = 0;
  std::uint64_t duplicated = 0;

  std::size_t bucket_begin(std::size_t vertex) const { return vertex == 0 ? 0 : bucket_end[vertex - 1]; }
};

/// Splits the kept cells, leaves out tetrahedra without volume and repeated ones, orients and sorts the rest.
/// Releases `weld`. `length_scale` brings coordinate differences near 1, so that a volume neither over- nor underflows;
/// a power of two, so that it changes no sign.
/// @throws Error: kUnsupported above 2^32 - 2 tetrahedra, kCancelled.
TetrahedronList collect_tetrahedra(const MeshData& mesh, const Survey& survey, Weld&& weld, double length_scale,
                                   ProgressMeter& meter);

}  // namespace tetravox::mesh
