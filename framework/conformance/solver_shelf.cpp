// SPDX-License-Identifier: Apache-2.0
#include "framework/conformance/solver_shelf.h"

#include <chrono>
#include <thread>

#include "framework/conformance/standard_setting.h"
#include "framework/problem/differentiable.h"

namespace lapwing {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr int kStages = 11;
constexpr double kStep = 0.2;  // s

// A cart on a rail, pushed: place'' = push, held over a step.
class Cart final : public DifferentiableModel<Cart, 2, 1> {
 public:
  void bind(const Vehicle&) override {}
  std::vector<BlockSpec> blocks() const override {
    return {{.name = "place", .size = 1, .unit = "m"},
            {.name = "rate", .size = 1, .unit = "m/s"},
            {.name = "push", .size = 1, .unit = "m/s^2", .role = BlockRole::input}};
  }
  bool affine() const override { return true; }
  template <class T>
  void next_state(const T* state, const T* input, const T& step, T* next) const {
    next[0] = state[0] + step * state[1] + 0.5 * step * step * input[0];
    next[1] = state[1] + step * input[0];
  }
  void to_sample(const double* numbers, Sample& sample) const override {
    sample.position.x() = numbers[0];
    sample.velocity.x() = numbers[1];
    sample.acceleration.x() = numbers[2];
  }
  void from_sample(const Sample& sample, double* numbers) const override {
    numbers[0] = sample.position.x();
    numbers[1] = sample.velocity.x();
    numbers[2] = 0;
  }
  void bounds(double* lower, double* upper) const override {
    std::fill_n(lower, 3, -kInfinity);
    std::fill_n(upper, 3, kInfinity);
  }
  void describe(Trajectory&) const override {}
};

// block^power - value at some stages (all where none are given), as a cost or within bounds.
struct Reading {
  std::string block;
  double value = 0;
  std::vector<int> stages = {};
  int power = 1;
  double lower = 0, upper = 0;  // of a constraint
  bool as_bound = true;         // of a constraint: on the variable, or a row of its own
};

template <class Base>
class Reader final : public DifferentiableFunction<Reader<Base>, Base, 1> {
 public:
  explicit Reader(Reading reading) : reading_(std::move(reading)) {}
  FunctionShape declare(const ProblemSetting& setting) {
    return {.blocks = {setting.layout.index(reading_.block)},
            .rows = 1,
            .stages = reading_.stages,
            .affine = reading_.power == 1,
            .identity = reading_.as_bound};
  }
  template <class T>
  void residual(const Stage<T>& stage, Rows<T>& rows) const {
    const T& x = stage.scalar(0);
    rows[0] = (reading_.power == 1 ? x : x * x) - reading_.value;
  }
  void bounds(InstanceRange range, double* lower, double* upper) const {
    std::fill_n(lower, range.count, reading_.lower);
    std::fill_n(upper, range.count, reading_.upper);
  }

