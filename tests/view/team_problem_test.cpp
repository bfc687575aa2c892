// SPDX-License-Identifier: Apache-2.0
// Team problems: what they refuse, their bounds against enumeration, and tours under change.
#include "framework/view/team_problem.h"

#include <cmath>

#include <gmock/gmock.h>

#include "framework/conformance/tour_worlds.h"
#include "framework/core/error.h"
#include "framework/core/random.h"
#include "framework/view/tour_bound.h"
#include "framework/view/working_team.h"

namespace lapwing {
namespace {

using ::testing::HasSubstr;

// Two clusters of two views, 10 s to the west and to the east of a home, 1 s between neighbours.
TourDefinition two_clusters(double budget) {
  const double x[] = {0, -10, -11, 10, 11};
  TourDefinition d;
  d.score = std::make_shared<const ViewScore>(additive_score(std::vector<double>{0, 3, 4, 5, 6}));
  d.view_seconds = {0};
  for (int a = 0; a < 5; ++a)
    for (int b = 0; b < 5; ++b) d.legs.push_back(std::abs(x[a] - x[b]));
  d.budget = budget;
  return d;
}

std::string refusal_of(std::vector<TeamTour> tours) {
  try {
    TeamProblem(std::move(tours));
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(TeamProblem, RefusesWhatIsNoTeam) {
  EXPECT_THAT(refusal_of({}), HasSubstr("needs at least one"));
  const TourDefinition d = two_clusters(22);
  const auto tour = [&](const char* name, const TourDefinition& of) {
    return TeamTour{name, TourProblem(of)};
  };
  std::vector<TeamTour> same;
  same.push_back(tour("a", d));
  same.push_back(tour("a", d));
  EXPECT_THAT(refusal_of(std::move(same)), HasSubstr("two tours of a team are named 'a'"));
  std::vector<TeamTour> scores;
  scores.push_back(tour("a", d));
  scores.push_back(tour("b", two_clusters(22)));
  EXPECT_THAT(refusal_of(std::move(scores)), HasSubstr("tour 'b' has another score"));
  TourDefinition motions = d;
  motions.legs.clear();
  motions.motions = {{0, 1, 5}};
  std::vector<TeamTour> mixed;
  mixed.push_back(tour("a", d));
  mixed.push_back(tour("b", motions));
  EXPECT_THAT(refusal_of(std::move(mixed)), HasSubstr("both have legs, or both have motions"));
  EXPECT_THROW(equal_tours(d, 0), InputError);
  EXPECT_THROW(TourProblem(d).with_limits(-1, std::nullopt), InputError);
  EXPECT_THROW(TourProblem(d).with_limits(1, 0), InputError);
}

TEST(TeamProblem, AViewCountsOnceOverAllTours) {
  const TeamProblem team = equal_tours(two_clusters(22), 2);
  const Walks apart{{0, 1, 2, 0}, {0, 3, 4, 0}}, same{{0, 3, 4, 0}, {0, 3, 4, 0}};
  EXPECT_EQ(team.problem_of(apart), "");
  EXPECT_EQ(team.score_of(apart), 18);
  EXPECT_EQ(team.problem_of(same), "");
  EXPECT_EQ(team.score_of(same), 11);
  EXPECT_THAT(team.problem_of({{0, 1, 2, 0}}), HasSubstr("1 walks of 2 tours"));
  EXPECT_THAT(team.problem_of({{0, 1, 2, 0}, {0, 1, 3, 0}}), HasSubstr("tour '2': it takes 40 s"));
  EXPECT_THAT(equal_tours(two_clusters(22), 3).name(2), "3");
  TourDefinition apart_ends = two_clusters(5);
  apart_ends.end = 4;
  EXPECT_THAT(equal_tours(apart_ends, 2).why_infeasible(), HasSubstr("tour '1': a budget of 5 s"));
}

TEST(TeamBounds, HoldForEverySetOfViewsAndAreNotLoose) {
  int close = 0, problems = 0;
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    TourWorldOptions options;
    options.views = 5 + static_cast<int>(seed % 4);
    options.legs = seed % 2 == 0;
    options.loop = seed % 3 != 0;
    options.additive = seed % 5 == 0;
    options.budget_share = 0.1 * static_cast<double>(1 + seed % 6);
    if (seed % 7 == 0) options.image_limit = 3;
    TeamWorld world{"", {random_tour(seed, options)}};
    for (std::uint64_t t = 0; t <= seed % 2; ++t) {
      TourDefinition other = world.tours.front();
      if (seed % 4 == 1 && options.loop) other.start = other.end = 2;
      other.budget *= 1 + 0.5 * static_cast<double>(t);
      world.tours.push_back(other);
    }
    const double best = best_team_score_by_enumeration(world.tours);
    const TeamProblem problem = team_of(world);
    if (best < 0) {
      EXPECT_NE(problem.why_infeasible(), "") << seed;
      continue;
    }
    ++problems;
    Random random(seed);
    for (int trial = 0; trial < 10; ++trial) {
      std::vector<int> set;
      for (int v = 0; v < problem.views(); ++v)
        if (random.uniform() < 0.1 * trial) set.push_back(v);
      EXPECT_GE(team_bound_with(problem, set), best - 1e-5) << seed << ", trial " << trial;
    }
    const double bound = team_upper_bound(problem, WorkingTeam(problem).finished());
    EXPECT_GE(bound, best - 1e-5) << seed;
    close += bound < 1.5 * best;
  }
  EXPECT_GT(problems, 40);
  EXPECT_GT(close, problems / 2);
}

void expect_team_consistent(WorkingTeam& team) {
  const TeamProblem& problem = team.problem();
  Walks walks;
  for (int t = 0; t < team.size(); ++t) {
    const WorkingTour& tour = team.tour(t);
    walks.push_back(tour.walk());
    EXPECT_NEAR(tour.seconds(), problem.tour(t).seconds_of(tour.finished()), 1e-9);
    EXPECT_EQ(tour.images(), TourProblem::images_of(tour.walk()));
  }
  EXPECT_DOUBLE_EQ(team.score(), problem.score_of(walks));
  for (int v = 0; v < problem.views(); ++v) {
    int tours = 0;
    for (int t = 0; t < team.size(); ++t) tours += team.tour(t).visits(v) > 0;
    EXPECT_EQ(team.tour(0).taken(v), tours > 0) << v;
  }
}

TEST(WorkingTeam, ScoreAndViewsAreThoseOfAllTours) {
  for (const TeamWorld& world : team_worlds()) {
    if (world.best < 0) continue;
    SCOPED_TRACE(world.name);
    const TeamProblem problem = team_of(world);
    WorkingTeam team(problem);
    expect_team_consistent(team);
    std::vector<double> known = gains_alone(problem.tour(0));
    const TourRequest request;
    TourWork work(request);
    team.grow_all(known, {.by_ratio = true}, work);
    expect_team_consistent(team);
    EXPECT_EQ(problem.problem_of(team.finished()), "");
    const WorkingTeam kept = team;
    const double score = team.score();
    for (int t = 0; t < team.size(); ++t)
      if (team.tour(t).size() > 2) team.tour(t).take_out(1, 1);
    expect_team_consistent(team);
    EXPECT_EQ(kept.score(), score) << "a copy is a team of its own";
    team = kept;
    expect_team_consistent(team);
    team.shorten();
    expect_team_consistent(team);
    EXPECT_EQ(problem.problem_of(team.finished()), "");
    EXPECT_GE(team.score(), score - 1e-9);
    EXPECT_GE(team.room(), kept.room() - 1e-9);
  }
}

// What each move is for: walks that only it can shorten.
TEST(WorkingTeam, MovesBetweenToursShorten) {
  const TeamProblem team = equal_tours(two_clusters(100), 2);
  const auto shortened = [&](const Walks& walks) {
    WorkingTeam working(team);
    working.become(walks);
    while (working.shorten()) {
    }
    EXPECT_EQ(team.problem_of(working.finished()), "");
    EXPECT_EQ(working.score(), 18);
    return team.tour(0).budget() + team.tour(1).budget() - working.room();
  };
  EXPECT_NEAR(shortened({{0, 1, 3, 4, 0}, {0, 2, 0}}), 44, 1e-3) << "relocate: 22 s to either side";
  EXPECT_NEAR(shortened({{0, 1, 4, 0}, {0, 3, 2, 0}}), 44, 1e-3) << "swap";
}

TEST(WorkingTeam, ABudgetAndALimitOfImagesForbidAMove) {
  const TeamProblem narrow = equal_tours(two_clusters(42), 2);
  WorkingTeam team(narrow);
  team.become({{0, 1, 3, 0}, {0, 2, 0}});
  team.shorten();
  EXPECT_EQ(narrow.problem_of(team.finished()), "");
  TourDefinition d = two_clusters(100);
  d.image_limit = 3;
  const TeamProblem few = equal_tours(d, 2);
  WorkingTeam limited(few);
  limited.become({{0, 1, 4, 0}, {0, 2, 3, 0}});
  limited.shorten();
  EXPECT_EQ(few.problem_of(limited.finished()), "");
}

}  // namespace
}  // namespace lapwing
