// SPDX-License-Identifier: Apache-2.0
#include "framework/vehicle/vehicle.h"

#include "framework/core/fields.h"
#include "framework/core/units.h"
#include "framework/vehicle/vehicle_check.h"

namespace lapwing {

// Without a roll or pitch moment opposite rotors carry the same thrust, so a thrust u and a yaw
// moment M ask u/4 + M/(4 k) of one pair and u/4 - M/(4 k) of the other, k = k_M/k_F. With
// |M| <= beta 2 k F_max the second summand is at most beta F_max / 2, which gives both bounds.
double Vehicle::thrust_max() const {
  return (1 - yaw_share / 2) * 4 * rotors.thrust_max;
}

double Vehicle::thrust_min() const {
  return yaw_share / 2 * 4 * rotors.thrust_max + 4 * rotors.thrust_min;
}

double Vehicle::yaw_torque_max() const {
  return yaw_share * 2 * rotors.torque_coefficient * rotors.thrust_max;
}

double Vehicle::largest_acceleration_up() const {
  const double stated = acceleration_up_max.value_or(std::numeric_limits<double>::infinity());
  return has_rotors ? std::min(stated, thrust_max() / mass - kGravity) : stated;
}

// Rotors push and never pull: falling is the fastest way down.
double Vehicle::largest_acceleration_down() const {
  return std::min(acceleration_down_max.value_or(kGravity), kGravity);
}

namespace {

Value list_of(const Eigen::Vector3d& v) {
  return Value(Value::List{v.x(), v.y(), v.z()});
}

Value rotors_to_value(const Rotors& rotors) {
  Value value = Value::map();
  value.set("thrust_min", rotors.thrust_min);
  value.set("thrust_max", rotors.thrust_max);
  value.set("torque_coefficient", rotors.torque_coefficient);
  value.set("arm_length", rotors.arm_length);
  value.set("lag", rotors.lag);
  value.set("diagonal", rotors.diagonal);
  return value;
}

Value wing_to_value(const Wing& wing) {
  Value value = Value::map();
  value.set("stall_speed", wing.stall_speed);
  value.set("bank", wing.bank_max);
  value.set("bank_rate", wing.bank_rate_max);
  value.set("excess_thrust_min", wing.excess_thrust_min);
  value.set("excess_thrust_max", wing.excess_thrust_max);
  return value;
}

Value gimbal_to_value(const GimbalLimits& gimbal) {
  Value value = Value::map();
  value.set("yaw_min", gimbal.yaw_min);
  value.set("yaw_max", gimbal.yaw_max);
  value.set("yaw_rate", gimbal.yaw_rate_max);
  value.set("pitch_min", gimbal.pitch_min);
  value.set("pitch_max", gimbal.pitch_max);
  value.set("pitch_rate", gimbal.pitch_rate_max);
  return value;
}

Value simulation_to_value(const Disturbances& disturbances) {
  Value value = Value::map();
  for (const DisturbanceField& f : disturbance_fields())
    if (disturbances.*f.field != 0) value.set(f.name, disturbances.*f.field);
  return value;
}

Disturbances read_simulation(Fields fields) {
  Disturbances disturbances;
  for (const DisturbanceField& f : disturbance_fields())
    if (fields.has(f.name)) disturbances.*f.field = fields.number(f.name);
  if (const auto problem = problem_of(disturbances)) fields.add_error("", *problem);
  fields.finish();
  return disturbances;
}

Value camera_to_value(const Camera& camera) {
  Value value = Value::map();
  value.set("name", camera.name);
  value.set("width", camera.width);
  value.set("height", camera.height);
  value.set("focal_x", camera.focal_x);
  value.set("focal_y", camera.focal_y);
  value.set("principal_x", camera.principal_x);
  value.set("principal_y", camera.principal_y);
  return value;
}

void read_body(Fields& fields, Vehicle& vehicle) {
  vehicle.name = fields.text("name");
  vehicle.mass = fields.number("mass");
  vehicle.drag = fields.number("drag");
  vehicle.flight_time = fields.number("flight_time");
  vehicle.has_rotors = fields.has("rotors") || fields.has("inertia") || fields.has("yaw_share");
  if (!vehicle.has_rotors) return;
  vehicle.inertia = fields.vector3("inertia");
  vehicle.yaw_share = fields.number("yaw_share");
  Fields rotors = fields.table("rotors");
  vehicle.rotors.thrust_min = rotors.number("thrust_min");
  vehicle.rotors.thrust_max = rotors.number("thrust_max");
  vehicle.rotors.torque_coefficient = rotors.number("torque_coefficient");
  vehicle.rotors.arm_length = rotors.number("arm_length");
  vehicle.rotors.lag = rotors.number("lag");
  vehicle.rotors.diagonal = rotors.boolean("diagonal");
  rotors.finish();
}

void read_limits(Fields fields, Vehicle& vehicle) {
  vehicle.speed_across_max = fields.number("speed_across");
  vehicle.climb_speed_max = fields.number("climb_speed");
  vehicle.descent_speed_max = fields.number("descent_speed");
  vehicle.acceleration_across_max = fields.number("acceleration_across");
  vehicle.acceleration_up_max = fields.optional_number("acceleration_up");
  vehicle.acceleration_down_max = fields.optional_number("acceleration_down");
  vehicle.jerk_max = fields.optional_number("jerk");
  vehicle.yaw_rate_max = fields.number("yaw_rate");
  vehicle.tilt_rate_max = fields.optional_number("tilt_rate");
  fields.finish();
}

Wing read_wing(Fields fields) {
  Wing wing;
  wing.stall_speed = fields.number("stall_speed");
  wing.bank_max = fields.number("bank");
  wing.bank_rate_max = fields.number("bank_rate");
  wing.excess_thrust_min = fields.number("excess_thrust_min");
  wing.excess_thrust_max = fields.number("excess_thrust_max");
  fields.finish();
  return wing;
}

GimbalLimits read_gimbal(Fields fields) {
  GimbalLimits gimbal;
  gimbal.yaw_min = fields.number("yaw_min");
  gimbal.yaw_max = fields.number("yaw_max");
  gimbal.yaw_rate_max = fields.number("yaw_rate");
  gimbal.pitch_min = fields.number("pitch_min");
  gimbal.pitch_max = fields.number("pitch_max");
  gimbal.pitch_rate_max = fields.number("pitch_rate");
  fields.finish();
  return gimbal;
}

Camera read_camera(Fields fields) {
  Camera camera;
  const auto pixels = [&](const char* name) {
    const std::int64_t count = fields.integer(name);
    if (count > 0 && count <= 1 << 20) return static_cast<int>(count);
    fields.add_error(name, "expected a number of pixels");
    return 0;
  };
  camera.name = fields.text("name");
  camera.width = pixels("width");
  camera.height = pixels("height");
  camera.focal_x = fields.number("focal_x");
  camera.focal_y = fields.number("focal_y");
  camera.principal_x = fields.number("principal_x");
  camera.principal_y = fields.number("principal_y");
  fields.finish();
  return camera;
}

}  // namespace

Value limits_to_value(const Vehicle& vehicle) {
  Value value = Value::map();
  value.set("speed_across", vehicle.speed_across_max);
  value.set("climb_speed", vehicle.climb_speed_max);
  value.set("descent_speed", vehicle.descent_speed_max);
  value.set("acceleration_across", vehicle.acceleration_across_max);
  if (vehicle.acceleration_up_max) value.set("acceleration_up", *vehicle.acceleration_up_max);
  if (vehicle.acceleration_down_max) value.set("acceleration_down", *vehicle.acceleration_down_max);
  if (vehicle.jerk_max) value.set("jerk", *vehicle.jerk_max);
  value.set("yaw_rate", vehicle.yaw_rate_max);
  if (vehicle.tilt_rate_max) value.set("tilt_rate", *vehicle.tilt_rate_max);
  return value;
}

Value to_value(const Vehicle& vehicle) {
  Value value = Value::map();
  value.set("name", vehicle.name);
  value.set("mass", vehicle.mass);
  if (vehicle.has_rotors) value.set("inertia", list_of(vehicle.inertia));
  value.set("drag", vehicle.drag);
  if (vehicle.has_rotors) {
    value.set("rotors", rotors_to_value(vehicle.rotors));
    value.set("yaw_share", vehicle.yaw_share);
  }
  value.set("limits", limits_to_value(vehicle));
  value.set("flight_time", vehicle.flight_time);
  if (vehicle.wing) value.set("wing", wing_to_value(*vehicle.wing));
  if (vehicle.gimbal) value.set("gimbal", gimbal_to_value(*vehicle.gimbal));
  if (!vehicle.controller.is_null()) value.set("controller", vehicle.controller);
  if (vehicle.disturbances != Disturbances{})
    value.set("simulation", simulation_to_value(vehicle.disturbances));
  value.set("camera", camera_to_value(vehicle.camera));
  return value;
}

Vehicle vehicle_from_value(const Value& value) {
  Diagnostics errors;
  Vehicle vehicle;
  Fields fields(value, "vehicle", errors);
  read_body(fields, vehicle);
  read_limits(fields.table("limits"), vehicle);
  if (fields.has("wing")) vehicle.wing = read_wing(fields.table("wing"));
  if (fields.has("gimbal")) vehicle.gimbal = read_gimbal(fields.table("gimbal"));
  vehicle.controller = fields.opaque("controller");
  if (fields.has("simulation")) vehicle.disturbances = read_simulation(fields.table("simulation"));
  vehicle.camera = read_camera(fields.table("camera"));
  fields.finish();
  errors.throw_if_any();
  check_vehicle(vehicle, [&](const std::string& key, const std::string& message) {
    errors.add(value.origin(), "vehicle." + key, message);
  });
  errors.throw_if_any();
  return vehicle;
}

}  // namespace lapwing
