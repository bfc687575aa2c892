// SPDX-License-Identifier: Apache-2.0
// Predictive control: its derivatives, its programme, what it finds of its model's errors.
#include <gtest/gtest.h>

#include "framework/core/units.h"
#include "framework/vehicle/closed_loop.h"
#include "framework/vehicle/planned_attitude.h"
#include "framework/vehicle/state_predictor.h"
#include "plugins/controllers/predictive/horizon.h"
#include "plugins/controllers/predictive/observer.h"
#include "tests/verify/reference_plan.h"

namespace lapwing {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;
using Eigen::Vector4d;
using Eigen::VectorXd;

Vehicle quick(double lag) {
  Vehicle vehicle = reference_vehicle();
  vehicle.drag = 0.3;
  vehicle.rotors.lag = lag;
  vehicle.rotors.thrust_max = vehicle.mass * kGravity;
  vehicle.rotors.thrust_min = 0;
  return vehicle;
}

BodyState somewhere(const BodyPoint& p) {
  BodyState state{p.position, p.velocity, p.orientation, p.body_rates, p.rotor_thrusts};
  state.position += Vector3d(0.3, -0.2, 0.1);
  state.velocity += Vector3d(1, 0.5, -0.4);
  state.orientation =
      state.orientation * Quaterniond(Eigen::AngleAxisd(0.4, Vector3d(2, 1, -1).normalized()));
  state.body_rates += Vector3d(2, -3, 1);
  return state;
}

// What a state differs from another one, as the sensitivities count.
VectorXd difference(const BodyState& a, const BodyState& b, int n) {
  VectorXd d(n);
  d.segment<3>(0) = a.position - b.position;
  d.segment<3>(3) = a.velocity - b.velocity;
  d.segment<3>(6) = rotation_vector(b.orientation.conjugate() * a.orientation);
  d.segment<3>(9) = a.body_rates - b.body_rates;
  if (n > 12) d.tail<4>() = a.rotor_thrusts - b.rotor_thrusts;
  return d;
}

TEST(Horizon, StatesMoveWithTheInputsAsItSays) {
  constexpr int kStages = 6;
  for (const double lag : {0.0, 0.03}) {
    const Vehicle vehicle = quick(lag);
    const Trajectory film = reference_plan().trajectory;
    const BodyReference reference(film, vehicle);
    HorizonSettings settings;
    settings.stages = kStages;
    settings.length = kStages * 0.015;
    settings.period = 0.015;
    const BodyState start = somewhere(reference.at(1));
    const ModelError error{0.1, {0.5, -1, 0.2}};
    const RotorBody body(vehicle, 1 / 1.1, 1.1);
    const auto rolled_out = [&](Prediction guess) {
      guess.states.clear();
      BodyState at = start;
      for (int k = 0; k < kStages; ++k) {
        at = body.after(at, guess.thrusts[k], Vector3d::Zero(), 0.015);
        at.velocity += 0.015 * error.acceleration;
        at.position += 0.015 * 0.015 / 2 * error.acceleration;
        guess.states.push_back(at);
      }
      return guess;
    };
    Prediction guess;
    for (int k = 0; k < kStages; ++k) {
      guess.ends.push_back(0.015 * (k + 1));
      guess.paces.push_back(1.0);
      guess.thrusts.push_back(vehicle.mass * kGravity / 4 *
                              Vector4d(1.0 + 0.02 * k, 1.05, 0.95, 1.02 - 0.01 * k));
    }
    Horizon horizon(vehicle, reference, settings);
    horizon.keep_sensitivities();
    horizon.set_prediction(rolled_out(guess));
    horizon.solve(1, 0, start, error);
    const double d = 1e-5;
    const int n = lag > 0 ? 16 : 12;
    for (int stage : {0, 3, 5})
      for (int rotor = 0; rotor < 4; ++rotor) {
        Prediction more = guess, less = guess;
        more.thrusts[stage](rotor) += d;
        less.thrusts[stage](rotor) -= d;
        more = rolled_out(more), less = rolled_out(less);
        for (int k = stage; k < kStages; ++k) {
          const VectorXd rate = difference(more.states[k], less.states[k], n) / (2 * d);
          const VectorXd said = horizon.sensitivities()[k].col(4 * stage + rotor);
          // Each block of three counts by its own size: the linearisation is of second order in
          // the substep.
          for (int block = 0; block < n / 3; ++block)
            EXPECT_LT((rate.segment<3>(3 * block) - said.segment<3>(3 * block)).norm(),
                      0.02 * rate.segment<3>(3 * block).norm() + 1e-4)
                << "lag " << lag << ", stage " << stage << ", rotor " << rotor << ", end " << k
                << ", block " << block << "\n"
                << rate.transpose() << "\n"
                << said.transpose();
        }
      }
  }
}

TEST(Horizon, ComesToRestAtInputsThatItKeeps) {
  const Vehicle vehicle = quick(0.03);
  const Trajectory film = reference_plan().trajectory;
  const BodyReference reference(film, vehicle);
  for (const bool paced : {false, true}) {
    HorizonSettings settings;
    settings.paced = paced;
    Horizon horizon(vehicle, reference, settings);
    const BodyState start = somewhere(reference.at(1));
    Prediction last;
    double change = 0;
    for (int i = 0; i < 30; ++i) {
      const Prediction now = horizon.solve(1, 0, start, {});
      EXPECT_TRUE(horizon.solved());
      change = 0;
      if (i > 0)
        for (std::size_t k = 0; k < now.thrusts.size(); ++k)
          change = std::max(change, (now.thrusts[k] - last.thrusts[k]).lpNorm<Eigen::Infinity>());
      last = now;
      for (const Vector4d& u : now.thrusts) {
        EXPECT_GE(u.minCoeff(), vehicle.rotors.thrust_min);
        EXPECT_LE(u.maxCoeff(), vehicle.rotors.thrust_max);
      }
    }
    EXPECT_LT(change, 1e-3) << paced;
  }
}

TEST(ModelObserver, FindsMassAndWind) {
  Vehicle vehicle = quick(0.03);
  const RotorBody heavy(vehicle, 1.1);
  const Vector3d wind(4, -2, 0);
  ModelObserver observer(vehicle, 8);
  BodyState state;
  const double hover = vehicle.mass * kGravity / 4;
  state.rotor_thrusts.setConstant(hover);
  Vector4d commanded = Vector4d::Constant(hover);
  for (int k = 0; k < 2000; ++k) {
    observer.see(state, commanded, 0.002);
    // Up and down, so that thrust and force can be told apart.
    commanded = Vector4d::Constant(hover * (1.1 + 0.4 * std::sin(0.02 * k)));
    state = heavy.after(state, commanded, wind, 0.002);
  }
  EXPECT_NEAR(observer.thrust(), 1 / 1.1 - 1, 0.02);
  // Drag in the wind, of the true mass; what drag itself differs by the wrong mass is small.
  const Vector3d force = vehicle.drag * wind / (1.1 * vehicle.mass);
  EXPECT_NEAR(observer.acceleration().x(), force.x(), 0.15);
  EXPECT_NEAR(observer.acceleration().y(), force.y(), 0.15);
}

// The state that a late estimate has become, as the simulator moves it.
TEST(StatePredictor, MovesALateEstimateAsTheVehicleMoved) {
  const Vehicle vehicle = quick(0.03);
  const RotorBody body(vehicle);
  const double step = 0.002, hover = vehicle.mass * kGravity / 4;
  const int late = 4, under_way = 3;
  StatePredictor predictor(vehicle, {late * step, under_way * step});
  std::vector<BodyState> states(1);
  states[0].rotor_thrusts.setConstant(hover);
  std::vector<Vector4d> commands;
  const Vector4d first = states[0].rotor_thrusts;
  for (int k = 0; k < 100; ++k) {
    const BodyState known = states[std::max(0, k - late)];
    const BodyState predicted = predictor.predicted(known, step);
    const Vector4d command =
        hover * Vector4d(1 + 0.2 * std::sin(0.1 * k), 1, 1 + 0.1 * std::cos(0.2 * k), 1);
    predictor.sent(command);
    commands.push_back(command);
    // What the vehicle will be when this command arrives.
    BodyState then = states.back();
    for (int i = 0; i < under_way; ++i) {
      const int sent = k + i - under_way;
      then = body.after(then, sent < 0 ? first : commands[sent], Vector3d::Zero(), step);
    }
    if (k > late + under_way) {
      EXPECT_LT((predicted.position - then.position).norm(), 1e-12) << k;
      EXPECT_LT((predicted.rotor_thrusts - then.rotor_thrusts).norm(), 1e-12) << k;
      EXPECT_LT(predicted.orientation.angularDistance(then.orientation), 1e-7) << k;
    }
    states.push_back(body.after(states.back(), k < under_way ? first : commands[k - under_way],
                                Vector3d::Zero(), step));
  }
}

}  // namespace
}  // namespace lapwing
