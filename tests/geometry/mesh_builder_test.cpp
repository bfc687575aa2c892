// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <numbers>

#include "framework/core/error.h"
#include "framework/geometry/mesh_builder.h"

namespace lapwing {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

// The volume that closed surfaces enclose, by the divergence theorem: positive only if triangles
// turn counter-clockwise as seen from outside, right only if there is no hole.
double volume(const TriangleMesh& mesh) {
  double sum = 0;
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    sum += mesh.corner(i, 0).dot(mesh.corner(i, 1).cross(mesh.corner(i, 2))) / 6;
  }
  return sum;
}

double area(const TriangleMesh& mesh) {
  double sum = 0;
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) sum += mesh.area(i);
  return sum;
}

TEST(MeshBuilder, BodiesHaveTheirVolumeAndArea) {
  MeshBuilder box;
  box.box({10, 20, 30}, {12, 23, 34});
  EXPECT_NEAR(volume(box.mesh()), 24, 1e-9);
  EXPECT_NEAR(area(box.mesh()), 52, 1e-9);
  EXPECT_EQ(box.mesh().triangles.size(), 12u);

  // An L in either turn: 3 by 3 less 2 by 2.
  std::vector<Vector2d> corners = {{0, 0}, {3, 0}, {3, 1}, {1, 1}, {1, 3}, {0, 3}};
  for (int turns = 0; turns < 2; ++turns) {
    MeshBuilder prism;
    prism.prism(corners, -1, 3);
    EXPECT_NEAR(volume(prism.mesh()), 20, 1e-9);
    EXPECT_NEAR(area(prism.mesh()), 2 * 5 + 4 * 12, 1e-9);
    std::reverse(corners.begin(), corners.end());
  }

  MeshBuilder cone, bar;
  cone.tube({1, 1, 1}, {1, 1, 7}, 2, 0, 400);
  EXPECT_NEAR(volume(cone.mesh()), std::numbers::pi * 4 * 6 / 3, 0.01);
  bar.tube({5, -3, 2}, {8, 1, 2}, 1, 1, 400);
  EXPECT_NEAR(volume(bar.mesh()), std::numbers::pi * 5, 0.01);

  MeshBuilder ball;
  ball.ball({40, 0, 0}, {1, 2, 3}, 5);
  EXPECT_EQ(ball.mesh().triangles.size(), 20480u);
  EXPECT_NEAR(volume(ball.mesh()), 4.0 / 3 * std::numbers::pi * 6, 0.05);
}

TEST(MeshBuilder, ARoughBallIsClosedAndSeeded) {
  const auto made = [](std::uint64_t seed) {
    MeshBuilder builder(seed);
    builder.ball({0, 0, 0}, {1, 1, 1}, 3, 0.2);
    return builder.take();
  };
  const TriangleMesh one = made(1), again = made(1), other = made(2);
  EXPECT_EQ(one.vertices, again.vertices);
  EXPECT_NE(one.vertices, other.vertices);
  for (const Vector3d& v : one.vertices) {
    EXPECT_GE(v.norm(), 0.8);
    EXPECT_LE(v.norm(), 1.2);
  }
  Vector3d closed = Vector3d::Zero();
  for (std::size_t i = 0; i < one.triangles.size(); ++i) closed += one.cross(i);
  EXPECT_LT(closed.norm(), 1e-9);
}

TEST(MeshBuilder, FramesNest) {
  MeshBuilder builder;
  builder.push({10, 0, 1}, std::numbers::pi / 2);
  builder.push({2, 0, 0}, 0, 3);
  builder.quad({0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0});
  builder.pop();
  builder.pop();
  builder.quad({0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0});
  const auto& v = builder.mesh().vertices;
  EXPECT_LT((v[0] - Vector3d(10, 2, 1)).norm(), 1e-12);
  EXPECT_LT((v[1] - Vector3d(10, 5, 1)).norm(), 1e-12);
  EXPECT_LT((v[2] - Vector3d(7, 5, 1)).norm(), 1e-12);
  EXPECT_LT((v[5] - Vector3d(1, 0, 0)).norm(), 1e-12);
  EXPECT_THROW(builder.pop(), InputError);
}

