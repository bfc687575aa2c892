// SPDX-License-Identifier: Apache-2.0
// Gates: their openings, distances from them, and passages with known places and times.
#include "framework/trajectory/gate.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include <Eigen/Geometry>

#include "framework/core/error.h"
#include "framework/core/random.h"
#include "framework/trajectory/gate_passage.h"

namespace lapwing {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

using Corners = std::vector<Vector2d>;

double area_of(const Corners& corners) {
  double twice = 0;
  for (std::size_t k = 0; k < corners.size(); ++k) {
    const Vector2d &a = corners[k], &b = corners[(k + 1) % corners.size()];
    twice += a.x() * b.y() - a.y() * b.x();
  }
  return twice / 2;
}

TEST(GateCorners, RectanglesAndTrianglesHaveTheirMiddleAtTheOrigin) {
  EXPECT_EQ(gate_corners({"rectangle", 4, 2, 0, 0}), (Corners{{-2, -1}, {2, -1}, {2, 1}, {-2, 1}}));
  EXPECT_EQ(gate_corners({"triangle", 4, 2, 0, 0}), (Corners{{-2, -1}, {2, -1}, {0, 1}}));
  EXPECT_TRUE(gate_corners({"ball", 0, 0, 1, 0}).empty());
}

TEST(GateCorners, RegularOnesStandOnAFlatSide) {
  for (const auto& [shape, count] : {std::pair{"pentagon", 5}, {"hexagon", 6}}) {
    const Corners corners = gate_corners({shape, 0, 0, 2, 0});
    ASSERT_EQ(corners.size(), static_cast<std::size_t>(count));
    for (const Vector2d& c : corners) EXPECT_NEAR(c.norm(), 2, 1e-12);
    // Counter-clockwise: the area is positive, and that of the polygon.
    EXPECT_NEAR(area_of(corners), count * 2 * std::sin(2 * std::numbers::pi / count), 1e-12);
    // The lowest two corners are equally low, and beside each other.
    EXPECT_NEAR(corners.front().y(), corners.back().y(), 1e-12);
    for (const Vector2d& c : corners) EXPECT_GE(c.y(), corners.front().y() - 1e-12);
    // By its side instead: every side has that length.
    const Corners sides = gate_corners({shape, 0, 0, 0, 1.5});
    for (std::size_t k = 0; k < sides.size(); ++k)
      EXPECT_NEAR((sides[k] - sides[(k + 1) % sides.size()]).norm(), 1.5, 1e-12);
  }
}

TEST(GateCorners, WrongSizesAreNamed) {
  for (const auto& [shape, said] : std::initializer_list<std::pair<GateShape, const char*>>{
           {{"rectangle", 4, 0, 0, 0}, "a rectangle needs a width and height above 0"},
           {{"rectangle", 4, -1, 0, 0}, "a rectangle needs a width and height above 0"},
           {{"triangle", 4, std::nan(""), 0, 0}, "a triangle needs a width and height"},
           {{"triangle", 4, HUGE_VAL, 0, 0}, "a triangle needs a width and height"},
           {{"rectangle", 4, 2, 1, 0}, "a rectangle has a width and height, no radius"},
           {{"ball", 0, 0, 0, 0}, "a ball needs a radius above 0"},
           {{"ball", 1, 0, 1, 0}, "a ball has a radius, no width"},
           {{"hexagon", 0, 0, 0, 0}, "a hexagon needs a radius above 0"},
           {{"hexagon", 0, 0, 1, 1}, "a hexagon has a side, no radius"},
           {{"pentagon", 0, 0, 0, -1}, "a pentagon needs a side above 0"},
           {{"circle", 0, 0, 1, 0}, "no gate has the shape 'circle'; there are ball, rectangle"}}) {
    try {
      gate_corners(shape);
      ADD_FAILURE() << said;
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find(said), std::string::npos) << error.what();
    }
  }
}

