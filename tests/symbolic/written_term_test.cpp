// SPDX-License-Identifier: Apache-2.0
// Terms that are recorded without a script: what enters the problem, what the plan states of them,
// and the points at which they are tried.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "framework/symbolic/trial_point.h"
#include "framework/symbolic/written_term.h"
#include "tests/problem/laboratory.h"

namespace lapwing {
namespace {

using laboratory::Pendulum;

const Origin kPlace{"shot.lua", 12};

class Written : public testing::Test {
 protected:
  Written() : problem_(camera_drone(), {.stages = 6, .step = 0.5}) {
    problem_.add_model("pendulum", std::make_unique<Pendulum>());
    problem_.add_block({.name = "target", .size = 3, .unit = "m"});
  }

  static WrittenTerm constraint(double lower, double upper) {
    WrittenTerm term;
    term.kind = WrittenTermKind::constraint;
    term.name = "tried";
    term.lower = {lower};
    term.upper = {upper};
    term.origin = {"shot.lua", 7};
    return term;
  }
  // target.x - q, of which q is the parameter, a window of `window` stages apart.
  SymbolicEntries offset(TermFormula& formula, int stage = 0) {
    SymbolicSetting* setting = &formula.setting();
    const SymbolicScalar x = formula.read(stage, formula.layout().index("target"))[0];
    if (formula.parameters().list.empty()) return {x};
    return {symbolic_result(setting, TapeOp::subtract, x,
                            formula.read(formula.parameters().list[0])[0])};
  }
  std::string refusal(WrittenTerm& term, const SymbolicEntries& rows, TermFormula& formula) {
    try {
      add_written_term(term, formula, rows, kPlace, problem_);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  }

  TrajectoryProblem problem_;
};

TEST_F(Written, ACostIsItsSquaresAndFollowsItsParameter) {
  WrittenTerm term;
  term.name = "tried";
  term.weight = 3;
  term.parameters.list = {{"q", 0, 1, true}};
  *term.parameters.values = {2};
  TermFormula formula(term.what(), problem_, term.parameters, 0);
  add_written_term(term, formula, offset(formula), kPlace, problem_);
  problem_.finish();
  Stages at = problem_.initial_guess();
  at.row(problem_.layout().offset(problem_.layout().index("target"))).setConstant(5);
  EXPECT_NEAR(problem_.cost(at), 3 * 6 * 9, 1e-9);  // at each of six stages (5 - 2)^2
  (*term.parameters.values)[0] = 4;
  EXPECT_NEAR(problem_.cost(at), 3 * 6 * 1, 1e-9);
  EXPECT_EQ(term.shape.written_at, "shot.lua:12: cost 'tried'");
}

TEST_F(Written, APlanStatesAConstraintWithItsParametersAsTheyAre) {
  WrittenTerm term = constraint(-1, std::numeric_limits<double>::infinity());
  term.parameters.list = {{"q", 0, 1, true}};
  *term.parameters.values = {2};
  TermFormula formula(term.what(), problem_, term.parameters, 0);
  add_written_term(term, formula, offset(formula), kPlace, problem_);
  *term.parameters.values = {6};
  const StatedConstraint stated = stated_constraint(term);
  EXPECT_EQ(stated.unjudged, "");
  ASSERT_EQ(stated.operations.size(), 3u);  // the block, the parameter, their difference
  const ConstraintStep& last = stated.operations.back();
  EXPECT_EQ(last.op, ConstraintOp::subtract);
  const ConstraintStep& read = stated.operations[static_cast<std::size_t>(last.operands[0])];
  EXPECT_EQ(read.op, ConstraintOp::input);
  EXPECT_EQ(read.name, "target");
  EXPECT_EQ(read.component, 0);
  const ConstraintStep& known = stated.operations[static_cast<std::size_t>(last.operands[1])];
  EXPECT_EQ(known.op, ConstraintOp::constant);
  EXPECT_EQ(known.number, 6);
  ASSERT_EQ(stated.results.size(), 1u);
  EXPECT_EQ(stated.results[0].operation, 2);
  EXPECT_EQ(stated.results[0].lower, -1);
  EXPECT_FALSE(stated.results[0].upper);
}

TEST_F(Written, WhatPlansDoNotHoldIsSaidThere) {
  WrittenTerm term = constraint(0, 1);
  TermFormula formula(term.what(), problem_, term.parameters, 0);
  add_written_term(term, formula, formula.read(0, formula.layout().index("place")), kPlace,
                   problem_);
  const StatedConstraint stated = stated_constraint(term);
  EXPECT_NE(stated.unjudged.find("it reads 'place'"), std::string::npos) << stated.unjudged;
  EXPECT_TRUE(stated.operations.empty());
}

TEST_F(Written, AConstraintThatIsNotHeldIsStatedAlone) {
  WrittenTerm term = constraint(0, 1);
  term.held = false;
  term.required = false;
  TermFormula formula(term.what(), problem_, term.parameters, 0);
  add_written_term(term, formula, offset(formula), kPlace, problem_);
  problem_.finish();
  for (const Violation& violation : problem_.violations(problem_.initial_guess()))
    EXPECT_NE(violation.name, "tried");
  EXPECT_FALSE(stated_constraint(term).required);
  EXPECT_EQ(stated_constraint(term).operations.size(), 1u);
}

TEST_F(Written, BoundsMustFitTheRows) {
  WrittenTerm term = constraint(0, 1);
  term.upper = {1, 2, 3};
  TermFormula formula(term.what(), problem_, term.parameters, 0);
  const SymbolicEntries two = {offset(formula)[0], offset(formula)[0]};
  const std::string said = refusal(term, two, formula);
  EXPECT_NE(said.find("constraint 'tried': upper has 3 numbers, the function returns 2"),
            std::string::npos)
      << said;
  EXPECT_NE(said.find("shot.lua:7"), std::string::npos) << said;
  term.upper = {1, -1};
  const std::string other = refusal(term, two, formula);
  EXPECT_NE(other.find("lower is above upper in result 2"), std::string::npos) << other;
}

TEST_F(Written, AtGivenTimesThereIsNoNeighbour) {
  WrittenTerm term = constraint(0, 1);
  term.shape.times = {0.5};
  TermFormula formula(term.what(), problem_, term.parameters, 0);
  EXPECT_NE(refusal(term, offset(formula, 2), formula).find("no neighbouring stage"),
            std::string::npos);
  EXPECT_EQ(term.shape.window, 3);
}

TEST_F(Written, ARowWithoutAValueIsRefusedAtTheFunction) {
  WrittenTerm term = constraint(0, 1);
  TermFormula formula(term.what(), problem_, term.parameters, 0);
  const std::string said = refusal(term, {{.value = std::nan("")}}, formula);
  EXPECT_NE(said.find("shot.lua:12"), std::string::npos) << said;
  EXPECT_NE(said.find("no finite number"), std::string::npos) << said;
}

TEST_F(Written, AFixedStepIsAPlainNumberAndAFreeOneIsRead) {
  const TermParameters none;
  TermFormula fixed("cost 'tried'", problem_, none, 0);
  const SymbolicScalar step = fixed.read(0, fixed.layout().index("step"))[0];
  ASSERT_TRUE(step.known());
  EXPECT_EQ(step.value, 0.5);
  const TrajectoryProblem loose(camera_drone(), {.stages = 6, .step = 0.5, .step_free = true});
  TermFormula free("cost 'tried'", loose, none, 0);
  EXPECT_FALSE(free.read(0, free.layout().index("step"))[0].known());
}

TEST_F(Written, ValuesOfTwoRecordingsAreToldApart) {
  const TermParameters none;
  TermFormula one("cost 'one'", problem_, none, 0), other("cost 'other'", problem_, none, 0);
  EXPECT_NE(one.setting().serial, other.setting().serial);
}

class Tried : public Written {
 protected:
  // |target.x|, as recorded.
  Tried() : formula_("cost 'tried'", problem_, parameters_, 0) {
    const SymbolicScalar x = formula_.read(0, formula_.layout().index("target"))[0];
    formula_.compile({symbolic_result(&formula_.setting(), TapeOp::absolute, x)}, kPlace, term_);
  }
  double target(TrialPoint& point) {
    return point.numbers(0, formula_.layout().index("target"))[0];
  }

