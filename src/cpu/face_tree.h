#pragma once

/// Boundary faces of a mesh, found along lines.

#include "src/cpu/shadow_rays.h"
#include "tetravox/mesh.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace tetravox::cpu {

/// A hierarchy of boxes (Kay and Kajiya 1986), halved at the median along its longest side.
class FaceTree {
 public:
  FaceTree() = default;
  explicit FaceTree(const PreparedMesh& mesh);

  bool is_empty() const { return nodes_.empty(); }
  std::uint64_t bytes() const { return nodes_.size() * sizeof(Node) + faces_.size() * sizeof(std::uint32_t); }

  /// Calls visit(face) for all faces that a line may meet before its place, in any order, until it returns false.
  /// Boxes are sheared with the roundings of vertices: no face that a line meets is missed.
  template <class Visit>
  void visit_faces(const ShadowLine& line, const Visit& visit) const {
    if (nodes_.empty()) return;
    std::array<std::uint32_t, kDeepest> stack;
    std::size_t depth = 0;
    stack[depth++] = 0;
    while (depth > 0) {
      const std::uint32_t index = stack[--depth];
      const Node& node = nodes_[index];
      if (!may_meet(node, line)) continue;
      if (node.count == 0) {
        stack[depth++] = node.first;
        stack[depth++] = index + 1;
        continue;
      }
      for (std::uint32_t i = 0; i < node.count; ++i)
        if (!visit(faces_[node.first + i])) return;
    }
  }

 private:
  static constexpr std::size_t kDeepest = 64;
  static constexpr std::size_t kFacesOfLeaf = 4;

  struct Node {
    std::array<float, 3> lower{}, upper{};
    std::uint32_t first = 0;  ///< of a leaf: its first face; else: the second child. The first child is next to it.
    std::uint32_t count = 0;  ///< faces; 0: no leaf
  };

  static bool may_meet(const Node& node, const ShadowLine& line) {
    const int z = line.axes[2];
    const double below = node.lower[z] - line.place[z], above = node.upper[z] - line.place[z];
    if ((line.sign > 0.0 ? below : -above) > 0.0) return false;
    for (int i = 0; i < 2; ++i) {
      const int axis = line.axes[i];
      const double slope = line.step[axis] * line.sign;
      const double a = slope * below, b = slope * above;
      const double least = (node.lower[axis] - line.place[axis]) - (a > b ? a : b);
      const double most = (node.upper[axis] - line.place[axis]) - (a > b ? b : a);
      if (least > 0.0 || most < 0.0) return false;
    }
    return true;
  }

  struct Build;

  std::vector<Node> nodes_;
  std::vector<std::uint32_t> faces_;
};

}  // namespace tetravox::cpu
