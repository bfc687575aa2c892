// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <map>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "framework/core/units.h"
#include "framework/path/free_space.h"
#include "framework/view/candidates.h"
#include "framework/view/motions.h"
#include "tests/view/view_world.h"

namespace lapwing {
namespace {

using Eigen::AlignedBox3d;
using Eigen::Vector3d;

CandidateSettings candidate_settings() {
  CandidateSettings s;
  s.region = AlignedBox3d(Vector3d(4, -4, 0), Vector3d(6, 4, 9));
  s.allowed = AlignedBox3d(Vector3d(-10, -10, 0), Vector3d(10, 10, 10));
  s.half = {0.5, 0.5, 0.25};
  return s;
}

const std::vector<Viewpoint> kStart{{{-5, 0, 5}, 0, 0}};

Candidates generate(const CandidateSettings& s, std::uint64_t seed = 1) {
  const auto space = free_space_of(std::shared_ptr<const Map>(walled_room()));
  return generate_candidates(*space, kStart, s, seed);
}

TEST(Candidates, AreFreeAllowedApartAndLookDown) {
  const auto space = free_space_of(std::shared_ptr<const Map>(walled_room()));
  const CandidateSettings s = candidate_settings();
  const Candidates made = generate(s);
  ASSERT_GT(made.viewpoints.size(), 200u);
  for (std::size_t k = 0; k < made.viewpoints.size(); ++k) {
    const Viewpoint& v = made.viewpoints[k];
    EXPECT_TRUE(s.allowed.contains(v.position));
    EXPECT_TRUE(space->swept_box_free(v.position, v.position, s.half));
    EXPECT_LE(v.pitch, s.pitch_max);
    EXPECT_GE(v.pitch, s.pitch_min);
    for (std::size_t j = 0; j < k; ++j) {
      const Viewpoint& w = made.viewpoints[j];
      EXPECT_TRUE((v.position - w.position).norm() >= s.distance_apart ||
                  angle_between(v, w) >= s.angle_apart);
    }
  }
}

// A ball without views is grown through all the same.
TEST(Candidates, NoneLieWhereViewsAreForbidden) {
  CandidateSettings s = candidate_settings();
  const auto in_ball = [](const Candidates& made) {
    int count = 0;
    for (const Viewpoint& v : made.viewpoints)
      count += (v.position - Vector3d(0, 0, 5)).norm() <= 4;
    return count;
  };
  EXPECT_GT(in_ball(generate(s)), 5);
  s.viewless = {{Vector3d(0, 0, 5), 4}};
  const Candidates made = generate(s);
  EXPECT_EQ(in_ball(made), 0);
  int beyond = 0;
  for (const Viewpoint& v : made.viewpoints) beyond += v.position.x() > 6;
  EXPECT_GT(beyond, 20);
  // The one to begin with stays.
  s.viewless = {{kStart[0].position, 1}};
  EXPECT_EQ(generate(s).viewpoints[0].position, kStart[0].position);
}

// Each place without candidates is told once, with why.
TEST(Candidates, PlacesThatAreLeftOutAreToldWithWhy) {
  const auto space = free_space_of(std::shared_ptr<const Map>(walled_room()));
  CandidateSettings s = candidate_settings();
  s.allowed = AlignedBox3d(Vector3d(-9, -9, 1), Vector3d(9, 9, 8));
  s.viewless = {{Vector3d(0, 0, 5), 3}};
  s.most = 300;
  const Candidates made = generate(s);
  std::map<PlaceLoss, int> counts;
  for (const LostPlace& lost : made.lost) {
    ++counts[lost.why];
    const bool free = space->swept_box_free(lost.position, lost.position, s.half);
    EXPECT_EQ(s.allowed.contains(lost.position), lost.why != PlaceLoss::outside);
    if (lost.why == PlaceLoss::blocked)
      EXPECT_FALSE(free);
    else if (lost.why != PlaceLoss::outside)
      EXPECT_TRUE(free);
    EXPECT_EQ(lost.why == PlaceLoss::viewless,
              (lost.position - Vector3d(0, 0, 5)).norm() <= 3 && lost.why != PlaceLoss::thinned);
    for (const Viewpoint& v : made.viewpoints) EXPECT_NE(v.position, lost.position);
  }
  for (const PlaceLoss why :
       {PlaceLoss::outside, PlaceLoss::blocked, PlaceLoss::viewless, PlaceLoss::thinned})
    EXPECT_GT(counts[why], 0) << static_cast<int>(why);
  EXPECT_EQ(made.lost_beyond, 0);
  // Every free place that was found has candidates or is left out.
  EXPECT_EQ(made.grown, made.places + counts[PlaceLoss::viewless] + counts[PlaceLoss::thinned]);
}

TEST(Candidates, BehindTheWallAreReachedRoundIt) {
  int behind = 0;
  for (const Viewpoint& v : generate(candidate_settings()).viewpoints) behind += v.position.x() > 6;
  EXPECT_GT(behind, 20);
}

TEST(Candidates, AreDenserNearTheRegion) {
  CandidateSettings s = candidate_settings();
  s.step = 1.2;
  s.step_growth = 0.4;
  int near = 0, far = 0;
  for (const Viewpoint& v : generate(s).viewpoints) {
    const double x = v.position.x();
    near += x > 1 && x < 5;
    far += x > -9 && x < -5;
  }
  EXPECT_GT(near, 2 * far);
}

// How many lie in each quarter of the room, seen from above.
std::array<int, 4> in_quarters(const Candidates& made) {
  std::array<int, 4> count{};
  for (const Viewpoint& v : made.viewpoints)
    ++count[(v.position.x() > 0 ? 1u : 0u) + (v.position.y() > 0 ? 2u : 0u)];
  return count;
}

TEST(Candidates, FewOfManyAreAllOverTheRoom) {
  CandidateSettings s = candidate_settings();
  s.step_growth = 0;
  s.directions = 2;
  const Candidates many = generate(s);
  s.most = 120;
  const Candidates few = generate(s);
  EXPECT_EQ(few.viewpoints.size(), 120u);
  EXPECT_EQ(few.grown, many.grown);
  EXPECT_GT(few.grown, 1000);
  EXPECT_GE(few.places, 45);
  EXPECT_LE(few.places, 61);  // two directions for each, and the start
  for (const int count : in_quarters(few)) EXPECT_GE(count, 20);
  // Places are apart from each other, not only from those that look the same way.
  for (const Viewpoint& v : few.viewpoints)
    for (const Viewpoint& w : few.viewpoints) {
      const double apart = (v.position - w.position).norm();
      EXPECT_TRUE(apart == 0 || apart > s.step) << apart;
    }
}

TEST(Candidates, PlacesHaveAsManyDirectionsAsTheMostAllows) {
  CandidateSettings s = candidate_settings();
  s.step = 6;
  s.step_growth = 0;
  s.most = 100000;
  const Candidates all = generate(s);
  EXPECT_EQ(all.places, all.grown);
  EXPECT_GT(all.viewpoints.size(), 10 * static_cast<std::size_t>(all.places));
  s.most = 3 * static_cast<int>(all.places);
  std::map<double, int> views;
  for (const Viewpoint& v : generate(s).viewpoints)
    ++views[v.position.x() + 100 * v.position.y() + 10000 * v.position.z()];
  EXPECT_EQ(views.size(), static_cast<std::size_t>(all.places));
  for (const auto& [place, count] : views) EXPECT_EQ(count, 3);
}

TEST(Candidates, LookMostlyTowardsTheRegion) {
  CandidateSettings s = candidate_settings();
  s.most = 400;  // so many that places are not full yet and must look elsewhere
  int towards = 0, all = 0;
  for (const Viewpoint& v : generate(s).viewpoints) {
    if (v.position.x() > 0) continue;
    ++all;
    towards += v.direction().x() > 0;
  }
  EXPECT_GT(towards, 0.95 * all);
}

TEST(Candidates, AreTheSameForASeedAndOthersForAnother) {
  const auto at = [](const Candidates& made) {
    std::vector<double> numbers;
    for (const Viewpoint& v : made.viewpoints) {
      numbers.push_back(v.position.sum());
      numbers.push_back(v.yaw);
    }
    return numbers;
  };
  EXPECT_EQ(at(generate(candidate_settings(), 4)), at(generate(candidate_settings(), 4)));
  EXPECT_NE(at(generate(candidate_settings(), 4)), at(generate(candidate_settings(), 5)));
}

TEST(Candidates, StopAtTheMostAndDrawUpToTheLeast) {
  CandidateSettings s = candidate_settings();
  s.most = 50;
  EXPECT_EQ(generate(s).viewpoints.size(), 50u);
  s.most = 1000;
  s.step = 100;  // nothing to grow to
  const Candidates alone = generate(s);
  EXPECT_EQ(alone.places, 1);
  EXPECT_LT(alone.viewpoints.size(), 30u);
  for (const Viewpoint& v : alone.viewpoints) EXPECT_EQ(v.position, kStart[0].position);
  s.least = 30;
  EXPECT_EQ(generate(s).viewpoints.size(), 30u);
}

std::string refusal(const std::vector<Viewpoint>& given, const CandidateSettings& s) {
  const auto space = free_space_of(std::shared_ptr<const Map>(walled_room()));
  try {
    generate_candidates(*space, given, s, 1);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(Candidates, NoFreeStartIsSaid) {
  using testing::HasSubstr;
  EXPECT_THAT(refusal({}, candidate_settings()), HasSubstr("no start"));
  EXPECT_THAT(refusal({kStart[0], {{5.2, 0, 5}, 0, 0}}, candidate_settings()),
              HasSubstr("viewpoint 2 to begin with is not in free space"));
  EXPECT_THAT(refusal({{{0, 0, 50}, 0, 0}}, candidate_settings()), HasSubstr("outside the room"));
  CandidateSettings s = candidate_settings();
  s.region = AlignedBox3d();
  EXPECT_THAT(refusal(kStart, s), HasSubstr("region of interest is empty"));
}

std::vector<std::vector<VoxelKey>> seen_from(const std::shared_ptr<SmallMap>& map,
                                             const std::vector<Viewpoint>& viewpoints) {
  SightSettings sight;
  sight.pinhole = {120, 90, 69, 69, 59.5, 44.5};
  sight.region = AlignedBox3d(Vector3d(4, -4, 0), Vector3d(6, 4, 9));
  const VisibleVoxels visible(map, nullptr, sight);
  std::vector<std::vector<VoxelKey>> seen;
  for (const Viewpoint& v : viewpoints) seen.push_back(visible.seen_coarsely_from(v, 24));
  return seen;
}

TEST(Motions, JoinTheNearestThatMatchNotTheNearest) {
  // Four places in a row; at each, one view of the wall between ten that look away from it.
  const auto map = walled_room();
  const auto space = free_space_of(std::shared_ptr<const Map>(map));
  std::vector<Viewpoint> viewpoints;
  for (int place = 0; place < 4; ++place) {
    const Vector3d p(-3, 1.5 * place - 2, 5);
    viewpoints.push_back({p, 0, 0});
    for (int k = 0; k < 10; ++k) viewpoints.push_back({p, 2.6 + 0.1 * k, 0});
  }
  const auto seen = seen_from(map, viewpoints);
  MotionSettings s;
  s.allowed = candidate_settings().allowed;
  s.half = candidate_settings().half;
  s.neighbours = 2;
  s.among = 5;
  EXPECT_TRUE(find_motions(*space, viewpoints, seen, s, 1, 1).motions.empty());
  s.among = 43;
  const MotionGraph graph = find_motions(*space, viewpoints, seen, s, 1, 1);
  std::vector<std::pair<int, int>> joined;
  for (const ViewMotion& m : graph.motions) joined.emplace_back(m.a, m.b);
  const std::vector<std::pair<int, int>> expected{{0, 11}, {0, 22}, {11, 22}, {11, 33}, {22, 33}};
  EXPECT_EQ(joined, expected);
}

TEST(Motions, JoinNeighboursThatAreFreeAndMatch) {
  const auto map = walled_room();
  const auto space = free_space_of(std::shared_ptr<const Map>(map));
  CandidateSettings few = candidate_settings();
  few.most = 60;
  const std::vector<Viewpoint> viewpoints = generate(few).viewpoints;
  const std::vector<std::vector<VoxelKey>> seen = seen_from(map, viewpoints);
  MotionSettings s;
  s.allowed = candidate_settings().allowed;
  s.half = candidate_settings().half;
  const MotionGraph graph = find_motions(*space, viewpoints, seen, s, 1, 2);
  ASSERT_GT(graph.motions.size(), viewpoints.size() / 2);
  EXPECT_EQ(graph.tried,
            graph.unmatched + graph.blocked + static_cast<std::int64_t>(graph.motions.size()));
  EXPECT_GT(graph.unmatched, 0);
  for (const ViewMotion& m : graph.motions) {
    EXPECT_LT(m.a, m.b);
    EXPECT_TRUE(space->swept_box_free(m.points.front(), m.points.back(), s.half));
    EXPECT_TRUE(matchable(seen[static_cast<std::size_t>(m.a)], seen[static_cast<std::size_t>(m.b)],
                          s.alpha));
    EXPECT_NEAR(m.length, (m.points.back() - m.points.front()).norm(), 1e-12);
  }
  const MotionGraph alone = find_motions(*space, viewpoints, seen, s, 1, 1);
  ASSERT_EQ(alone.motions.size(), graph.motions.size());
  for (std::size_t k = 0; k < alone.motions.size(); ++k) {
    EXPECT_EQ(alone.motions[k].a, graph.motions[k].a);
    EXPECT_EQ(alone.motions[k].b, graph.motions[k].b);
  }
}

}  // namespace
}  // namespace lapwing
