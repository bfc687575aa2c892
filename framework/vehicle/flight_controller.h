// SPDX-License-Identifier: Apache-2.0
// The controller that a plan is flown with (thesis 3.8.2): a linear quadratic regulator with
// integral action for the place, (3.14), and Lee's attitude law on SO(3) (CDC 2010) for the rest.
#pragma once

#include "framework/vehicle/controller.h"
#include "framework/vehicle/planned_attitude.h"

namespace lapwing {

struct ControllerGains {
  double integral = 0;                                 // 1/s^3, acceleration per m s
  double position = 0;                                 // 1/s^2
  double velocity = 0;                                 // 1/s
  Eigen::Vector3d attitude = Eigen::Vector3d::Zero();  // N m per rad, K_R
  Eigen::Vector3d rates = Eigen::Vector3d::Zero();     // N m s per rad, K_omega
};

// What an acceleration of 2 m/s^2 is worth to the regulator, and how fast an attitude may be.
struct ControllerWeights {
  double position = 0.1;           // m
  double velocity = 0.5;           // m/s
  double integral = 0.1;           // m s
  double tilt_bandwidth = 20;      // rad/s, at most
  double heading_bandwidth = 4.0;  // rad/s, at most
};

// The attitude loop is critically damped. Its bandwidth w is such that an error of 0.5 rad asks for
// half of the moment that rotors have left beside hovering; at most those of the weights, and 0.5
// over the rotors' lag. Where the attitude answers later than 0.15 s (2/w and the lag) all times of
// the regulator grow in proportion.
ControllerGains gains_of(const Vehicle& vehicle, const ControllerWeights& weights = {});

// The law itself, for one flight.
class FlightController final : public ControlledFlight {
 public:
  FlightController(const Vehicle& vehicle, const ReferenceMotion& reference,
                   const ControllerWeights& weights = {});

  // The integral stands still while rotors are saturated.
  RotorCommand command(double time, const BodyState& state, double step) override;

  const ControllerGains& gains() const { return gains_; }

 private:
  const ReferenceMotion& reference_;
  double mass_, lag_;
  Eigen::Vector3d inertia_;
  ControllerGains gains_;
  RotorAllocation allocation_;
  SteppedAttitudes attitudes_;
  Eigen::Vector3d integral_ = Eigen::Vector3d::Zero();  // m s
  bool saturated_ = false;
};

// The controller `thesis`. It follows places, headings and forces; of a plan of rotors, those that
// `forces_of` finds. The kernel holds it because plans that name no controller are judged by it.
class ThesisController final : public Controller {
 public:
  explicit ThesisController(const ControllerWeights& weights = {}) : weights_(weights) {}
  void follow(const Vehicle& vehicle, const BodyReference& reference) override {
    vehicle_ = &vehicle;
    reference_ = &reference;
  }
  std::unique_ptr<ControlledFlight> begin() const override {
    return std::make_unique<FlightController>(*vehicle_, reference_->motion(), weights_);
  }

 private:
  ControllerWeights weights_;
  const Vehicle* vehicle_ = nullptr;
  const BodyReference* reference_ = nullptr;
};

}  // namespace lapwing
