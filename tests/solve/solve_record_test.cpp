// SPDX-License-Identifier: Apache-2.0
// What solvers keep and say of a solve, and how a wrong answer is told.
#include "framework/solve/solve_record.h"

#include <cmath>
#include <functional>
#include <limits>
#include <thread>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "framework/core/json.h"
#include "tests/problem/laboratory.h"

namespace lapwing {
namespace {

using namespace laboratory;

constexpr double kNowhere = std::numeric_limits<double>::infinity();

TrajectoryProblem swung(bool constrained = true) {
  TrajectoryProblem problem(camera_drone(), {.stages = 5, .step = 0.25});
  problem.add_model("pendulum", std::make_unique<Pendulum>());
  problem.add_cost("calm", 2.0, wavy_cost({.blocks = {"place"}, .linear = true}));
  problem.add_cost("bent", 0.5, wavy_cost({.blocks = {"rate", "push"}}));
  if (constrained) problem.add_constraint("near", wavy_constraint({.blocks = {"place", "rate"}}));
  problem.finish();
  return problem;
}

TEST(SolveRecord, StartsWarmOnlyWhereThePointFits) {
  const TrajectoryProblem problem = swung();
  const Stages point = random_point(problem, 1);
  SolveRequest request;
  const SolveRecord cold(problem, request);
  EXPECT_EQ(cold.start(), problem.initial_guess());
  EXPECT_FALSE(cold.warm_multipliers());
  request.warm_start = WarmStart{point, Eigen::VectorXd::Zero(problem.rows()),
                                 Eigen::VectorXd::Zero(problem.columns())};
  const SolveRecord warm(problem, request);
  EXPECT_EQ(warm.start(), point);
  EXPECT_TRUE(warm.warm_multipliers());
  const auto changed = [&](const std::function<void(WarmStart&)>& change) {
    SolveRequest other = request;
    change(*other.warm_start);
    const SolveRecord record(problem, other);
    return std::pair(record.start() == point, record.warm_multipliers());
  };
  using Fits = std::pair<bool, bool>;
  EXPECT_EQ(changed([](WarmStart& w) { w.stages.conservativeResize(w.stages.rows(), 4); }),
            Fits(false, true));
  EXPECT_EQ(changed([](WarmStart& w) { w.stages.conservativeResize(w.stages.rows() + 1, 5); }),
            Fits(false, true));
  EXPECT_EQ(changed([](WarmStart& w) { w.stages(1, 3) = kNowhere; }), Fits(false, true));
  EXPECT_EQ(changed([](WarmStart& w) { w.row_multipliers.conservativeResize(2); }),
            Fits(true, false));
  EXPECT_EQ(changed([](WarmStart& w) { w.bound_multipliers.resize(0); }), Fits(true, false));
}

TEST(SolveRecord, StopsForCancellationBeforeTheClock) {
  const TrajectoryProblem problem = swung();
  CancellationToken token;
  SolveRequest request;
  request.cancellation = &token;
  const SolveRecord free(problem, request);
  EXPECT_FALSE(free.stopped());
  request.wall_clock_guard = 1e-9;
  std::this_thread::sleep_for(std::chrono::milliseconds(1));
  EXPECT_EQ(free.stopped(), SolveStatus::time_limit);
  token.cancel();
  EXPECT_EQ(free.stopped(), SolveStatus::cancelled);
  EXPECT_GT(free.seconds(), 0);
}

TEST(SolveRecord, HistoryAndReportAreThoseOfTheProblem) {
  const TrajectoryProblem problem = swung();
  const SolveRequest request;
  SolveRecord record(problem, request);
  const Stages first = random_point(problem, 2), second = random_point(problem, 3);
  record.add(first, 1.0);
  record.add(second, 0.25);
  EXPECT_EQ(record.latest().iteration, 1);
  EXPECT_EQ(record.latest().step, 0.25);
  EXPECT_NEAR(record.latest().cost, problem.cost(second), 1e-12);
  const SolveResult result =
      record.finish(SolveStatus::feasible, "stopped early", 7, WarmStart{second, {}, {}});
  const SolveReport& report = result.report;
  EXPECT_EQ(report.status, SolveStatus::feasible);
  EXPECT_EQ(report.message, "stopped early");
  EXPECT_EQ(report.iterations, 7);
  EXPECT_EQ(result.point.stages, second);
  ASSERT_EQ(report.history.size(), 2u);
  ASSERT_EQ(report.terms.size(), 2u);
  EXPECT_EQ(report.terms[0].name, "calm");
  EXPECT_DOUBLE_EQ(report.terms[0].cost, 2.0 * report.terms[0].unweighted);
  EXPECT_DOUBLE_EQ(report.terms[1].cost, 0.5 * report.terms[1].unweighted);
  EXPECT_NEAR(report.cost, report.terms[0].cost + report.terms[1].cost, 1e-12);
  EXPECT_NEAR(report.history[0].cost, problem.cost(first), 1e-12);
  EXPECT_DOUBLE_EQ(report.history[1].violation, report.violations.front().amount);
  ASSERT_EQ(report.history[1].terms.size(), 2u);
  EXPECT_EQ(report.history[1].terms[1], report.terms[1].cost);
}

// The largest violation of a row against one written out, and none where rows hold.
TEST(SolveRecord, TheWorstRowIsFoundOnBothSides) {
  LocalModel model;
  model.row_lower = Eigen::Vector4d(0, -kNowhere, 2, -1);
  model.row_upper = Eigen::Vector4d(1, 3, 2, kNowhere);
  const auto worst = [&](double a, double b, double c, double d) {
    return worst_row_violation(model, Eigen::Vector4d(a, b, c, d));
  };
  EXPECT_EQ(worst(0.5, -1e9, 2, 1e9), 0);
  EXPECT_EQ(worst(-0.5, 0, 2, 0), 0.5);
  EXPECT_EQ(worst(1.25, 5, 2.5, 0), 2);
  EXPECT_EQ(worst(0, 0, 2, -4), 3);
  model.row_lower.resize(0);
  model.row_upper.resize(0);
  EXPECT_EQ(worst_row_violation(model, Eigen::VectorXd(0)), 0);
}

TEST(SolveRecord, SaysWhatIsMissed) {
  EXPECT_EQ(say_missed({}), "");
  EXPECT_EQ(say_missed({{"near", "near.x at 1 s", 0.0, 1}}), "");
  EXPECT_EQ(say_missed({{"near", "near.x at 1 s", 2.34567, 1}, {"far", "far", 1, 1}}),
            "near.x at 1 s is violated by 2.346");
  EXPECT_EQ(say_missed({{"near", "near.x at 1 s", std::nan(""), 1}}), "");
}

// A constraint on the place that asks for the impossible, or for little enough.
struct Between final : DifferentiableConstraint<Between> {
  double low, high;
  bool bound;  // as a bound on the variable, or as a row
  Between(double l, double h, bool b) : low(l), high(h), bound(b) {}
  FunctionShape declare(const ProblemSetting& setting) {
    return {.blocks = setting.layout.indices({"place"}),
            .rows = 1,
            .stages = {2},
            .affine = true,
            .identity = bound};
  }
  template <class T>
  void residual(const Stage<T>& stage, Rows<T>& rows) const {
    rows[0] = stage.scalar(0);
  }
  void bounds(InstanceRange, double* lower, double* upper) const override {
    *lower = low;
    *upper = high;
  }
};

TEST(SolveRecord, SaysWhichLimitsCross) {
  const auto said = [](double low, double high, bool bound) {
    TrajectoryProblem problem(camera_drone(), {.stages = 5, .step = 0.25});
    problem.add_model("pendulum", std::make_unique<Pendulum>());
    problem.add_constraint("between", std::make_unique<Between>(low, high, bound));
    problem.finish();
    LocalModel model;
    problem.linearise(problem.initial_guess(), model);
    return say_crossed(problem, model);
  };
  for (const bool bound : {false, true}) {
    EXPECT_EQ(said(1, 2, bound), "");
    EXPECT_EQ(said(2, 2, bound), "");
    const std::string message = said(3, 2, bound);
    EXPECT_NE(message.find("between"), std::string::npos) << message;
    EXPECT_NE(message.find("at 0.5 s must be at least 3 and at most 2"), std::string::npos)
        << message;
  }
}

TEST(SolveRecord, TheDocumentHoldsNoClock) {
  const TrajectoryProblem problem = swung();
  const SolveRequest request;
  SolveRecord record(problem, request);
  const Stages at = random_point(problem, 4);
  record.add(at, 1.0);
  SolveResult result = record.finish(SolveStatus::optimal, "", 3, WarmStart{at, {}, {}});
  const Value value = to_value(result.report, "iqp");
  result.report.seconds += 100;
  EXPECT_EQ(to_json(value), to_json(to_value(result.report, "iqp")));
  const auto at_of = [](const Value& map, const char* key) -> const Value& {
    return *map.find(key);
  };
  EXPECT_EQ(at_of(value, "name").as_text(), "iqp");
  EXPECT_EQ(at_of(value, "status").as_text(), "optimal");
  EXPECT_EQ(value.find("message"), nullptr) << "an empty message is left out";
  const Value& line = at_of(value, "history").as_list().front();
  EXPECT_EQ(at_of(at_of(line, "terms"), "bent").as_number(), result.report.terms[1].cost);
  EXPECT_EQ(at_of(value, "violations").as_list().size(), result.report.violations.size());
}

TEST(SolveStatuses, HaveNamesOfTheirOwn) {
  std::vector<std::string> names;
  for (int k = 0; k <= static_cast<int>(SolveStatus::numerical_error); ++k)
    names.emplace_back(to_string(static_cast<SolveStatus>(k)));
  for (std::size_t a = 0; a < names.size(); ++a)
    for (std::size_t b = 0; b < a; ++b) EXPECT_NE(names[a], names[b]);
  EXPECT_EQ(names.front(), "optimal");
  EXPECT_EQ(names.back(), "numerical_error");
}

// Answers what it was told to.
class Fixed final : public TrajectorySolver {
 public:
  explicit Fixed(SolveResult answer) : answer_(std::move(answer)) {}
  SolveResult solve(const TrajectoryProblem&, const SolveRequest&) const override {
    return answer_;
  }

