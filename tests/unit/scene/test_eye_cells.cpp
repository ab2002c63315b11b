#include "src/scene/eye_cells.h"

#include "tests/unit/cpu/test_mesh.h"

#include <gtest/gtest.h>

#include <cmath>

namespace tetravox::cpu {
namespace {

std::vector<BoundaryFace> find_faces(const PreparedMesh& mesh, const Vector3& eye,
                                     scene::CameraFrame* moved = nullptr) {
  Camera camera;
  camera.position = eye;
  camera.focal_point = {eye[0] + 0.3, eye[1] + 1.0, eye[2] - 0.2};
  camera.view_up = {0, 0, 1};
  TestFrame frame = make_test_frame(mesh, camera, 16, 16);
  std::vector<BoundaryFace> faces =
      scene::find_eye_cell_faces(frame.mesh.seen(), mesh.boundary, mesh.cells.size(), frame.camera);
  if (moved) *moved = frame.camera;
  return faces;
}

TEST(EyeCells, ThereAreNoneOutside) {
  const PreparedMesh mesh = make_test_mesh("sphere");
  EXPECT_TRUE(find_faces(mesh, {0, -20, 0}).empty());
  EXPECT_TRUE(find_faces(mesh, {0, 20, 0}).empty()) << "the mesh is behind the eye";
}

TEST(EyeCells, OneCellHoldsAnEyeInside) {
  const PreparedMesh mesh = make_test_mesh("sphere");
  const auto faces = find_faces(mesh, {0.123, 0.234, -0.345});
  ASSERT_EQ(faces.size(), 4u);
  for (const BoundaryFace& face : faces) EXPECT_EQ(face.cell, faces[0].cell);
  // Each pair of faces shares an edge, met in opposite directions.
  int shared = 0;
  for (std::size_t i = 0; i < 4; ++i)
    for (std::size_t j = 0; j < 4; ++j)
      for (int a = 0; a < 3; ++a)
        for (int b = 0; b < 3; ++b)
          shared += i != j && faces[i].vertices[a] == faces[j].vertices[(b + 1) % 3] &&
                    faces[i].vertices[(a + 1) % 3] == faces[j].vertices[b];
  EXPECT_EQ(shared, 12);
}

TEST(EyeCells, AnEyeOnAVertexIsMovedIntoACell) {
  const PreparedMesh mesh = make_test_mesh("sphere");
  const Vertex& v = mesh.vertices[mesh.vertices.size() / 2];
  const Vector3 eye{mesh.origin[0] + v.x * mesh.world_per_local, mesh.origin[1] + v.y * mesh.world_per_local,
                    mesh.origin[2] + v.z * mesh.world_per_local};
  scene::CameraFrame moved;
  EXPECT_EQ(find_faces(mesh, eye, &moved).size(), 4u);
}

}  // namespace
}  // namespace tetravox::cpu
