#include "src/cpu/face_tree.h"

#include <algorithm>
#include <limits>
#include <numeric>

namespace tetravox::cpu {

/// Builds the nodes of a range of faces, depth first.
struct FaceTree::Build {
  FaceTree& tree;
  const PreparedMesh& mesh;
  std::vector<std::array<float, 3>> middles;  // [faces]: sums of the corners

  void add_node(std::size_t begin, std::size_t end) {
    const std::size_t index = tree.nodes_.size();
    tree.nodes_.push_back(make_node(begin, end));
    if (end - begin <= kFacesOfLeaf) return;
    const std::size_t half = begin + (end - begin) / 2;
    const int axis = find_longest(begin, end);
    const auto faces = tree.faces_.begin();
    std::nth_element(faces + static_cast<std::ptrdiff_t>(begin), faces + static_cast<std::ptrdiff_t>(half),
                     faces + static_cast<std::ptrdiff_t>(end), [&](std::uint32_t a, std::uint32_t b) {
                       return middles[a][axis] != middles[b][axis] ? middles[a][axis] < middles[b][axis] : a < b;
                     });
    add_node(begin, half);
    tree.nodes_[index].first = static_cast<std::uint32_t>(tree.nodes_.size());
    tree.nodes_[index].count = 0;
    add_node(half, end);
  }

  Node make_node(std::size_t begin, std::size_t end) const {
    Node node;
    node.lower.fill(std::numeric_limits<float>::infinity());
    node.upper.fill(-std::numeric_limits<float>::infinity());
    for (std::size_t i = begin; i < end; ++i)
      for (const std::uint32_t id : mesh.boundary[tree.faces_[i]].vertices) {
        const Vertex& vertex = mesh.vertices[id];
        const std::array<float, 3> at{vertex.x, vertex.y, vertex.z};
        for (int axis = 0; axis < 3; ++axis) {
          node.lower[axis] = std::min(node.lower[axis], at[axis]);
          node.upper[axis] = std::max(node.upper[axis], at[axis]);
        }
      }
    node.first = static_cast<std::uint32_t>(begin);
    node.count = static_cast<std::uint32_t>(end - begin);
    return node;
  }

  int find_longest(std::size_t begin, std::size_t end) const {
    int longest = 0;
    float length = -1.0f;
    for (int axis = 0; axis < 3; ++axis) {
      float lower = std::numeric_limits<float>::infinity(), upper = -lower;
      for (std::size_t i = begin; i < end; ++i) {
        lower = std::min(lower, middles[tree.faces_[i]][axis]);
        upper = std::max(upper, middles[tree.faces_[i]][axis]);
      }
      if (upper - lower > length) {
        length = upper - lower;
        longest = axis;
      }
    }
    return longest;
  }
};

FaceTree::FaceTree(const PreparedMesh& mesh) {
  if (mesh.boundary.empty()) return;
  faces_.resize(mesh.boundary.size());
  std::iota(faces_.begin(), faces_.end(), 0u);
  Build build{*this, mesh, {}};
  build.middles.reserve(mesh.boundary.size());
  for (const BoundaryFace& face : mesh.boundary) {
    std::array<float, 3> sum{};
    for (const std::uint32_t id : face.vertices) {
      const Vertex& vertex = mesh.vertices[id];
      sum[0] += vertex.x;
      sum[1] += vertex.y;
      sum[2] += vertex.z;
    }
    build.middles.push_back(sum);
  }
  nodes_.reserve(mesh.boundary.size());
  build.add_node(0, faces_.size());
}

}  // namespace tetravox::cpu
