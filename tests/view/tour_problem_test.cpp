// SPDX-License-Identifier: Apache-2.0
#include "framework/view/tour_problem.h"

#include <cmath>

#include "framework/conformance/tour_worlds.h"
#include "framework/core/error.h"
#include "framework/core/parallel.h"

namespace lapwing {
namespace {

// Five views in a row, 2 s apart, 3 s each, with a score of 1 each.
TourDefinition row(double budget) {
  TourDefinition d;
  d.score = std::make_shared<const ViewScore>(additive_score(std::vector<double>(5, 1)));
  d.view_seconds = {3};
  for (int v = 0; v + 1 < 5; ++v) d.motions.push_back({v, v + 1, 2});
  d.budget = budget;
  return d;
}

std::string refusal(TourDefinition d) {
  try {
    TourProblem problem(std::move(d));
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

bool has(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

TEST(TourProblems, CountSecondsOfMotionsAndViews) {
  const TourProblem problem(row(100));
  const int there_and_back[] = {0, 1, 2, 1, 0};
  // 3 for the start; 1, 2 and 1 again cost 3 each; four motions of 2.
  EXPECT_DOUBLE_EQ(problem.seconds_of(there_and_back), 3 + 9 + 8);
  EXPECT_DOUBLE_EQ(problem.score_of(there_and_back), 3);
  EXPECT_EQ(TourProblem::images_of(there_and_back), 3);
  EXPECT_DOUBLE_EQ(problem.leg(0, 4), 8 + 3 * 3 + 1.5);
  EXPECT_EQ(problem.problem_of(there_and_back), "");
  const int alone[] = {0};
  EXPECT_DOUBLE_EQ(problem.seconds_of(alone), 3);
  EXPECT_EQ(problem.problem_of(alone), "");
}

TEST(TourProblems, TheWayIsTheSameThereAndBack) {
  const TourProblem problem(random_tour(5, {.views = 40}));
  for (int a = 0; a < 40; ++a) {
    for (int b = 0; b < 40; ++b) {
      std::vector<int> there{a}, back{b};
      problem.append_way(a, b, there);
      problem.append_way(b, a, back);
      std::reverse(back.begin(), back.end());
      EXPECT_EQ(there, back);
      EXPECT_EQ(there.back(), b);
    }
  }
}

TEST(TourProblems, ThreadsMaySearchWaysAtOnce) {
  const TourDefinition definition = random_tour(5, {.views = 200});
  const TourProblem one(definition), many(definition);
  std::vector<double> sums(200);
  parallel_for(200, 4, [&](std::size_t v) {
    for (int w = 0; w < 200; ++w) sums[v] += many.leg(w, static_cast<int>(v));
  });
  for (int v = 0; v < 200; ++v) {
    double sum = 0;
    for (int w = 0; w < 200; ++w) sum += one.leg(w, v);
    EXPECT_EQ(sum, sums[v]);
  }
}

TEST(TourProblems, SayWhatIsWrongWithAWalk) {
  const TourProblem problem(row(20));
  const auto wrong = [&](std::vector<int> walk) { return problem.problem_of(walk); };
  EXPECT_TRUE(has(wrong({}), "empty"));
  EXPECT_TRUE(has(wrong({0, 2, 0}), "from view 0 to view 2 there is no motion"));
  EXPECT_TRUE(has(wrong({0, 0}), "no motion"));
  EXPECT_TRUE(has(wrong({1, 0}), "begins"));
  EXPECT_TRUE(has(wrong({0, 1}), "ends"));
  EXPECT_TRUE(has(wrong({0, 9, 0}), "does not exist"));
  EXPECT_TRUE(has(wrong({0, 1, 2, 3, 2, 1, 0}), "of 20 s"));
  TourDefinition few = row(100);
  few.image_limit = 2;
  EXPECT_TRUE(has(TourProblem(few).problem_of(std::vector<int>{0, 1, 2, 1, 0}), "3 images of 2"));
  const TourProblem once(random_tour(3, {.legs = true, .budget_share = 5}));
  EXPECT_TRUE(has(once.problem_of(std::vector<int>{0, 1, 2, 1, 0}), "twice"));
}

TEST(TourProblems, RefuseWhatIsNoProblem) {
  TourDefinition d = row(10);
  d.budget = std::nan("");
  d.start = 7;
  d.motions[1].seconds = -2;
  d.motions[2].b = -1;
  const std::string all = refusal(d);
  EXPECT_TRUE(has(all, "budget")) << all;
  EXPECT_TRUE(has(all, "view 7 does not exist")) << all;
  EXPECT_TRUE(has(all, "motions[1]: takes -2 s")) << all;
  EXPECT_TRUE(has(all, "motions[2]: view -1")) << all;
  d = row(10);
  d.view_seconds = {3, std::nan(""), 3, 3, 3};
  EXPECT_TRUE(has(refusal(d), "view 1 takes"));
  d.view_seconds = {3, 3};
  EXPECT_TRUE(has(refusal(d), "one number or 5"));
  d = row(10);
  d.score = std::make_shared<const ViewScore>();
  EXPECT_TRUE(has(refusal(d), "no views"));
  d = row(10);
  d.legs.assign(25, 1);
  EXPECT_TRUE(has(refusal(d), "not both"));
  d.motions.clear();
  d.legs[1] = 4;
  EXPECT_TRUE(has(refusal(d), "the same in both directions"));
  d.image_limit = 0;
  EXPECT_TRUE(has(refusal(d), "at least 1"));
}

TEST(TourProblems, SayWhyThereIsNoTour) {
  TourDefinition d = row(10);
  d.end = 4;
  EXPECT_TRUE(has(TourProblem(d).why_infeasible(), "too small"));
  d.motions.erase(d.motions.begin() + 1);
  EXPECT_TRUE(has(TourProblem(d).why_infeasible(), "2 of 5 views can be reached"));
  EXPECT_TRUE(TourProblem(d).reachable().empty());
  EXPECT_TRUE(has(TourProblem(row(2.9)).why_infeasible(), "the view at the start alone takes 3 s"));
  // From 0 to 1 and back: 3 + 2 + 3 + 2.
  EXPECT_EQ(TourProblem(row(10)).reachable(), (std::vector<int>{0, 1}));
}

TEST(ViewScores, SaturateAndTakeBackExactly) {
  ViewScoreBuilder builder(2, std::vector<double>{1, 2});
  builder.add_view(std::vector<ViewScore::Contribution>{{1, 1.5F}, {0, 0.75F}});
  builder.add_view(std::vector<ViewScore::Contribution>{{0, 0.5F}, {1, 9.0F}});
  builder.add_view({});
  const ViewScore score = std::move(builder).take();
  ScoreState state(score);
  EXPECT_DOUBLE_EQ(state.gain(0), 2.25);
  state.add(0);
  EXPECT_DOUBLE_EQ(state.score(), 2.25);
  EXPECT_DOUBLE_EQ(state.gain(0), 0);
  EXPECT_DOUBLE_EQ(state.gain(1), 0.75);
  state.add(1);
  EXPECT_DOUBLE_EQ(state.score(), 3);
  EXPECT_DOUBLE_EQ(score.total(), 3);
  EXPECT_DOUBLE_EQ(state.loss(0), 0.5);
  state.remove(0);
  EXPECT_DOUBLE_EQ(state.score(), 2.5);
  EXPECT_DOUBLE_EQ(state.loss(0), 0);
  state.remove(1);
  EXPECT_DOUBLE_EQ(state.score(), 0);
  EXPECT_EQ(state.gain(2), 0);
}

TEST(ViewScores, RefuseWhatIsNoContribution) {
  EXPECT_THROW(ViewScoreBuilder(2, std::vector<double>{1}), InputError);
  EXPECT_THROW(ViewScoreBuilder(1, std::vector<double>{-1}), InputError);
  EXPECT_THROW(additive_score(std::vector<double>{1, std::nan("")}), InputError);
  ViewScoreBuilder builder(3);
  const auto refused = [&](std::vector<ViewScore::Contribution> view) {
    try {
      builder.add_view(view);
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_TRUE(has(refused({{3, 1}}), "voxel 3"));
  EXPECT_TRUE(has(refused({{1, -0.1F}}), "at least 0"));
  EXPECT_TRUE(has(refused({{1, std::nanf("")}}), "finite"));
  EXPECT_TRUE(has(refused({{1, 0.1F}, {1, 0.2F}}), "twice"));
}

TEST(ViewScores, KeepWholeNumbersExact) {
  const std::vector<double> scores{1, 1000003, 77, 0};
  const ViewScore score = additive_score(scores);
  ScoreState state(score);
  for (int v = 0; v < 4; ++v) {
    EXPECT_EQ(state.gain(v), scores[v]);
    state.add(v);
  }
  EXPECT_EQ(state.score(), 1000081);
}

}  // namespace
}  // namespace lapwing
