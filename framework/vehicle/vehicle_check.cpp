// SPDX-License-Identifier: Apache-2.0
#include "framework/vehicle/vehicle_check.h"

#include <cstdio>

#include "framework/core/units.h"
#include "framework/vehicle/plausibility.h"

namespace lapwing {
namespace {

std::string text_of(double value, const char* unit) {
  char buffer[64];
  std::snprintf(buffer, sizeof buffer, "%.6g%s%s", value, *unit ? " " : "", unit);
  return buffer;
}

// One pass over everything that a vehicle must satisfy; `add` takes a key and a message.
class Checker {
 public:
  using Add = std::function<void(const std::string&, const std::string&)>;
  Checker(const Vehicle& vehicle, Add add) : v_(vehicle), add_(std::move(add)) {}

  void run() {
    body();
    const bool body_is_sound = sound_;
    limits();
    signs_are_sound_ =
        sound_ && v_.camera.width >= 1 && v_.camera.focal_x > 0 && v_.camera.focal_y > 0;
    if (v_.wing) wing(*v_.wing);
    if (v_.gimbal) gimbal(*v_.gimbal);
    camera();
    if (body_is_sound && v_.has_rotors) hover();
    if (signs_are_sound_) check_plausible(v_, add_);
  }

 private:
  void require(bool good, const std::string& key, const std::string& message) {
    if (good) return;
    sound_ = false;
    add_(key, message);
  }
  void positive(double value, const std::string& key) {
    require(std::isfinite(value) && value > 0, key, "must be above 0, is " + text_of(value, ""));
  }

  void body() {
    positive(v_.mass, "mass");
    require(v_.drag >= 0 && v_.drag <= 100, "drag",
            "must lie between 0 and 100 N s/m, is " + text_of(v_.drag, "N s/m"));
    if (!v_.has_rotors) return;
    const Eigen::Vector3d& i = v_.inertia;
    require(i.allFinite() && (i.array() > 0).all(), "inertia", "each entry must be above 0");
    // A body's moments of inertia obey the triangle inequality; equality is a flat plate.
    require(2 * i.maxCoeff() <= i.sum() * (1 + 1e-9), "inertia",
            "a moment of inertia cannot exceed the sum of the other two");
    positive(v_.rotors.thrust_max, "rotors.thrust");
    require(v_.rotors.thrust_min >= 0 && v_.rotors.thrust_min < v_.rotors.thrust_max,
            "rotors.thrust",
            "the smallest thrust of a rotor (" + text_of(v_.rotors.thrust_min, "N") +
                ") must be at least 0 and below the largest (" +
                text_of(v_.rotors.thrust_max, "N") + ")");
    positive(v_.rotors.torque_coefficient, "rotors.torque_coefficient");
    positive(v_.rotors.arm_length, "rotors.arm_length");
    require(v_.rotors.lag >= 0 && v_.rotors.lag <= 1, "rotors.lag",
            "must lie between 0 and 1 s, is " + text_of(v_.rotors.lag, "s"));
    require(v_.yaw_share > 0 && v_.yaw_share < 1, "yaw_share",
            "must lie between 0 and 1, both excluded, is " + text_of(v_.yaw_share, ""));
  }

  void hover() {
    const double weight = v_.mass * kGravity;
    const std::string bounds = text_of(v_.thrust_min(), "N") + " to " +
                               text_of(v_.thrust_max(), "N") + " with yaw_share " +
                               text_of(v_.yaw_share, "");
    require(v_.thrust_min() < v_.thrust_max(), "yaw_share",
            "leaves no range of thrust: the bounds are " + bounds);
    require(v_.thrust_min() < weight && weight < v_.thrust_max(), "mass",
            "the vehicle cannot hover: its weight is " + text_of(weight, "N") +
                ", its usable thrust " + bounds + lighter(weight));
  }

  // What a weight is that a thousandth of would hover.
  std::string lighter(double weight) const {
    const bool in_grams = v_.thrust_min() < weight / 1000 && weight / 1000 < v_.thrust_max();
    return in_grams ? "; is the mass in g? Then write '" + text_of(v_.mass, "g") + "'" : "";
  }

