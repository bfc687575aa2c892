// SPDX-License-Identifier: Apache-2.0
// Names, bounds, violations, guesses and refusals of trajectory problems.
#include "framework/problem/trajectory_problem.h"

#include "framework/core/units.h"
#include "framework/plugin/registry.h"
#include "tests/problem/laboratory.h"

namespace lapwing {
namespace {

using namespace laboratory;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

const Registry& problem_plugins() {
  static const Registry registry({LAPWING_BUILD_DIR "/lib/plugins"});
  return registry;
}

TrajectoryProblem pendulum(Horizon horizon = {.stages = 5, .step = 0.25}) {
  TrajectoryProblem problem(camera_drone(), horizon);
  problem.add_model("pendulum", std::make_unique<Pendulum>());
  return problem;
}

std::string message_of_error(const std::function<void()>& call) {
  try {
    call();
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

void expect_message(const std::function<void()>& call, const std::vector<std::string>& parts) {
  const std::string message = message_of_error(call);
  for (const std::string& part : parts)
    EXPECT_NE(message.find(part), std::string::npos)
        << "'" << message << "' lacks '" << part << "'";
}

const Violation* find(const std::vector<Violation>& violations, const std::string& name) {
  for (const Violation& violation : violations)
    if (violation.name == name) return &violation;
  return nullptr;
}

struct Band final : DifferentiableConstraint<Band> {
  double low, high;
  Band(double l, double h) : low(l), high(h) {}
  FunctionShape declare(const ProblemSetting& setting) {
    return {
        .blocks = setting.layout.indices({"place"}), .rows = 1, .affine = true, .identity = true};
  }
  template <class T>
  void residual(const Stage<T>& stage, Rows<T>& rows) const {
    rows[0] = stage.scalar(0);
  }
  void bounds(InstanceRange range, double* lower, double* upper) const override {
    std::fill_n(lower, range.count, low);
    std::fill_n(upper, range.count, high);
  }
};

struct Read final : DifferentiableConstraint<Read> {
  FunctionShape declare(const ProblemSetting& setting) {
    return {.blocks = setting.layout.indices({"position", "force", "time"}),
            .rows = 3,
            .times = {0.25, 2.0, 2.9, 3.0}};
  }
  template <class T>
  void residual(const Stage<T>& stage, Rows<T>& rows) const {
    rows[0] = stage.data(0)[0];
    rows[1] = stage.data(1)[0];
    rows[2] = stage.scalar(2);
  }
  void bounds(InstanceRange range, double* lower, double* upper) const override {
    std::fill_n(lower, 3 * range.count, -kInfinity);
    std::fill_n(upper, 3 * range.count, kInfinity);
  }
};

TEST(TrajectoryProblem, NamesRowsAndColumns) {
  TrajectoryProblem problem = pendulum();
  problem.add_block({.name = "target", .size = 3});
  problem.add_constraint("near", wavy_constraint({.blocks = {"target"}, .times = {0.3, 1.0}}));
  problem.finish();
  EXPECT_EQ(problem.columns(), 5 * 6);
  EXPECT_EQ(problem.column_name(0), "place at 0 s");
  EXPECT_EQ(problem.column_name(2 * 6 + 4), "target.y at 0.5 s");
  EXPECT_EQ(problem.rows(), 4 * 2 + 1 + 2 * 2);
  EXPECT_EQ(problem.row_name(0), "pendulum.flow.place at 0 s");
  EXPECT_EQ(problem.row_name(7), "pendulum.flow.rate at 0.75 s");
  EXPECT_EQ(problem.row_name(8), "pendulum.held.push at 1 s");
  EXPECT_EQ(problem.row_name(9), "near.0 at 0.3 s");
  EXPECT_EQ(problem.row_name(12), "near.1 at 1 s");
  EXPECT_THROW(problem.row_name(13), Error);
  EXPECT_THROW(problem.column_name(30), Error);
}

TEST(TrajectoryProblem, NamesTheClock) {
  TrajectoryProblem problem = pendulum({.stages = 4, .step = 0.5, .step_free = true});
  problem.finish();
  EXPECT_EQ(problem.row_name(3 * 2 + 1), "clock.time at 0 s");
  EXPECT_EQ(problem.row_name(3 * 2 + 1 + 5), "clock.step at 1 s");
  EXPECT_EQ(problem.column_name(3), "time at 0 s");
  EXPECT_EQ(problem.column_name(9), "step at 0.5 s");
  Stages at = problem.initial_guess();
  at(problem.layout().offset(problem.layout().index("step")), 2) += 0.1;  // unequal steps
  const std::vector<Violation> violations = problem.violations(at);
  const Violation* clock = find(violations, "clock");
  ASSERT_NE(clock, nullptr);
  EXPECT_NEAR(clock->amount, 0.1, 1e-12);
  EXPECT_NE(clock->row.find("clock."), std::string::npos);
  EXPECT_GT(clock->time, 0.4) << "the rows of the third stage are broken, not those of the first";
}

TEST(TrajectoryProblem, IdentitiesBecomeBounds) {
  TrajectoryProblem problem = pendulum();
  problem.add_constraint(
      "inside", wavy_constraint({.blocks = {"push", "place"}, .stages = {1, 3}, .identity = true}));
  problem.finish();
  EXPECT_EQ(problem.rows(), 4 * 2 + 1) << "no rows of its own";
  Stages at = problem.initial_guess();
  at(0, 1) = 0.1;
  LocalModel model;
  problem.linearise(at, model);
  EXPECT_DOUBLE_EQ(model.step_lower(3), -0.6);
  EXPECT_DOUBLE_EQ(model.step_upper(3), 0.15);
  EXPECT_DOUBLE_EQ(model.step_upper(5), 0.25) << "push";
  EXPECT_DOUBLE_EQ(model.step_upper(4), 50) << "the model's own bound";
  EXPECT_DOUBLE_EQ(model.step_upper(6), 50) << "stage 2 is not read";

  at(0, 3) = 1.0;
  const std::vector<Violation> violations = problem.violations(at);
  const Violation* inside = find(violations, "inside");
  ASSERT_NE(inside, nullptr);
  EXPECT_DOUBLE_EQ(inside->amount, 0.75);
  EXPECT_EQ(inside->row, "inside: place at 0.75 s");
  EXPECT_DOUBLE_EQ(inside->time, 0.75);
}

TEST(TrajectoryProblem, TheTightestBoundWinsAndIsBlamed) {
  TrajectoryProblem problem = pendulum();
  problem.add_constraint("wide", std::make_unique<Band>(-1, 4));
  problem.add_constraint("narrow", std::make_unique<Band>(-kInfinity, 2));
  problem.finish();
  Stages at = problem.initial_guess();
  at(0, 2) = 5;
  at(0, 4) = -3;
  const std::vector<Violation> violations = problem.violations(at);
  ASSERT_NE(find(violations, "narrow"), nullptr);
  EXPECT_DOUBLE_EQ(find(violations, "narrow")->amount, 3);
  EXPECT_DOUBLE_EQ(find(violations, "wide")->amount, 2);
  EXPECT_EQ(find(violations, "wide")->row, "wide: place at 1 s");

  TrajectoryProblem broken = pendulum();
  broken.add_constraint("odd", std::make_unique<Band>(std::nan(""), 2));
  EXPECT_THROW(broken.finish(), Error);
}

TEST(TrajectoryProblem, ViolationsNameTheWorstRowAndComeLargestFirst) {
  TrajectoryProblem problem = pendulum();
  problem.add_constraint("bent", wavy_constraint({.blocks = {"place", "rate"}}));
  problem.finish();
  const Stages at = random_point(problem, 3, 2.0);
  const Eigen::VectorXd values = problem.row_values(at);
  double worst_flow = 0, worst_bent = 0;
  std::string flow_row, bent_row;
  for (int r = 0; r < problem.rows(); ++r) {
    const double amount =
        r < 9 ? std::abs(values(r)) : std::max(-0.5 - values(r), values(r) - 0.25);
    double& worst = r < 9 ? worst_flow : worst_bent;
    if (amount > worst) worst = amount, (r < 9 ? flow_row : bent_row) = problem.row_name(r);
  }
  const std::vector<Violation> violations = problem.violations(at);
  ASSERT_GE(violations.size(), 2u);
  for (std::size_t k = 1; k < violations.size(); ++k)
    EXPECT_GE(violations[k - 1].amount, violations[k].amount);
  EXPECT_DOUBLE_EQ(find(violations, "pendulum")->amount, worst_flow);
  EXPECT_EQ(find(violations, "pendulum")->row, flow_row);
  EXPECT_DOUBLE_EQ(find(violations, "bent")->amount, worst_bent);
  EXPECT_EQ(find(violations, "bent")->row, bent_row);
  EXPECT_NE(bent_row.find(" at "), std::string::npos);
}

TEST(TrajectoryProblem, APointThatIsNoNumberIsNeverCalledFeasible) {
  TrajectoryProblem problem = pendulum();
  problem.finish();
  Stages at = problem.initial_guess();
  at(1, 2) = std::nan("");
  const std::vector<Violation> violations = problem.violations(at);
  EXPECT_EQ(violations.front().amount, kInfinity);
}

TEST(TrajectoryProblem, ReusesALocalModelOfAnotherProblem) {
  // Same counts, other places: the pattern has to be replaced, not only filled.
  const auto build = [](std::vector<int> stages) {
    TrajectoryProblem problem = pendulum();
    problem.add_cost("wavy", 1.0, wavy_cost({.blocks = {"place", "rate"}, .stages = stages}));
    problem.finish();
    return problem;
  };
  const TrajectoryProblem first = build({0}), second = build({3});
  LocalModel reused, fresh;
  first.linearise(random_point(first, 1), reused);
  second.linearise(random_point(second, 1), reused);
  second.linearise(random_point(second, 1), fresh);
  EXPECT_EQ(reused.hessian.toDense(), fresh.hessian.toDense());
  EXPECT_EQ(reused.jacobian.toDense(), fresh.jacobian.toDense());
}

TEST(TrajectoryProblem, IntegralsDoNotDependOnTheNumberOfStages) {
  // integral over 2 s of the squared third derivative of t^4 / 24, that is of t^2: 8 / 3.
  double previous = 1;
  for (const int intervals : {20, 80, 320}) {
    TrajectoryProblem problem(camera_drone(), {.stages = intervals + 1, .step = 2.0 / intervals});
    problem.add_model("quadrotor", problem_plugins().create<VehicleModel>("quadrotor"));
    Value parameters = Value::map();
    parameters.set("order", 3);
    problem.add_cost("jerk", 1.0, problem_plugins().create<CostTerm>("derivative", parameters));
    problem.finish();
    Stages at = problem.initial_guess();
    for (int i = 0; i <= intervals; ++i) at(0, i) = std::pow(i * 2.0 / intervals, 4) / 24;
    const double error = std::abs(problem.cost(at) - 8.0 / 3.0);
    EXPECT_LT(error, 0.4 * previous) << intervals;
    previous = error;
  }
  EXPECT_LT(previous, 0.05);
}

TEST(TrajectoryProblem, ReadsKeyframesOffTheFlow) {
  // Constant acceleration: r = t^2 exactly, at any time.
  TrajectoryProblem problem(camera_drone(), {.stages = 4, .step = 1.0});
  problem.add_model("quadrotor", problem_plugins().create<VehicleModel>("quadrotor"));
  problem.add_constraint("read", std::make_unique<Read>());
  problem.finish();
  Stages at = problem.initial_guess();
  const int velocity = problem.layout().offset(problem.layout().index("velocity"));
  const int force = problem.layout().offset(problem.layout().index("force"));
  for (int i = 0; i < 4; ++i) {
    at(0, i) = i * i;
    at(velocity, i) = 2 * i;
    at(force, i) = 2 * 1.5;
  }
  const Eigen::VectorXd values = problem.row_values(at).tail(12);
  const double times[] = {0.25, 2.0, 2.9, 3.0};
  for (int k = 0; k < 4; ++k) {
    EXPECT_NEAR(values(3 * k), times[k] * times[k], 1e-13);
    EXPECT_NEAR(values(3 * k + 1), 3.0, 1e-15);
    EXPECT_NEAR(values(3 * k + 2), times[k], 1e-15);
  }
}

TEST(TrajectoryProblem, GuessesFollowTheirTimes) {
  TrajectoryProblem problem(camera_drone(), {.stages = 5, .step = 1.0});
  problem.add_model("quadrotor", problem_plugins().create<VehicleModel>("quadrotor"));
  problem.add_block({.name = "target", .size = 3});
  problem.add_block({.name = "look", .size = 4, .topology = Topology::quaternion});
  problem.add_block({.name = "other", .size = 4, .topology = Topology::quaternion});
  problem.set_path_guess({1, 3}, {{0, 0, 0}, {4, 0, 2}}, {0, 1});
  problem.set_block_guess("target", {2, 2}, {Eigen::Vector3d(1, 1, 1), Eigen::Vector3d(3, 3, 3)});
  problem.set_block_guess("look", {0, 4},
                          {Eigen::Vector4d(2, 0, 0, 0), Eigen::Vector4d(0, 0, 0, -1)});
  problem.finish();
  const Stages at = problem.initial_guess();
  EXPECT_EQ(at.col(0).head<3>(), Eigen::Vector3d(0, 0, 0));
  EXPECT_EQ(at.col(2).head<3>(), Eigen::Vector3d(2, 0, 1));
  EXPECT_EQ(at.col(4).head<3>(), Eigen::Vector3d(4, 0, 2));
  EXPECT_DOUBLE_EQ(at(4, 1), 2.0) << "velocity follows";
  EXPECT_DOUBLE_EQ(at(10, 0), 1.5 * kGravity) << "hovering force";
  EXPECT_EQ(at(12, 1), 1.0);
  EXPECT_EQ(at(12, 2), 3.0) << "the later of two values at one time";
  for (int i = 0; i < 5; ++i) {  // half a turn about z in four equal parts
    EXPECT_NEAR(std::abs(at(15, i)), std::cos(i * M_PI / 8), 1e-12);
    EXPECT_NEAR(std::abs(at(18, i)), std::sin(i * M_PI / 8), 1e-12);
    EXPECT_EQ(at(19, i), 1.0) << "an orientation without a guess is the identity";
  }
}

TEST(TrajectoryProblem, RefusesWhatMakesNoSense) {
  expect_message([] { pendulum({.stages = 1, .step = 1}); }, {"at least 2 stages"});
  expect_message([] { pendulum({.stages = 3, .step = 0}); }, {"positive step"});
  expect_message([] { pendulum({.stages = 3, .step = kInfinity}); }, {"positive step"});
  expect_message([] { TrajectoryProblem(camera_drone(), {.stages = 3, .step = 1}).finish(); },
                 {"needs a vehicle model"});
  TrajectoryProblem problem = pendulum();
  expect_message([&] { problem.add_cost("smooth", -1, wavy_cost({.blocks = {"place"}})); },
                 {"smooth", "weight"});
  expect_message([&] { problem.add_cost("smooth", kInfinity, wavy_cost({.blocks = {"place"}})); },
                 {"smooth", "weight"});
  expect_message([&] { problem.add_model("again", std::make_unique<Pendulum>()); }, {"'place'"});
  expect_message([&] { problem.set_block_guess("plaice", {0}, {Eigen::VectorXd(1)}); },
                 {"no block 'plaice'", "did you mean 'place'"});
  expect_message(
      [&] {
        problem.set_block_guess("place", {1, 0},
                                {Eigen::VectorXd::Zero(1), Eigen::VectorXd::Zero(1)});
      },
      {"place", "in order"});
  expect_message([&] { problem.set_block_guess("place", {1}, {Eigen::VectorXd::Zero(2)}); },
                 {"place", "needs 1 numbers"});
  expect_message([&] { problem.set_path_guess({0}, {Eigen::Vector3d(0, 0, std::nan(""))}, {0}); },
                 {"path", "finite"});
  expect_message([&] { problem.set_path_guess({0}, {}, {0}); }, {"path", "as many values"});
}

void expect_unfit(const Reading& reading, const std::vector<std::string>& parts,
                  Horizon horizon = {.stages = 5, .step = 0.25}) {
  TrajectoryProblem problem = pendulum(horizon);
  problem.add_constraint("odd", wavy_constraint(reading));
  expect_message([&] { problem.finish(); }, parts);
}

TEST(TrajectoryProblem, NamesTheTermThatDoesNotFit) {
  expect_unfit({.blocks = {"plaice"}}, {"odd: ", "no block 'plaice'"});
  expect_unfit({.blocks = {"place"}, .window = 6}, {"odd: ", "6 neighbouring stages", "has 5"});
  expect_unfit({.blocks = {"place"}, .times = {0.5, 1.1}},
               {"odd: time 1.1 s lies outside the duration of 1 s"});
  expect_unfit({.blocks = {"place"}, .times = {-0.1}}, {"odd: time -0.1 s"});
  expect_unfit({.blocks = {"place"}, .times = {std::nan("")}}, {"odd: time nan s"});
  expect_unfit({.blocks = {"place"}, .window = 2, .times = {0.1}}, {"odd: ", "reads one stage"});
  expect_unfit({.blocks = {"place"}, .stages = {5}}, {"odd: ", "outside the horizon"});
  expect_unfit({.blocks = {}}, {"odd: reads no block"});
  expect_unfit({.blocks = {"place"}, .times = {0.1}}, {"odd: given times need a fixed step"},
               {.stages = 5, .step = 0.25, .step_free = true});
}

TEST(TrajectoryProblem, DoesNotChangeOnceFinished) {
  TrajectoryProblem problem = pendulum();
  problem.finish();
  EXPECT_THROW(problem.finish(), Error);
  EXPECT_THROW(problem.add_cost("late", 1, wavy_cost({.blocks = {"place"}})), Error);
  EXPECT_THROW(problem.add_constraint("late", wavy_constraint({.blocks = {"place"}})), Error);
  EXPECT_THROW(problem.add_block({.name = "late"}), Error);
}

TEST(TrajectoryProblem, AKeyframeAtTheVeryEndSurvivesRounding) {
  // 0.1 is not a binary number: 299 steps of it are not 29.9 exactly.
  TrajectoryProblem problem(camera_drone(), {.stages = 300, .step = 0.1});
  problem.add_model("pendulum", std::make_unique<Pendulum>());
  problem.add_constraint("end", wavy_constraint({.blocks = {"place"}, .times = {29.9, 0.3}}));
  problem.finish();
  EXPECT_EQ(problem.row_name(problem.rows() - 3), "end.1 at 29.9 s");
  EXPECT_EQ(problem.row_name(problem.rows() - 1), "end.1 at 0.3 s");
}

// Flown from its first state and inputs alone, whatever the states said.
TEST(TrajectoryProblem, SimulationMeetsTheDynamics) {
  for (const int round : {0, 1, 2, 3}) {
    const bool step_free = round % 2 == 1;
    TrajectoryProblem problem(camera_drone(), {.stages = 6, .step = 0.2, .step_free = step_free});
    if (round < 2)
      problem.add_model("tumbler", std::make_unique<Tumbler>());
    else
      problem.add_model("pendulum", std::make_unique<Pendulum>());
    problem.add_block({.name = "target", .size = 3, .unit = "m"});
    problem.finish();
    const Stages at = random_point(problem, 7);
    EXPECT_GT(problem.row_values(at).norm(), 0.1);
    const Stages flown = problem.simulate(at);
    EXPECT_LT(problem.row_values(flown).norm(), 1e-12);
    EXPECT_EQ(flown.col(0), at.col(0));
    for (const char* kept : {"push", "target"}) {
      const int offset = problem.layout().offset(problem.layout().index(kept));
      EXPECT_EQ(flown.block(offset, 0, 1, 5), at.block(offset, 0, 1, 5)) << kept;
    }
    EXPECT_EQ(problem.simulate(flown), flown);
  }
}

}  // namespace
}  // namespace lapwing
