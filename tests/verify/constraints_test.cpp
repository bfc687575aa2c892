// SPDX-License-Identifier: Apache-2.0
// Constraints that a script states, as the verifier reads them from a plan.
#include <gtest/gtest.h>

#include <limits>

#include "framework/core/json.h"
#include "framework/core/random.h"
#include "framework/problem/tape_operation.h"
#include "framework/verify/constraint_evaluation.h"
#include "framework/verify/verify.h"
#include "tests/verify/reference_plan.h"

namespace lapwing {
namespace {

ConstraintStep input(const char* block, int component, int later = 0) {
  return {.op = ConstraintOp::input, .name = block, .component = component, .later = later};
}
ConstraintStep constant(double number) {
  return {.op = ConstraintOp::constant, .number = number};
}
ConstraintStep of(ConstraintOp op, int a, int b = -1, int c = -1, double number = 0) {
  return {.op = op, .operands = {a, b, c}, .number = number};
}

// x of the position, at most so much.
StatedConstraint west(double upper) {
  return {.name = "west",
          .operations = {input("position", 0)},
          .results = {{.operation = 0, .upper = upper}}};
}

Plan with(StatedConstraint constraint) {
  Plan plan = reference_plan();
  plan.constraints = {std::move(constraint)};
  return plan;
}

Check judged_constraint(const Plan& plan) {
  const Certificate certificate = verify(plan);
  const Check& check = certificate.checks.back();
  EXPECT_EQ(check.name, "constraint \"" + plan.constraints.back().name + "\"");
  return check;
}

// Every operation, on random numbers, against what solvers are given.
TEST(StatedConstraints, EveryOperationGivesWhatTheTapeGives) {
  const std::pair<ConstraintOp, TapeOp> same[] = {
      {ConstraintOp::add, TapeOp::add},           {ConstraintOp::subtract, TapeOp::subtract},
      {ConstraintOp::multiply, TapeOp::multiply}, {ConstraintOp::divide, TapeOp::divide},
      {ConstraintOp::negate, TapeOp::negate},     {ConstraintOp::sin, TapeOp::sin},
      {ConstraintOp::cos, TapeOp::cos},           {ConstraintOp::tan, TapeOp::tan},
      {ConstraintOp::exp, TapeOp::exp},           {ConstraintOp::log, TapeOp::log},
      {ConstraintOp::sqrt, TapeOp::sqrt},         {ConstraintOp::power, TapeOp::power},
      {ConstraintOp::atan2, TapeOp::atan2},       {ConstraintOp::absolute, TapeOp::absolute},
      {ConstraintOp::norm, TapeOp::norm},         {ConstraintOp::maximum, TapeOp::maximum},
      {ConstraintOp::select, TapeOp::select}};
  ASSERT_EQ(std::size(same) + 4, static_cast<std::size_t>(kConstraintOps));
  const Plan plan = reference_plan();
  const std::vector<std::unique_ptr<JudgedShape>> none;
  Random random(7);
  for (const auto& [stated, recorded] : same) {
    ASSERT_EQ(operand_count(stated), operand_count(recorded)) << name_of(stated);
    for (int i = 0; i < 500; ++i) {
      double x[3];
      // Near a kink in every other case; roots and logarithms of what is below 0 are no numbers.
      for (double& number : x) number = (i % 2 ? 0.1 : 10) * random.uniform(-1, 1);
      if (stated == ConstraintOp::norm) x[0] = std::abs(x[0]);
      const bool kink = stated == ConstraintOp::absolute || stated == ConstraintOp::norm ||
                        stated == ConstraintOp::maximum;
      const double number = kink                            ? (i % 3 ? 0.2 : 0.0)
                            : stated == ConstraintOp::power ? 1 + i % 3
                                                            : 0;
      StatedConstraint constraint{.name = "one",
                                  .operations = {constant(x[0]), constant(x[1]), constant(x[2]),
                                                 of(stated, 0, 1, 2, number)},
                                  .results = {{.operation = 3, .upper = 0.0}}};
      ASSERT_EQ(problem_of(constraint, plan), "") << name_of(stated);
      ConstraintEvaluation evaluation(constraint, plan.trajectory, {plan.environment, none});
      double result = 0;
      const ConstraintPoint point;
      evaluation.evaluate({&point, 1}, {&result, 1});
      const double wanted = local_value({recorded, 0, number}, x, {}, 0).value;
      if (std::isnan(wanted))
        EXPECT_TRUE(std::isnan(result)) << name_of(stated) << " of " << x[0];
      else
        EXPECT_NEAR(result, wanted, 1e-12 * (1 + std::abs(wanted)))
            << name_of(stated) << " of " << x[0] << ", " << x[1] << ", " << x[2];
    }
  }
}

TEST(StatedConstraints, ASubjectIsWhereTheTapeHasIt) {
  const Plan plan = reference_plan();
  const Subject& walker = plan.environment.subjects[0];
  const std::vector<std::unique_ptr<JudgedShape>> none;
  for (double time = -1; time < 10; time += 0.13)
    for (int component = 0; component < 3; ++component) {
      const StatedConstraint constraint{.name = "one",
                                        .operations = {constant(time),
                                                       {.op = ConstraintOp::subject,
                                                        .operands = {0},
                                                        .name = "walker",
                                                        .component = component}},
                                        .results = {{.operation = 1, .upper = 0.0}}};
      ConstraintEvaluation evaluation(constraint, plan.trajectory, {plan.environment, none});
      double result = 0;
      const ConstraintPoint point;
      evaluation.evaluate({&point, 1}, {&result, 1});
      const double wanted =
          local_value({TapeOp::track, component, 0}, &time, {.subjects = {walker}, .fields = {}}, 0)
              .value;
      EXPECT_NEAR(result, wanted, 1e-12 * (1 + std::abs(wanted)));
    }
}

TEST(StatedConstraints, OneThatHoldsPassesAndOneThatDoesNotIsNamed) {
  const Plan reference = reference_plan();
  const double farthest = reference.trajectory.samples.back().position.x();
  EXPECT_TRUE(judged_constraint(with(west(farthest + 0.1))).pass);
  const Plan plan = with(west(farthest - 0.5));
  const Check check = judged_constraint(plan);
  EXPECT_FALSE(check.pass);
  EXPECT_TRUE(check.required);
  EXPECT_NEAR(*check.worst, farthest, 1e-3);
  EXPECT_FALSE(verify(plan).feasible());
  EXPECT_EQ(to_line(check).rfind("constraint \"west\" ", 0), 0u) << to_line(check);
}

TEST(StatedConstraints, OneThatIsReportedDoesNotFailThePlan) {
  StatedConstraint constraint = west(-100);
  constraint.required = false;
  const Plan plan = with(constraint);
  EXPECT_FALSE(judged_constraint(plan).pass);
  EXPECT_TRUE(verify(plan).feasible());
}

TEST(StatedConstraints, OneThatCannotBeJudgedIsListedWithTheReason) {
  const Plan plan = with({.name = "level", .unjudged = "of a plugin, not judged independently"});
  EXPECT_EQ(judged_constraint(plan).skipped, "of a plugin, not judged independently");
  EXPECT_TRUE(verify(plan).feasible());
}

// The flight of the reference is fastest at 4 s, where coarse samples have none.
TEST(StatedConstraints, WhatHappensBetweenTwoSamplesCounts) {
  StatedConstraint slow{
      .name = "slow",
      .operations = {input("time", 0), constant(3.95), of(ConstraintOp::subtract, 0, 1),
                     of(ConstraintOp::absolute, 2, -1, -1, 0.0)},
      .results = {{.operation = 3, .lower = 0.04}}};
  const Check check = judged_constraint(with(slow));
  EXPECT_FALSE(check.pass);
  EXPECT_LT(*check.worst, 0.04 - check.tolerance);
  // A value that is at its bound at the samples and bends evenly beyond it holds.
  Plan plan = reference_plan();
  double highest = -1e9;
  for (const Sample& s : plan.trajectory.samples) highest = std::max(highest, s.velocity.x());
  plan.constraints = {{.name = "fast",
                       .operations = {input("velocity", 0)},
                       .results = {{.operation = 0, .upper = highest}}}};
  EXPECT_TRUE(judged_constraint(plan).pass);
}

TEST(StatedConstraints, ItIsAskedInItsSpansAndAtItsTimesAlone) {
  const Plan reference = reference_plan();
  const double middle = reference.trajectory.samples[40].position.x();
  StatedConstraint constraint = west(middle + 0.01);
  constraint.spans = {{0, 4}};
  EXPECT_TRUE(judged_constraint(with(constraint)).pass);
  constraint.spans = {{0, 4.5}};
  EXPECT_FALSE(judged_constraint(with(constraint)).pass);
  constraint.except = {{3.9, 5}};
  EXPECT_TRUE(judged_constraint(with(constraint)).pass);
  constraint = west(middle + 0.01);
  constraint.times = {1.03, 4.0};
  EXPECT_TRUE(judged_constraint(with(constraint)).pass);
  constraint.times = {4.2};
  const Check late = judged_constraint(with(constraint));
  EXPECT_FALSE(late.pass);
  EXPECT_DOUBLE_EQ(late.at, 4.2);
  constraint.times.clear();
  constraint.spans = {{100, 200}};
  EXPECT_NE(judged_constraint(with(constraint)).skipped, "");
}

TEST(StatedConstraints, NeighbouringSamplesAreRead) {
  StatedConstraint slope{.name = "slope",
                         .operations = {input("position", 0), input("position", 0, 1),
                                        of(ConstraintOp::subtract, 1, 0), input("step", 0),
                                        of(ConstraintOp::divide, 2, 3)},
                         .results = {{.operation = 4, .lower = -0.1, .upper = 20.0}}};
  EXPECT_TRUE(judged_constraint(with(slope)).pass);
  slope.results[0].upper = 1.0;
  EXPECT_FALSE(judged_constraint(with(slope)).pass);
}

TEST(StatedConstraints, WhatIsNoNumberFails) {
  StatedConstraint constraint{
      .name = "root",
      .operations = {input("position", 0), constant(-1e6), of(ConstraintOp::add, 0, 1),
                     of(ConstraintOp::sqrt, 2)},
      .results = {{.operation = 3, .upper = 1.0}}};
  const Check check = judged_constraint(with(constraint));
  EXPECT_FALSE(check.pass);
  EXPECT_EQ(check.detail, "not a finite number");
}

// Each is broken in one place: the document fails and says where, and nothing else is judged.
TEST(StatedConstraints, CorruptOperationsAreRefusedByName) {
  const double none = std::numeric_limits<double>::quiet_NaN();
  const auto refused = [](StatedConstraint constraint, const std::string& fragment) {
    const Certificate certificate = verify(with(std::move(constraint)));
    EXPECT_FALSE(certificate.checks[0].pass) << fragment;
    EXPECT_NE(certificate.checks[0].detail.find(fragment), std::string::npos)
        << certificate.checks[0].detail;
    EXPECT_NE(certificate.checks.back().skipped, "");
  };
  StatedConstraint broken = west(4);
  broken.operations.push_back(of(ConstraintOp::sin, 2));
  refused(broken, "operation 1 reads operation 2, which is not before it");
  broken = west(4);
  broken.operations.push_back(of(ConstraintOp::add, 0));
  refused(broken, "operation 1 reads operation -1");
  broken = west(4);
  broken.operations.push_back({.op = static_cast<ConstraintOp>(77)});
  refused(broken, "operation 1 is unknown");
  broken = west(4);
  broken.operations.push_back(constant(none));
  refused(broken, "holds a number that is not finite");
  broken = west(4);
  broken.operations[0].name = "thrust_rates";
  refused(broken, "'thrust_rates', which the motion does not have");
  broken = west(4);
  broken.operations[0].component = 3;
  refused(broken, "component 3");
  broken = west(4);
  broken.operations[0].later = -1;
  refused(broken, "a sample -1 later");
  broken = west(4);
  broken.results[0].operation = 9;
  refused(broken, "result 0 is of operation 9, which does not exist");
  refused(west(none), "has a bound that is not finite");
  broken = west(4);
  broken.results[0].lower = 5;
  refused(broken, "its lower bound above its upper one");
  broken = west(4);
  broken.results.clear();
  refused(broken, "has no result");
  broken = west(4);
  broken.operations.resize(StatedConstraint::kMostOperations + 1, constant(1));
  refused(broken, "more than 100000");
  broken = west(4);
  broken.operations.resize(StatedConstraint::kMostOperations, constant(1));
  broken.operations.push_back(constant(1));
  broken.operations.pop_back();
  Plan huge = with(broken);
  huge.constraints.resize(200, broken);
  for (std::size_t i = 0; i < huge.constraints.size(); ++i)
    huge.constraints[i].name = std::to_string(i);
  EXPECT_FALSE(verify(huge).checks[0].pass);
  broken = west(4);
  broken.operations.push_back(
      {.op = ConstraintOp::subject, .operands = {0}, .name = "nobody", .component = 0});
  refused(broken, "the subject 'nobody'");
  broken = west(4);
  broken.operations.push_back(
      {.op = ConstraintOp::distance, .operands = {0, 0, 0}, .number = 5, .component = 99});
  refused(broken, "measures to obstacle 99, which the environment lacks");
  broken = west(4);
  broken.spans = {{4, 2}};
  refused(broken, "ends before it begins");
  Plan twice = with(west(4));
  twice.constraints.push_back(west(5));
  EXPECT_NE(verify(twice).checks[0].detail.find("two constraints are named 'west'"),
            std::string::npos);
}

TEST(StatedConstraints, ADocumentHoldsThemAndOlderOnesHaveNone) {
  const Plan plain = reference_plan();
  EXPECT_EQ(to_value(plain).find("constraints"), nullptr);
  EXPECT_TRUE(plan_from_value(to_value(plain)).constraints.empty());
  StatedConstraint all = west(4);
  all.operations.push_back(
      {.op = ConstraintOp::subject, .operands = {0}, .name = "walker", .component = 2});
  all.operations.push_back(of(ConstraintOp::maximum, 0, 1, -1, 0.25));
  all.operations.push_back(of(ConstraintOp::power, 2, -1, -1, 1.5));
  all.operations.push_back(
      {.op = ConstraintOp::distance, .operands = {0, 1, 2}, .number = 7, .component = 3});
  all.results.push_back({.operation = 4, .lower = 0.5});
  all.times = {1, 2};
  Plan plan = with(all);
  plan.constraints.push_back({.name = "level", .required = false, .unjudged = "of a plugin"});
  const std::string text = plan_text(plan);
  EXPECT_EQ(plan_text(plan_from_value(from_json(text, "plan"))), text);
}

TEST(StatedConstraints, ADocumentThatIsMalformedIsRefusedWithItsKey) {
  const std::string text = plan_text(with(west(4)));
  const auto refused = [&](const std::string& from, const std::string& to,
                           const std::string& fragment) {
    std::string broken = text;
    const std::size_t at = broken.find(from, broken.find("\"constraints\""));
    ASSERT_NE(at, std::string::npos) << from;
    broken.replace(at, from.size(), to);
    try {
      plan_from_value(from_json(broken, "plan"));
      ADD_FAILURE() << to << " was read";
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find(fragment), std::string::npos) << error.what();
    }
  };
  refused("\"input\"", "\"inputt\"", "constraints[1].operations[1].op");
  refused("\"op\": \"input\"", "\"op\": \"add\", \"of\": [0]", "constraints[1].operations[1].of");
  refused("\"op\": \"input\"", "\"op\": \"add\", \"of\": [0, 0.5]",
          "constraints[1].operations[1].of");
  refused("\"later\": 0", "\"later\": 64", "constraints[1].operations[1].later");
  refused("\"upper\": 4.0", "\"uper\": 4.0", "uper");
  refused("\"required\": true", "\"required\": 1", "constraints[1].required");
}

// Where there is no flight there is nothing that could meet it.
TEST(StatedConstraints, ATimeOutsideTheFlightFails) {
  const double end = reference_plan().trajectory.duration();
  StatedConstraint constraint = west(1e6);
  constraint.times = {end};
  EXPECT_TRUE(judged_constraint(with(constraint)).pass);
  constraint.times = {end + 1e-7};  // rounding
  EXPECT_TRUE(judged_constraint(with(constraint)).pass);
  for (const double time : {end + 1e-3, end + 100}) {  // the document refuses times below 0
    constraint.times = {1, time};
    const Certificate certificate = verify(with(constraint));
    const Check& check = certificate.checks.back();
    EXPECT_FALSE(check.pass) << time;
    EXPECT_TRUE(check.skipped.empty()) << time;
    EXPECT_EQ(check.at, time);
    EXPECT_NE(check.detail.find("and the flight lasts from 0 to"), std::string::npos)
        << check.detail;
    EXPECT_FALSE(certificate.feasible()) << time;
  }
}

}  // namespace
}  // namespace lapwing
