// SPDX-License-Identifier: Apache-2.0
// How wide the gaps between rays are, by place.
#include "framework/map/ray_gaps.h"

#include <gtest/gtest.h>

#include <cmath>

#include "framework/geometry/depth_camera.h"
#include "framework/geometry/mesh_builder.h"

namespace lapwing {
namespace {

using Eigen::Vector3d;

constexpr Pinhole kFew{80, 60, 50, 50, 39.5, 29.5};

MeasuringImage looking_east(double x) {
  return {camera_pose({x, 0, 5}, 0, 0), kFew, 30};
}

TEST(RayGaps, AreTheDiagonalOfFourRaysOfTheNearestImage) {
  const MapRays rays{{looking_east(-20), looking_east(0)}, 0.7};
  EXPECT_NEAR(gap_at({10, 0, 5}, rays, nullptr), std::sqrt(2.0) * 10 / 50, 1e-12);
  EXPECT_NEAR(gap_at({10, 4, 6}, rays, nullptr), std::sqrt(2.0) * 10 / 50, 1e-12) << "depth";
  EXPECT_NEAR(gap_at({-5, 0, 5}, rays, nullptr), std::sqrt(2.0) * 15 / 50, 1e-12) << "behind one";
  for (const Vector3d& unseen : {Vector3d(-25, 0, 5), Vector3d(10, 30, 5), Vector3d(31, 0, 5)})
    EXPECT_EQ(gap_at(unseen, rays, nullptr), 0.7) << unseen.transpose();
}

TEST(RayGaps, OfAnImageThatIsHiddenDoNotCountButWhereAllAre) {
  MeshBuilder builder;  // a wall before the nearer image
  builder.quad({5, -50, -50}, {5, 50, -50}, {5, 50, 50}, {5, -50, 50});
  const MeshScene wall(builder.take());
  const MeasuringImage west{camera_pose({30, 0, 5}, EIGEN_PI, 0), kFew, 30};
  EXPECT_NEAR(gap_at({10, 0, 5}, {{looking_east(0), west}, 0}, &wall), std::sqrt(2.0) * 20 / 50,
              1e-12);
  EXPECT_NEAR(gap_at({10, 0, 5}, {{looking_east(0)}, 0}, &wall), std::sqrt(2.0) * 10 / 50, 1e-12);
}

TEST(RayGaps, OfALatticeAreTheWidestBeside) {
  const MapRays rays{{looking_east(0)}, 0};
  const PlaceLattice lattice{{2, 0, 5}, 3, {5, 1, 2}};
  const std::vector<double> gaps = widest_gaps(lattice, rays, nullptr, 2);
  ASSERT_EQ(gaps.size(), 10u);
  for (int x = 0; x < 5; ++x)
    EXPECT_NEAR(gaps[lattice.place(x, 0, 0)], std::sqrt(2.0) * (2 + 3 * std::min(x + 1, 4)) / 50,
                1e-12);
  EXPECT_EQ(gaps, widest_gaps(lattice, rays, nullptr, 1));
}

}  // namespace
}  // namespace lapwing