  TermParameters parameters_;
  TermFormula formula_;
  TapeFunction term_;
};

TEST_F(Tried, AFunctionThatIsTheTapeHasNoDifference) {
  TrialPoint point(formula_);
  std::vector<bool> finite(1, false);
  for (int k = 0; k < TrialPoint::kSeeded; ++k) {
    point.begin(k);
    EXPECT_EQ(difference_at(point, formula_, term_, {{.value = std::abs(target(point))}}, finite),
              "");
  }
  EXPECT_TRUE(finite[0]);
}

TEST_F(Tried, OneThatDecidesByTheSignIsFoundOut) {
  TrialPoint point(formula_);
  std::vector<bool> finite(1, false);
  int found = 0;
  for (int k = 0; k < TrialPoint::kSeeded; ++k) {
    point.begin(k);
    // As if the function had been recorded where the number was positive.
    const std::string difference =
        difference_at(point, formula_, term_, {{.value = target(point)}}, finite);
    EXPECT_EQ(difference.empty(), target(point) >= 0) << difference;
    found += difference.empty() ? 0 : 1;
  }
  EXPECT_GT(found, TrialPoint::kSeeded / 4);
  EXPECT_LT(found, TrialPoint::kSeeded);
}

TEST_F(Tried, OtherNumbersOfRowsAreADifference) {
  TrialPoint point(formula_);
  std::vector<bool> finite(1, false);
  point.begin(3);
  EXPECT_NE(difference_at(point, formula_, term_, {{.value = 1}, {.value = 2}}, finite), "");
  EXPECT_NE(difference_at(point, formula_, term_, {{.value = 0, .node = 4}}, finite), "");
}

TEST_F(Tried, PointsAreTheSameInEveryRunAndTheFirstIsZero) {
  TrialPoint one(formula_), other(formula_);
  one.begin(0);
  EXPECT_EQ(target(one), 0);
  for (int k = 0; k < TrialPoint::kSeeded; ++k) {
    one.begin(k);
    other.begin(k);
    EXPECT_EQ(target(one), target(other)) << k;
    if (k < 8) {
      EXPECT_EQ(target(one), std::round(target(one))) << k;
    }
  }
}

TEST_F(Tried, PointsOfLiteralsAndOfTheGuessAreTheseNumbers) {
  TrialPoint point(formula_);
  point.begin(40, 7.25);
  EXPECT_EQ(target(point), 7.25);
  EXPECT_EQ(point.text(), "target = {7.25 7.25 7.25}");
  problem_.finish();
  Stages guess = problem_.initial_guess();
  const int row = problem_.layout().offset(problem_.layout().index("target"));
  guess(row, 4) = -3;
  point.begin(41, guess, 4);
  EXPECT_EQ(target(point), -3);
  // Neighbours of the last stage are the last stage.
  guess(row, 5) = 9;
  point.begin(42, guess, 5);
  EXPECT_EQ(point.numbers(1, formula_.layout().index("target"))[0], 9);
}

}  // namespace
}  // namespace lapwing
