// SPDX-License-Identifier: Apache-2.0
// Which voxels a moving box meets, against a test of another kind: a segment and a box are apart
// just when one of nine axes parts them (Gottschalk, Lin, Manocha 1996).
#include "framework/map/swept_box.h"

#include "framework/core/random.h"
#include "tests/map/small_map.h"

namespace lapwing {
namespace {

using Eigen::Vector3d;

constexpr double kVoxel = 0.25;  // m, exact in binary

// Whether a box on its way overlaps a cube by more than `margin` in every direction; the cube is
// grown by the box, so that its middle's way is a segment.
bool overlap(const Vector3d& from, const Vector3d& to, const Vector3d& half, const Vector3d& middle,
             double cube_half, double margin) {
  const Vector3d reach = half + Vector3d::Constant(cube_half - margin);
  const Vector3d segment = (to - from) / 2, offset = (from + to) / 2 - middle;
  for (int i = 0; i < 3; ++i) {
    if (std::abs(offset[i]) >= reach[i] + std::abs(segment[i])) return false;
    const Vector3d axis = Vector3d::Unit(i).cross(segment);
    if (axis.norm() < 1e-12) continue;
    if (std::abs(offset.dot(axis)) >= reach.dot(axis.cwiseAbs())) return false;
  }
  return true;
}

TEST(SweptBox, MeetsWhatNoAxisParts) {
  const VoxelGrid grid(kVoxel);
  Random random(5);
  int met = 0, missed = 0;
  for (int k = 0; k < 400; ++k) {
    const auto place = [&](double reach) {
      return Vector3d(random.uniform(-reach, reach), random.uniform(-reach, reach),
                      random.uniform(-reach, reach));
    };
    const Vector3d from = place(1), half = place(0.4).cwiseAbs();
    Vector3d to = k % 4 == 0 ? from : place(1.5);
    if (k % 4 == 1) to[k / 4 % 3] = from[k / 4 % 3];  // along a plane of the grid
    const SweptBox box(grid, from, to, half);
    for (int level = 0; level <= 2; ++level)
      for (int z = -12; z < 12; z += 1 << level)
        for (int y = -12; y < 12; y += 1 << level)
          for (int x = -12; x < 12; x += 1 << level) {
            const int lowest[3] = {kCenterKey + x, kCenterKey + y, kCenterKey + z};
            const double cube_half = kVoxel * (1 << level) / 2;
            const Vector3d middle = kVoxel * Vector3d(x, y, z) + Vector3d::Constant(cube_half);
            const bool meets = box.meets(lowest, level);
            // What touches within the tolerance may be called either way.
            if (overlap(from, to, half, middle, cube_half, 4e-6 * kVoxel)) {
              ASSERT_TRUE(meets) << k << ": " << x << " " << y << " " << z << " level " << level;
              ++met;
            } else if (!overlap(from, to, half, middle, cube_half, -4e-6 * kVoxel)) {
              ASSERT_FALSE(meets) << k << ": " << x << " " << y << " " << z << " level " << level;
              ++missed;
            }
          }
    // Nothing beyond the stated corners is met.
    for (int i = 0; i < 3; ++i) {
      const double low = std::min(from[i], to[i]) - half[i];
      const double high = std::max(from[i], to[i]) + half[i];
      EXPECT_LE(grid.face(box.lower[i]), low + 1e-5);
      EXPECT_GT(grid.face(box.lower[i] + 1), low - 1e-5);
      EXPECT_LE(grid.face(box.upper[i]), high + 1e-5);
      EXPECT_GT(grid.face(box.upper[i] + 1), high - 1e-5);
    }
  }
  EXPECT_GT(met, 10000);
  EXPECT_GT(missed, 100000);
}

TEST(SweptBox, TouchingIsNoMeeting) {
  const VoxelGrid grid(kVoxel);
  // Slides along the faces of x = 0 and z = 1, from y = 0 to 2.
  const SweptBox box(grid, {-0.5, 0.5, 0.5}, {-0.5, 1.5, 0.5}, Vector3d::Constant(0.5));
  const auto meets = [&](int x, int y, int z) {
    const int lowest[3] = {kCenterKey + x, kCenterKey + y, kCenterKey + z};
    return box.meets(lowest, 0);
  };
  EXPECT_TRUE(meets(-1, 0, 3));
  EXPECT_TRUE(meets(-4, 7, 0));
  EXPECT_FALSE(meets(0, 3, 2));
  EXPECT_FALSE(meets(-5, 3, 2));
  EXPECT_FALSE(meets(-1, 3, 4));
  EXPECT_FALSE(meets(-1, -1, 2));
  EXPECT_FALSE(meets(-1, 8, 2));
}

TEST(Uncertainty, FallsByAFactorWithEachObservation) {
  Value value = Value::map();
  value.set("observations", true);
  value.set("resolution", 0.5);
  PlainMap map(map_settings(check(map_parameters(), value)));
  EXPECT_EQ(map.uncertainty(0), 1);
  EXPECT_NEAR(map.uncertainty(1), 0.6065306597126334, 1e-12);  // exp(-0.5), eta of reading 5.2
  EXPECT_NEAR(map.uncertainty(4), 0.1353352832366127, 1e-12);
  value.set("information", 2.0);
  EXPECT_NEAR(PlainMap(map_settings(check(map_parameters(), value))).uncertainty(1),
              0.1353352832366127, 1e-12);
  // Over 2^3 voxels, one of them measured twice.
  map.integrate(std::vector<Eigen::Vector3f>{{0.3f, 0.3f, 0.3f}}, {0.2f, 0.2f, 0.2f});
  map.integrate(std::vector<Eigen::Vector3f>{{0.3f, 0.3f, 0.3f}}, {0.2f, 0.2f, 0.2f});
  const VoxelKey key = map.grid().key(Vector3d(0.3, 0.3, 0.3));
  MeanReading mean;
  map.read_means(1, {&key, 1}, {&mean, 1});
  EXPECT_NEAR(mean.uncertainty, (7 + 0.36787944117144233) / 8, 1e-6);
}

}  // namespace
}  // namespace lapwing
