#include "src/mesh/cell_table.h"

#include <algorithm>
#include <initializer_list>
#include <utility>

namespace tetravox::mesh {
namespace {

using Node = std::uint8_t;
using Nodes = std::vector<Node>;
using Faces = std::vector<Nodes>;

/// Mid-edge node of the edge between two corners.
struct MidEdge {
  Node a, b, middle;
};
using MidEdges = std::vector<MidEdge>;

// Faces of the linear cells, all seen counter-clockwise from outside.
const Faces& tetrahedron_faces() {
  static const Faces faces = {{0, 1, 3}, {1, 2, 3}, {2, 0, 3}, {0, 2, 1}};
  return faces;
}
const Faces& hexahedron_faces() {
  static const Faces faces = {{0, 4, 7, 3}, {1, 2, 6, 5}, {0, 1, 5, 4}, {3, 7, 6, 2}, {0, 3, 2, 1}, {4, 5, 6, 7}};
  return faces;
}
const Faces& wedge_faces() {
  static const Faces faces = {{0, 1, 2}, {3, 5, 4}, {0, 3, 4, 1}, {1, 4, 5, 2}, {2, 5, 3, 0}};
  return faces;
}
const Faces& pyramid_faces() {
  static const Faces faces = {{0, 3, 2, 1}, {0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}};
  return faces;
}

Faces prism_faces(int sides) {
  Nodes bottom, top;
  Faces faces;
  for (int i = 0; i < sides; ++i) {
    const int next = (i + 1) % sides;
    bottom.push_back(static_cast<Node>(i));
    top.push_back(static_cast<Node>(2 * sides - 1 - i));
    faces.push_back(
        {static_cast<Node>(i), static_cast<Node>(i + sides), static_cast<Node>(next + sides), static_cast<Node>(next)});
  }
  faces.push_back(bottom);
  faces.push_back(top);
  return faces;
}

CellPart make_part(const Faces& faces) {
  CellPart part;
  for (const Nodes& nodes : faces) {
    CellFace face;
    face.count = static_cast<int>(nodes.size());
    std::copy(nodes.begin(), nodes.end(), face.nodes.begin());
    part.faces.push_back(face);
    part.nodes.insert(part.nodes.end(), nodes.begin(), nodes.end());
  }
  std::sort(part.nodes.begin(), part.nodes.end());
  part.nodes.erase(std::unique(part.nodes.begin(), part.nodes.end()), part.nodes.end());
  return part;
}

/// A linear cell whose corner i is node `nodes[i]`.
CellPart make_part(const Faces& faces, const Nodes& nodes) {
  Faces mapped = faces;
  for (Nodes& face : mapped)
    for (Node& node : face) node = nodes[node];
  return make_part(mapped);
}

Node middle_of(const MidEdges& edges, Node a, Node b) {
  const auto edge = std::find_if(edges.begin(), edges.end(),
                                 [=](const MidEdge& e) { return (e.a == a && e.b == b) || (e.a == b && e.b == a); });
  return edge->middle;
}

/// Cuts each corner off through the mid-edge nodes around it; what remains has the mid-edge nodes as its corners.
std::vector<CellPart> rectify(const Faces& faces, const MidEdges& edges, int corners) {
  std::vector<CellPart> parts;
  Faces core;
  for (const Nodes& face : faces) {
    Nodes middle;
    for (std::size_t i = 0; i < face.size(); ++i)
      middle.push_back(middle_of(edges, face[i], face[(i + 1) % face.size()]));
    core.push_back(middle);
  }
  for (int corner = 0; corner < corners; ++corner) {
    // Collect the triangle that each face loses at this corner; chained, they go around the cut.
    Faces corner_faces;
    std::vector<std::pair<Node, Node>> steps;
    for (const Nodes& face : faces) {
      const auto at = std::find(face.begin(), face.end(), static_cast<Node>(corner));
      if (at == face.end()) continue;
      const std::size_t i = static_cast<std::size_t>(at - face.begin());
      const Node before = middle_of(edges, face[(i + face.size() - 1) % face.size()], *at);
      const Node after = middle_of(edges, *at, face[(i + 1) % face.size()]);
      corner_faces.push_back({*at, after, before});
      steps.emplace_back(before, after);
    }
    Nodes cut = {steps[0].first};
    while (cut.size() < steps.size()) {
      const auto step = std::find_if(steps.begin(), steps.end(), [&](const auto& s) { return s.first == cut.back(); });
      cut.push_back(step->second);
    }
    corner_faces.push_back(cut);
    core.push_back(cut);
    parts.push_back(make_part(corner_faces));
  }
  parts.push_back(make_part(core));
  return parts;
}

/// Eight hexahedra between the 27 nodes.
std::vector<CellPart> split_triquadratic_hexahedron() {
  static constexpr Node lattice[3][3][3] = {// [z][y][x]
                                            {{0, 8, 1}, {11, 24, 9}, {3, 10, 2}},
                                            {{16, 22, 17}, {20, 26, 21}, {19, 23, 18}},
                                            {{4, 12, 5}, {15, 25, 13}, {7, 14, 6}}};
  std::vector<CellPart> parts;
  for (int z = 0; z < 2; ++z)
    for (int y = 0; y < 2; ++y)
      for (int x = 0; x < 2; ++x)
        parts.push_back(make_part(
            hexahedron_faces(),
            {lattice[z][y][x], lattice[z][y][x + 1], lattice[z][y + 1][x + 1], lattice[z][y + 1][x],
             lattice[z + 1][y][x], lattice[z + 1][y][x + 1], lattice[z + 1][y + 1][x + 1], lattice[z + 1][y + 1][x]}));
  return parts;
}

/// A layer between two quadrilaterals with mid-edge nodes (corners first): four wedges around a hexahedron.
void append_quadrilateral_layer(std::vector<CellPart>& parts, const Nodes& low, const Nodes& high) {
  for (std::size_t i = 0; i < 4; ++i) {
    const std::size_t after = 4 + i, before = 4 + (i + 3) % 4;
    parts.push_back(make_part(wedge_faces(), {low[i], low[after], low[before], high[i], high[after], high[before]}));
  }
  parts.push_back(make_part(hexahedron_faces(), {low[4], low[5], low[6], low[7], high[4], high[5], high[6], high[7]}));
}

/// A layer between two triangles with mid-edge nodes (corners first): four wedges.
void append_triangle_layer(std::vector<CellPart>& parts, const Nodes& low, const Nodes& high) {
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t after = 3 + i, before = 3 + (i + 2) % 3;
    parts.push_back(make_part(wedge_faces(), {low[i], low[after], low[before], high[i], high[after], high[before]}));
  }
  parts.push_back(make_part(wedge_faces(), {low[3], low[4], low[5], high[3], high[4], high[5]}));
}

/// All pieces of the faces, joined to the node in the middle.
std::vector<CellPart> split_triquadratic_pyramid() {
  Faces faces = {{0, 5, 13, 8}, {5, 1, 6, 13}, {13, 6, 2, 7}, {8, 13, 7, 3}};
  for (int side = 0; side < 4; ++side) {
    const Node a = static_cast<Node>(side), b = static_cast<Node>((side + 1) % 4), top = 4;
    const Node middle = static_cast<Node>(14 + side);
    const Nodes rim = {a, static_cast<Node>(5 + a), b, static_cast<Node>(9 + b), top, static_cast<Node>(9 + a)};
    for (std::size_t i = 0; i < 6; ++i) faces.push_back({rim[i], rim[(i + 1) % 6], middle});
  }
  CellPart part = make_part(faces);
  part.apex = 18;
  return {part};
}

int max_tetrahedra_of(const CellPart& part) {
  int all = 0;
  for (const CellFace& face : part.faces) all += face.count - 2;
  if (part.apex >= 0) return all;
  int most = 0;
  for (const Node node : part.nodes) {
    int away = all;
    for (const CellFace& face : part.faces)
      if (std::find(face.nodes.begin(), face.nodes.begin() + face.count, node) != face.nodes.begin() + face.count)
        away -= face.count - 2;
    most = std::max(most, away);
  }
  return most;
}

const MidEdges kTetrahedronEdges = {{0, 1, 4}, {1, 2, 5}, {2, 0, 6}, {0, 3, 7}, {1, 3, 8}, {2, 3, 9}};
const MidEdges kHexahedronEdges = {{0, 1, 8},  {1, 2, 9},  {2, 3, 10}, {3, 0, 11}, {4, 5, 12}, {5, 6, 13},
                                   {6, 7, 14}, {7, 4, 15}, {0, 4, 16}, {1, 5, 17}, {2, 6, 18}, {3, 7, 19}};
const MidEdges kWedgeEdges = {{0, 1, 6},  {1, 2, 7},  {2, 0, 8},  {3, 4, 9}, {4, 5, 10},
                              {5, 3, 11}, {0, 3, 12}, {1, 4, 13}, {2, 5, 14}};
const MidEdges kPyramidEdges = {{0, 1, 5}, {1, 2, 6},  {2, 3, 7},  {3, 0, 8},
                                {0, 4, 9}, {1, 4, 10}, {2, 4, 11}, {3, 4, 12}};

std::vector<CellPart> make_parts(CellType type) {
  std::vector<CellPart> parts;
  switch (type) {
    case CellType::kTetrahedron:
      return {make_part(tetrahedron_faces())};
    case CellType::kVoxel:
      return {make_part(hexahedron_faces(), {0, 1, 3, 2, 4, 5, 7, 6})};
    case CellType::kHexahedron:
      return {make_part(hexahedron_faces())};
    case CellType::kWedge:
      return {make_part(wedge_faces())};
    case CellType::kPyramid:
      return {make_part(pyramid_faces())};
    case CellType::kPentagonalPrism:
      return {make_part(prism_faces(5))};
    case CellType::kHexagonalPrism:
      return {make_part(prism_faces(6))};
    case CellType::kQuadraticTetrahedron:
      return rectify(tetrahedron_faces(), kTetrahedronEdges, 4);
    case CellType::kQuadraticHexahedron:
      return rectify(hexahedron_faces(), kHexahedronEdges, 8);
    case CellType::kQuadraticWedge:
      return rectify(wedge_faces(), kWedgeEdges, 6);
    case CellType::kQuadraticPyramid:
      return rectify(pyramid_faces(), kPyramidEdges, 5);
    case CellType::kTriquadraticHexahedron:
      return split_triquadratic_hexahedron();
    case CellType::kQuadraticLinearWedge:
      append_triangle_layer(parts, {0, 1, 2, 6, 7, 8}, {3, 4, 5, 9, 10, 11});
      return parts;
    case CellType::kBiquadraticQuadraticWedge:
      append_triangle_layer(parts, {0, 1, 2, 6, 7, 8}, {12, 13, 14, 15, 16, 17});
      append_triangle_layer(parts, {12, 13, 14, 15, 16, 17}, {3, 4, 5, 9, 10, 11});
      return parts;
    case CellType::kBiquadraticQuadraticHexahedron:
      append_quadrilateral_layer(parts, {0, 1, 2, 3, 8, 9, 10, 11}, {16, 17, 18, 19, 22, 21, 23, 20});
      append_quadrilateral_layer(parts, {16, 17, 18, 19, 22, 21, 23, 20}, {4, 5, 6, 7, 12, 13, 14, 15});
      return parts;
    case CellType::kTriquadraticPyramid:
      return split_triquadratic_pyramid();
    case CellType::kPolyhedron:
      break;
  }
  return parts;
}

int node_count_of(CellType type) {
  switch (type) {
    case CellType::kTetrahedron:
      return 4;
    case CellType::kVoxel:
    case CellType::kHexahedron:
      return 8;
    case CellType::kWedge:
      return 6;
    case CellType::kPyramid:
      return 5;
    case CellType::kPentagonalPrism:
    case CellType::kQuadraticTetrahedron:
      return 10;
    case CellType::kHexagonalPrism:
    case CellType::kQuadraticLinearWedge:
      return 12;
    case CellType::kQuadraticHexahedron:
      return 20;
    case CellType::kQuadraticWedge:
      return 15;
    case CellType::kQuadraticPyramid:
      return 13;
    case CellType::kTriquadraticHexahedron:
      return kLargestNodeCount;
    case CellType::kBiquadraticQuadraticWedge:
      return 18;
    case CellType::kBiquadraticQuadraticHexahedron:
      return 24;
    case CellType::kTriquadraticPyramid:
      return 19;
    case CellType::kPolyhedron:
      break;
  }
  return 0;
}

std::vector<CellTable> make_tables() {
  std::vector<CellTable> tables(256);
  for (std::size_t i = 0; i < tables.size(); ++i) {
    const CellType type = static_cast<CellType>(i);
    tables[i].node_count = node_count_of(type);
    if (tables[i].node_count == 0) continue;
    tables[i].parts = make_parts(type);
    for (const CellPart& part : tables[i].parts) tables[i].max_tetrahedra += max_tetrahedra_of(part);
  }
  return tables;
}

}  // namespace

const CellTable& cell_table(CellType type) {
  static const std::vector<CellTable> tables = make_tables();
  return tables[static_cast<std::uint8_t>(type)];
}

}  // namespace tetravox::mesh
