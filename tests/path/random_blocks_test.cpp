// SPDX-License-Identifier: Apache-2.0
// Ways, corridors and detours in worlds of random blocks: what must hold in each of them.
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "framework/conformance/path_worlds.h"
#include "framework/core/error.h"
#include "framework/core/random.h"
#include "framework/path/passages.h"

namespace lapwing {
namespace {

using Eigen::AlignedBox3d;
using Eigen::Vector3d;

const AlignedBox3d kYard(Vector3d(-10, -10, 0), Vector3d(10, 10, 8));

Vector3d place_in(const AlignedBox3d& box, Random& random) {
  return box.min() +
         box.sizes().cwiseProduct(Vector3d(random.uniform(), random.uniform(), random.uniform()));
}

BlockSpace random_blocks(Random& random, int count) {
  std::vector<AlignedBox3d> blocks;
  for (int k = 0; k < count; ++k) {
    const Vector3d middle = place_in(kYard, random);
    const Vector3d half(random.uniform(0.3, 2), random.uniform(0.3, 2), random.uniform(0.3, 2));
    blocks.emplace_back(middle - half, middle + half);
  }
  return BlockSpace(std::move(blocks));
}

// A free way of some corners, found by drawing them until they are joined.
std::vector<Vector3d> random_way(const FreeSpace& space, Random& random, const Vector3d& half) {
  std::vector<Vector3d> way;
  for (int tries = 0; tries < 4000 && way.size() < 7; ++tries) {
    const Vector3d p = place_in(kYard, random);
    if (space.swept_box_free(way.empty() ? p : way.back(), p, half)) way.push_back(p);
  }
  return way;
}

TEST(RandomBlocks, CorridorsHoldTheWayAndCannotGrow) {
  Random random(1);
  int several = 0;
  for (int k = 0; k < 40; ++k) {
    const BlockSpace space = random_blocks(random, 12);
    const std::vector<Vector3d> way = random_way(space, random, Vector3d::Constant(0.1));
    if (way.size() < 2) continue;
    const std::vector<CorridorBox> boxes = grow_corridor(space, kYard, way, 100);
    ASSERT_FALSE(boxes.empty()) << k;
    several += boxes.size() > 3;
    EXPECT_EQ(boxes.front().from, 0);
    EXPECT_EQ(boxes.back().to, 1);
    for (std::size_t b = 0; b < boxes.size(); ++b) {
      const AlignedBox3d& box = boxes[b].box;
      if (b > 0) {
        EXPECT_EQ(boxes[b].from, boxes[b - 1].to) << "they share a place";
      }
      ASSERT_LT(boxes[b].from, boxes[b].to);
      EXPECT_TRUE(space.swept_box_free(box.center(), box.center(), box.sizes() / 2));
      EXPECT_TRUE(AlignedBox3d(kYard.min() - Vector3d::Constant(1e-9),
                               kYard.max() + Vector3d::Constant(1e-9))
                      .contains(box));
      for (int i = 0; i <= 10; ++i) {
        const double share = boxes[b].from + i / 10.0 * (boxes[b].to - boxes[b].from);
        EXPECT_LT(box.exteriorDistance(place_on(way, share)), 1e-9) << k << ", box " << b;
      }
      // Each face is at the end of the yard or stopped by something within 7 cm.
      for (int face = 0; face < 6; ++face) {
        AlignedBox3d more = box;
        const int axis = face / 2;
        (face % 2 ? more.max() : more.min())(axis) += face % 2 ? 0.07 : -0.07;
        if (!AlignedBox3d(kYard.min() - Vector3d::Constant(0.02),
                          kYard.max() + Vector3d::Constant(0.02))
                 .contains(more))
          continue;
        EXPECT_FALSE(space.swept_box_free(more.center(), more.center(), more.sizes() / 2))
            << k << ", box " << b << ", face " << face;
      }
    }
  }
  EXPECT_GT(several, 10);
}

TEST(RandomBlocks, CorridorsGrowNoFartherThanTold) {
  const BlockSpace space(std::vector<AlignedBox3d>{});
  const std::vector<Vector3d> way = {{0, 0, 4}, {2, 0, 4}};
  const auto boxes = grow_corridor(space, kYard, way, 1.5);
  ASSERT_EQ(boxes.size(), 1u);
  EXPECT_LT((boxes[0].box.min() - Vector3d(-1.5, -1.5, 2.5)).norm(), 1e-9);
  EXPECT_LT((boxes[0].box.max() - Vector3d(3.5, 1.5, 5.5)).norm(), 1e-9);
  const auto none = grow_corridor(space, kYard, way, 0);
  ASSERT_EQ(none.size(), 1u);
  EXPECT_LT(none[0].box.volume(), 1e-9);
  EXPECT_TRUE(grow_corridor(space, kYard, {}, 1).empty());
  EXPECT_TRUE(grow_corridor(space, kYard, std::vector<Vector3d>{{0, 0, 1}}, 1).empty());
  EXPECT_TRUE(grow_corridor(space, kYard, std::vector<Vector3d>{{0, 0, 1}, {0, 0, 1}}, 1).empty())
      << "a way of no length";
  // A way outside of the bounds is held, for the box is about the way, but it grows inwards alone.
  const auto outside =
      grow_corridor(space, kYard, std::vector<Vector3d>{{12, 0, 1}, {12, 2, 1}}, 5);
  ASSERT_EQ(outside.size(), 1u);
  EXPECT_EQ(outside[0].box.max().x(), 12);
  EXPECT_EQ(outside[0].box.min().x(), 7);
}

TEST(RandomBlocks, AWayThatIsNotFreeHasNoCorridor) {
  const BlockSpace space({AlignedBox3d(Vector3d(-1, -1, 0), Vector3d(1, 1, 8))});
  EXPECT_TRUE(grow_corridor(space, kYard, std::vector<Vector3d>{{-5, 0, 4}, {5, 0, 4}}).empty());
  EXPECT_FALSE(grow_corridor(space, kYard, std::vector<Vector3d>{{-5, 1, 4}, {5, 1, 4}}).empty())
      << "touching is free";
}

// Between two slabs the room is half of what is between them, wherever the way is narrowest.
TEST(RandomBlocks, TheNarrowestPlaceIsBetweenTheNearestWalls) {
  for (const double gap : {0.5, 1.0, 3.0})
    for (const double at : {-3.0, 0.0, 4.0}) {
      const BlockSpace space(
          {AlignedBox3d(Vector3d(at - 0.5, gap / 2, -9), Vector3d(at + 0.5, 9, 9)),
           AlignedBox3d(Vector3d(at - 0.5, -9, -9), Vector3d(at + 0.5, -gap / 2, 9))});
      const std::vector<Vector3d> way = {{-9, 0, 0}, {9, 0, 0}};
      const Narrowest place = narrowest(space, way);
      EXPECT_NEAR(place.room, gap / 2, 0.02 * gap + 0.01) << gap;
      EXPECT_LE(place.room, gap / 2) << "never said to be more";
      EXPECT_LT(std::abs(place.place.x() - at), 0.5 + gap / 2 + 0.1) << gap;
    }
  const BlockSpace open(std::vector<AlignedBox3d>{});
  EXPECT_EQ(narrowest(open, std::vector<Vector3d>{{0, 0, 0}, {1, 0, 0}}).room, 20) << "the most";
}

TEST(RandomBlocks, ShortcutsAreFreeAndNeverLonger) {
  Random random(2);
  int shorter = 0;
  for (int k = 0; k < 60; ++k) {
    const BlockSpace space = random_blocks(random, 15);
    const Vector3d half(0.2, 0.2, 0.1);
    const std::vector<Vector3d> way = random_way(space, random, half);
    if (way.size() < 3) continue;
    const PathProblem problem{&space, way.front(), way.back(), half, kYard};
    const std::vector<Vector3d> kept = without_detours(problem, way);
    EXPECT_EQ(kept.front(), way.front());
    EXPECT_EQ(kept.back(), way.back());
    EXPECT_LE(path_length(kept), path_length(way) + 1e-12);
    shorter += path_length(kept) < path_length(way);
    for (std::size_t i = 1; i < kept.size(); ++i)
      EXPECT_TRUE(space.swept_box_free(kept[i - 1], kept[i], half)) << k;
    std::size_t next = 0;  // what is kept comes in the order of the way
    for (const Vector3d& p : kept)
      while (next < way.size() && way[next] != p) ++next;
    EXPECT_LT(next, way.size());
    EXPECT_EQ(without_detours(problem, kept), kept) << "there is nothing more to gain";
  }
  EXPECT_GT(shorter, 20);
}

TEST(RandomBlocks, BeingOfOnePassageHasNoOrder) {
  Random random(3);
  int same = 0, other = 0;
  for (int k = 0; k < 150; ++k) {
    const BlockSpace space = random_blocks(random, 6);
    std::vector<Vector3d> a = random_way(space, random, Vector3d::Zero());
    std::vector<Vector3d> b = random_way(space, random, Vector3d::Zero());
    if (a.size() < 3 || b.size() < 3) continue;
    b.front() = a.front();
    b.back() = a.back();
    const bool joined = same_passage(space, a, b);
    (joined ? same : other) += 1;
    EXPECT_EQ(same_passage(space, b, a), joined) << k;
    EXPECT_TRUE(same_passage(space, a, a)) << k;
    std::reverse(a.begin(), a.end());
    std::reverse(b.begin(), b.end());
    EXPECT_EQ(same_passage(space, a, b), joined) << k << ": the way back is of the same passage";
  }
  EXPECT_GT(same, 5);
  EXPECT_GT(other, 5);
}

TEST(RandomBlocks, RoomIsThatOfALargerBody) {
  Random random(4);
  for (int k = 0; k < 200; ++k) {
    const BlockSpace space = random_blocks(random, 10);
    const double more = random.uniform(0, 1);
    const auto roomy = with_room(std::make_unique<BlockSpace>(space), more);
    const Vector3d p = place_in(kYard, random), q = place_in(kYard, random);
    const Vector3d half(0.1, 0.4, 0.2), grown = Vector3d::Constant(more);
    EXPECT_EQ(roomy->point_free(p), space.swept_box_free(p, p, grown));
    EXPECT_EQ(roomy->segment_free(p, q), space.swept_box_free(p, q, grown));
    EXPECT_EQ(roomy->swept_box_free(p, q, half), space.swept_box_free(p, q, half + grown));
  }
  const auto blocks = [] { return std::make_unique<BlockSpace>(std::vector<AlignedBox3d>{}); };
  EXPECT_THROW(with_room(blocks(), -0.1), Error);
  EXPECT_THROW(with_room(blocks(), std::nan("")), Error);
  EXPECT_THROW(with_room(nullptr, 1), Error);
  EXPECT_THROW(free_in_both(blocks(), nullptr), Error);
}

// Never asked to search: every problem here is none.
class Unasked final : public PathPlanner {
 protected:
  Search search(const PathProblem&, const PathRequest&) const override {
    ADD_FAILURE() << "was asked";
    return {};
  }
};

TEST(RandomBlocks, ProblemsThatAreNoneAreNamed) {
  const BlockSpace space({AlignedBox3d(Vector3d(-1, -9, 0), Vector3d(1, 9, 8))});
  const PathProblem good{&space, {-5, 0, 1}, {5, 0, 1}, {0.1, 0.1, 0.1}, kYard};
  const double nan = std::nan(""), endless = std::numeric_limits<double>::infinity();
  const auto said = [&](const auto& spoil) {
    PathProblem problem = good;
    spoil(problem);
    const PathResult result = Unasked().plan(problem);
    EXPECT_TRUE(result.points.empty());
    EXPECT_EQ(result.report.length, 0);
    return std::string(to_string(result.report.status)) + ": " + result.report.message;
  };
  const std::string ends = "unsupported: start and goal must be finite";
  EXPECT_EQ(said([&](PathProblem& p) { p.start.y() = nan; }), ends);
  EXPECT_EQ(said([&](PathProblem& p) { p.goal.z() = endless; }), ends);
  const std::string body = "unsupported: the body's half edges must be finite and at least 0 m";
  EXPECT_EQ(said([&](PathProblem& p) { p.half.z() = nan; }), body);
  EXPECT_EQ(said([&](PathProblem& p) { p.half.x() = endless; }), body);
  EXPECT_EQ(said([&](PathProblem& p) { p.half.y() = -1e-9; }), body);
  const std::string bounds = "unsupported: the bounds must be a finite box";
  EXPECT_EQ(said([&](PathProblem& p) { p.bounds.max().x() = endless; }), bounds);
  EXPECT_EQ(said([&](PathProblem& p) { p.bounds.min().x() = nan; }), bounds);
  EXPECT_EQ(said([&](PathProblem& p) { p.bounds.min().x() = 99; }), bounds);
  EXPECT_EQ(said([](PathProblem& p) { p.start.x() = -11; }),
            "start_blocked: the start (-11.00, 0.00, 1.00) lies outside the bounds of the search");
  EXPECT_EQ(
      said([](PathProblem& p) { p.goal.x() = 1.05; }),
      "goal_blocked: the goal (1.05, 0.00, 1.00) is blocked for a body of (0.20, 0.20, 0.20) m");
}

}  // namespace
}  // namespace lapwing
