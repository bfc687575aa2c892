// SPDX-License-Identifier: Apache-2.0
// One real-time iteration of nonlinear predictive control of the whole quadrotor (Diehl, Bock,
// Schloeder, SIAM J. Control Optim. 43(5), 2005) by multiple shooting: states at the ends of all
// stages and the inputs between them are guessed by the last solution, the motion is linearised
// from each of these states, and a quadratic programme in the inputs alone mends both. Where there
// is no guess, and where one is far from the plan, the plan's own states are taken.
//
//   minimise    sum_k h_k (|e_k|^2 + |c_k|^2)  +  terminal |e_N|^2
//   subject to  thrust_min <= u <= thrust_max
//
// e_k: what a state differs from the plan's at its time, over what that is worth; attitudes differ
// by the rotation vector. c_k: what the commands u differ from those that the plan needs, likewise.
//
// With a pace, the time of the plan is a state and its rate an input (Lam, Manzie, Good, CDC 2010,
// whose progress is along a path): a flight that cannot keep up waits instead of cutting corners.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "framework/solve/interior_point.h"
#include "framework/vehicle/body_reference.h"

namespace lapwing {

struct HorizonSettings {
  double length = 0.6;  // s
  int stages = 20;
  double period = 0.01;  // s, the first stage; the others grow evenly
  // Errors that cost as much as each other.
  double position = 0.1;  // m
  double velocity = 1.0;  // m/s
  double attitude = 0.4;  // rad
  double rates = 6;       // rad/s
  double thrust = 0.3;    // of a rotor's largest
  double terminal = 0.1;  // s, that the last error counts for
  bool paced = false;
  double pace = 0.3;  // error of the plan's rate that costs as much
  double slowest = 0.3, quickest = 1.1;
};

// What the vehicle does beside its model.
struct ModelError {
  double thrust = 0;  // share by which thrusts accelerate it more
  Eigen::Vector3d acceleration = Eigen::Vector3d::Zero();  // m/s^2, world
};

struct Prediction {
  std::vector<double> ends;              // s, of each stage from the start of the horizon
  std::vector<Eigen::Vector4d> thrusts;  // N, commanded in each
  std::vector<double> paces;             // rate of the plan's time in each
  std::vector<BodyState> states;         // at the ends
};

class Horizon {
 public:
  // Keeps references.
  Horizon(const Vehicle& vehicle, const BodyReference& reference, const HorizonSettings& settings);

  // Better inputs from `time` (s, of the plan) on for a vehicle in this state; `elapsed`: s since
  // the last call.
  const Prediction& solve(double time, double elapsed, const BodyState& state,
                          const ModelError& error);

  int iterations() const { return iterations_; }
  bool solved() const { return solved_; }

  // For tests: how the states at the ends move with the inputs (thrusts, and the pace, of each
  // stage in turn), where the last call linearised.
  const std::vector<Eigen::MatrixXd>& sensitivities() const { return sensitivities_; }
  void keep_sensitivities() { kept_ = true; }
  void set_prediction(const Prediction& guess) { guess_ = guess; }

  // As the plan asks for at a time of its own; after its end it goes on as it ends.
  BodyPoint wanted(double time) const;
  Eigen::Vector4d fed_forward(double time) const;

 private:
  template <int n>
  const Prediction& solve(double time, const BodyState& state, const ModelError& error);
  void shift(double time, double elapsed, const BodyState& state);
  BodyState planned(double time) const;

  const Vehicle& vehicle_;
  const BodyReference& reference_;
  HorizonSettings s_;
  std::vector<double> lengths_;
  Prediction guess_;
  InteriorPoint solver_;
  QuadraticProgram program_;
  Eigen::MatrixXd hessian_;
  std::vector<Eigen::MatrixXd> sensitivities_;
  int iterations_ = 0;
  bool solved_ = false, kept_ = false;
};

}  // namespace lapwing
