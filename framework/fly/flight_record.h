// SPDX-License-Identifier: Apache-2.0
// How far the vehicle was from what it was sent, at its own time.
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <vector>

#include "framework/core/value.h"
#include "framework/fly/plan_pacer.h"

namespace lapwing {

struct TrackedWorst {
  double error = 0;      // m or rad
  double plan_time = 0;  // s
};

class FlightRecord {
 public:
  // A setpoint that is meant for `time` (s, our clock). Kept for 5 s.
  void sent(const Setpoint& setpoint, double time);
  // The vehicle was here at `time` (s, our clock). Nothing where no setpoint is known for it.
  std::optional<double> placed(const Eigen::Vector3d& p_W, double time);
  void headed(double yaw, double time);

  std::uint64_t setpoints() const { return setpoints_; }
  std::uint64_t measured() const { return measured_; }
  const TrackedWorst& place_worst() const { return place_worst_; }
  const TrackedWorst& yaw_worst() const { return yaw_worst_; }
  double place_mean() const { return measured_ == 0 ? 0 : sum_ / static_cast<double>(measured_); }

 private:
  struct Sent {
    double time;
    Setpoint setpoint;
  };
  std::optional<Setpoint> at(double time) const;

  std::deque<Sent> sent_;
  std::uint64_t setpoints_ = 0, measured_ = 0;
  double sum_ = 0;
  TrackedWorst place_worst_, yaw_worst_;
};

}  // namespace lapwing
