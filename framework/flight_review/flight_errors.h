// SPDX-License-Identifier: Apache-2.0
// How far a flown flight is from its plan, over time.
#pragma once

#include <string>
#include <vector>

#include "framework/flight_review/flown_track.h"

namespace lapwing {

// One kind of error at the poses of a log.
struct ErrorSeries {
  std::string name;     // "along", snake_case
  std::string summary;  // "ahead of the plan, along its path"
  std::string unit;     // SI, "rad" for angles
  bool is_signed = true;
  std::vector<double> times;  // s of the plan
  std::vector<double> values;

  double median() const;                // of the absolute values
  double quantile(double share) const;  // likewise
  double mean() const;                  // signed
  std::size_t worst() const;            // the number of the largest absolute value
};

// In this order, where the log holds them:
//   distance  between the places of flight and plan at the same time (m)
//   along     the part of it along the plan's velocity (m), ahead positive
//   across    the horizontal part across it (m), to the left positive
//   height    (m), above positive
//   path      distance from the place of the plan that the flight has come to (m)
//   late      time behind the plan at that place (s), late positive
//   yaw       of the vehicle (rad), counter-clockwise positive
//   camera    angle between the optical axes (rad)
// Where the plan hovers, `along` is 0 and `across` is the horizontal distance.
std::vector<ErrorSeries> flight_errors(const Plan& plan, const FlownTrack& flown);

const ErrorSeries* find_error(const std::vector<ErrorSeries>& errors, std::string_view name);

}  // namespace lapwing