TEST(MeshBuilder, FacesKeepTheirSideAndShape) {
  MeshBuilder builder;
  // A house's gable end, upright, facing -y.
  const Vector3d gable[] = {{0, 2, 0}, {4, 2, 0}, {4, 2, 3}, {2, 2, 5}, {0, 2, 3}};
  builder.face(gable);
  EXPECT_NEAR(area(builder.mesh()), 16, 1e-9);
  for (std::size_t i = 0; i < builder.mesh().triangles.size(); ++i) {
    EXPECT_LT((builder.mesh().normal(i) - Vector3d(0, -1, 0)).norm(), 1e-12);
  }
  const Vector3d bent[] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0.5}, {0, 1, 0}};
  EXPECT_THROW(builder.face(bent), InputError);
  const Vector3d line[] = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}};
  EXPECT_THROW(builder.face(line), InputError);
}

TEST(MeshBuilder, PolygonsOfManyKindsAreCut) {
  const auto cut = [](const std::vector<Vector2d>& corners) {
    double sum = 0;
    for (const auto& t : triangulate(corners)) {
      const Vector2d a = corners[static_cast<std::size_t>(t[0])];
      const Vector2d u = corners[static_cast<std::size_t>(t[1])] - a;
      const Vector2d w = corners[static_cast<std::size_t>(t[2])] - a;
      EXPECT_GT(u.x() * w.y() - u.y() * w.x(), 0);
      sum += (u.x() * w.y() - u.y() * w.x()) / 2;
    }
    return sum;
  };
  EXPECT_NEAR(cut({{0, 0}, {4, 0}, {4, 4}, {2, 1}, {0, 4}}), 10, 1e-12);
  EXPECT_NEAR(cut({{0, 0}, {1, 0}, {2, 0}, {3, 0}, {3, 2}, {0, 2}}), 6, 1e-12);
  std::vector<Vector2d> star;
  for (int i = 0; i < 40; ++i) {
    const double angle = -2 * std::numbers::pi * i / 40, radius = i % 2 ? 1 : 3;
    star.emplace_back(radius * std::cos(angle), radius * std::sin(angle));
  }
  EXPECT_NEAR(cut(star), 20 * 3 * std::sin(2 * std::numbers::pi / 40), 1e-9);
  EXPECT_THROW(triangulate(std::vector<Vector2d>{{0, 0}, {1, 0}}), InputError);
  EXPECT_THROW(triangulate(std::vector<Vector2d>{{0, 0}, {1, 1}, {2, 2}}), InputError);
}

TEST(MeshBuilder, TerrainLooksUp) {
  MeshBuilder builder;
  const double heights[] = {0, 0, 0, 1, 1, 1};
  builder.terrain({5, 5}, 2, 3, heights);
  EXPECT_EQ(builder.mesh().triangles.size(), 4u);
  for (std::size_t i = 0; i < 4; ++i) EXPECT_GT(builder.mesh().normal(i).z(), 0.8);
  EXPECT_EQ(builder.mesh().vertices.back(), Vector3d(9, 7, 1));
}

TEST(MeshBuilder, BadNumbersAddNothing) {
  MeshBuilder builder;
  const double nan = std::nan(""), few[] = {0, 0, 0};
  EXPECT_THROW(builder.box({0, 0, 0}, {1, 0, 1}), InputError);
  EXPECT_THROW(builder.box({0, 0, nan}, {1, 1, 1}), InputError);
  EXPECT_THROW(builder.tube({0, 0, 0}, {0, 0, 0}, 1, 1, 8), InputError);
  EXPECT_THROW(builder.tube({0, 0, 0}, {0, 0, 1}, 1, 1, 2), InputError);
  EXPECT_THROW(builder.tube({0, 0, 0}, {0, 0, 1}, 0, 0, 8), InputError);
  EXPECT_THROW(builder.ball({0, 0, 0}, {1, 1, 0}, 1), InputError);
  EXPECT_THROW(builder.ball({0, 0, 0}, {1, 1, 1}, 30), InputError);
  EXPECT_THROW(builder.terrain({0, 0}, 1, 2, few), InputError);
  EXPECT_THROW(builder.push({0, 0, 0}, 0, 0), InputError);
  EXPECT_THROW(builder.quad({nan, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}), InputError);
  EXPECT_TRUE(builder.mesh().vertices.empty());
  EXPECT_TRUE(builder.mesh().triangles.empty());
}

}  // namespace
}  // namespace lapwing
