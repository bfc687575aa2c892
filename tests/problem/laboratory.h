// SPDX-License-Identifier: Apache-2.0
// Models and terms made for tests: nonlinear, with windows, orientations and all the rest.
#pragma once

#include "framework/core/random.h"
#include "framework/problem/differentiable.h"
#include "framework/problem/trajectory_problem.h"
#include "tests/camera_drone.h"

namespace lapwing::laboratory {

// A pendulum that is pushed: nonlinear, on lines.
//   place+ = place + h rate      rate+ = rate + h (push - sin(place) - 0.1 rate^2)
class Pendulum final : public DifferentiableModel<Pendulum, 2, 1> {
 public:
  void bind(const Vehicle&) override {}
  std::vector<BlockSpec> blocks() const override {
    return {{.name = "place", .size = 1, .unit = "m"},
            {.name = "rate", .size = 1, .unit = "m/s"},
            {.name = "push", .size = 1, .unit = "m/s^2", .role = BlockRole::input}};
  }
  bool affine() const override { return false; }
  template <class T>
  void next_state(const T* state, const T* input, const T& step, T* next) const {
    using std::sin;
    next[0] = state[0] + step * state[1];
    next[1] = state[1] + step * (input[0] - sin(state[0]) - 0.1 * state[1] * state[1]);
  }
  void to_sample(const double* numbers, Sample& sample) const override {
    sample.position.x() = numbers[0];
  }
  void from_sample(const Sample& sample, double* numbers) const override {
    numbers[0] = sample.position.x();
    numbers[1] = sample.velocity.x();
    numbers[2] = 0;
  }
  void bounds(double* lower, double* upper) const override {
    std::fill_n(lower, 3, -50.0);
    std::fill_n(upper, 3, 50.0);
  }
  void describe(Trajectory&) const override {}
};

// An orientation that spins, and a place that is pushed along one of its axes.
//   attitude+ = attitude * (1, h spin / 2) normalised      height+ = height + h push (1 -
//   2(x^2+y^2))
class Tumbler final : public DifferentiableModel<Tumbler, 5, 4> {
 public:
  void bind(const Vehicle&) override {}
  std::vector<BlockSpec> blocks() const override {
    return {{.name = "height", .size = 1, .unit = "m"},
            {.name = "attitude", .size = 4, .topology = Topology::quaternion},
            {.name = "spin", .size = 3, .unit = "rad/s", .role = BlockRole::input},
            {.name = "push", .size = 1, .unit = "m/s", .role = BlockRole::input}};
  }
  bool affine() const override { return false; }
  template <class T>
  void next_state(const T* state, const T* input, const T& step, T* next) const {
    using std::sqrt;
    const T* q = state + 1;
    const T x = 0.5 * step * input[0], y = 0.5 * step * input[1], z = 0.5 * step * input[2];
    const T turned[] = {
        q[0] - q[1] * x - q[2] * y - q[3] * z, q[1] + q[0] * x + q[2] * z - q[3] * y,
        q[2] + q[0] * y + q[3] * x - q[1] * z, q[3] + q[0] * z + q[1] * y - q[2] * x};
    const T length = sqrt(turned[0] * turned[0] + turned[1] * turned[1] + turned[2] * turned[2] +
                          turned[3] * turned[3]);
    for (int i = 0; i < 4; ++i) next[1 + i] = turned[i] / length;
    next[0] = state[0] + step * input[3] * (1.0 - 2.0 * (q[1] * q[1] + q[2] * q[2]));
  }
  void to_sample(const double* numbers, Sample& sample) const override {
    sample.position.z() = numbers[0];
    sample.columns.set("orientation",
                       Eigen::Quaterniond(numbers[1], numbers[2], numbers[3], numbers[4]));
  }
  void from_sample(const Sample& sample, double* numbers) const override {
    std::fill_n(numbers, 9, 0.0);
    numbers[0] = sample.position.z();
    numbers[1] = 1.0;
  }
  void bounds(double* lower, double* upper) const override {
    std::fill_n(lower, 9, -std::numeric_limits<double>::infinity());
    std::fill_n(upper, 9, std::numeric_limits<double>::infinity());
  }
  void describe(Trajectory&) const override {}
};

struct Reading {
  std::vector<std::string> blocks;
  int window = 1;
  std::vector<int> stages = {};
  std::vector<double> times = {};
  bool integral = false;
  bool linear = false;    // the residual is a straight function
  bool unsaid = false;    // and the shape does not say so
  bool identity = false;  // the inputs themselves; constraints
};

// A curved (or straight) function of everything it reads, two rows.
template <class Base>
class Wavy final : public DifferentiableFunction<Wavy<Base>, Base, 5> {
 public:
  explicit Wavy(Reading reading) : reading_(std::move(reading)) {}

  FunctionShape declare(const ProblemSetting& setting) {
    FunctionShape shape{.window = reading_.window,
                        .rows = 2,
                        .stages = reading_.stages,
                        .times = reading_.times,
                        .integral = reading_.integral,
                        .affine = (reading_.linear || reading_.identity) && !reading_.unsaid,
                        .identity = reading_.identity};
    size_ = 0;
    for (const std::string& name : reading_.blocks) {
      shape.blocks.push_back(setting.layout.index(name));
      size_ += setting.layout.block(shape.blocks.back()).size;
    }
    if (reading_.identity) shape.rows = size_ * reading_.window;
    rows_ = shape.rows;
    return shape;
  }

  template <class T>
  void residual(const Stage<T>& stage, Rows<T>& rows) const {
    using std::cos, std::sin;
    if (reading_.identity) {
      for (int i = 0; i < rows_; ++i) rows[i] = stage.data(0)[i];
      return;
    }
    T first = 0.1 * (1 + stage.instance()), second = 0.2;
    for (int w = 0; w < reading_.window; ++w)
      for (int i = 0; i < size_; ++i) {
        const T& x = stage[w].data(0)[i];
        first += (0.3 + 0.1 * i - 0.25 * w) * x;
        second += (0.5 - 0.07 * i + 0.1 * w) * (reading_.linear ? x : x * x);
      }
    rows[0] = reading_.linear ? first : sin(first) + 0.1 * second;
    rows[1] = reading_.linear ? second - first : first * cos(0.3 * second);
  }

  void bounds(InstanceRange range, double* lower, double* upper) const {
    for (int k = 0; k < range.count * rows_; ++k) {
      lower[k] = -0.5;
      upper[k] = 0.25;
    }
  }

 private:
  Reading reading_;
  int size_ = 0, rows_ = 0;
};

inline std::unique_ptr<CostTerm> wavy_cost(Reading reading) {
  return std::make_unique<Wavy<CostTerm>>(std::move(reading));
}
inline std::unique_ptr<Constraint> wavy_constraint(Reading reading) {
  return std::make_unique<Wavy<Constraint>>(std::move(reading));
}

// Somewhere around the initial guess.
inline Stages random_point(const TrajectoryProblem& problem, std::uint64_t seed,
                           double size = 0.4) {
  Random random(seed);
  Eigen::VectorXd step(problem.columns());
  for (double& x : step) x = random.uniform(-size, size);
  return problem.retract(problem.initial_guess(), step);
}

inline Eigen::VectorXd random_multipliers(const TrajectoryProblem& problem, std::uint64_t seed) {
  Random random(seed);
  Eigen::VectorXd lambda(problem.rows());
  for (double& x : lambda) x = random.uniform(-1, 1);
  return lambda;
}

}  // namespace lapwing::laboratory