  void limits() {
    positive(v_.speed_across_max, "limits.speed_across");
    positive(v_.climb_speed_max, "limits.climb_speed");
    positive(v_.descent_speed_max, "limits.descent_speed");
    positive(v_.acceleration_across_max, "limits.acceleration_across");
    if (v_.acceleration_up_max) positive(*v_.acceleration_up_max, "limits.acceleration_up");
    if (v_.acceleration_down_max) positive(*v_.acceleration_down_max, "limits.acceleration_down");
    // Without rotors nothing else says how fast it climbs.
    require(v_.has_rotors || v_.acceleration_up_max, "limits.acceleration_up",
            "missing: required for a vehicle without rotors");
    require(v_.has_rotors || v_.acceleration_down_max, "limits.acceleration_down",
            "missing: required for a vehicle without rotors");
    if (v_.jerk_max) positive(*v_.jerk_max, "limits.jerk");
    positive(v_.yaw_rate_max, "limits.yaw_rate_deg");
    if (v_.tilt_rate_max) positive(*v_.tilt_rate_max, "limits.tilt_rate_deg");
    positive(v_.flight_time, "flight_time");
  }

  void wing(const Wing& w) {
    positive(w.stall_speed, "wing.stall_speed");
    positive(w.bank_rate_max, "wing.bank_rate_deg");
    require(w.bank_max > 0 && w.bank_max < radians(80), "wing.bank_deg",
            "must lie between 0 and 80 degrees, both excluded, is " +
                text_of(degrees(w.bank_max), "degrees"));
    require(w.excess_thrust_min < 0 && w.excess_thrust_max > 0, "wing.excess_thrust",
            "expected a negative number (deceleration without thrust) and a positive "
            "one; are " +
                text_of(w.excess_thrust_min, "") + " and " + text_of(w.excess_thrust_max, "m/s^2"));
    require(w.stall_speed < v_.speed_across_max, "wing.stall_speed",
            text_of(w.stall_speed, "m/s") + " is not below the largest speed of " +
                text_of(v_.speed_across_max, "m/s"));
    const double turn = kGravity * std::tan(w.bank_max);
    require(turn <= v_.acceleration_across_max, "limits.acceleration_across",
            text_of(v_.acceleration_across_max, "m/s^2") + " is less than a turn at the bank of " +
                text_of(degrees(w.bank_max), "degrees") + " takes: g tan(bank) is " +
                text_of(turn, "m/s^2"));
  }

  void gimbal(const GimbalLimits& g) {
    axis("yaw", g.yaw_min, g.yaw_max, g.yaw_rate_max, std::numbers::pi);
    axis("pitch", g.pitch_min, g.pitch_max, g.pitch_rate_max, std::numbers::pi / 2);
  }

  void axis(const std::string& name, double low, double high, double rate, double largest) {
    const std::string range =
        text_of(degrees(low), "") + " to " + text_of(degrees(high), "degrees");
    const double slack = 1e-9;
    require(low <= high, "gimbal." + name + "_deg", "the range " + range + " is empty");
    require(low >= -largest - slack && high <= largest + slack, "gimbal." + name + "_deg",
            "the range " + range + " leaves -" + text_of(degrees(largest), "") + " to " +
                text_of(degrees(largest), "degrees"));
    require(std::isfinite(rate) && rate >= 0, "gimbal." + name + "_rate_deg",
            "must be at least 0, is " + text_of(degrees(rate), ""));
    require(low >= high || rate > 0, "gimbal." + name + "_rate_deg",
            "the gimbal has a range of " + range + " but a rate of 0");
  }

  void camera() {
    const Camera& c = v_.camera;
    require(c.width >= 1 && c.height >= 1, "camera.image_size",
            "both sizes must be at least 1 pixel");
    require(c.focal_x > 0 && c.focal_y > 0, "camera.focal_length", "both entries must be above 0");
    require(c.principal_x >= -0.5 && c.principal_x <= c.width - 0.5 && c.principal_y >= -0.5 &&
                c.principal_y <= c.height - 0.5,
            "camera.principal_point", "must lie within the image");
  }

  const Vehicle& v_;
  Add add_;
  bool sound_ = true;
  bool signs_are_sound_ = false;  // of body, limits and camera
};

}  // namespace

void check_vehicle(const Vehicle& vehicle,
                   const std::function<void(const std::string&, const std::string&)>& add) {
  Checker(vehicle, add).run();
}

}  // namespace lapwing
