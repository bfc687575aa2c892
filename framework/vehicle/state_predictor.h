// SPDX-License-Identifier: Apache-2.0
// The state that a late estimate has become by the time at which a late command arrives.
#pragma once

#include <deque>

#include "framework/vehicle/rotor_body.h"

namespace lapwing {

// What a controller knows of its own delays, s.
struct KnownDelays {
  double estimator = 0, command = 0;
};

// Moves estimates forward by both delays, with the commands that were sent meanwhile.
class StatePredictor {
 public:
  StatePredictor(const Vehicle& vehicle, const KnownDelays& delays);

  // `known`: the estimate now; `step`: s, of the controller. At the first call, before any command
  // was sent, rotors are held to keep the thrusts of the estimate.
  BodyState predicted(const BodyState& known, double step);
  // Each command, once it is decided.
  void sent(const Eigen::Vector4d& thrusts);
  // The command under which a vehicle moved that is now in the estimated state: it arrived then.
  // Valid after `predicted`.
  const Eigen::Vector4d& arrived() const { return sent_.front(); }

 private:
  RotorBody body_;
  double delay_;
  std::deque<Eigen::Vector4d> sent_;  // the oldest first; as many as the delay has steps, and one
};

}  // namespace lapwing
