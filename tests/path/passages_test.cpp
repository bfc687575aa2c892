// SPDX-License-Identifier: Apache-2.0
// Passages: which ways deform into one another, how another one is found, and corridors about them.
#include <gtest/gtest.h>

#include "framework/geometry/mesh_builder.h"
#include "framework/path/passages.h"
#include "framework/plugin/registry.h"

namespace lapwing {
namespace {

using Eigen::AlignedBox3d;
using Eigen::Vector3d;
using Way = std::vector<Vector3d>;

// A wall from y = -10 to 10 and up to 8 m, with windows at y = 2 to 4 and y = -7 to -5, z = 1 to 3.
std::shared_ptr<const MeshScene> two_windows() {
  MeshBuilder builder;
  const auto part = [&](double y0, double y1, double z0, double z1) {
    builder.box({-0.1, y0, z0}, {0.1, y1, z1});
  };
  part(-10, -7, 0, 8);
  part(-7, -5, 0, 1), part(-7, -5, 3, 8);
  part(-5, 2, 0, 8);
  part(2, 4, 0, 1), part(2, 4, 3, 8);
  part(4, 10, 0, 8);
  return std::make_shared<const MeshScene>(builder.take());
}

PathProblem across(const FreeSpace& space) {
  return {
      &space, {-5, 0, 2}, {5, 0, 2}, {0.3, 0.3, 0.3}, {Vector3d(-8, -9, 0.2), Vector3d(8, 9, 6)}};
}

std::unique_ptr<PathPlanner> planner() {
  static const Registry registry({std::filesystem::path(LAPWING_BUILD_DIR) / "lib/plugins"});
  return registry.create<PathPlanner>("bit_star");
}

TEST(Passages, PlacesAtSharesOfTheLength) {
  const Way way = {{0, 0, 0}, {3, 0, 0}, {3, 1, 0}};
  EXPECT_LT((place_on(way, 0.5) - Vector3d(2, 0, 0)).norm(), 1e-12);
  EXPECT_LT((place_on(way, 1) - Vector3d(3, 1, 0)).norm(), 1e-12);
  EXPECT_LT((place_on(way, -1) - Vector3d(0, 0, 0)).norm(), 1e-12);
  const Way still = {{0, 0, 0}, {0, 0, 0}, {1, 0, 0}};
  EXPECT_LT((place_on(still, 0.5) - Vector3d(0.5, 0, 0)).norm(), 1e-12);
}

TEST(Passages, OneWindowIsAnotherPassageThanTheOther) {
  const auto space = free_space_of(two_windows());
  const Way north = {{-5, 0, 2}, {0, 3, 2}, {5, 0, 2}}, south = {{-5, 0, 2}, {0, -6, 2}, {5, 0, 2}};
  const Way bent = {{-5, 0, 2}, {-1, 2.5, 2.5}, {0, 3.3, 1.8}, {1, 3, 2}, {5, 0, 2}};
  EXPECT_TRUE(same_passage(*space, north, north));
  EXPECT_TRUE(same_passage(*space, north, bent));
  EXPECT_TRUE(same_passage(*space, bent, north));
  EXPECT_FALSE(same_passage(*space, north, south));
  // In three dimensions a bounded wall can be gone round: no topology tells these apart.
  const Way above = {{-5, 0, 2}, {0, 0, 9}, {5, 0, 2}};
  EXPECT_FALSE(same_passage(*space, north, above));
}

TEST(Passages, TheNarrowestPlaceIsInTheWindow) {
  const auto space = free_space_of(two_windows());
  const Narrowest place = narrowest(*space, Way{{-5, 0, 2}, {-1, 3, 2}, {1, 3, 2}, {5, 0, 2}});
  EXPECT_LT(std::abs(place.place.x()), 1.1) << "a cube with half an edge of a metre feels it there";
  EXPECT_NEAR(place.room, 1, 0.05);
}

TEST(Passages, WhatFailedIsNotFoundAgain) {
  const auto space = free_space_of(two_windows());
  const PathProblem problem = across(*space);
  const PassageResult first = find_passage(*planner(), problem, {.seed = 1}, {});
  ASSERT_EQ(first.path.report.status, PathStatus::found) << first.path.report.message;
  EXPECT_EQ(first.tries, 1);
  EXPECT_GT(place_on(first.path.points, 0.5).y(), 1.5) << "the nearer window";
  const PassageResult second =
      find_passage(*planner(), problem, {.seed = 1}, {.excluded = {first.path.points}});
  ASSERT_EQ(second.path.report.status, PathStatus::found) << second.path.report.message;
  EXPECT_FALSE(same_passage(*space, first.path.points, second.path.points));
  EXPECT_LT(place_on(second.path.points, 0.5).y(), -4);
  for (std::size_t i = 1; i < second.path.points.size(); ++i)
    EXPECT_TRUE(
        space->swept_box_free(second.path.points[i - 1], second.path.points[i], problem.half));
}

TEST(Passages, WhereThereIsNoOtherTheSearchEnds) {
  MeshBuilder builder;
  builder.box({-0.1, -10, -1}, {0.1, 2, 8});
  builder.box({-0.1, 4, -1}, {0.1, 10, 8});
  const auto space = free_space_of(std::make_shared<const MeshScene>(builder.take()));
  const PathProblem problem = across(*space);
  const PassageResult first = find_passage(*planner(), problem, {.seed = 1}, {});
  ASSERT_EQ(first.path.report.status, PathStatus::found);
  const PassageResult other =
      find_passage(*planner(), problem, {.seed = 1}, {.excluded = {first.path.points}, .tries = 3});
  EXPECT_NE(other.path.report.status, PathStatus::found);
  EXPECT_EQ(other.tries, 3);
  EXPECT_TRUE(other.path.points.empty());
  EXPECT_NE(other.path.report.message.find("no other passage in 3 tries"), std::string::npos)
      << other.path.report.message;
}

TEST(Corridors, AreFreeAndHoldTheWay) {
  const auto space = free_space_of(two_windows());
  const AlignedBox3d bounds(Vector3d(-8, -9, 0.2), Vector3d(8, 9, 6));
  const Way way = {{-5, 0, 2}, {-1, 3, 2}, {1, 3, 2}, {5, 0, 3}};
  const std::vector<CorridorBox> boxes = grow_corridor(*space, bounds, way);
  ASSERT_GE(boxes.size(), 3u);
  EXPECT_EQ(boxes.front().from, 0);
  EXPECT_EQ(boxes.back().to, 1);
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    const CorridorBox& b = boxes[i];
    if (i > 0) {
      EXPECT_EQ(b.from, boxes[i - 1].to);
    }
    EXPECT_TRUE(bounds.contains(b.box));
    EXPECT_TRUE(space->swept_box_free(b.box.center(), b.box.center(), b.box.sizes() / 2));
    for (int k = 0; k <= 20; ++k) {
      const Vector3d p = place_on(way, b.from + (b.to - b.from) * k / 20);
      EXPECT_LT(b.box.exteriorDistance(p), 1e-9) << i;
    }
  }
  // In the window the box is the window's: 2 m wide and high.
  const auto in_window = std::find_if(boxes.begin(), boxes.end(), [](const CorridorBox& b) {
    return b.box.contains(Vector3d(0, 3, 2));
  });
  ASSERT_NE(in_window, boxes.end());
  EXPECT_LE(in_window->box.sizes().y(), 2.0 + 1e-6);
  EXPECT_GT(in_window->box.sizes().y(), 1.7);
  EXPECT_TRUE(grow_corridor(*space, bounds, Way{{-5, 0, 2}, {5, 0, 2}}).empty())
      << "the way itself is blocked";
}

}  // namespace
}  // namespace lapwing
