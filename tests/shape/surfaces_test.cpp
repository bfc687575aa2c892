// SPDX-License-Identifier: Apache-2.0
// Surfaces of shapes: closed, turned outwards, of the volume that formulas give.
#include "framework/shape/surfaces.h"

#include <cmath>
#include <map>
#include <numbers>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "framework/core/random.h"
#include "framework/geometry/winding.h"

namespace lapwing {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

// By the divergence theorem; of a closed surface that is turned outwards.
double volume_of(const TriangleMesh& mesh) {
  double sum = 0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    sum += mesh.corner(t, 0).dot(mesh.corner(t, 1).cross(mesh.corner(t, 2))) / 6;
  return sum;
}

double area_of(const TriangleMesh& mesh) {
  double sum = 0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) sum += mesh.area(t);
  return sum;
}

// Every edge is passed as often one way as the other.
void expect_closed(const TriangleMesh& mesh, const char* what) {
  std::map<std::pair<int, int>, int> passed;
  for (const auto& t : mesh.triangles)
    for (std::size_t k = 0; k < 3; ++k) {
      const int a = t[k], b = t[(k + 1) % 3];
      passed[std::minmax(a, b)] += a < b ? 1 : -1;
    }
  for (const auto& [edge, balance] : passed)
    ASSERT_EQ(balance, 0) << what << ", edge " << edge.first << " to " << edge.second;
}

TEST(Chords, StayWithinTheToleranceAndAreNoMoreThanNeeded) {
  for (const double radius : {0.1, 1.0, 25.0})
    for (const double tolerance : {1e-1, 1e-2, 1e-3, 1e-5}) {
      const int n = chords_of(radius, tolerance);
      const auto sagitta = [&](int chords) {
        return radius * (1 - std::cos(std::numbers::pi / chords));
      };
      if (n < 2000) {
        EXPECT_LE(sagitta(n), tolerance * (1 + 1e-9)) << radius << ", " << tolerance;
      }
      if (n > 8) {
        EXPECT_GT(sagitta(n - 1), tolerance * (1 - 1e-9)) << radius << ", " << tolerance;
      }
    }
  EXPECT_EQ(chords_of(1, 5), 8) << "coarser than the circle";
  EXPECT_EQ(chords_of(1, 0), 8) << "no tolerance was stated";
  EXPECT_EQ(chords_of(1, std::nan("")), 8);
  EXPECT_EQ(chords_of(1e4, 1e-9), 2000) << "enough is enough";
}

TEST(TurnedSurface, HasTheVolumeOfItsRings) {
  const Eigen::Matrix3d tilted =
      Eigen::AngleAxisd(0.7, Vector3d(1, 2, 0.5).normalized()).toRotationMatrix();
  for (const int n : {3, 8, 31}) {
    // The polygon of n chords on the unit circle.
    const double disc = 0.5 * n * std::sin(2 * std::numbers::pi / n);
    struct Case {
      const char* what;
      std::vector<Vector2d> profile;
      double volume;
    };
    const std::vector<Case> cases = {{"cylinder", {{2, -1}, {2, 4}}, disc * 4 * 5},
                                     {"cone", {{3, 0}, {0, 2}}, disc * 9 * 2 / 3},
                                     {"cone upside down", {{0, 0}, {3, 2}}, disc * 9 * 2 / 3},
                                     {"frustum", {{1, 0}, {2, 3}}, disc * 3 * (1 + 2 + 4) / 3},
                                     {"double cone", {{0, -1}, {1, 0}, {0, 1}}, disc * 2 / 3}};
    for (const Case& c : cases)
      for (const Eigen::Matrix3d& R : {Eigen::Matrix3d(Eigen::Matrix3d::Identity()), tilted}) {
        const TriangleMesh mesh = turned_surface(c.profile, n, {5, -3, 1}, R);
        expect_closed(mesh, c.what);
        EXPECT_NEAR(volume_of(mesh), c.volume, 1e-9) << c.what << " of " << n << " chords";
      }
  }
}

// A polyline of a half circle, turned, comes to the ball.
TEST(TurnedSurface, AHalfCircleTurnsToABall) {
  std::vector<Vector2d> half;
  constexpr int kSteps = 60;
  for (int k = 0; k <= kSteps; ++k) {
    const double angle = std::numbers::pi * (static_cast<double>(k) / kSteps - 0.5);
    half.emplace_back(k % kSteps ? 2 * std::cos(angle) : 0.0, 2 * std::sin(angle));
  }
  const TriangleMesh ball = turned_surface(half, 2 * kSteps, {1, 1, 1});
  expect_closed(ball, "ball");
  EXPECT_NEAR(volume_of(ball), 4 * std::numbers::pi / 3 * 8, 0.1);
  EXPECT_LT(volume_of(ball), 4 * std::numbers::pi / 3 * 8) << "chords lie inside";
  EXPECT_NEAR(area_of(ball), 16 * std::numbers::pi, 0.1);
  for (const Vector3d& v : ball.vertices) EXPECT_NEAR((v - Vector3d(1, 1, 1)).norm(), 2, 1e-12);
}

