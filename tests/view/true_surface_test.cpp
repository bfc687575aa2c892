// SPDX-License-Identifier: Apache-2.0
// How much of a true surface images see.
#include "framework/view/true_surface.h"

#include <gtest/gtest.h>

#include "framework/core/error.h"
#include "framework/geometry/mesh_builder.h"

namespace lapwing {
namespace {

using Eigen::Vector3d;

// A house of 8 m x 8 m x 6 m with a wall within, on a ground of 80 m.
std::shared_ptr<const MeshScene> seen_house() {
  MeshBuilder builder;
  builder.quad({-40, -40, 0}, {40, -40, 0}, {40, 40, 0}, {-40, 40, 0});
  builder.box({-4, -4, 0}, {4, 4, 6});
  builder.box({-0.2, -3, 0.2}, {0.2, 3, 5});
  return std::make_shared<MeshScene>(builder.take());
}

const Eigen::AlignedBox3d kHouseRegion(Vector3d(-6, -6, -0.5), Vector3d(6, 6, 7));
const Eigen::AlignedBox3d kHouseRoom(Vector3d(-20, -20, 1.5), Vector3d(20, 20, 20));
constexpr Pinhole kHouseCamera{600, 450, 345, 345, 299.5, 224.5};
const double kHouseOutside = 4 * 8 * 6 + 8 * 8;  // m^2, walls and roof
const double kHouseGround = 12 * 12 - 8 * 8;

TEST(TrueSurface, IsWhatCanBeSeenFromOutside) {
  const TrueSurface surface(seen_house(), kHouseRegion, kHouseRoom, 1);
  EXPECT_NEAR(surface.area(), kHouseOutside + kHouseGround, 0.02 * (kHouseOutside + kHouseGround));
  EXPECT_EQ(TrueSurface(seen_house(), kHouseRegion, kHouseRoom, 2).area(), surface.area());
  EXPECT_THROW(
      TrueSurface(seen_house(), Eigen::AlignedBox3d(Vector3d(-6, -6, 10), Vector3d(6, 6, 12)),
                  kHouseRoom, 1),
      InputError);
}

TEST(TrueSurface, AViewSeesWhatFacesItAndIsNotHidden) {
  const TrueSurface surface(seen_house(), kHouseRegion, kHouseRoom, 1);
  const auto seen = [&](const std::vector<Viewpoint>& views, double range = 60) {
    return surface.seen(views, kHouseCamera, range, 1);
  };
  // From the east, below the roof: the east wall, the ground before it, and past the corners as far
  // as a line from the camera leads: 5 m^2 on either side.
  const Viewpoint east{{14, 0, 4}, EIGEN_PI, -0.1};
  EXPECT_NEAR(seen({east}), 8 * 6 + 2 * 12 + 2 * 5, 3);
  EXPECT_EQ(seen({east}, 5), 0);
  const Viewpoint away{{14, 0, 4}, 0, -0.1};
  EXPECT_EQ(seen({away}), 0);
  // From straight above: the roof, which hides all the ground of the region, and no wall.
  const Viewpoint above{{0, 0, 18}, 0, -EIGEN_PI / 2};
  EXPECT_NEAR(seen({above}), 8 * 8, 2);
  // What two see is not counted twice.
  EXPECT_DOUBLE_EQ(seen({east, east}), seen({east}));
  EXPECT_GT(seen({east, above}), seen({above}) + 40);
}

}  // namespace
}  // namespace lapwing
