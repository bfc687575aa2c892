// SPDX-License-Identifier: Apache-2.0
// Polygons, windings, nearest points, swept boxes and welding, by what defines them.
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "framework/core/error.h"
#include "framework/core/random.h"
#include "framework/geometry/mesh_builder.h"
#include "framework/geometry/polygon.h"
#include "framework/geometry/triangle_mesh.h"
#include "framework/geometry/triangle_tests.h"
#include "framework/geometry/winding.h"

namespace lapwing {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

Vector3d somewhere(Random& random, double reach) {
  return {random.uniform(-reach, reach), random.uniform(-reach, reach),
          random.uniform(-reach, reach)};
}

TriangleMesh cube_of(const Vector3d& lower, const Vector3d& upper) {
  MeshBuilder builder;
  builder.box(lower, upper);
  return builder.take();
}

void reverse(TriangleMesh& mesh) {
  for (auto& triangle : mesh.triangles) std::swap(triangle[1], triangle[2]);
}

void append(TriangleMesh& mesh, const TriangleMesh& more) {
  const auto shift = static_cast<std::int32_t>(mesh.vertices.size());
  mesh.vertices.insert(mesh.vertices.end(), more.vertices.begin(), more.vertices.end());
  for (const auto& t : more.triangles)
    mesh.triangles.push_back({t[0] + shift, t[1] + shift, t[2] + shift});
}

TEST(Winding, IsOneInsideAndZeroOutsideOfACube) {
  Random random(1);
  TriangleMesh cube = cube_of({-1, -2, 0}, {3, 1, 2});
  const Eigen::AlignedBox3d box = cube.bounds();
  int inside = 0;
  for (int k = 0; k < 500; ++k) {
    const Vector3d p = somewhere(random, 4);
    inside += box.contains(p);
    EXPECT_NEAR(winding_number(cube, p), box.contains(p) ? 1 : 0, 1e-12) << p.transpose();
  }
  EXPECT_GT(inside, 10);
  // In line with edges and corners, where counting crossings of a ray goes wrong.
  for (const Vector3d& p : {Vector3d(0, 0, 1), Vector3d(1, -0.5, 1), Vector3d(-0.999999, 0, 1)})
    EXPECT_NEAR(winding_number(cube, p), 1, 1e-9);
  for (const Vector3d& p : {Vector3d(-5, -2, 0), Vector3d(-1, -2, 9), Vector3d(3, 1, -4)})
    EXPECT_NEAR(winding_number(cube, p), 0, 1e-12);
  reverse(cube);
  EXPECT_NEAR(winding_number(cube, {0, 0, 1}), -1, 1e-12) << "inside out";
}

TEST(Winding, AddsUpOverBodies) {
  TriangleMesh hollow = cube_of({-3, -3, -3}, {3, 3, 3});
  TriangleMesh core = cube_of({-1, -1, -1}, {1, 1, 1});
  TriangleMesh twice = hollow;
  append(twice, core);
  EXPECT_NEAR(winding_number(twice, {0, 0.2, 0.1}), 2, 1e-12);
  reverse(core);
  append(hollow, core);
  EXPECT_NEAR(winding_number(hollow, {0, 0.2, 0.1}), 0, 1e-12) << "in the cavity";
  EXPECT_NEAR(winding_number(hollow, {2, 0.2, 0.1}), 1, 1e-12) << "in the wall";
  EXPECT_EQ(winding_number(TriangleMesh{}, {0, 0, 0}), 0);
}

// A face of a cube covers a sixth of what is seen from its middle; it is no closed surface.
TEST(Winding, OfAnOpenSurfaceIsItsShareOfTheView) {
  TriangleMesh face;
  face.vertices = {{1, -1, -1}, {1, 1, -1}, {1, 1, 1}, {1, -1, 1}};
  face.triangles = {{0, 1, 2}, {0, 2, 3}};
  EXPECT_NEAR(winding_number(face, {0, 0, 0}), 1.0 / 6, 1e-12);
  EXPECT_NEAR(winding_number(face, {2, 0, 0}), -1.0 / 6, 1e-12) << "from behind";
  EXPECT_NEAR(winding_number(face, {1 - 1e-9, 0, 0}), 0.5, 1e-6) << "close to it";
}

struct PolygonCase {
  const char* what;
  std::vector<Vector2d> corners;
  bool simple;
};

TEST(Polygons, AreSimpleOrNot) {
  const double nan = std::nan("");
  const std::vector<PolygonCase> cases = {
      {"nothing", {}, false},
      {"two corners", {{0, 0}, {1, 0}}, false},
      {"triangle", {{0, 0}, {1, 0}, {0, 1}}, true},
      {"triangle turned round", {{0, 0}, {0, 1}, {1, 0}}, true},
      {"no area", {{0, 0}, {1, 0}, {2, 0}}, false},
      {"corner in line", {{0, 0}, {1, 0}, {2, 0}, {2, 2}}, true},
      {"spike", {{0, 0}, {3, 0}, {1, 0}, {1, 2}}, false},
      {"corner twice in a row", {{0, 0}, {1, 0}, {1, 0}, {0, 1}}, false},
      {"first corner repeated at the end", {{0, 0}, {1, 0}, {0, 1}, {0, 0}}, false},
      {"bow tie", {{0, 0}, {2, 2}, {2, 0}, {0, 2}}, false},
      {"notch", {{0, 0}, {4, 0}, {4, 4}, {2, 1}, {0, 4}}, true},
      {"notch that touches the floor", {{0, 0}, {4, 0}, {4, 4}, {2, 0}, {0, 4}}, false},
      {"notch through the floor", {{0, 0}, {4, 0}, {4, 4}, {2, -1}, {0, 4}}, false},
      {"two rooms that meet in a corner",
       {{0, 0}, {2, 0}, {2, 2}, {4, 2}, {4, 4}, {2, 4}, {2, 2}, {0, 2}},
       false},
      {"edge along another",
       {{0, 0}, {4, 0}, {4, 2}, {3, 2}, {3, 0}, {1, 0}, {1, 2}, {0, 2}},
       false},
      {"not a number", {{0, 0}, {nan, 0}, {0, 1}}, false},
      {"tiny", {{0, 0}, {1e-9, 0}, {0, 1e-9}}, true},
      {"large", {{-1e5, -1e5}, {1e5, -1e5}, {1e5, 1e5}, {-1e5, 1e5}}, true}};
  for (const PolygonCase& c : cases) {
    EXPECT_EQ(is_simple_polygon(c.corners), c.simple) << c.what;
    // Neither the first corner nor the turn matters.
    std::vector<Vector2d> other = c.corners;
    for (std::size_t k = 0; k < other.size(); ++k) {
      std::rotate(other.begin(), other.begin() + 1, other.end());
      EXPECT_EQ(is_simple_polygon(other), c.simple) << c.what << ", from corner " << k + 1;
    }
    std::reverse(other.begin(), other.end());
    EXPECT_EQ(is_simple_polygon(other), c.simple) << c.what << ", reversed";
  }
}

// Stars about a middle are simple whatever their spikes; two corners exchanged cross the edges.
TEST(Polygons, StarsAreSimple) {
  Random random(2);
  for (int k = 0; k < 50; ++k) {
    const int n = static_cast<int>(random.integer(5, 30));
    std::vector<Vector2d> star;
    for (int i = 0; i < n; ++i) {
      const double angle = 2 * std::numbers::pi * i / n;
      star.push_back(random.uniform(1, 2) * Vector2d(std::cos(angle), std::sin(angle)));
    }
    EXPECT_TRUE(is_simple_polygon(star));
    for (Vector2d& corner : star) corner.normalize();
    EXPECT_TRUE(is_simple_polygon(star)) << "round";
    std::swap(star[1], star[3]);
    EXPECT_FALSE(is_simple_polygon(star)) << n;
  }
}

// The nearest point q of a convex set to p: no corner lies on p's side of q.
TEST(NearestPoint, MeetsTheConditionOfConvexSets) {
  Random random(3);
  for (int k = 0; k < 3000; ++k) {
    Triangle t{somewhere(random, 2), somewhere(random, 2), somewhere(random, 2)};
    if (k % 5 == 1) {  // in one line, to rounding or to the width of a hair
      t.c = t.a + random.uniform(-1, 2) * (t.b - t.a);
      if (k % 2) t.c += std::pow(10.0, random.uniform(-12, -3)) * somewhere(random, 1);
    }
    if (k % 5 == 2) t.b = t.a;
    if (k % 5 == 3) t.c = t.b = t.a;
    const Vector3d p = somewhere(random, 3), q = nearest_point(t, p);
    ASSERT_TRUE(q.allFinite()) << k;
    double most = 0;
    for (const Vector3d& corner : {t.a, t.b, t.c}) most = std::max(most, (p - q).dot(corner - q));
    EXPECT_LT(most, 1e-9) << "case " << k % 5;
    // And it is of the triangle: no direction of separation, by the box and the plane.
    const Vector3d low = t.a.cwiseMin(t.b).cwiseMin(t.c), high = t.a.cwiseMax(t.b).cwiseMax(t.c);
    EXPECT_TRUE(((q - low).array() > -1e-12).all() && ((high - q).array() > -1e-12).all());
    const Vector3d n = (t.b - t.a).cross(t.c - t.a);
    if (n.norm() > 1e-6) {
      EXPECT_LT(std::abs(n.normalized().dot(q - t.a)), 1e-9);
    }
    EXPECT_LT((nearest_point(t, q) - q).norm(), 1e-7) << "of the triangle already";
  }
}

TEST(PlaneDistance, IsAlongTheRay) {
  const Triangle floor{{0, 0, 2}, {1, 0, 2}, {0, 1, 2}};
  EXPECT_DOUBLE_EQ(plane_distance(floor, {9, 9, 5}, {0, 0, -1}), 3);
  EXPECT_DOUBLE_EQ(plane_distance(floor, {9, 9, 5}, {0, 0, 1}), -3) << "behind";
  EXPECT_DOUBLE_EQ(plane_distance(floor, {0, 0, 5}, Vector3d(0, 0.8, -0.6)), 5);
  EXPECT_TRUE(std::isnan(plane_distance(floor, {0, 0, 5}, {1, 0, 0})));
  EXPECT_TRUE(std::isnan(plane_distance({{0, 0, 0}, {1, 1, 1}, {2, 2, 2}}, {5, 0, 0}, {1, 0, 0})));
}

// What is left of a triangle within a box, cut plane by plane.
bool box_meets(const Triangle& t, const Vector3d& middle, const Vector3d& half) {
  std::vector<Vector3d> polygon = {t.a - middle, t.b - middle, t.c - middle};
  for (int axis = 0; axis < 3 && !polygon.empty(); ++axis)
    for (const double side : {1.0, -1.0}) {
      std::vector<Vector3d> kept;
      const auto beyond = [&](const Vector3d& p) { return side * p(axis) - half(axis); };
      for (std::size_t k = 0; k < polygon.size(); ++k) {
        const Vector3d &a = polygon[k], &b = polygon[(k + 1) % polygon.size()];
        const double from = beyond(a), to = beyond(b);
        if (from <= 0) kept.push_back(a);
        if ((from < 0 && to > 0) || (from > 0 && to < 0))
          kept.push_back(a + from / (from - to) * (b - a));
      }
      polygon = kept;
    }
  return !polygon.empty();
}

// Between boxes side by side along the way a swept box meets what a little larger one does.
TEST(SweptBoxes, LieBetweenSmallerAndLargerBoxesAlongTheWay) {
  Random random(4);
  int met = 0, missed = 0;
  for (int k = 0; k < 1500; ++k) {
    const Triangle t{somewhere(random, 2), somewhere(random, 2), somewhere(random, 2)};
    const Vector3d from = somewhere(random, 3),
                   to = k % 4 ? Vector3d(from + somewhere(random, 2)) : from;
    const Vector3d half(random.uniform(0.05, 0.6), random.uniform(0.05, 0.6),
                        random.uniform(0.05, 0.6));
    constexpr int kSteps = 40;
    const Vector3d more = half + (to - from).cwiseAbs() / (2.0 * kSteps) + Vector3d::Constant(1e-6);
    const Vector3d less = half - Vector3d::Constant(1e-6);
    bool small = false, large = false;
    for (int i = 0; i <= kSteps; ++i) {
      const Vector3d at = from + static_cast<double>(i) / kSteps * (to - from);
      small |= box_meets(t, at, less);
      large |= box_meets(t, at, more);
    }
    const bool meets = swept_box_meets(t, from, to, half);
    (meets ? met : missed) += 1;
    if (small) {
      EXPECT_TRUE(meets) << k;
    }
    if (!large) {
      EXPECT_FALSE(meets) << k;
    }
    EXPECT_EQ(meets, swept_box_meets(t, to, from, half)) << "the way back";
    EXPECT_EQ(meets, swept_box_meets({t.c, t.a, t.b}, from, to, half)) << "any first corner";
  }
  EXPECT_GT(met, 50);
  EXPECT_GT(missed, 200);
}

TEST(SweptBoxes, TouchingIsNoMeeting) {
  const Triangle wall{{1, -5, -5}, {1, 5, -5}, {1, 0, 9}};
  const Vector3d half(0.5, 0.5, 0.5);
  EXPECT_FALSE(swept_box_meets(wall, {0, 0, 0}, {0.5, 0, 0}, half)) << "up to it";
  EXPECT_TRUE(swept_box_meets(wall, {0, 0, 0}, {0.501, 0, 0}, half));
  EXPECT_FALSE(swept_box_meets(wall, {0.5, -2, 0}, {0.5, 2, 0}, half)) << "along it";
  EXPECT_TRUE(swept_box_meets(wall, {0.6, -2, 0}, {0.6, 2, 0}, half));
  EXPECT_TRUE(swept_box_meets(wall, {-50, 0, 0}, {50, 0, 0}, half)) << "right through";
}

// Tolerances are between vertices, wherever they lie.
TEST(Welding, JoinsWhatAgreesWhereverItLies) {
  Random random(5);
  for (const double tolerance : {1e-3, 0.1}) {
    for (int k = 0; k < 200; ++k) {
      const Vector3d p = somewhere(random, 5);
      const Vector3d q = p + 0.9 * tolerance * somewhere(random, 1);
      TriangleMesh mesh;
      mesh.vertices = {p, p + Vector3d(1, 0, 0), p + Vector3d(0, 1, 0),
                       q, p + Vector3d(0, 1, 0), p + Vector3d(0, 0, 1)};
      mesh.triangles = {{0, 1, 2}, {3, 4, 5}};
      weld(mesh, tolerance);
      ASSERT_EQ(mesh.vertices.size(), 4u) << tolerance << ", " << k;
      EXPECT_EQ(mesh.vertices[0], p) << "the first of them stays";
      EXPECT_EQ(mesh.triangles[1], (std::array<std::int32_t, 3>{0, 2, 3}));
    }
  }
  TriangleMesh apart;
  apart.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0.0021, 0, 0}, {1, 0, 1}, {0, 1, 1}};
  apart.triangles = {{0, 1, 2}, {3, 4, 5}};
  weld(apart, 1e-3);
  EXPECT_EQ(apart.vertices.size(), 6u);
}

