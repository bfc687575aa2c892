// SPDX-License-Identifier: Apache-2.0
// Meshes and depth images of tests/data, read as a user's would be.
#include <gtest/gtest.h>

#include <filesystem>

#include "framework/geometry/depth_folder.h"
#include "framework/geometry/mesh_file.h"

namespace lapwing {
namespace {

const std::filesystem::path kShipped = std::filesystem::path(LAPWING_SOURCE_DIR) / "tests/data";

// A house of 8 m by 6 m under a roof that overhangs, drawn in inches with z up.
TEST(ShippedMeshes, ColladaInInchesComesInMetresWithZUp) {
  const MeshFile house = read_mesh(kShipped / "meshes/cottage.dae");
  EXPECT_EQ(house.unit, 0.0254);
  EXPECT_EQ(house.unit_from, StatedBy::file);
  EXPECT_EQ(house.up_from, StatedBy::file);
  const Eigen::AlignedBox3d bounds = house.mesh.bounds();
  EXPECT_TRUE(bounds.min().isApprox(Eigen::Vector3d(-0.3, -0.4, 0), 1e-3)) << bounds.min();
  EXPECT_TRUE(bounds.max().isApprox(Eigen::Vector3d(8.3, 6.4, 6.2), 1e-3)) << bounds.max();
  EXPECT_EQ(house.mesh.triangles.size(), 12u + 8u + 12u);
}

// Its faces are squares and triangles; its file states neither unit nor axis.
TEST(ShippedMeshes, ObjIsTakenForMetresWithZUp) {
  const MeshFile tower = read_mesh(kShipped / "meshes/tower.obj");
  EXPECT_EQ(tower.unit_from, StatedBy::assumption);
  EXPECT_NEAR(tower.mesh.bounds().sizes().z(), 13, 1e-6);
  EXPECT_NEAR(tower.mesh.bounds().sizes().x(), 6.2, 1e-3);
  EXPECT_EQ(tower.mesh.triangles.size(), 3u * 12 * 2 + 12);
}

// A room of 6 m by 5 m, from within: every depth ends inside of it.
TEST(ShippedDepth, IsRead) {
  const DepthFolder folder(kShipped / "depth");
  ASSERT_EQ(folder.size(), 8u);
  EXPECT_EQ(folder.pinhole().width, 64);
  EXPECT_EQ(folder.pinhole().focal_x, 58.5);
  int missing = 0;
  for (std::size_t k = 0; k < folder.size(); ++k) {
    const PosedDepthImage frame = folder.read(k);
    EXPECT_GT(frame.camera.position.x(), 0);
    EXPECT_LT(frame.camera.position.x(), 6);
    double sum = 0, count = 0;
    for (const float d : frame.image.depth) {
      EXPECT_LT(d, 6);
      if (d > 0) sum += static_cast<double>(d), ++count;
      missing += d == 0;
    }
    EXPECT_GT(sum / count, 1);
    EXPECT_LT(sum / count, 4);
  }
  EXPECT_GT(missing, 100) << "two in a hundred pixels see nothing";
  EXPECT_LT(missing, 1000);
}

}  // namespace
}  // namespace lapwing
