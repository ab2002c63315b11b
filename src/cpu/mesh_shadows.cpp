#include "src/cpu/mesh_shadows.h"

#include <algorithm>

namespace tetravox::cpu {

/// A vertex in the frame of a line.
struct MeshShadows::Corner {
  std::uint32_t id = 0;
  double x = 0.0, y = 0.0, z = 0.0, scalar = 0.0;
};

namespace {

/// Twice the area of the origin and an edge; exactly the negative for the edge the other way round.
template <class Corner>
double edge_area(const Corner& a, const Corner& b) {
  return a.x * b.y - a.y * b.x;
}

/// Whether the origin lies to the left of an edge with that area. On the edge it counts as moved a little along x, and
/// still less along y.
template <class Corner>
bool is_left(double area, const Corner& a, const Corner& b) {
  if (area != 0.0) return area > 0.0;
  return a.y != b.y ? a.y > b.y : b.x > a.x;
}

}  // namespace

/// A face with the origin of the line's frame inside, clockwise, and the areas of its edges.
struct MeshShadows::Face {
  Corner a, b, c;
  double ab = 0.0, bc = 0.0, ca = 0.0;
};

/// Where a line meets a face.
struct MeshShadows::Meeting {
  double z = 0.0;
  optics::ExtinctionIntegral::Mark mark;
  std::array<double, 3> gradient{};
};

/// One way through the mesh.
class MeshShadows::Walk {
 public:
  Walk(const MeshShadows& owner, const ShadowLine& line, std::span<const DepthRange> kept, Transmission& sum)
      : owner_(owner), mesh_(owner.mesh_), line_(line), kept_(kept), sum_(sum) {
    for (std::size_t i = 0; i < 2; ++i) shear_[i] = line.step[static_cast<std::size_t>(line.axes[i])] * line.sign;
    is_constant_ = !mesh_.cell_scalars.empty();
    wants_gradients_ = owner.optics_.weight_by_gradient > 0.0f && !owner.has_cell_gradients_;
  }

  /// Enters through a boundary face, if the line does. Whether the line goes on: it does not in the dark.
  bool enter(const BoundaryFace& boundary) {
    Face face{corner(boundary.vertices[0]), corner(boundary.vertices[1]), corner(boundary.vertices[2])};
    face.ab = edge_area(face.a, face.b);
    face.bc = edge_area(face.b, face.c);
    face.ca = edge_area(face.c, face.a);
    if (is_left(face.ab, face.a, face.b) || is_left(face.bc, face.b, face.c) || is_left(face.ca, face.c, face.a))
      return true;
    const Meeting met = meet(face, -std::numeric_limits<double>::infinity());
    if (met.z < kept_.back().end) pass(boundary.cell, face, met);
    return !owner_.optics_.is_dark(sum_);
  }

 private:
  using Mark = optics::ExtinctionIntegral::Mark;

  Corner corner(std::uint32_t id) const {
    const Vertex& vertex = mesh_.vertices[id];
    const std::array<double, 3> at{vertex.x, vertex.y, vertex.z};
    const auto& axes = line_.axes;
    const double along = at[axes[2]] - line_.place[axes[2]];
    const auto across = [&](std::size_t i) { return (at[axes[i]] - line_.place[axes[i]]) - shear_[i] * along; };
    return {id, across(0), across(1), line_.sign * along, vertex.scalar};
  }

  /// By barycentric coordinates; not before `z_least`.
  Meeting meet(const Face& face, double z_least) const {
    const double total = face.ab + face.bc + face.ca;
    const bool is_edge_on = total == 0.0;
    const double inverse = is_edge_on ? 0.0 : 1.0 / total;
    const double third = 1.0 / 3.0;
    const double a = is_edge_on ? third : face.bc * inverse, b = is_edge_on ? third : face.ca * inverse;
    const double c = is_edge_on ? third : face.ab * inverse;
    Meeting met{std::max(z_least, a * face.a.z + b * face.b.z + c * face.c.z),
                owner_.optics_.extinction->mark(a * face.a.scalar + b * face.b.scalar + c * face.c.scalar),
                {}};
    if (wants_gradients_)
      for (std::size_t axis = 0; axis < 3; ++axis)
        met.gradient[axis] = a * owner_.gradients_[face.a.id][axis] + b * owner_.gradients_[face.b.id][axis] +
                             c * owner_.gradients_[face.c.id][axis];
    return met;
  }

