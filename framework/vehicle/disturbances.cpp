// SPDX-License-Identifier: Apache-2.0
#include "framework/vehicle/disturbances.h"

#include <cstdio>

#include "framework/core/units.h"

namespace lapwing {

const std::vector<DisturbanceField>& disturbance_fields() {
  using D = Disturbances;
  static const std::vector<DisturbanceField> fields{
      {"quadratic_drag", "N s^2/m^2", "drag divided by the square of the airspeed",
       &D::quadratic_drag, 0, 10, false},
      {"inertia_error", "", "fraction by which the true inertia exceeds that of the file",
       &D::inertia_error, -0.9, 10, false},
      {"battery_loss", "", "fraction of the thrust that is lost when the battery is empty",
       &D::battery_loss, 0, 0.9, false},
      {"battery_used", "", "fraction of the battery that is used at take-off", &D::battery_used, 0,
       1, false},
      {"position_noise", "m", "standard deviation of each axis of the estimate", &D::position_noise,
       0, 10, false},
      {"velocity_noise", "m/s", "standard deviation of each axis of the estimate",
       &D::velocity_noise, 0, 10, false},
      {"attitude_noise", "rad", "standard deviation of each axis of the estimate",
       &D::attitude_noise, 0, 1, true},
      {"rate_noise", "rad/s", "standard deviation of each axis of the estimate", &D::rate_noise, 0,
       10, true},
      {"estimator_delay", "s", "age of the estimated state", &D::estimator_delay, 0, 1, false},
      {"command_delay", "s", "time until a command reaches the rotors", &D::command_delay, 0, 1,
       false}};
  return fields;
}

std::optional<std::string> problem_of(const Disturbances& disturbances) {
  for (const DisturbanceField& f : disturbance_fields()) {
    const double value = disturbances.*f.field;
    if (value >= f.least && value <= f.most) continue;
    const double scale = f.degrees ? degrees(1.0) : 1.0;
    char text[160];
    std::snprintf(text, sizeof text, "%s: %.4g is not within %.4g and %.4g",
                  f.outside_name().c_str(), scale * value, scale * f.least, scale * f.most);
    return text;
  }
  return std::nullopt;
}

}  // namespace lapwing
