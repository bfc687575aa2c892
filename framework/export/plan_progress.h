// SPDX-License-Identifier: Apache-2.0
// How far a flight has come along its plan: which place of the plan it is at, whatever the time.
#pragma once

#include <vector>

#include "framework/trajectory/trajectory.h"

namespace lapwing {

// Of every sample of the flight, the time of the plan whose place it has come to, never falling:
// the alignment with the least squared distances (dynamic time warping).
class PlanProgress {
 public:
  // The flight is of the plan from `start` to `finish`, s. Keeps references to both.
  PlanProgress(const Trajectory& plan, const Trajectory& flown, double start, double finish);

  // s of the plan, one for each sample of the flight.
  const std::vector<double>& times() const { return reached_; }
  // The distance of the flight's sample of that number from the plan near the place it has come to.
  double across(std::size_t number) const;
  // The time of the flight at which it has come to a time of the plan.
  double flown_time(double planned) const;

 private:
  static std::vector<std::size_t> align(const std::vector<Eigen::Vector3d>& wanted,
                                        const std::vector<Eigen::Vector3d>& shown);

  const Trajectory& plan_;
  const Trajectory& flown_;
  double start_, finish_;
  std::vector<double> reached_;
};

}  // namespace lapwing
