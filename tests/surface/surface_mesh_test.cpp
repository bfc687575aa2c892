// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <numbers>

#include "framework/core/error.h"
#include "framework/geometry/depth_camera.h"
#include "framework/geometry/mesh_builder.h"
#include "framework/surface/surface_mesh.h"

namespace lapwing {
namespace {

using Eigen::Vector3d;

constexpr Pinhole kMeshCamera{160, 120, 120, 120, 79.5, 59.5};

// Looked at from places all around it.
PointFusion fused_ball(double voxel, const DepthNoise& noise) {
  MeshBuilder builder;
  builder.ball({1, 2, 3}, {2, 2, 2}, 5);
  const MeshScene scene(builder.take());
  PointFusion fusion({.voxel = voxel});
  for (int i = 0; i < 24; ++i) {
    const double up = -0.9 + 1.8 * i / 23, around = 2.4 * i, across = std::sqrt(1 - up * up);
    const Vector3d out(across * std::cos(around), across * std::sin(around), up);
    const Pose pose =
        camera_pose(Vector3d(1, 2, 3) + 6 * out, std::atan2(-out.y(), -out.x()), -std::asin(up));
    DepthImage image = render_depth(scene, pose, kMeshCamera, 30, 2);
    add_noise(image, noise, static_cast<std::uint64_t>(i));
    fusion.add({pose, image});
  }
  return fusion;
}

TEST(PointFusion, PointsLieOnTheSurfaceAndFaceTheCamera) {
  const auto points = fused_ball(0.2, {0, 0}).points();
  // As many as there are cubes that the sphere passes through, nearly.
  EXPECT_GT(points.size(), 4 * std::numbers::pi * 4 / 0.04);
  EXPECT_LT(points.size(), 3 * 4 * std::numbers::pi * 4 / 0.04);
  for (const FusedPoint& p : points) {
    const Vector3d out = p.position - Vector3d(1, 2, 3);
    EXPECT_NEAR(out.norm(), 2, 0.03);
    EXPECT_GT(p.normal.dot(out.normalized()), 0.9);
    EXPECT_NEAR(p.normal.norm(), 1, 1e-9);
    EXPECT_GE(p.images, 1);
  }
  EXPECT_LT(fused_ball(0.2, {0, 0}).points(3).size(), points.size());
}

TEST(PointFusion, LeavesOutWhatIsFarOrFlatOrAtAnEdge) {
  MeshBuilder builder;
  builder.quad({-50, -50, 0}, {50, -50, 0}, {50, 50, 0}, {-50, 50, 0});
  builder.box({5, -1, 0}, {5.2, 1, 2});
  const MeshScene scene(builder.take());
  const Pose pose = camera_pose({0, 0, 1}, 0, 0);
  const DepthImage image = render_depth(scene, pose, kMeshCamera, 100, 1);
  PointFusion fusion({.voxel = 0.1, .range = 8});
  fusion.add({pose, image});
  const auto points = fusion.points();
  EXPECT_GT(points.size(), 100u);
  for (const FusedPoint& p : points) {
    EXPECT_LE((p.position - pose.position).x(), 8 + 1e-6);
    const Vector3d ray = (p.position - pose.position).normalized();
    EXPECT_LE(-ray.dot(p.normal), 1);
    EXPECT_GE(-ray.dot(p.normal), std::cos(1.309) - 0.05);
    // On the ground or on the board, and nowhere between the two.
    const bool ground = std::abs(p.position.z()) < 0.01;
    const bool board = std::abs(p.position.x() - 5) < 0.01;
    EXPECT_TRUE(ground || board) << p.position.transpose();
  }
}

TEST(PointFusion, RefusesWhatIsNoImage) {
  EXPECT_THROW(PointFusion({.voxel = 0}), InputError);
  EXPECT_THROW(PointFusion({.stride = 0}), InputError);
  PointFusion fusion({});
  PosedDepthImage image{{}, {{4, 3, 10, 10, 1.5, 1}, std::vector<float>(12, 1.f)}};
  EXPECT_NO_THROW(fusion.add(image));
  image.image.depth.pop_back();
  EXPECT_THROW(fusion.add(image), InputError);
  image.image.depth.push_back(std::nanf(""));
  EXPECT_THROW(fusion.add(image), InputError);
  image.image.depth.back() = 1;
  image.camera.position.x() = std::nan("");
  EXPECT_THROW(fusion.add(image), InputError);
  image.camera = {};
  image.camera.orientation.coeffs() *= 2;
  EXPECT_THROW(fusion.add(image), InputError);
}

class SurfaceMesh : public testing::TestWithParam<SurfaceMethod> {};

INSTANTIATE_TEST_SUITE_P(Methods, SurfaceMesh,
                         testing::Values(SurfaceMethod::poisson, SurfaceMethod::local),
                         [](const auto& entry) {
                           return entry.param == SurfaceMethod::local ? "local" : "poisson";
                         });

TEST_P(SurfaceMesh, OfABallIsABall) {
  const auto points = fused_ball(0.2, {0.2, 0.02}).points();
  const SurfaceOptions options{.cell = 0.15, .trim = 0.5, .method = GetParam()};
  const TriangleMesh mesh = surface_from_points(points, options);
  double area = 0, volume = 0;
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    area += mesh.area(i);
    const Vector3d a = mesh.corner(i, 0) - Vector3d(1, 2, 3);
    volume +=
        a.dot(
            (mesh.corner(i, 1) - Vector3d(1, 2, 3)).cross(mesh.corner(i, 2) - Vector3d(1, 2, 3))) /
        6;
  }
  for (const Vector3d& v : mesh.vertices) EXPECT_NEAR((v - Vector3d(1, 2, 3)).norm(), 2, 0.12);
  EXPECT_NEAR(area, 4 * std::numbers::pi * 4, 3);
  // Closed, and its triangles turn outwards.
  EXPECT_NEAR(volume, 4.0 / 3 * std::numbers::pi * 8, 2);
  SurfaceOptions two = options;
  two.threads = 2;
  const TriangleMesh again = surface_from_points(points, two);
  EXPECT_EQ(again.vertices, mesh.vertices);
  EXPECT_EQ(again.triangles, mesh.triangles);
}

TEST_P(SurfaceMesh, OfRealPlacesIsNearThem) {
  // A house on its ground, almost all of it flat.
  MeshBuilder builder;
  builder.quad({-12, -12, 0}, {12, -12, 0}, {12, 12, 0}, {-12, 12, 0});
  builder.box({-3, -2, 0}, {3, 2, 4});
  const MeshScene scene(builder.take());
  PointFusion fusion({.voxel = 0.5});
  for (int i = 0; i < 16; ++i) {
    const double around = 2 * std::numbers::pi * i / 16;
    const Pose pose = camera_pose({10 * std::cos(around), 10 * std::sin(around), 7},
                                  around + std::numbers::pi, -0.55);
    fusion.add({pose, render_depth(scene, pose, kMeshCamera, 30, 2)});
  }
  const TriangleMesh mesh =
      surface_from_points(fusion.points(), {.cell = 0.4, .trim = 0.8, .method = GetParam()});
  double off = 0, count = 0, reconstructed = 0;
  for (const Vector3d& v : mesh.vertices) {
    const double distance = scene.nearest(v, 5)->distance;
    EXPECT_LT(distance, 1.1) << v.transpose();
    off += distance, ++count;
  }
  EXPECT_LT(off / count, 0.12);
  // And the other way: the house is there.
  const MeshScene made(mesh);
  for (const Vector3d& p : {Vector3d(3, 0, 2), Vector3d(-3, 1, 1), Vector3d(0, 2, 3),
                            Vector3d(0, -2, 2), Vector3d(1, 1, 4), Vector3d(6, 6, 0)}) {
    if (made.nearest(p, 0.35)) ++reconstructed;
  }
  EXPECT_EQ(reconstructed, 6);
}

TEST_P(SurfaceMesh, EndsWhereNothingWasSeen) {
  // Half a ball: the other half is not made up.
  std::vector<FusedPoint> half;
  for (const FusedPoint& p : fused_ball(0.2, {0, 0}).points()) {
    if (p.position.z() > 3) half.push_back(p);
  }
  const TriangleMesh mesh =
      surface_from_points(half, {.cell = 0.15, .trim = 0.4, .method = GetParam()});
  EXPECT_GT(mesh.triangles.size(), 1000u);
  EXPECT_GT(mesh.bounds().min().z(), 3 - 0.7);
}

TEST_P(SurfaceMesh, RefusesPointsWithoutASurface) {
  std::vector<FusedPoint> points(5);
  EXPECT_THROW(surface_from_points(points, {}), InputError);
  points.assign(100, {});
  EXPECT_THROW(surface_from_points(points, {}), InputError) << "all in one place";
  for (std::size_t i = 0; i < points.size(); ++i) {
    points[i].position = {0.1 * static_cast<double>(i % 10), 0.1 * static_cast<double>(i / 10), 1};
  }
  EXPECT_THROW(surface_from_points(points, {}), InputError) << "all in one plane";
  points[7].position.x() = std::nan("");
  EXPECT_THROW(surface_from_points(points, {}), InputError);
  points = fused_ball(0.2, {0, 0}).points();
  EXPECT_THROW(surface_from_points(points, {.cell = 0}), InputError);
  EXPECT_THROW(surface_from_points(points, {.cell = 0.001, .trim = 1}), InputError);
  points[3].normal.setZero();
  EXPECT_THROW(surface_from_points(points, {}), InputError);
}

}  // namespace
}  // namespace lapwing
