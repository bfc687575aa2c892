// SPDX-License-Identifier: Apache-2.0
// Brings a log and a plan together in time and space: clock offset, position offset and, where it
// is asked for, the heading of the log's local frame.
//
//   p_W(t) = R_z(turn) p_log(t + clock) + offset
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "framework/core/error.h"
#include "framework/flight_review/flown_series.h"

namespace lapwing {

// The log is of another flight than the plan.
class AnotherFlight : public InputError {
 public:
  using InputError::InputError;
};

struct AlignmentRequest {
  std::optional<double> clock = {};  // s, stated; else estimated
  bool estimate_offset = true;       // else the positions stand as they are
  bool estimate_turn = false;        // of a local frame alone
};

struct FlightAlignment {
  double clock = 0, clock_sigma = 0;  // s of the log's clock at time 0 of the plan
  Eigen::Vector3d offset = Eigen::Vector3d::Zero(), offset_sigma = Eigen::Vector3d::Zero();  // m
  double turn = 0, turn_sigma = 0;                                                           // rad
  double residual = 0;  // m, root of the mean square that remains
  double end = 0;       // s of the plan's clock, when the flight was at its end
  // The flight took another time than the plan: `clock` is that of its beginning.
  bool stretched = false;
  // A straight and even flight: a later clock and an offset along the path look the same.
  bool confounded = false;

  Eigen::Vector3d corrected(const Eigen::Vector3d& position) const;
  double plan_time(double log_time) const { return log_time - clock; }
};

// A search over every clock offset at which a fifth of the plan or 3 s lie within the log, by a
// loss that is bounded, and its refinement by least squares that are robust against outliers. Sigma
// are standard deviations over ten parts of the flight that are left out in turn. AnotherFlight for
// a log of another place (with the distance), and for one that never flew this plan (with how near
// it came).
FlightAlignment align_flight(const Trajectory& plan, const FlownSeries& flown,
                             const AlignmentRequest& asked = {});

}  // namespace lapwing