TEST(GateDirection, MakesARightHandedFrame) {
  Random random(2);
  for (int turn = 0; turn < 50; ++turn) {
    const auto any = [&] {
      return Vector3d(random.uniform(-3, 3), random.uniform(-3, 3), random.uniform(-3, 3));
    };
    GateTask gate;
    const Vector3d way = any(), up = any();
    set_direction(gate, way, up);
    EXPECT_NEAR(gate.direction.norm(), 1, 1e-12);
    EXPECT_NEAR(gate.up.norm(), 1, 1e-12);
    EXPECT_NEAR(gate.up.dot(gate.direction), 0, 1e-12);
    EXPECT_GT(gate.direction.dot(way), 0);
    EXPECT_GT(gate.up.dot(up), 0);
    EXPECT_NEAR(gate.direction.cross(gate.left()).dot(gate.up), 1, 1e-12) << "ahead, left, up";
  }
  GateTask east;
  set_direction(east, {5, 0, 0}, {0, 0, 1});
  EXPECT_LT((east.left() - Vector3d(0, 1, 0)).norm(), 1e-12) << "north is left of who flies east";
}

TEST(GateDirection, WhatHasNoDirectionIsRefused) {
  GateTask gate;
  for (const Vector3d& way :
       {Vector3d(0, 0, 0), Vector3d(std::nan(""), 0, 1), Vector3d(HUGE_VAL, 0, 0)})
    EXPECT_THROW(set_direction(gate, way, {0, 0, 1}), InputError);
  for (const Vector3d& up :
       {Vector3d(2, 0, 0), Vector3d(-1e-9, 0, 0), Vector3d(0, 0, 0), Vector3d(0, std::nan(""), 0)})
    EXPECT_THROW(set_direction(gate, {1, 0, 0}, up), InputError);
}

// Inside, the distance to the nearest edge, with a minus; outside, never more than the distance
// and positive: by the distance to points all along the edges.
TEST(OutsideOf, IsTheDistanceFromTheEdges) {
  Random random(9);
  for (const GateShape& shape :
       {GateShape{"rectangle", 4, 2, 0, 0}, GateShape{"triangle", 3, 4, 0, 0},
        GateShape{"pentagon", 0, 0, 2, 0}, GateShape{"hexagon", 0, 0, 0, 1}}) {
    const Corners corners = gate_corners(shape);
    for (int turn = 0; turn < 200; ++turn) {
      const Vector2d p(random.uniform(-4, 4), random.uniform(-4, 4));
      double nearest = HUGE_VAL;
      bool inside = true;
      for (std::size_t k = 0; k < corners.size(); ++k) {
        const Vector2d a = corners[k], edge = corners[(k + 1) % corners.size()] - a;
        inside &= edge.x() * (p - a).y() - edge.y() * (p - a).x() > 0;
        for (int i = 0; i <= 400; ++i)
          nearest = std::min(nearest, (a + i / 400.0 * edge - p).norm());
      }
      const double told = outside_of(corners, p);
      EXPECT_EQ(told < 0, inside);
      if (inside)
        EXPECT_NEAR(-told, nearest, 0.01);
      else
        EXPECT_LE(told, nearest + 1e-9);
    }
  }
  EXPECT_DOUBLE_EQ(outside_of(gate_corners({"rectangle", 4, 2, 0, 0}), {5, 0}), 3);
}

GateTask upright(double tunnel = 0) {
  GateTask gate;
  gate.position = {10, 0, 5};
  gate.corners = gate_corners({"rectangle", 4, 2, 0, 0});
  gate.tunnel_length = tunnel;
  set_direction(gate, {1, 0, 0}, {0, 0, 1});
  return gate;
}

std::vector<PathPoint> timed(const std::vector<Vector3d>& places) {
  std::vector<PathPoint> path;
  for (const Vector3d& p : places) path.push_back({static_cast<double>(path.size()), p});
  return path;
}

double outside(const GateTask& gate, const std::vector<Vector3d>& places, double tolerance = 0.1) {
  return gate_passage(gate, timed(places), 0, tolerance).outside;
}

