// SPDX-License-Identifier: Apache-2.0
// What a simulated vehicle and its sensors have that plans and controllers do not know of. From the
// table `simulation` of a vehicle file, or from the command line; all of it off by default.
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace lapwing {

struct Disturbances {
  double quadratic_drag = 0;   // N s^2/m^2, times the square of the airspeed, beside linear drag
  double inertia_error = 0;    // share by which the true inertia exceeds the file's
  double battery_loss = 0;     // share of the thrust that an empty battery has lost
  double battery_used = 0;     // share of the battery that is used at take-off
  double position_noise = 0;   // m, standard deviation of each axis of the estimate
  double velocity_noise = 0;   // m/s, likewise
  double attitude_noise = 0;   // rad, likewise
  double rate_noise = 0;       // rad/s, likewise
  double estimator_delay = 0;  // s, by which the estimate is old
  double command_delay = 0;    // s, after which a command reaches the rotors

  bool operator==(const Disturbances&) const = default;
};

// One line for each field: name, unit, least and largest value, and what it is.
struct DisturbanceField {
  const char* name;
  const char* unit;
  const char* summary;
  double Disturbances::*field;
  double least, most;
  bool degrees;  // rad inside, degrees in files and options, whose names end in _deg
  std::string outside_name() const { return std::string(name) + (degrees ? "_deg" : ""); }
};
const std::vector<DisturbanceField>& disturbance_fields();

// The first field that lies outside its range, in words with its range.
std::optional<std::string> problem_of(const Disturbances& disturbances);

}  // namespace lapwing
