// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "framework/core/error.h"
#include "framework/surface/cloud_surface.h"
#include "framework/surface/surface_mesh.h"
#include "tests/survey/made_clouds.h"

namespace lapwing {
namespace {

using Eigen::Vector3d;
using testing::HasSubstr;

std::vector<ThinnedPoint> thinned_of(const std::vector<Vector3d>& points, double cell,
                                     const Eigen::Vector3f& normal = Eigen::Vector3f::Zero()) {
  ThinnedCloud cloud(cell, 1'000'000);
  for (const Vector3d& p : points) cloud.add(p, normal);
  EXPECT_EQ(cloud.points(), points.size());
  return cloud.take();
}

TEST(ThinnedCloud, OnePointACubeWhichIsTheMean) {
  ThinnedCloud cloud(0.5, 3);
  cloud.add({0.1, 0.1, -0.1}, {0, 0, 1});
  cloud.add({0.3, 0.2, -0.2}, {0, 0, 3});
  cloud.add({-0.1, 7.2, 0}, Eigen::Vector3f::Zero());
  EXPECT_EQ(cloud.cells(), 2u);
  cloud.add({1e4, 0, 0}, Eigen::Vector3f::Zero());
  EXPECT_THROW(cloud.add({2e4, 0, 0}, {}), InputError) << "more than three cubes";
  ThinnedCloud again(0.5, 3);
  EXPECT_THROW(again.add({1e6, 0, 0}, {}), InputError) << "beyond the keys";
  again.add({0.1, 0.1, -0.1}, {0, 0, 1});
  again.add({0.3, 0.2, -0.2}, {0, 0, 3});
  again.add({-0.1, 7.2, 0}, Eigen::Vector3f::Zero());
  const std::vector<ThinnedPoint> points = again.take();
  ASSERT_EQ(points.size(), 2u);
  EXPECT_LT((points[0].position - Vector3d(-0.1, 7.2, 0.0005)).norm(), 1e-6);
  EXPECT_EQ(points[0].normal, Vector3d::Zero());
  EXPECT_LT((points[1].position - Vector3d(0.2, 0.15, -0.15)).norm(), 1e-6);
  EXPECT_LT((points[1].normal - Vector3d::UnitZ()).norm(), 1e-6);
  EXPECT_EQ(points[1].points, 2u);
}

// Away from edges normals are those of slope, roof and walls, and face outwards.
void expect_normals_of_house(const CloudSurface& surface) {
  const Vector3d slope = Vector3d(-0.1, 0, 1).normalized();
  int walls = 0, roof = 0, ground = 0, wrong = 0;
  for (const FusedPoint& point : surface.points) {
    const Vector3d& p = point.position;
    EXPECT_NEAR(point.normal.norm(), 1, 1e-9);
    if (std::abs(p.x()) > 6 || std::abs(p.y()) > 7) {
      ++ground;
      wrong += point.normal.dot(slope) < 0.95;
    } else if (p.z() > 4.95 && std::abs(p.x()) < 3 && std::abs(p.y()) < 2) {
      ++roof;
      wrong += point.normal.z() < 0.95;
    } else if (std::abs(p.y() - 3) < 0.1 && p.z() > 1.5 && p.z() < 3.5 && std::abs(p.x()) < 3) {
      ++walls;
      wrong += point.normal.y() < 0.95;
    } else if (std::abs(p.x() + 4) < 0.1 && p.z() > 1.5 && p.z() < 3.5 && std::abs(p.y()) < 2) {
      ++walls;
      wrong += point.normal.x() > -0.95;
    }
  }
  EXPECT_GT(ground, 2000);
  EXPECT_GT(roof, 50);
  EXPECT_GT(walls, 50);
  EXPECT_LT(wrong, 0.01 * (ground + roof + walls));
}

TEST(CloudSurface, NormalsFaceTheOpenSky) {
  const std::vector<Vector3d> house = house_on_slope(0.25);
  const CloudSurface one = surface_of_cloud(thinned_of(house, 0.2), {.spacing = 0.4});
  expect_normals_of_house(one);
  EXPECT_EQ(one.alone, 0u);
  const CloudSurface two =
      surface_of_cloud(thinned_of(house, 0.2), {.spacing = 0.4, .scanners = {}, .threads = 2});
  ASSERT_EQ(one.points.size(), two.points.size());
  for (std::size_t i = 0; i < one.points.size(); ++i)
    EXPECT_EQ(one.points[i].normal, two.points[i].normal);
}

TEST(CloudSurface, NormalsFaceTheScanner) {
  std::vector<Vector3d> wall;
  for (int i = 0; i < 20; ++i)
    for (int k = 0; k < 20; ++k) wall.emplace_back(5, 0.3 * i - 3, 0.3 * k);
  for (const double side : {0.0, 10.0}) {
    const CloudSurface surface =
        surface_of_cloud(thinned_of(wall, 0.2), {.spacing = 0.4, .scanners = {{side, 0, 2}}});
    for (const FusedPoint& point : surface.points)
      EXPECT_GT(point.normal.x() * (side - 5), 4.9) << side;
  }
  // Free-standing, without scanners: as the file says.
  const CloudSurface stated = surface_of_cloud(thinned_of(wall, 0.2, {-1, 0, 0}), {.spacing = 0.4});
  for (const FusedPoint& point : stated.points) EXPECT_LT(point.normal.x(), -0.99);
}

TEST(CloudSurface, PointsFarFromAllOthersAreNoise) {
  std::vector<Vector3d> house = house_on_slope(0.25);
  house.emplace_back(0, 0, -40);
  house.emplace_back(5, 5, 60);
  const std::vector<ThinnedPoint> thinned = thinned_of(house, 0.2);
  const CloudSurface surface = surface_of_cloud(thinned, {.spacing = 0.4});
  EXPECT_EQ(surface.alone, 2u);
  for (std::size_t i = 0; i < thinned.size(); ++i)
    EXPECT_EQ(surface.kept[i], std::abs(thinned[i].position.z()) < 30);
  for (const FusedPoint& point : surface.points) EXPECT_LT(std::abs(point.position.z()), 6);
}

TEST(CloudSurface, WhatShowsNoSurfaceIsRefused) {
  const auto refused = [](const std::vector<Vector3d>& points) -> std::string {
    try {
      surface_of_cloud(thinned_of(points, 0.2), {.spacing = 0.4});
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_THAT(refused({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}), HasSubstr("a cloud of 3 points"));
  std::vector<Vector3d> sparse;
  for (int i = 0; i < 100; ++i) sparse.emplace_back(5 * (i % 10), 5 * (i / 10), 0);
  EXPECT_THAT(refused(sparse), HasSubstr("too far apart"));
}

// The mesh lies within half a cell, 0.25 m, of the slope and within a cell of the roof, for which
// missions allow. The level of the reconstruction is the median of all samples, of which nine of
// ten are on the slope: it puts the roof 0.3 m above its points.
TEST(CloudSurface, AMeshOfIt) {
  std::vector<Vector3d> house = house_on_slope(0.25);
  std::erase_if(house, [](const Vector3d& p) { return p.cwiseAbs().maxCoeff() > 10; });
  const CloudSurface surface = surface_of_cloud(thinned_of(house, 0.2), {.spacing = 0.4});
  const TriangleMesh mesh = surface_from_points(surface.points, {0.5, 1});
  int ground = 0, roof = 0;
  for (const Vector3d& p : mesh.vertices) {
    const double far = std::max(std::abs(p.x()), std::abs(p.y()));
    if (far < 9 && (std::abs(p.x()) > 6 || std::abs(p.y()) > 7)) {
      EXPECT_NEAR(p.z(), slope_height(p.x()), 0.25);
      ++ground;
    }
    if (std::abs(p.x()) < 2 && std::abs(p.y()) < 1 && p.z() > 3) {
      EXPECT_NEAR(p.z(), 5, 0.5);
      ++roof;
    }
  }
  EXPECT_GT(ground, 200);
  EXPECT_GT(roof, 20);
}

}  // namespace
}  // namespace lapwing