TEST(GatePassages, WhereThePathCrossesThePlane) {
  const GateTask gate = upright();
  EXPECT_DOUBLE_EQ(outside(gate, {{0, 0, 5}, {20, 0, 5}}), -1);
  EXPECT_DOUBLE_EQ(outside(gate, {{0, 1.5, 5}, {20, 1.5, 5}}), -0.5);
  EXPECT_DOUBLE_EQ(outside(gate, {{0, 0, 8}, {20, 0, 8}}), 2);
  EXPECT_DOUBLE_EQ(outside(gate, {{0, -2, 5}, {20, 6, 5}}), 0) << "at 2 m in the middle";
  EXPECT_TRUE(std::isinf(outside(gate, {{20, 0, 5}, {0, 0, 5}}))) << "the wrong way";
  EXPECT_TRUE(std::isinf(outside(gate, {{0, 0, 5}, {9, 0, 5}}))) << "not there";
  EXPECT_TRUE(std::isinf(outside(gate, {{11, 0, 5}, {20, 0, 5}}))) << "begins behind it";
  EXPECT_TRUE(std::isinf(outside(gate, {{0, 0, 5}})));
  EXPECT_TRUE(std::isinf(outside(gate, {})));
}

// A lap ends in the plane of its gate, to the tolerance.
TEST(GatePassages, APathMayEndInThePlane) {
  const GateTask gate = upright();
  EXPECT_DOUBLE_EQ(outside(gate, {{0, 0, 5}, {10, 0, 5}}), -1);
  EXPECT_DOUBLE_EQ(outside(gate, {{0, 0, 5}, {9.95, 0, 5}}), -1);
  EXPECT_TRUE(std::isinf(outside(gate, {{0, 0, 5}, {9.85, 0, 5}})));
  // Only its end: what turns back before the plane was not there.
  EXPECT_TRUE(std::isinf(outside(gate, {{0, 0, 5}, {9.95, 0, 5}, {5, 0, 5}})));
}

TEST(GatePassages, TheFirstGoodOneCountsElseTheBest) {
  const GateTask gate = upright();
  // Three times through: 3 m beside it, 1.5 m beside it, in the middle; back around it in between.
  const std::vector<Vector3d> thrice = {{0, 5, 5},   {20, 5, 5},   {20, 50, 5}, {0, 50, 5},
                                        {0, 3.5, 5}, {20, 3.5, 5}, {20, 50, 5}, {0, 50, 5},
                                        {0, 0, 5},   {20, 0, 5}};
  const GatePassage best = gate_passage(gate, timed(thrice), 0, 0.1);
  EXPECT_DOUBLE_EQ(best.outside, -1);
  EXPECT_EQ(best.after, 8u);
  const GatePassage first = gate_passage(gate, timed(thrice), 0, 2);
  EXPECT_DOUBLE_EQ(first.outside, 1.5);
  EXPECT_EQ(first.after, 4u);
  EXPECT_DOUBLE_EQ(gate_passage(gate, timed(thrice), 5, 2).outside, -1) << "looked for from there";
  const std::span<const PathPoint> none;
  EXPECT_TRUE(std::isinf(gate_passage(gate, none, 5, 2).outside));
}

// The worst place of the whole tunnel counts: here where the path bends aside within it.
TEST(GatePassages, TunnelsAreFollowedToTheirEnd) {
  const GateTask gate = upright(6);
  const GatePassage straight = gate_passage(gate, timed({{0, 1, 5}, {20, 1, 5}}), 0, 0.1);
  EXPECT_DOUBLE_EQ(straight.outside, -1);
  EXPECT_DOUBLE_EQ(straight.share, 13.0 / 20) << "left 3 m behind the gate";
  const GatePassage bent =
      gate_passage(gate, timed({{0, 0, 5}, {9, 0, 5}, {11, 4, 5}, {12, 0, 5}, {20, 0, 5}}), 0, 0.1);
  EXPECT_DOUBLE_EQ(bent.outside, 2);
  EXPECT_DOUBLE_EQ(bent.time, 2) << "of the worst place";
  EXPECT_EQ(bent.after, 3u);
  // Out again where it came in: never through. What passes it far aside is the best that is left.
  EXPECT_TRUE(std::isinf(outside(gate, {{0, 0, 5}, {9, 0, 5}, {0, 0, 5}})));
  EXPECT_DOUBLE_EQ(outside(gate, {{0, 0, 5}, {9, 0, 5}, {0, 0, 5}, {0, 50, 5}, {20, 50, 5}}), 48);
  // The tunnel's own ends: at 7 m and 13 m.
  EXPECT_TRUE(std::isinf(outside(gate, {{8, 0, 5}, {20, 0, 5}}))) << "begins within it";
  EXPECT_TRUE(std::isinf(outside(gate, {{0, 0, 5}, {12.8, 0, 5}}))) << "ends within it";
  EXPECT_DOUBLE_EQ(outside(gate, {{0, 0, 5}, {12.95, 0, 5}}), -1);
}

