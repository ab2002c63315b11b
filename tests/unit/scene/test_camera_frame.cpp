#include "src/scene/camera_frame.h"

#include "tests/unit/cpu/test_mesh.h"

#include <gtest/gtest.h>

#include <cmath>

namespace tetravox::cpu {
namespace {

const Camera kCamera{{3.0, -5.0, 2.0}, {0.1, 0.2, -0.1}, {0.0, 0.0, 1.0}, 40.0, {}};

TEST(Frame, AxesAreOrthonormalAndRightHandedOnTheScreen) {
  const PreparedMesh mesh = make_test_mesh("sphere");
  const scene::CameraFrame frame = scene::make_camera_frame(mesh, kCamera, 64, 48);
  const auto dot = [&](int a, int b) {
    return frame.axes[a][0] * frame.axes[b][0] + frame.axes[a][1] * frame.axes[b][1] +
           frame.axes[a][2] * frame.axes[b][2];
  };
  for (int a = 0; a < 3; ++a)
    for (int b = 0; b < 3; ++b) EXPECT_NEAR(dot(a, b), a == b ? 1.0 : 0.0, 1e-14);
  EXPECT_GT(frame.axes[1][2], 0.5) << "view_up points up";
}

TEST(Frame, RaysOfAPerspectivePassThroughTheEye) {
  const PreparedMesh mesh = make_test_mesh("sphere");
  const TestFrame frame = make_test_frame(mesh, kCamera, 63, 48);
  const float z = static_cast<float>(frame.camera.eye[2]);
  for (int column = 0; column < 63; ++column)
    EXPECT_NEAR(frame.rays.column_offset[column] + frame.rays.column_slope[column] * z, frame.camera.eye[0], 2e-6);
  EXPECT_EQ(frame.rays.column_slope[31], 0.0f) << "the middle of an odd width looks straight ahead";
}

TEST(Frame, RowsGoDownAndTheViewAngleIsVertical) {
  const PreparedMesh mesh = make_test_mesh("sphere");
  const TestFrame frame = make_test_frame(mesh, kCamera, 64, 48);
  EXPECT_GT(frame.rays.row_slope[0], frame.rays.row_slope[47]);
  const double half_pixel = 0.5 * frame.camera.pixel_step;
  EXPECT_NEAR(frame.rays.row_slope[0] + half_pixel, std::tan(20.0 * 3.14159265358979 / 180.0), 1e-6);
}

TEST(Frame, OrthographicRaysAreParallelAndParallelScaleIsHalfTheHeight) {
  const PreparedMesh mesh = make_test_mesh("sphere");
  Camera camera = kCamera;
  camera.parallel_scale = 2.0;
  const TestFrame frame = make_test_frame(mesh, camera, 64, 48);
  for (int row = 0; row < 48; ++row) EXPECT_EQ(frame.rays.row_slope[row], 0.0f);
  const double height = (frame.rays.row_offset[0] - frame.rays.row_offset[47]) * mesh.world_per_local * 48.0 / 47.0;
  EXPECT_NEAR(height, 4.0, 1e-5);
}

TEST(Frame, VerticesKeepTheirDistances) {
  const PreparedMesh mesh = make_test_mesh("sphere");
  const TestFrame frame = make_test_frame(mesh, kCamera, 8, 8);
  for (std::size_t i = 0; i < mesh.vertices.size(); i += 7) {
    const Vertex& v = mesh.vertices[i];
    const float* w = frame.vertices.data() + 4 * i;
    EXPECT_NEAR(std::hypot(w[0], w[1], w[2]), std::hypot(v.x, v.y, v.z), 1e-6);
    EXPECT_EQ(w[3], v.scalar);
  }
}

}  // namespace
}  // namespace tetravox::cpu