 private:
  Reading reading_;
};

void cost(TrajectoryProblem& problem, const std::string& name, Reading reading) {
  reading.as_bound = false;
  problem.add_cost(name, 1.0, std::make_unique<Reader<CostTerm>>(std::move(reading)));
}
void hold(TrajectoryProblem& problem, const std::string& name, Reading reading) {
  problem.add_constraint(name, std::make_unique<Reader<Constraint>>(std::move(reading)));
}

TrajectoryProblem cart(double from) {
  TrajectoryProblem problem(standard_vehicle(), {.stages = kStages, .step = kStep});
  problem.add_model("cart", std::make_unique<Cart>());
  problem.set_path_guess({0}, {{from, 0, 0}}, {0});
  return problem;
}

void start_at(TrajectoryProblem& problem, double place) {
  hold(problem, "start_place", {.block = "place", .stages = {0}, .lower = place, .upper = place});
  hold(problem, "start_rate", {.block = "rate", .stages = {0}});
}

std::vector<int> all_but_the_last() {
  std::vector<int> stages;
  for (int i = 0; i + 1 < kStages; ++i) stages.push_back(i);
  return stages;
}

// From rest at 0 to rest at 1 with the least sum of squared pushes: a least-norm solution.
ShelfProblem least_effort() {
  TrajectoryProblem problem = cart(0);
  start_at(problem, 0);
  hold(problem, "finish_place",
       {.block = "place", .stages = {kStages - 1}, .lower = 1, .upper = 1});
  hold(problem, "finish_rate", {.block = "rate", .stages = {kStages - 1}, .as_bound = false});
  cost(problem, "effort", {.block = "push", .stages = all_but_the_last()});
  Eigen::Matrix<double, 2, kStages - 1> reach;  // what each push adds to the last place and rate
  for (int i = 0; i + 1 < kStages; ++i)
    reach.col(i) << kStep * kStep * (kStages - 2 - i + 0.5), kStep;
  const Eigen::Vector2d finish(1, 0);
  const Eigen::Matrix2d gram = reach * reach.transpose();
  return {"least effort", std::move(problem), finish.dot(gram.inverse() * finish)};
}

// As far as |push| <= 1 goes in 2 s: 2 m, of 10 m.
ShelfProblem full_push() {
  TrajectoryProblem problem = cart(0);
  start_at(problem, 0);
  hold(problem, "limits", {.block = "push", .lower = -1, .upper = 1});
  cost(problem, "far", {.block = "place", .value = 10, .stages = {kStages - 1}});
  return {"active bounds", std::move(problem), 64.0};
}

// Wants to be at 1, may not pass 0.5, and begins there.
ShelfProblem wall() {
  TrajectoryProblem problem = cart(0.5);
  start_at(problem, 0.5);
  hold(problem, "wall", {.block = "place", .lower = -kInfinity, .upper = 0.5, .as_bound = false});
  cost(problem, "beyond", {.block = "place", .value = 1});
  return {"active rows", std::move(problem), 0.25 * kStages};
}

ShelfProblem too_far() {
  TrajectoryProblem problem = cart(0);
  start_at(problem, 0);
  hold(problem, "limits", {.block = "push", .lower = -1, .upper = 1});
  hold(problem, "finish",
       {.block = "place", .stages = {kStages - 1}, .lower = 100, .upper = 100, .as_bound = false});
  cost(problem, "effort", {.block = "push"});
  return {"infeasible", std::move(problem), std::nullopt};
}

// The place's square should be 4.
ShelfProblem square_root() {
  TrajectoryProblem problem = cart(1);
  start_at(problem, 1);
  cost(problem, "square", {.block = "place", .value = 4, .stages = {kStages - 1}, .power = 2});
  return {"curved cost", std::move(problem), 0.0, true};
}

// Should be at 0.2, must keep 1 away from 0.
ShelfProblem keep_away() {
  TrajectoryProblem problem = cart(1.5);
  start_at(problem, 1.5);
  cost(problem, "near", {.block = "place", .value = 0.2, .stages = {kStages - 1}});
  hold(problem, "away",
       {.block = "place",
        .stages = {kStages - 1},
        .power = 2,
        .lower = 1,
        .upper = kInfinity,
        .as_bound = false});
  return {"curved constraint", std::move(problem), 0.64, true};
}

// The last place to some power, watched.
class Watched final : public DifferentiableCost<Watched, 1> {
  using Formula = DifferentiableCost<Watched, 1>;

 public:
  Watched(SolverWatch& watch, int power) : watch_(watch), power_(power) {}
  FunctionShape declare(const ProblemSetting& setting) {
    return {.blocks = {setting.layout.index("place")},
            .rows = 1,
            .stages = {kStages - 1},
            .affine = power_ == 1};
  }
  template <class T>
  void residual(const Stage<T>& stage, Rows<T>& rows) const {
    const T& x = stage.scalar(0);
    rows[0] = power_ == 1 ? x : x * x;
  }
  void evaluate(InstanceRange range, const double* inputs, double* values, double* jacobian,
                Workspace& workspace) const override {
    Formula::evaluate(range, inputs, values, jacobian, workspace);
    if (watch_.pause > 0) std::this_thread::sleep_for(std::chrono::duration<double>(watch_.pause));
    if (++watch_.calls == watch_.cancel_after) watch_.token.cancel();
  }

 private:
  SolverWatch& watch_;
  int power_;
};

TrajectoryProblem watched(SolverWatch& watch, int power) {
  TrajectoryProblem problem = cart(100);
  start_at(problem, 100);
  problem.add_cost("watched", 1.0, std::make_unique<Watched>(watch, power));
  problem.finish();
  return problem;
}

}  // namespace

TrajectoryProblem watched_problem(SolverWatch& watch) {
  return watched(watch, 2);
}

TrajectoryProblem watched_quadratic_problem(SolverWatch& watch) {
  return watched(watch, 1);
}

std::vector<ShelfProblem> solver_shelf() {
  std::vector<ShelfProblem> shelf;
  for (const auto make : {least_effort, full_push, wall, too_far, square_root, keep_away})
    shelf.push_back(make());
  add_small_programs(shelf);
  for (ShelfProblem& item : shelf) item.problem.finish();
  return shelf;
}

}  // namespace lapwing