  /// From cell to cell, until the line leaves the mesh or what is kept of it ends.
  void pass(std::uint32_t cell, Face face, Meeting front) {
    const double z_end = kept_.back().end;
    const std::size_t most = mesh_.cells.size() + 1;  // more only where damaged meshes lead in circles
    for (std::size_t count = 0; count < most && cell != kNoCell && front.z < z_end; ++count) {
      const TetrahedronLinks& links = mesh_.cells[cell];
      const Corner d = corner(links.vertex_xor ^ face.a.id ^ face.b.id ^ face.c.id);
      const std::uint32_t left = replace_corner(d, face);
      const Meeting back = meet(face, front.z);
      if (back.z > front.z) absorb(cell, front, back);
      if (owner_.optics_.is_dark(sum_)) return;
      const int rank = (face.a.id < left) + (face.b.id < left) + (face.c.id < left);
      cell = links.neighbours[static_cast<std::size_t>(rank)];
      front = back;
    }
  }

  /// Makes the face that the line enters the one that it leaves: `d` takes the place of a corner. Returns that corner's
  /// id.
  static std::uint32_t replace_corner(const Corner& d, Face& face) {
    const double ad = edge_area(face.a, d), bd = edge_area(face.b, d), cd = edge_area(face.c, d);
    const bool a = is_left(ad, face.a, d), b = is_left(bd, face.b, d), c = is_left(cd, face.c, d);
    if (a && !b) {
      const std::uint32_t id = face.c.id;
      face.c = d;
      face.bc = bd;
      face.ca = -ad;
      return id;
    }
    if (b && !c) {
      const std::uint32_t id = face.a.id;
      face.a = d;
      face.ab = -bd;
      face.ca = cd;
      return id;
    }
    const std::uint32_t id = face.b.id;
    face.b = d;
    face.ab = ad;
    face.bc = -cd;
    return id;
  }

  void absorb(std::uint32_t cell, const Meeting& front, const Meeting& back) {
    if (is_constant_) {
      const Mark mark = owner_.optics_.extinction->mark(mesh_.cell_scalars[cell]);
      visit_kept(kept_, front.z, back.z, [&](double begin, double end) {
        absorb_piece(cell, {front, back, begin, end, mark, mark});
      });
      return;
    }
    visit_kept(kept_, front.z, back.z, [&](double begin, double end) {
      const auto mark_at = [&](double z) {
        const double t = (z - front.z) / (back.z - front.z);
        return owner_.optics_.extinction->mark(front.mark.scalar + t * (back.mark.scalar - front.mark.scalar));
      };
      absorb_piece(cell, {front, back, begin, end, begin == front.z ? front.mark : mark_at(begin),
                          end == back.z ? back.mark : mark_at(end)});
    });
  }

  /// What is kept of the line in a cell.
  struct Part {
    const Meeting &front, &back;
    double begin = 0.0, end = 0.0;
    const Mark &mark_begin, &mark_end;
  };

  void absorb_piece(std::uint32_t cell, const Part& part) {
    ShadowPiece piece{part.mark_begin, part.mark_end, (part.end - part.begin) * line_.world_per_z, 0.0};
    if (owner_.optics_.weight_by_gradient > 0.0f) {
      const double middle = 0.5 * (part.begin + part.end);
      piece.gradient = magnitude(cell, part.front, part.back, (middle - part.front.z) / (part.back.z - part.front.z));
    }
    add_extinction(owner_.optics_, piece, sum_);
    add_surfaces(owner_.optics_, part.mark_begin.scalar, part.mark_end.scalar, sum_);
  }

  /// Of the gradient, at `t` from front to back.
  double magnitude(std::uint32_t cell, const Meeting& front, const Meeting& back, double t) const {
    std::array<double, 3> gradient{};
    for (std::size_t axis = 0; axis < 3; ++axis)
      gradient[axis] = owner_.has_cell_gradients_
                           ? owner_.gradients_[cell][axis]
                           : front.gradient[axis] + t * (back.gradient[axis] - front.gradient[axis]);
    return std::hypot(gradient[0], gradient[1], gradient[2]);
  }

  const MeshShadows& owner_;
  const PreparedMesh& mesh_;
  const ShadowLine& line_;
  std::span<const DepthRange> kept_;
  Transmission& sum_;
  std::array<double, 2> shear_{};
  bool is_constant_ = false, wants_gradients_ = false;
};

void MeshShadows::expect_parallel(std::size_t light, const Vector3& travel) {
  if (bins_.size() <= light) bins_.resize(light + 1);
  bins_[light] = FaceBins(mesh_, travel);
}

void MeshShadows::gather(const ShadowLine& line, std::span<const DepthRange> kept, Transmission& sum) const {
  Walk walk(*this, line, kept, sum);
  if (line.light < bins_.size() && !bins_[line.light].is_empty()) {
    for (const std::uint32_t face : bins_[line.light].faces_at(line.place))
      if (!walk.enter(mesh_.boundary[face])) return;
  } else {
    faces_.visit_faces(line, [&](std::uint32_t face) { return walk.enter(mesh_.boundary[face]); });
  }
}

}  // namespace tetravox::cpu