TEST(BoxSurface, HasTwelveTrianglesAndTheArea) {
  const TriangleMesh box = box_surface({Vector3d(-1, 2, 3), Vector3d(1, 5, 3.5)});
  expect_closed(box, "box");
  EXPECT_EQ(box.triangles.size(), 12u);
  EXPECT_NEAR(volume_of(box), 2 * 3 * 0.5, 1e-12);
  EXPECT_NEAR(area_of(box), 2 * (2 * 3 + 2 * 0.5 + 3 * 0.5), 1e-12);
}

// A plane and its opposite share a box between them; through the middle each gets half.
TEST(CutBox, PartsAddUpToTheBox) {
  Random random(1);
  const Eigen::AlignedBox3d box(Vector3d(-1, -2, 0), Vector3d(3, 1, 2));
  const double whole = box.volume();
  const auto somewhere = [&] {
    return Vector3d(random.uniform(-1, 3), random.uniform(-2, 1), random.uniform(0, 2));
  };
  for (int k = 0; k < 300; ++k) {
    const Vector3d normal =
        Vector3d(random.normal(), random.normal(), random.normal()).normalized();
    const bool middle = k % 3 == 0;
    const Vector3d point = middle ? Vector3d(box.center()) : somewhere();
    const TriangleMesh behind = cut_box(box, point, normal), before = cut_box(box, point, -normal);
    expect_closed(behind, "behind");
    expect_closed(before, "before");
    EXPECT_NEAR(volume_of(behind) + volume_of(before), whole, 1e-9) << k;
    if (middle) {
      EXPECT_NEAR(volume_of(behind), whole / 2, 1e-9) << k;
    }
    for (const Vector3d& v : behind.vertices) EXPECT_LT(normal.dot(v - point), 1e-9);
    // Inside by winding is inside by definition.
    const Vector3d p = somewhere();
    if (std::abs(normal.dot(p - point)) > 1e-3) {
      EXPECT_NEAR(winding_number(behind, p), normal.dot(p - point) < 0 ? 1 : 0, 1e-6) << k;
    }
  }
}

TEST(CutBox, PlanesThroughFacesEdgesAndCornersStayClosed) {
  const Eigen::AlignedBox3d box(Vector3d(0, 0, 0), Vector3d(1, 1, 1));
  struct Case {
    const char* what;
    Vector3d point, normal;
    double volume;
  };
  const std::vector<Case> cases = {
      {"all of it", {0, 0, 9}, {0, 0, 1}, 1},
      {"nothing of it", {0, 0, -9}, {0, 0, 1}, 0},
      {"level cut", {0, 0, 0.25}, {0, 0, 1}, 0.25},
      {"upper face", {0, 0, 1}, {0, 0, 1}, 1},
      {"lower face", {0, 0, 0}, {0, 0, 1}, 0},
      {"through two edges", {0, 0, 0}, Vector3d(1, -1, 0).normalized(), 0.5},
      {"along one edge", {0, 0, 0}, Vector3d(1, 1, 0).normalized(), 0},
      {"through three corners", {1, 0, 0}, Vector3d(1, 1, 1).normalized(), 1.0 / 6},
      {"through three others", {1, 1, 0}, Vector3d(1, 1, 1).normalized(), 5.0 / 6},
      {"hexagon", {0.5, 0.5, 0.5}, Vector3d(1, 1, 1).normalized(), 0.5},
      {"one corner alone", {0, 0, 0}, Vector3d(1, 1, 1).normalized(), 0}};
  for (const Case& c : cases) {
    const TriangleMesh mesh = cut_box(box, c.point, c.normal);
    expect_closed(mesh, c.what);
    EXPECT_NEAR(volume_of(mesh), c.volume, 1e-12) << c.what;
  }
}

TEST(PrismSurface, HasTheVolumeOfItsPolygon) {
  Random random(2);
  const std::vector<Vector2d> court = {{0, 0}, {6, 0}, {6, 5}, {4, 5},
                                       {4, 2}, {2, 2}, {2, 5}, {0, 5}};
  const std::vector<Vector2d> in_line = {{0, 0}, {1, 0}, {2, 0}, {3, 0}, {3, 2}, {0, 2}};
  std::vector<std::vector<Vector2d>> all = {{{0, 0}, {1, 0}, {0, 1}}, court, in_line};
  for (int k = 0; k < 20; ++k) {
    std::vector<Vector2d> star;
    const int n = static_cast<int>(random.integer(4, 40));
    for (int i = 0; i < n; ++i) {
      const double angle = 2 * std::numbers::pi * i / n;
      star.push_back(random.uniform(0.5, 3) * Vector2d(std::cos(angle), std::sin(angle)));
    }
    all.push_back(star);
  }
  for (std::vector<Vector2d> corners : all) {
    double twice = 0;
    for (std::size_t i = 0; i < corners.size(); ++i) {
      const Vector2d &a = corners[i], &b = corners[(i + 1) % corners.size()];
      twice += a.x() * b.y() - a.y() * b.x();
    }
    for (const bool reversed : {false, true}) {
      if (reversed) std::reverse(corners.begin(), corners.end());
      const TriangleMesh mesh = prism_surface(corners, -1, 2.5);
      expect_closed(mesh, "prism");
      EXPECT_NEAR(volume_of(mesh), 3.5 * std::abs(twice) / 2, 1e-9) << corners.size();
    }
  }
}

}  // namespace
}  // namespace lapwing
