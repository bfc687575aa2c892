// SPDX-License-Identifier: Apache-2.0
// A vehicle model with a motion that the verifier does not know: it brings its derivatives.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "framework/conformance/check.h"
#include "framework/conformance/standard_setting.h"
#include "framework/problem/differentiable.h"
#include "framework/problem/trajectory_problem.h"
#include "framework/trajectory/motion_recorder.h"
#include "framework/verify/verify.h"

namespace lapwing {
namespace {

using testing::HasSubstr;

constexpr double kDrag = 0.4;  // 1/s

// A sled on ice: v' = pull - kDrag v, and a heading that turns at a commanded rate. Position[3],
// yaw, velocity[3]; pull[3] and turn are held.
class Sled final : public DifferentiableModel<Sled, 7, 4> {
 public:
  enum class Mistake { none, no_table, other_drag };
  explicit Sled(Mistake mistake = Mistake::none) : mistake_(mistake) {}

  void bind(const Vehicle&) override {}
  std::vector<BlockSpec> blocks() const override {
    return {{.name = "position", .size = 3, .unit = "m"},
            {.name = "yaw", .unit = "rad"},
            {.name = "velocity", .size = 3, .unit = "m/s"},
            {.name = "pull", .size = 3, .unit = "m/s^2", .role = BlockRole::input},
            {.name = "turn", .unit = "rad/s", .role = BlockRole::input}};
  }
  bool affine() const override { return false; }

  // Exactly: v+ = v e + pull (1 - e) / k with e = exp(-k h).
  template <class T>
  void next_state(const T* state, const T* input, const T& step, T* next) const {
    using std::exp;
    const T e = exp(-kDrag * step), grown = (1.0 - e) * (1 / kDrag);
    for (int i = 0; i < 3; ++i) {
      const T settled = input[i] * (1 / kDrag);
      next[i] = state[i] + settled * step + (state[4 + i] - settled) * grown;
      next[4 + i] = settled + (state[4 + i] - settled) * e;
    }
    next[3] = state[3] + step * input[3];
  }

  void to_sample(const double* x, Sample& sample) const override {
    const Eigen::Vector3d pull(x + 7);
    sample.position = Eigen::Vector3d(x);
    sample.yaw = x[3];
    sample.velocity = Eigen::Vector3d(x + 4);
    sample.acceleration = pull - kDrag * sample.velocity;
    sample.yaw_rate = x[10];
    sample.columns.set("pull", pull);
    sample.columns.set("turn", x[10]);
  }
  void from_sample(const Sample& sample, double* x) const override {
    Eigen::Map<Eigen::Vector3d>(x + 0) = sample.position;
    x[3] = sample.yaw;
    Eigen::Map<Eigen::Vector3d>(x + 4) = sample.velocity;
    Eigen::Map<Eigen::Vector3d>(x + 7) = sample.columns.vector3("pull");
    x[10] = sample.columns.scalar("turn");
  }
  void bounds(double* lower, double* upper) const override {
    std::fill_n(lower, 11, -100.0);
    std::fill_n(upper, 11, 100.0);
  }

  void describe(Trajectory& trajectory) const override {
    trajectory.motion = {.name = "sled",
                         .columns = {{"pull", "m/s^2", 3, true}, {"turn", "rad/s", 1, true}}};
    if (mistake_ == Mistake::no_table) return;
    MotionRecorder motion;
    const double drag = mistake_ == Mistake::other_drag ? 2 * kDrag : kDrag;
    for (int i = 0; i < 3; ++i)
      motion.rate("acceleration", i, motion.input("pull", i) - drag * motion.input("velocity", i));
    motion.rate("yaw_rate", 0, motion.input("turn"));
    trajectory.motion.table = motion.table();
  }

 private:
  Mistake mistake_;
};

// A flight under inputs that change, as its plan.
Plan flown(Sled::Mistake mistake) {
  Vehicle vehicle = standard_vehicle();
  vehicle.gimbal.reset();
  TrajectoryProblem problem(vehicle, {.stages = 21, .step = 0.1});
  problem.add_model("sled", std::make_unique<Sled>(mistake));
  problem.finish();
  Stages at = problem.initial_guess();
  for (int i = 0; i < at.cols(); ++i) {
    at(7, i) = 1.5 * std::cos(0.2 * i);
    at(8, i) = 0.5;
    at(10, i) = 0.3;
  }
  at.col(20).segment(7, 4) = at.col(19).segment(7, 4);
  Plan plan;
  plan.mission = "sled";
  plan.kind = "hop";
  plan.vehicle = to_value(vehicle);
  plan.trajectory = problem.trajectory(problem.simulate(at));
  return plan;
}

TEST(OwnMotion, IsIntegratedFromItsDerivatives) {
  const Plan plan = flown(Sled::Mistake::none);
  EXPECT_GT(plan.trajectory.samples.back().position.norm(), 0.5) << "it moves";
  const Certificate certificate = verify(plan);
  for (const Check& check : certificate.failures()) ADD_FAILURE() << to_line(check);
  EXPECT_THAT(certificate.find("defect_position")->detail,
              HasSubstr("'sled' is integrated from the derivatives that the plan states"));
  EXPECT_THAT(certificate.find("closed_loop")->skipped, HasSubstr("'sled' has no inputs"));
  // From the document alone.
  EXPECT_TRUE(verify(plan_from_value(to_value(plan))).feasible());
}

TEST(OwnMotion, OtherDerivativesThanItsFlowAreFound) {
  const std::vector<Check> failures = verify(flown(Sled::Mistake::other_drag)).failures();
  EXPECT_TRUE(std::any_of(failures.begin(), failures.end(),
                          [](const Check& c) { return c.name == "defect_position"; }));
}

TEST(OwnMotion, WithoutDerivativesItIsRefusedByName) {
  EXPECT_THAT(verify(flown(Sled::Mistake::no_table)).find("document")->detail,
              HasSubstr("the motion 'sled' has no integrator in this version"));
}

TEST(OwnMotion, ConformanceSaysTheSame) {
  const auto failed = [](Sled::Mistake mistake) {
    std::vector<std::string> names;
    for (const CheckResult& result : check_vehicle_model(
             {"sled", {}, [=](const Value&) { return std::make_unique<Sled>(mistake); }}, {}))
      if (result.outcome == Outcome::failed) names.push_back(result.name);
    return names;
  };
  EXPECT_EQ(failed(Sled::Mistake::none), std::vector<std::string>{});
  EXPECT_EQ(failed(Sled::Mistake::no_table), std::vector<std::string>{"motion"});
}

}  // namespace
}  // namespace lapwing
