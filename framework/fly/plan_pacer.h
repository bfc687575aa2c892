// SPDX-License-Identifier: Apache-2.0
// The pace at which a plan is flown: paused, resumed and stopped along its own path, within the
// limits of the vehicle.
//
// The plan's time s passes at the rate r = ds/dt, 0 to 1, which changes by q = dr/dt. A plan p(s)
// gives the setpoint
//
//   position p, velocity p' r, acceleration p'' r^2 + p' q, yaw rate yaw' r
//
// so that every place lies on the certified path. Speeds are never above those of the plan. Of the
// changes of pace, that next to the wanted one is taken whose acceleration and thrust stay within
// the limits of the vehicle, or at those of the plan itself where it is at a limit already: then
// the brake waits. A stop takes half of the acceleration across that the vehicle has. q changes, at
// the ends of a change of pace too, by no more than a jerk |p'| dq/dt that reaches that brake in
// 0.4 s, or half of the vehicle's jerk, unless the limits of acceleration ask for more.
#pragma once

#include <Eigen/Core>

#include "framework/trajectory/trajectory.h"
#include "framework/vehicle/vehicle.h"

namespace lapwing {

struct Setpoint {
  double plan_time = 0;                                    // s of the plan
  double rate = 0;                                         // s of the plan per s
  Eigen::Vector3d position = Eigen::Vector3d::Zero();      // m, world
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();      // m/s, world
  Eigen::Vector3d acceleration = Eigen::Vector3d::Zero();  // m/s^2, world
  double yaw = 0, yaw_rate = 0;                            // rad, rad/s, of the world
  double gimbal_yaw = 0, gimbal_pitch = 0;                 // rad; where the plan has a gimbal
  Eigen::Vector3d target = Eigen::Vector3d::Zero();        // m, world; where the plan has targets
};

class PlanPacer {
 public:
  // Keeps references. At the plan's start: at full pace where the plan begins at rest, else
  // standing there, to gather way along the path.
  PlanPacer(const Trajectory& trajectory, const Vehicle& vehicle);

  // `step` seconds pass, at most 0.1. `run`: the plan is to be flown; else to stand.
  void advance(double step, bool run);

  // As it is `ahead` seconds from now, if the pace stays.
  Setpoint setpoint(double ahead = 0) const;
  double plan_time() const { return time_; }
  double rate() const { return rate_; }
  bool stands() const { return rate_ == 0; }
  // At the end of the plan. A plan that ends in motion is slowed before, so as to stop there.
  bool finished() const { return finished_; }

 private:
  struct Pace {
    double time, rate, change;
  };
  Setpoint at(const Pace& pace) const;
  double excess(const Pace& pace) const;
  double speed_at(double time) const;
  double wanted_change(const Pace& pace, double step, bool run) const;
  Pace after(const Pace& pace, double step, bool run) const;
  bool stops_in_time(Pace pace) const;
  bool may_run(double step) const;

  const Trajectory& trajectory_;
  const Vehicle& vehicle_;
  double end_ = 0, longest_brake_ = 0;  // s: the plan's end; what a brake takes at most
  bool ends_in_motion_ = false;
  double brake_ = 0, jerk_ = 0;  // m/s^2, m/s^3
  double time_ = 0, rate_ = 1, change_ = 0;
  bool finished_ = false;
};

}  // namespace lapwing