 private:
  SolveResult answer_;
};

TEST(SolveBy, RefusesEveryAnswerThatIsNone) {
  const TrajectoryProblem problem = swung();
  SolveResult good;
  good.report.status = SolveStatus::optimal;
  good.report.terms = {{"calm", 1, 0.5}, {"bent", 2, 4}};
  good.report.violations = {{"near", "near.x", 0, 0.25}};
  good.report.history = {{0, 3, 0, 1, {1, 2}}};
  good.point.stages = problem.initial_guess();
  const auto said = [&](const std::function<void(SolveResult&)>& spoil) -> std::string {
    SolveResult answer = good;
    spoil(answer);
    try {
      solve_by(Fixed(answer), problem, {});
    } catch (const PluginError& error) {
      return error.what();
    }
    return "";
  };
  const double nan = std::nan("");
  EXPECT_EQ(said([](SolveResult&) {}), "");
  EXPECT_EQ(said([](SolveResult& r) {
              r.report.status = SolveStatus::unsupported;
              r.point.stages.resize(0, 0);
            }),
            "")
      << "a solver that does not take a problem has no point";
  const std::vector<std::pair<std::string, std::function<void(SolveResult&)>>> mistakes = {
      {"its point is not the problem's", [](SolveResult& r) { r.point.stages.resize(0, 0); }},
      {"its point is not the problem's",
       [](SolveResult& r) {
         r.report.status = SolveStatus::infeasible;
         r.point.stages.conservativeResize(r.point.stages.rows(), 4);
       }},
      {"'rate' of stage 3 is not a finite number",
       [&](SolveResult& r) { r.point.stages(1, 3) = nan; }},
      {"'push' of stage 4 is not a finite number",
       [&](SolveResult& r) { r.point.stages(2, 4) = -kNowhere; }},
      {"its cost is not a finite number", [&](SolveResult& r) { r.report.cost = nan; }},
      {"the cost of 'bent' is not finite",
       [&](SolveResult& r) { r.report.terms[1].cost = kNowhere; }},
      {"the violation of 'near' is not finite",
       [&](SolveResult& r) { r.report.violations[0].amount = nan; }},
      {"the violation of 'near' is not finite",
       [&](SolveResult& r) { r.report.violations[0].time = kNowhere; }},
      {"iteration 0 of its history is not finite",
       [&](SolveResult& r) { r.report.history[0].step = nan; }},
      {"iteration 0 of its history is not finite",
       [&](SolveResult& r) { r.report.history[0].terms[1] = nan; }},
      {"iteration 0 of its history has more terms than the report",
       [](SolveResult& r) { r.report.history[0].terms.push_back(1); }}};
  for (const auto& [part, spoil] : mistakes) {
    const std::string message = said(spoil);
    EXPECT_NE(message.find(part), std::string::npos)
        << "'" << message << "' lacks '" << part << "'";
    EXPECT_NE(message.find("it reports '"), std::string::npos) << message;
  }
}

}  // namespace
}  // namespace lapwing
