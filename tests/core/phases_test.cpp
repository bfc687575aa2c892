// SPDX-License-Identifier: Apache-2.0
// What is said of work that has phases: shares never fall, and an estimate is one that came true.
#include "framework/core/phases.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace lapwing {
namespace {

// Flies through a run: each phase with its weight, its seconds, and whether it reports shares.
struct Stage {
  const char* name;
  double weight, seconds;
  bool shares;
};

struct Told {
  double time, left;
};

std::vector<Told> recorded(const std::vector<Stage>& stages, double& end) {
  PhaseTimes times;
  std::vector<Phase> phases;
  for (const Stage& stage : stages) phases.push_back({stage.name, stage.weight});
  times.expect(phases);
  std::vector<Told> told;
  double now = 0, whole = 0;
  for (const Stage& stage : stages) {
    times.begin(stage.name, now);
    double fraction = 0;
    for (int k = 0; k <= 200; ++k) {
      const double at = now + stage.seconds * k / 200;
      times.report(stage.shares ? k / 200.0 : -1, at);
      const auto standing = times.standing(at);
      EXPECT_EQ(standing.phase, stage.name);
      if (standing.fraction) {
        EXPECT_GE(*standing.fraction, fraction);
        fraction = *standing.fraction;
      }
      if (standing.whole) {
        EXPECT_GE(*standing.whole, whole) << stage.name << " " << k;
        EXPECT_LE(*standing.whole, 1);
        whole = *standing.whole;
      }
      if (standing.left) told.push_back({at, *standing.left});
    }
    now += stage.seconds;
  }
  end = now;
  return told;
}

// A scan of a mesh at full size, as it was measured.
const std::vector<Stage> kScan = {{"first flight", 35, 34, true}, {"prior mesh", 30, 40, false},
                                  {"views", 75, 79, true},        {"tour", 15, 13, true},
                                  {"flight", 10, 9, false},       {"certificate", 20, 22, false},
                                  {"files", 5, 4, false}};

TEST(PhaseTimes, WhatIsSaidToBeLeftIsLeft) {
  double end = 0;
  const std::vector<Told> told = recorded(kScan, end);
  ASSERT_GT(told.size(), 200u);
  for (const Told& t : told) EXPECT_NEAR(t.left, end - t.time, 0.3 * (end - t.time) + 8) << t.time;
}

// A machine on which every phase goes at another speed: no estimate is off by more than a fifth of
// the whole, however wrong the weights are.
TEST(PhaseTimes, WeightsThatAreFarOffDoNoGreatHarm) {
  std::vector<Stage> stages = kScan;
  stages[0].seconds = 5;
  stages[1].seconds = 200;
  stages[5].seconds = 3;
  double end = 0;
  const std::vector<Told> told = recorded(stages, end);
  ASSERT_GT(told.size(), 100u);
  for (const Told& t : told)
    EXPECT_LT(t.left - (end - t.time), 0.2 * (t.time + t.left) + 1) << t.time;
}

TEST(PhaseTimes, WithoutWeightsNobodyKnowsTheWhole) {
  PhaseTimes times;
  times.expect({{"search", 0}, {"certificate", 0}});
  times.begin("search", 0);
  times.report(0.5, 10);
  const auto standing = times.standing(10);
  EXPECT_EQ(standing.number, 1);
  EXPECT_EQ(standing.count, 2);
  EXPECT_EQ(standing.fraction, 0.5);
  EXPECT_FALSE(standing.whole);
  EXPECT_FALSE(standing.left);
}

// A film is solved, then judged: how far its certificate is, is not how far the run is.
TEST(PhaseTimes, TheShareOfAnUnexpectedPhaseIsNotTheWhole) {
  PhaseTimes times;
  times.begin("film", 0);
  times.report(-1, 5);
  times.begin("certificate", 10);
  times.report(0.5, 12);
  EXPECT_EQ(times.standing(12).fraction, 0.5);
  EXPECT_FALSE(times.standing(12).whole);
  EXPECT_FALSE(times.standing(12).left);
  // What was told of a first one is not taken back.
  PhaseTimes exploring;
  exploring.begin("exploration", 0);
  exploring.report(0.9, 90);
  EXPECT_EQ(exploring.standing(90).whole, 0.9);
  exploring.begin("certificate", 100);
  exploring.report(0.1, 101);
  EXPECT_EQ(exploring.standing(101).whole, 0.9);
  EXPECT_FALSE(exploring.standing(101).left);
}

// Later phases that are most of the work, and none like them measured.
TEST(PhaseTimes, AGuessOfMostOfTheWorkIsNotTold) {
  PhaseTimes times;
  times.expect({{"look", 1}, {"views", 50}});
  times.begin("look", 0);
  times.report(0.5, 10);
  EXPECT_TRUE(times.standing(10).whole);
  EXPECT_FALSE(times.standing(10).left);
}

TEST(PhaseTimes, WhatComesAgainTakesNothingBack) {
  PhaseTimes times;
  times.expect({{"views", 10}, {"tour", 10}, {"flight", 1}});
  times.begin("views", 0);
  times.begin("tour", 10);
  times.report(0.9, 19);
  const double before = *times.standing(19).whole;
  const auto ended = times.begin("flight", 20);
  ASSERT_TRUE(ended);
  EXPECT_EQ(ended->first, "tour");
  EXPECT_EQ(ended->second, 10);
  const double later = *times.standing(20).whole;
  EXPECT_GE(later, before);
  times.begin("tour", 21);
  times.report(0.01, 22);
  EXPECT_EQ(times.standing(22).number, 0);
  EXPECT_GE(*times.standing(22).whole, later);
  EXPECT_FALSE(times.standing(22).left);
}

TEST(PhaseTimes, AShareThatBeginsAnewTellsNothing) {
  PhaseTimes times;
  times.report(0.8, 10);
  EXPECT_TRUE(times.standing(10).left);
  times.report(0.1, 11);
  const auto standing = times.standing(11);
  EXPECT_FALSE(standing.whole);
  EXPECT_FALSE(standing.left);
  times.report(std::numeric_limits<double>::quiet_NaN(), 12);
  EXPECT_FALSE(times.standing(12).fraction);
}

}  // namespace
}  // namespace lapwing
