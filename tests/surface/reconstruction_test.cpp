// SPDX-License-Identifier: Apache-2.0
#include "framework/surface/reconstruction.h"

#include <gtest/gtest.h>

#include <cmath>

#include "framework/core/error.h"
#include "framework/core/random.h"

namespace lapwing {
namespace {

// A square of 6 m at a height, seen from above.
TriangleMesh square(double z, double half = 3) {
  TriangleMesh mesh;
  mesh.vertices = {{-half, -half, z}, {half, -half, z}, {half, half, z}, {-half, half, z}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  return mesh;
}

ReconstructionSettings settings() {
  ReconstructionSettings s;
  s.region = {Eigen::Vector3d(-3.5, -3.5, -1), Eigen::Vector3d(3.5, 3.5, 2)};
  return s;
}

const Pinhole kWide{240, 240, 120, 120, 119.5, 119.5};  // 4 cm at 5 m

// Cameras 5 m above, at a little distance from each other, that look straight down.
std::vector<Pose> above(int count, double x = 0) {
  std::vector<Pose> cameras;
  for (int i = 0; i < count; ++i) {
    cameras.push_back(camera_pose({x + 0.2 * i, -0.1 * i, 5}, 0.3 * i, -1.5707963267948966));
  }
  return cameras;
}

GridPoints points_of(const TriangleMesh& mesh, const std::vector<Pose>& cameras,
                     const ReconstructionSettings& s, int threads = 1,
                     std::optional<DepthNoise> noise = std::nullopt) {
  const MeshScene scene(mesh);
  Reconstruction reconstruction(s);
  reconstruction.add(scene, cameras, kWide, noise, 7, threads);
  return reconstruction.points(threads);
}

TEST(Reconstructions, ThreeViewsMakeAPlaneAndTwoDoNot) {
  const TriangleMesh plane = square(0);
  const SurfaceSample truth(plane, settings(), 1);
  // 120 by 120 places of 5 cm; the grid's edge need not be the plane's.
  EXPECT_NEAR(static_cast<double>(truth.points().size()), 120 * 120, 250);
  for (const int views : {0, 1, 2}) {
    const ReconstructionScore score = truth.score(points_of(plane, above(views), settings()), 1);
    EXPECT_EQ(score.recall, 0) << views;
    EXPECT_EQ(score.f, 0) << views;
    EXPECT_EQ(score.points, 0) << views;
  }
  const ReconstructionScore three = truth.score(points_of(plane, above(3), settings()), 1);
  EXPECT_GE(three.recall, 0.999);
  EXPECT_EQ(three.precision, 1);
  EXPECT_GE(three.f, 0.999);
  ReconstructionSettings two = settings();
  two.images = 2;
  EXPECT_GE(truth.score(points_of(plane, above(2), two), 1).recall, 0.999);
}

// Pixels of 17 cm: no two images measure the same places, and still they agree.
TEST(Reconstructions, FarImagesAgreeWherePixelsOverlap) {
  const TriangleMesh plane = square(0);
  const SurfaceSample truth(plane, settings(), 1);
  const MeshScene scene(plane);
  std::vector<Pose> cameras;
  for (int i = 0; i < 3; ++i) {
    cameras.push_back(camera_pose({0.13 * i, 0.07 * i, 20}, 0.5 * i, -1.5707963267948966));
  }
  for (const std::size_t views : {2u, 3u}) {
    Reconstruction reconstruction(settings());
    reconstruction.add(scene, std::span(cameras).first(views), kWide, std::nullopt, 1, 1);
    const GridPoints points = reconstruction.points(1);
    if (views == 2) {
      EXPECT_TRUE(points.empty());
      continue;
    }
    EXPECT_GE(points.size(), 3 * 33u * 33u);  // most pixels of each image
    const ReconstructionScore score = truth.score(points, 1);
    EXPECT_EQ(score.precision, 1);
    EXPECT_GE(score.recall, 0.9);
  }
}

TEST(Reconstructions, AShiftedSurfaceIsWrong) {
  const SurfaceSample truth(square(0), settings(), 1);
  const GridPoints near = points_of(square(0.09), above(3), settings());
  EXPECT_EQ(truth.score(near, 1).precision, 1);
  const GridPoints far = points_of(square(0.3), above(3), settings());
  ASSERT_GT(far.size(), 10000u);
  const ReconstructionScore score = truth.score(far, 1);
  EXPECT_EQ(score.precision, 0);
  EXPECT_EQ(score.recall, 0);
  EXPECT_EQ(score.f, 0);
}

TEST(Reconstructions, HalfASurfaceIsHalfRecalled) {
  // The scene has half of the surface that is asked for, and twice as much beside it.
  const SurfaceSample truth(square(0), settings(), 1);
  TriangleMesh half = square(0);
  for (auto& v : half.vertices) v.x() = std::max(v.x(), 0.0);
  const ReconstructionScore score = truth.score(points_of(half, above(3), settings()), 1);
  EXPECT_NEAR(score.recall, 0.5, 0.03);
  EXPECT_EQ(score.precision, 1);
  EXPECT_NEAR(score.f, 2.0 / 3, 0.03);
}

TEST(Reconstructions, LeaveOutWhatIsFarOrFlat) {
  const SurfaceSample truth(square(0), settings(), 1);
  ReconstructionSettings close = settings();
  close.range = 4.9;
  EXPECT_EQ(points_of(square(0), above(3), close).size(), 0u);
  // Seen from 5 m above only what lies within 5 m x tan 10 degrees is seen steeply enough.
  ReconstructionSettings steep = settings();
  steep.incidence = 10 * 0.017453292519943295;
  const double radius = 5 * std::tan(steep.incidence);
  const GridPoints points = points_of(square(0), std::vector<Pose>(3, above(1)[0]), steep);
  ASSERT_FALSE(points.empty());
  for (const auto& p : points) EXPECT_LE(p.head<2>().norm(), radius + 1e-3);
  const double area = 3.14159265 * radius * radius;
  EXPECT_NEAR(truth.score(points, 1).recall, area / 36, 0.02);
}

TEST(Reconstructions, AreTheSameForAnyThreadsAndParts) {
  const TriangleMesh plane = square(0.02);
  const std::vector<Pose> cameras = above(20, -1);
  const DepthNoise noise{0.4, 0.1};
  const GridPoints whole = points_of(plane, cameras, settings(), 1, noise);
  ASSERT_GT(whole.size(), 1000u);
  EXPECT_EQ(points_of(plane, cameras, settings(), 4, noise), whole);
  const MeshScene scene(plane);
  Reconstruction parts(settings());
  const std::span<const Pose> all(cameras);
  parts.add(scene, all.first(7), kWide, noise, 7, 2);
  const Reconstruction begun = parts;
  parts.add(scene, all.subspan(7), kWide, noise, 7, 1);
  EXPECT_EQ(parts.points(2), whole);
  EXPECT_EQ(parts.images(), 20);
  EXPECT_EQ(begun.images(), 7);
  EXPECT_LT(begun.points(1).size(), whole.size());
  const SurfaceSample one(plane, settings(), 1), four(plane, settings(), 4);
  EXPECT_EQ(one.points(), four.points());
  EXPECT_EQ(one.score(whole, 1).f, four.score(whole, 4).f);
}

TEST(Reconstructions, NoiseCostsPrecision) {
  const SurfaceSample truth(square(0), settings(), 2);
  const auto score = [&](double sigma) {
    return truth.score(points_of(square(0), above(6), settings(), 2, DepthNoise{0.4, sigma}), 2);
  };
  const ReconstructionScore low = score(0.02), high = score(0.2);
  EXPECT_GE(low.precision, 0.95);
  EXPECT_GE(low.recall, 0.95);
  EXPECT_LT(high.precision, low.precision - 0.2);
}

// Against every point compared with every other.
TEST(Reconstructions, SharesEqualBruteForce) {
  TriangleMesh mesh = square(0, 0.8);
  for (auto& v : mesh.vertices) v.z() = 0.2 * v.x() * v.y();
  ReconstructionSettings s = settings();
  s.region = {Eigen::Vector3d(-0.61, -0.7, -1), Eigen::Vector3d(0.6, 0.7, 1)};
  const SurfaceSample truth(mesh, s, 1);
  ReconstructionSettings wide = s;
  wide.region = {Eigen::Vector3d(-2, -2, -1), Eigen::Vector3d(2, 2, 1)};
  const SurfaceSample all(mesh, wide, 1);
  Random random(5);
  GridPoints points;
  for (int i = 0; i < 500; ++i) {
    points.push_back({static_cast<float>(random.uniform(-0.9, 0.9)),
                      static_cast<float>(random.uniform(-0.9, 0.9)),
                      static_cast<float>(random.uniform(-0.3, 0.3))});
  }
  const auto close = [](const Eigen::Vector3f& p, const GridPoints& to) {
    return std::any_of(to.begin(), to.end(), [&](const Eigen::Vector3f& q) {
      return (q - p).cast<double>().norm() <= 0.1;
    });
  };
  int inside = 0, precise = 0, recalled = 0;
  for (const auto& p : points) {
    if (!s.region.contains(p.cast<double>())) continue;
    ++inside;
    precise += close(p, all.points());
  }
  for (const auto& p : truth.points()) recalled += close(p, points);
  const ReconstructionScore score = truth.score(points, 1);
  EXPECT_EQ(score.points, inside);
  EXPECT_DOUBLE_EQ(score.precision, static_cast<double>(precise) / inside);
  EXPECT_DOUBLE_EQ(score.recall,
                   static_cast<double>(recalled) / static_cast<double>(truth.points().size()));
  EXPECT_GT(precise, 50);
  EXPECT_GT(recalled, 100);
}

TEST(Reconstructions, WithoutSenseAreRefused) {
  const TriangleMesh plane = square(0);
  const auto refused = [&](auto change) {
    ReconstructionSettings s = settings();
    change(s);
    EXPECT_THROW(SurfaceSample(plane, s, 1), InputError);
    EXPECT_THROW(Reconstruction{s}, InputError);
  };
  refused([](auto& s) { s.region = {}; });
  refused([](auto& s) { s.grid = 0; });
  refused([](auto& s) { s.near = 0.12; });
  refused([](auto& s) { s.images = 0; });
  refused([](auto& s) { s.incidence = 2; });
  refused([](auto& s) { s.region.max().x() = 1e6; });
  ReconstructionSettings nothing = settings();
  nothing.region = {Eigen::Vector3d(-1, -1, 1), Eigen::Vector3d(1, 1, 2)};
  EXPECT_THROW(SurfaceSample(plane, nothing, 1), InputError);
}

}  // namespace
}  // namespace lapwing
