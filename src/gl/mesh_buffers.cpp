#include "src/gl/mesh_buffers.h"

#include "src/scene/eye_cells.h"
#include "src/support/memory.h"
#include "tetravox/error.h"

#include <algorithm>
#include <string>

namespace tetravox::gl {
namespace {

constexpr GLuint kVertexUnit = 6, kCellUnit = 7, kFaceUnit = 8, kCellScalarUnit = 9;

}  // namespace

MeshBuffers::MeshBuffers(const PreparedMesh& mesh, const Limits& limits) : mesh_(mesh) {
  // Texels of cells are single numbers, five a cell.
  const std::uint64_t most =
      std::max<std::uint64_t>({5 * mesh.cells.size(), mesh.vertices.size(), mesh.boundary.size()});
  // The twelve vertices of a cell's faces are counted by signed numbers, too (source vicp).
  constexpr std::uint64_t kMostCells = 0x7FFFFFFFu / 12;
  const std::uint64_t allowed = std::min<std::uint64_t>(limits.buffer_texels, 5 * kMostCells);
  if (most > allowed)
    throw Error(ErrorCode::kUnsupported, "OpenGL: this device holds meshes of at most " + std::to_string(allowed / 5) +
                                             " tetrahedra, and this one has " + std::to_string(mesh.cells.size()) +
                                             ": draw with --backend cpu");
  static_assert(sizeof(TetrahedronLinks) == 5 * sizeof(std::uint32_t));
  cells_.upload(GL_R32UI, mesh.cells.data(), mesh.cells.size() * sizeof(TetrahedronLinks));
  cell_scalars_.upload(GL_R32F, mesh.cell_scalars.data(), mesh.cell_scalars.size() * sizeof(float));
  seen_.resize(4 * mesh.vertices.size());
}

scene::CameraFrame MeshBuffers::see(const Camera& camera, int width, int height) {
  scene::CameraFrame frame = scene::make_camera_frame(mesh_, camera, width, height);
  scene::transform_vertices(mesh_, frame, seen_.data());
  const std::vector<BoundaryFace> around =
      scene::find_eye_cell_faces(seen_mesh(), mesh_.boundary, mesh_.cells.size(), frame);
  vertices_.upload(GL_RGBA32F, seen_.data(), seen_.size() * sizeof(float));
  std::vector<BoundaryFace> faces = mesh_.boundary;
  faces.insert(faces.end(), around.begin(), around.end());
  face_count_ = faces.size();
  faces_.upload(GL_RGBA32UI, faces.data(), faces.size() * sizeof(BoundaryFace));
  return frame;
}

bool MeshBuffers::is_behind_eye(const scene::CameraFrame& frame) const {
  return scene::reaches_behind_eye(seen_mesh(), frame, face_count_ > mesh_.boundary.size());
}

scene::SeenMesh MeshBuffers::seen_mesh() const {
  return {seen_.data(), static_cast<std::uint32_t>(mesh_.vertices.size() - 1), mesh_.cells.data()};
}

void MeshBuffers::bind() const {
  vertices_.bind(kVertexUnit);
  cells_.bind(kCellUnit);
  faces_.bind(kFaceUnit);
  cell_scalars_.bind(kCellScalarUnit);
}

WalkBlock MeshBuffers::describe() const {
  WalkBlock block{};
  block.last_vertex = static_cast<uint>(mesh_.vertices.size() - 1);
  block.face_count = static_cast<uint>(face_count_);
  block.first_eye_face = static_cast<uint>(mesh_.boundary.size());
  return block;
}

std::uint64_t MeshBuffers::bytes() const {
  return seen_.size() * sizeof(float) + vertices_.bytes() + cells_.bytes() + faces_.bytes() + cell_scalars_.bytes();
}

}  // namespace tetravox::gl
