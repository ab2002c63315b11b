// Orders of public meshes.

#include "tests/common/cameras.h"
#include "tetravox/error.h"
#include "tetravox/io.h"
#include "tetravox/scene.h"
#include "tetravox/visibility.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <ostream>
#include <string>
#include <vector>

namespace tetravox::tests {
namespace {

const std::filesystem::path kData = std::filesystem::path(TETRAVOX_SHARED_DIR) / "data";

struct SharedMesh {
  const char* file;
  int pixels;  ///< of the check, along an axis
};

void PrintTo(const SharedMesh& mesh, std::ostream* out) { *out << mesh.file; }

std::vector<NamedCamera> make_views(const PreparedMesh& mesh) {
  std::vector<NamedCamera> views = make_cameras(mesh.bounds);
  Camera camera = make_default_camera(mesh.bounds, 1.0);
  for (int i = 0; i < 4; ++i)
    views.push_back({"default " + std::to_string(i), rotate_camera(camera, 90.0 * i, 15.0 * i)});
  return views;
}

class SharedMeshes : public testing::TestWithParam<SharedMesh> {
 protected:
  void SetUp() override {
    path_ = kData / GetParam().file;
    if (!std::filesystem::exists(path_)) GTEST_SKIP() << "no data in " << kData;
  }

  std::filesystem::path path_;
};

TEST_P(SharedMeshes, XmpvoIsExact) {
  const PreparedMesh mesh = prepare_mesh(read_dataset(path_.string()).mesh);
  VisibilitySorter sorter(mesh);
  for (const NamedCamera& view : make_views(mesh)) {
    SCOPED_TRACE(view.name);
    SortStatistics statistics;
    const auto order = sorter.sort(view.camera, {}, &statistics);
    const OrderReport report =
        check_order(mesh, view.camera, order, {SortDirection::kBackToFront, GetParam().pixels, GetParam().pixels, 0});
    EXPECT_TRUE(report.is_permutation);
    EXPECT_EQ(statistics.cycles, 0u);
    EXPECT_EQ(report.face_violations, 0u);
    EXPECT_EQ(report.wrong_segments, 0u);
    EXPECT_EQ(report.intersections, 0u);
  }
}

INSTANTIATE_TEST_SUITE_P(Acyclic, SharedMeshes,
                         testing::Values(SharedMesh{"bluntfin.vtu", 64}, SharedMesh{"bluntfin.vts", 64},
                                         SharedMesh{"post.vtu", 64}, SharedMesh{"post-coarse.vtk", 128},
                                         SharedMesh{"disk_out_ref.ex2", 96}, SharedMesh{"notch_stress_fixed.vtk", 96},
                                         SharedMesh{"CylinderQuadratic.vtk", 96}, SharedMesh{"sqnz_s.adf.cgns", 64},
                                         SharedMesh{"hexa.vtk", 64}, SharedMesh{"office.binary.vtk", 64},
                                         SharedMesh{"PentaHexa.vtk", 96}, SharedMesh{"tetraMesh.vtk", 96}));

/// A crushed can, whose walls go through each other and lie around each other in circles.
TEST(CyclicSharedMesh, CyclesAreReportedAndFewCellsSuffer) {
  const std::filesystem::path path = kData / "can.vtu";
  if (!std::filesystem::exists(path)) GTEST_SKIP() << "no data in " << kData;
  const PreparedMesh mesh = prepare_mesh(read_dataset(path.string()).mesh);
  const Camera camera = make_default_camera(mesh.bounds, 1.0);
  std::uint64_t wrong[4]{};
  for (const SortMethod method : {SortMethod::kCentroid, SortMethod::kMpvo, SortMethod::kMpvonc, SortMethod::kXmpvo}) {
    VisibilitySorter sorter(mesh);
    SortStatistics statistics;
    const auto order = sorter.sort(camera, {.method = method}, &statistics);
    const OrderReport report = check_order(mesh, camera, order);
    EXPECT_TRUE(report.is_permutation);
    EXPECT_GT(report.intersections, 0u);
    wrong[static_cast<int>(method)] = report.wrong_segments;
    if (method == SortMethod::kXmpvo) {
      EXPECT_GT(statistics.cycles, 0u);
      EXPECT_GT(statistics.broken_relations, 0u);
    }
  }
  EXPECT_LT(wrong[3], wrong[2]);
  EXPECT_LT(wrong[2], wrong[1]);
}

}  // namespace
}  // namespace tetravox::tests