// Two gates in one chord: the second is looked for from where the first was left.
TEST(GatePassages, OneChordLeadsThroughSeveral) {
  const GateTask near = upright();
  GateTask far = upright();
  far.position.x() = 15;
  const std::vector<PathPoint> path = timed({{0, 0, 5}, {20, 0, 5}});
  const GatePassage first = gate_passage(near, path, 0, 0.1);
  EXPECT_DOUBLE_EQ(first.share, 0.5);
  const GatePassage second = gate_passage(far, path, first.after, 0.1, first.share);
  EXPECT_DOUBLE_EQ(second.outside, -1);
  EXPECT_DOUBLE_EQ(second.share, 0.75);
  // The first is not passed again by what is left of the chord.
  EXPECT_TRUE(std::isinf(gate_passage(near, path, first.after, 0.1, first.share).outside));
}

// A ball: the least distance from its middle by small steps along the path.
TEST(GatePassages, BallsAreMeasuredFromTheirMiddle) {
  GateTask ball;
  ball.position = {1, 2, 3};
  ball.radius = 0.5;
  Random random(4);
  for (int turn = 0; turn < 100; ++turn) {
    std::vector<Vector3d> places;
    for (int i = 0; i < 5; ++i)
      places.emplace_back(random.uniform(-4, 6), random.uniform(-3, 7), random.uniform(-2, 8));
    double least = HUGE_VAL;
    for (int i = 0; i + 1 < 5; ++i)
      for (int s = 0; s <= 2000; ++s)
        least = std::min(
            least, (places[i] + s / 2000.0 * (places[i + 1] - places[i]) - ball.position).norm());
    EXPECT_NEAR(outside(ball, places, -0.5), least - 0.5, 0.005);
  }
  EXPECT_DOUBLE_EQ(outside(ball, {{1, 2, 3}, {1, 2, 3}}), -0.5) << "a path that stands still";
  EXPECT_DOUBLE_EQ(outside(ball, {{1, 2, 5}, {1, 2, 5}}), 1.5);
}

// Through, away by more than the radius, and through again nearer: the first is good enough.
TEST(GatePassages, ABallIsLeftBeforeItIsPassedAgain) {
  GateTask ball;
  ball.radius = 1;
  const std::vector<PathPoint> twice =
      timed({{-9, 0.5, 0}, {9, 0.5, 0}, {9, 20, 0}, {-9, 20, 0}, {-9, 0, 0}, {9, 0, 0}});
  const GatePassage first = gate_passage(ball, twice, 0, 0);
  EXPECT_DOUBLE_EQ(first.outside, -0.5);
  EXPECT_EQ(first.after, 0u);
  EXPECT_DOUBLE_EQ(gate_passage(ball, twice, 0, -0.9).outside, -1) << "not good enough";
}

// Moved and turned together with the path, a passage stays what it is.
TEST(GatePassages, DoNotDependOnWhereTheWorldIs) {
  Random random(6);
  for (int turn = 0; turn < 40; ++turn) {
    const Eigen::Matrix3d R = (Eigen::AngleAxisd(random.uniform(-3, 3), Vector3d::UnitZ()) *
                               Eigen::AngleAxisd(random.uniform(-1, 1), Vector3d::UnitY()))
                                  .toRotationMatrix();
    const Vector3d t(random.uniform(-50, 50), random.uniform(-50, 50), random.uniform(-9, 9));
    const GateTask gate = upright(2);
    GateTask other = gate;
    other.position = R * gate.position + t;
    set_direction(other, R * gate.direction, R * gate.up);
    std::vector<Vector3d> places, moved;
    for (int i = 0; i < 8; ++i) {
      places.emplace_back(3 * i, random.uniform(-2.5, 2.5), 5 + random.uniform(-1.5, 1.5));
      moved.push_back(R * places.back() + t);
    }
    EXPECT_NEAR(outside(gate, places), outside(other, moved), 1e-9);
  }
}

}  // namespace
}  // namespace lapwing