TEST(Welding, DropsWhatLosesItsArea) {
  TriangleMesh mesh;
  mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 1 + 1e-7, 0}, {-0.0, 0, 0}, {7, 7, 7}};
  mesh.triangles = {{0, 1, 2}, {1, 2, 3}, {4, 1, 3}, {0, 1, 1}};
  mesh.colors = {{1, 1, 1}, {2, 2, 2}, {3, 3, 3}, {4, 4, 4}};
  TriangleMesh exact = mesh;
  weld(exact, 0);
  EXPECT_EQ(exact.triangles.size(), 3u) << "only what had no area before";
  EXPECT_EQ(exact.vertices.size(), 4u) << "-0 is 0, and nobody uses the last";
  weld(mesh, 1e-6);
  ASSERT_EQ(mesh.triangles.size(), 2u);
  EXPECT_EQ(mesh.triangles[0], mesh.triangles[1]);
  EXPECT_EQ(mesh.colors[1], (Rgb{3, 3, 3}));
  EXPECT_EQ(mesh.vertices.size(), 3u);
  weld(mesh, 1e-6);
  EXPECT_EQ(mesh.vertices.size(), 3u) << "once is enough";
}

TEST(TriangleMeshes, SayWhatIsWrongWithThem) {
  TriangleMesh good;
  good.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  good.triangles = {{0, 1, 2}};
  const auto said = [&](const auto& spoil) -> std::string {
    TriangleMesh mesh = good;
    spoil(mesh);
    try {
      check_mesh(mesh, "barn.ply");
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(said([](TriangleMesh&) {}), "");
  EXPECT_EQ(said([](TriangleMesh& m) { m.triangles.clear(); }),
            "barn.ply: the mesh has no triangle");
  for (const double bad : {std::nan(""), 1.0 / 0.0, -1.0 / 0.0, 100'001.0})
    EXPECT_EQ(said([&](TriangleMesh& m) { m.vertices[1].z() = bad; }),
              "barn.ply: vertex 2 has a coordinate that is not finite or beyond 1e5 m");
  EXPECT_EQ(said([](TriangleMesh& m) { m.vertices[1].z() = -1e5; }), "");
  EXPECT_EQ(said([](TriangleMesh& m) { m.triangles[0][2] = 3; }),
            "barn.ply: triangle 1 names vertex 4 of 3");
  EXPECT_EQ(said([](TriangleMesh& m) { m.triangles[0][0] = -1; }),
            "barn.ply: triangle 1 names vertex 0 of 3");
  EXPECT_EQ(said([](TriangleMesh& m) {
              m.colors = {{1, 2, 3}, {4, 5, 6}};
            }),
            "barn.ply: 2 colours for 1 triangles");
}

}  // namespace
}  // namespace lapwing
