// SPDX-License-Identifier: Apache-2.0
// Vehicle and camera files: tables and conversion from degrees.
#include "framework/core/units.h"
#include "framework/vehicle/vehicle.h"
#include "framework/vehicle/vehicle_check.h"

namespace lapwing {
namespace {

ParameterTable rotors_table() {
  ParameterTable table;
  table.optional_numbers("thrust", 2, "N", "smallest and largest thrust of one rotor", at_least(0))
      .optional_number("torque_coefficient", "m", "ratio of drag torque and thrust of a rotor",
                       above(0))
      .optional_number("arm_length", "m", "distance from the axis of a rotor to the centre of mass",
                       above(0))
      .number("lag", 0, "s", "time constant of the thrust", between(0, 1))
      .choice("layout", "diagonal", {"diagonal", "along_axes"},
              "arms at 45 degrees to the body axes, or along them");
  return table;
}

ParameterTable limits_table() {
  ParameterTable table;
  table.required_number("speed_across", "m/s", "largest horizontal speed", above(0))
      .required_number("climb_speed", "m/s", "largest speed upwards", above(0))
      .required_number("descent_speed", "m/s", "largest speed downwards", above(0))
      .required_number("acceleration_across", "m/s^2", "largest horizontal acceleration", above(0))
      .optional_number("acceleration_up", "m/s^2", "absent: limited by the rotors only", above(0))
      .optional_number("acceleration_down", "m/s^2", "absent: limited by the rotors only", above(0))
      .optional_number("jerk", "m/s^3", "largest jerk; absent: no limit", above(0))
      .required_number("yaw_rate_deg", "deg/s", "largest yaw rate", above(0))
      .optional_number("tilt_rate_deg", "deg/s",
                       "largest body rate about x and about y; absent: limited by the rotors only",
                       above(0));
  return table;
}

ParameterTable gimbal_table() {
  ParameterTable table;
  table
      .optional_numbers("yaw_deg", 2, "deg", "yaw range relative to the body; equal ends: fixed",
                        between(-180, 180))
      .optional_number("yaw_rate_deg", "deg/s", "largest rate of the gimbal's yaw", at_least(0))
      .optional_numbers("pitch_deg", 2, "deg", "range, positive up", between(-90, 90))
      .optional_number("pitch_rate_deg", "deg/s", "largest rate of the gimbal's pitch",
                       at_least(0));
  return table;
}

ParameterTable wing_table() {
  ParameterTable table;
  table.optional_number("stall_speed", "m/s", "stall airspeed in straight flight", above(0))
      .optional_number("bank_deg", "deg", "largest bank angle", {.minimum = 0, .maximum = 80})
      .optional_number("bank_rate_deg", "deg/s", "largest rate of the bank angle", above(0))
      .optional_numbers("excess_thrust", 2, "m/s^2",
                        "smallest and largest (thrust - drag) / mass: negative, positive");
  return table;
}

ParameterTable simulation_table() {
  ParameterTable table;
  for (const DisturbanceField& f : disturbance_fields()) {
    const double scale = f.degrees ? degrees(1.0) : 1.0;
    const std::string unit = f.degrees ? (std::string(f.unit) == "rad" ? "deg" : "deg/s") : f.unit;
    table.number(f.outside_name(), 0, unit, f.summary, between(scale * f.least, scale * f.most));
  }
  return table;
}

Disturbances disturbances_from(const Parameters& table) {
  Disturbances result;
  for (const DisturbanceField& f : disturbance_fields()) {
    const double value = table.number(f.outside_name());
    result.*f.field = f.degrees ? radians(value) : value;
  }
  return result;
}

// All keys of a table that is present or absent as a whole; `what` names what needs them.
bool is_whole(const Parameters& table, const ParameterTable& known, const std::string& name,
              const std::string& what, Diagnostics& errors) {
  std::vector<std::string> missing;
  for (const ParameterSpec& spec : known.specs())
    if (!table.has(spec.name)) missing.push_back(spec.name);
  if (missing.size() == known.specs().size()) return false;
  for (const std::string& key : missing)
    errors.add(table.origin(), name + "." + key, "missing: " + what);
  return missing.empty();
}

std::optional<Wing> wing_from(const Parameters& table, Diagnostics& errors) {
  if (!is_whole(table, wing_table(), "wing", "a wing needs all of its values", errors))
    return std::nullopt;
  const auto thrust = table.numbers("excess_thrust");
  return Wing{.stall_speed = table.number("stall_speed"),
              .bank_max = radians(table.number("bank_deg")),
              .bank_rate_max = radians(table.number("bank_rate_deg")),
              .excess_thrust_min = thrust[0],
              .excess_thrust_max = thrust[1]};
}

// Inertia and rotors stand in a file together, or not at all.
void read_rotors(const Parameters& vehicle, Vehicle& result, Diagnostics& errors) {
  const Parameters& rotors = vehicle.table("rotors");
  const std::vector<std::string> needed{"thrust", "torque_coefficient", "arm_length"};
  result.has_rotors = vehicle.has("inertia");
  for (const std::string& key : needed) result.has_rotors |= rotors.has(key);
  if (!result.has_rotors) return;
  bool whole = vehicle.has("inertia");
  if (!whole)
    errors.add(vehicle.origin(), "inertia",
               "missing; expected 3 numbers in kg m^2: required for a vehicle with rotors");
  for (const std::string& key : needed) {
    if (rotors.has(key)) continue;
    whole = false;
    errors.add(rotors.origin(), "rotors." + key, "missing: required for a vehicle with an inertia");
  }
  if (!whole) return;
  const auto inertia = vehicle.numbers("inertia");
  result.inertia = {inertia[0], inertia[1], inertia[2]};
  result.rotors = {.thrust_max = rotors.numbers("thrust")[1],
                   .thrust_min = rotors.numbers("thrust")[0],
                   .torque_coefficient = rotors.number("torque_coefficient"),
                   .arm_length = rotors.number("arm_length"),
                   .lag = rotors.number("lag"),
                   .diagonal = rotors.text("layout") == "diagonal"};
  result.yaw_share = vehicle.number("yaw_share");
}

// All of the gimbal's keys or none of them: a camera fixed to the body has no gimbal table.
std::optional<GimbalLimits> gimbal_from(const Parameters& table, Diagnostics& errors) {
  if (!is_whole(table, gimbal_table(), "gimbal", "a gimbal needs both ranges and both rates",
                errors))
    return std::nullopt;
  const auto yaw = table.numbers("yaw_deg");
  const auto pitch = table.numbers("pitch_deg");
  return GimbalLimits{.yaw_min = radians(yaw[0]),
                      .yaw_max = radians(yaw[1]),
                      .pitch_min = radians(pitch[0]),
                      .pitch_max = radians(pitch[1]),
                      .yaw_rate_max = radians(table.number("yaw_rate_deg")),
                      .pitch_rate_max = radians(table.number("pitch_rate_deg"))};
}

Camera camera_from(const Parameters& table, const std::string& name, Diagnostics& errors) {
  Camera camera;
  camera.name = name;
  const auto size = table.numbers("image_size");
  if (size[0] != std::floor(size[0]) || size[1] != std::floor(size[1])) {
    errors.add(table.origin("image_size"), "image_size", "expected whole numbers of pixels");
    return camera;
  }
  camera.width = static_cast<int>(size[0]);
  camera.height = static_cast<int>(size[1]);
  camera.focal_x = table.numbers("focal_length")[0];
  camera.focal_y = table.numbers("focal_length")[1];
  camera.principal_x = table.numbers("principal_point")[0];
  camera.principal_y = table.numbers("principal_point")[1];
  return camera;
}

void read_limits(const Parameters& limits, Vehicle& vehicle) {
  vehicle.speed_across_max = limits.number("speed_across");
  vehicle.climb_speed_max = limits.number("climb_speed");
  vehicle.descent_speed_max = limits.number("descent_speed");
  vehicle.acceleration_across_max = limits.number("acceleration_across");
  if (limits.has("acceleration_up")) vehicle.acceleration_up_max = limits.number("acceleration_up");
  if (limits.has("acceleration_down")) {
    vehicle.acceleration_down_max = limits.number("acceleration_down");
  }
  if (limits.has("jerk")) vehicle.jerk_max = limits.number("jerk");
  vehicle.yaw_rate_max = radians(limits.number("yaw_rate_deg"));
  if (limits.has("tilt_rate_deg")) vehicle.tilt_rate_max = radians(limits.number("tilt_rate_deg"));
}

// Where the value of a dotted key was written, in the vehicle's file or the camera's.
Origin origin_of(const Parameters& vehicle, const Parameters& camera, const std::string& key) {
  const std::size_t dot = key.find('.');
  if (dot == std::string::npos) return vehicle.origin(key);
  const std::string table = key.substr(0, dot), name = key.substr(dot + 1);
  if (table == "camera") return camera.origin(name);
  return vehicle.table(table).origin(name);
}

}  // namespace

ParameterTable vehicle_table() {
  ParameterTable table;
  table.required_number("mass", "kg", "take-off mass, camera included", above(0))
      .optional_numbers("inertia", 3, "kg m^2",
                        "moments of inertia about the body axes; absent: not known", above(0))
      .number("drag", 0, "N s/m", "linear drag against the air; needed to fly in wind",
              between(0, 100))
      .table("rotors", rotors_table(), "four equal rotors; absent: not known")
      .number("yaw_share", 0.2, "",
              "share of the largest yaw moment that stays usable at every thrust (beta of 3.8.3)",
              {.minimum = 0, .maximum = 1, .minimum_excluded = true})
      .table("limits", limits_table(), "limits of the vehicle, for every problem")
      .required_number("flight_time", "s", "flight time of one battery", above(0))
      .table("wing", wing_table(), "wing of a fixed-wing aircraft; absent: none")
      .table("gimbal", gimbal_table(), "absent: the camera is fixed to the body")
      .optional_text("controller", "plugin that flies its plans; absent: thesis")
      .table("simulation", simulation_table(),
             "what simulated flights have that plans do not know of; absent: nothing")
      .required_text("camera", "the camera file, such as cameras/action");
  return table;
}

ParameterTable camera_table() {
  ParameterTable table;
  table.required_numbers("image_size", 2, "px", "width and height", between(1, 1 << 20))
      .required_numbers("focal_length", 2, "px", "along the image's x and y", above(0))
      .required_numbers("principal_point", 2, "px",
                        "offset from the centre of the upper left pixel");
  return table;
}

Vehicle vehicle_from(const Parameters& vehicle, const Parameters& camera, std::string name) {
  Diagnostics errors;
  Vehicle result;
  result.name = std::move(name);
  result.mass = vehicle.number("mass");
  result.drag = vehicle.number("drag");
  read_rotors(vehicle, result, errors);
  result.flight_time = vehicle.number("flight_time");
  read_limits(vehicle.table("limits"), result);
  result.wing = wing_from(vehicle.table("wing"), errors);
  result.gimbal = gimbal_from(vehicle.table("gimbal"), errors);
  if (vehicle.has("controller")) result.controller = Value(vehicle.text("controller"));
  result.disturbances = disturbances_from(vehicle.table("simulation"));
  const std::string& camera_file = vehicle.text("camera");
  result.camera =
      camera_from(camera, camera_file.substr(camera_file.find_last_of('/') + 1), errors);
  errors.throw_if_any();
  check_vehicle(result, [&](const std::string& key, const std::string& message) {
    errors.add(origin_of(vehicle, camera, key), key, message);
  });
  errors.throw_if_any();
  return result;
}

}  // namespace lapwing
