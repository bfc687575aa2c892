// SPDX-License-Identifier: Apache-2.0
// Where a log says that the vehicle was, in the world of a plan.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "framework/flight_log/flight_log.h"
#include "framework/trajectory/plan.h"

namespace lapwing {

struct FlownSeries {
  std::vector<double> times;               // s of the log's clock, rising
  std::vector<Eigen::Vector3d> positions;  // m, world of the plan, before any correction
  std::string source;                      // in words: "the local position (vehicle_...)"
  // Of a local frame whose place in the world of the plan is not known.
  bool local = false;
  // Heights of the log count from something that the plan's origin does not tell.
  bool height_unknown = false;

  double start() const { return times.front(); }
  double finish() const { return times.back(); }
  // m; nothing outside of the series and within gaps longer than `longest_gap` s.
  std::optional<Eigen::Vector3d> at(double time, double longest_gap = 2) const;
};

// The position in the log's local frame, placed by its reference on the earth, where plan and log
// have both; else latitudes and longitudes; else the local frame as it is. InputError for a log
// without positions, and for one with latitudes alone where the plan has no origin.
FlownSeries flown_series(const FlightLog& log, const Plan& plan);

}  // namespace lapwing
