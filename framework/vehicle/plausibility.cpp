// SPDX-License-Identifier: Apache-2.0
#include "framework/vehicle/plausibility.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <optional>
#include <span>
#include <vector>

#include "framework/core/units.h"

namespace lapwing {
namespace {
namespace plausible {  // short names, which other sources of the room have too

struct Range {
  double low, high;
  bool holds(double value) const { return value >= low && value <= high; }
};

// A unit that figures are often given in, in units of the file.
struct OtherUnit {
  const char* name;
  double size;
};

constexpr OtherUnit kLengths[] = {{"mm", 1e-3}, {"cm", 1e-2}, {"in", 0.0254}};
constexpr OtherUnit kMasses[] = {{"g", 1e-3}};
constexpr OtherUnit kInertias[] = {
    {"g cm^2", 1e-7}, {"kg cm^2", 1e-4}, {"g m^2", 1e-3}, {"kg mm^2", 1e-6}, {"g mm^2", 1e-9}};
constexpr OtherUnit kForces[] = {{"gf", 9.80665e-3}, {"kgf", 9.80665}, {"mN", 1e-3}};
constexpr OtherUnit kTimes[] = {{"min", 60}, {"h", 3600}, {"ms", 1e-3}};
constexpr OtherUnit kSpeeds[] = {{"km/h", 1 / 3.6}, {"cm/s", 1e-2}, {"mm/s", 1e-3}};
constexpr OtherUnit kAccelerations[] = {{"cm/s^2", 1e-2}, {"mm/s^2", 1e-3}};
constexpr OtherUnit kAngularRates[] = {{"rad/s", 180 / std::numbers::pi}};

constexpr OtherUnit kAngles[] = {{"rad", 180 / std::numbers::pi}};

// The lightest that fly are toys of 10 g; the heaviest lift a person.
constexpr Range kMass{0.005, 1000};    // kg
constexpr Range kArm{0.01, 5};         // m
constexpr Range kGyration{0.05, 2};    // radius of gyration, in arms: real ones 0.2 to 0.8
constexpr Range kThrust{1, 30};        // of all rotors over the weight: racers reach 15
constexpr Range kDragTorque{1e-4, 1};  // m; a propeller's diameter times 0.01 to 0.1
constexpr Range kYawShare{1e-3, 1};
constexpr Range kLevelSpeed{0.01, 200};     // m/s; the fastest made flies 160
constexpr Range kAcceleration{0.01, 1000};  // m/s^2
constexpr Range kJerk{0.01, 1e5};           // m/s^3
constexpr Range kYawRate{0.1, 1e4};         // deg/s
constexpr Range kBank{2, 80};               // deg; below 2 no aircraft turns
constexpr Range kFlightTime{5, 1e6};        // s; on a cable there is no end
// The narrowest and slowest gimbals made turn by tens of degrees. In radians, half a turn is 3.
constexpr Range kGimbalPitch{3.2, 181};  // deg, from end to end
constexpr Range kGimbalYaw{6.3, 361};    // deg, likewise
constexpr Range kGimbalRate{2, 1e4};     // deg/s
constexpr Range kFocal{0.1, 1000};       // focal length in widths of the image: 157 to 0.06 deg
constexpr Range kSquareness{0.5, 2};     // of a pixel

std::string shown(double value) {
  char buffer[32];
  std::snprintf(buffer, sizeof buffer, "%.4g", value);
  return buffer;
}

std::string shown(double value, const char* unit) {
  return shown(value) + (*unit ? " " : "") + unit;
}

// The significant digits of a figure, 16 where it is not a short decimal.
int digits_of(double value) {
  for (int digits = 1; digits < 12; ++digits) {
    char buffer[40];
    std::snprintf(buffer, sizeof buffer, "%.*e", digits - 1, value);
    if (std::abs(std::atof(buffer) - value) <= 1e-12 * std::abs(value)) return digits;
  }
  return 16;
}

class Plausibility {
 public:
  using Add = std::function<void(const std::string&, const std::string&)>;
  Plausibility(const Vehicle& vehicle, const Add& add) : v_(vehicle), add_(add) {}

  void check() {
    const bool mass = plain("mass", v_.mass, "kg", kMass, kMasses);
    if (v_.has_rotors) rotors(mass);
    limits();
    if (v_.gimbal) {
      const GimbalLimits& g = *v_.gimbal;
      gimbal("yaw", g.yaw_min, g.yaw_max, g.yaw_rate_max, kGimbalYaw);
      gimbal("pitch", g.pitch_min, g.pitch_max, g.pitch_rate_max, kGimbalPitch);
    }
    camera();
  }

 private:
  void rotors(bool mass) {
    const bool arm = plain("rotors.arm_length", v_.rotors.arm_length, "m", kArm, kLengths, arms());
    plain("rotors.torque_coefficient", v_.rotors.torque_coefficient, "m", kDragTorque, kLengths);
    plain("yaw_share", v_.yaw_share, "", kYawShare, {});
    if (mass && arm) inertia();
    if (mass) thrust();
  }

  // "; is it mm? Then write '230 mm'": the number that was written, with the first unit in which it
  // is one that real vehicles have. A file may have written another unit than `base`, in which the
  // value comes: the one that gives the shortest number, 900 h rather than 3.24e6 s.
  static std::string unit_hint(double value, const Range& range, std::span<const OtherUnit> units,
                               const char* base) {
    std::vector<OtherUnit> all{{base, 1}};
    all.insert(all.end(), units.begin(), units.end());
    int fewest = 17;
    std::string hint;
    for (const OtherUnit& written : all) {
      const double number = value / written.size;
      const int digits = digits_of(number);
      if (digits >= fewest) continue;
      for (const OtherUnit& meant : all) {
        if (!range.holds(number * meant.size)) continue;
        fewest = digits;
        hint = std::string("; is it ") + meant.name + "? Then write '" + shown(number, meant.name) +
               "'";
        break;
      }
    }
    return hint;
  }

  const char* kind() const { return v_.has_rotors ? "multirotor" : "drone"; }

  // Whether a figure lies in its range.
  bool plain(const std::string& key, double value, const char* unit, const Range& range,
             std::span<const OtherUnit> units, std::optional<Range> likely = {}) {
    if (range.holds(value)) return true;
    add_(key, shown(value, unit) + " is not what a " + kind() + " has (" + shown(range.low) +
                  " to " + shown(range.high, unit) + ")" +
                  unit_hint(value, likely.value_or(range), units, unit));
    return false;
  }

  // The arms that suit mass and inertia: 15 may be mm or cm, and only one of them fits these.
  Range arms() const {
    const double gyration = std::sqrt(v_.inertia.x() / v_.mass);
    return {std::max(kArm.low, gyration / 1.2), std::min(kArm.high, gyration / 0.1)};
  }

  // An inertia is that of the mass at a distance, which is of the arms' order.
  void inertia() {
    const double per_square = v_.mass * v_.rotors.arm_length * v_.rotors.arm_length;
    const Range range{per_square * kGyration.low * kGyration.low,
                      per_square * kGyration.high * kGyration.high};
    for (int axis = 0; axis < 3; ++axis) {
      const double value = v_.inertia(axis);
      if (range.holds(value)) continue;
      add_("inertia", shown(value, "kg m^2") + " for a mass of " + shown(v_.mass, "kg") +
                          " on arms of " + shown(v_.rotors.arm_length, "m") + ": expected " +
                          shown(range.low) + " to " + shown(range.high, "kg m^2") +
                          unit_hint(value, range, kInertias, "kg m^2"));
      return;
    }
  }

  void thrust() {
    const double weight = v_.mass * kGravity;
    const Range range{kThrust.low * weight / 4, kThrust.high * weight / 4};
    const double value = v_.rotors.thrust_max;
    if (value <= range.high) return;  // too little is said as what cannot hover
    add_("rotors.thrust", shown(value, "N") + " a rotor is " + shown(4 * value / weight) +
                              " times the weight of " + shown(v_.mass, "kg") +
                              " in all; expected at most " + shown(kThrust.high) +
                              unit_hint(value, range, kForces, "N"));
  }

  void limits() {
    plain("limits.speed_across", v_.speed_across_max, "m/s", kLevelSpeed, kSpeeds);
    plain("limits.climb_speed", v_.climb_speed_max, "m/s", kLevelSpeed, kSpeeds);
    plain("limits.descent_speed", v_.descent_speed_max, "m/s", kLevelSpeed, kSpeeds);
    plain("limits.acceleration_across", v_.acceleration_across_max, "m/s^2", kAcceleration,
          kAccelerations);
    if (v_.acceleration_up_max)
      plain("limits.acceleration_up", *v_.acceleration_up_max, "m/s^2", kAcceleration,
            kAccelerations);
    if (v_.acceleration_down_max)
      plain("limits.acceleration_down", *v_.acceleration_down_max, "m/s^2", kAcceleration,
            kAccelerations);
    if (v_.jerk_max) plain("limits.jerk", *v_.jerk_max, "m/s^3", kJerk, {});
    if (v_.wing) {
      plain("wing.stall_speed", v_.wing->stall_speed, "m/s", kLevelSpeed, kSpeeds);
      plain("wing.bank_deg", degrees(v_.wing->bank_max), "deg", kBank, kAngles);
      plain("wing.bank_rate_deg", degrees(v_.wing->bank_rate_max), "deg/s", kYawRate,
            kAngularRates);
    }
    plain("limits.yaw_rate_deg", degrees(v_.yaw_rate_max), "deg/s", kYawRate, kAngularRates);
    if (v_.tilt_rate_max)
      plain("limits.tilt_rate_deg", degrees(*v_.tilt_rate_max), "deg/s", kYawRate, kAngularRates);
    plain("flight_time", v_.flight_time, "s", kFlightTime, kTimes);
  }

  // One axis of the gimbal, which turns unless its ends are equal. rad, rad/s; `span` in deg.
  void gimbal(const std::string& axis, double low, double high, double rate, const Range& span) {
    if (!(low < high)) return;
    const std::string key = "gimbal." + axis;
    if (degrees(high - low) < span.low) {
      add_(key + "_deg", shown(degrees(low)) + " to " + shown(degrees(high), "degrees") +
                             " is narrower than any gimbal's range (" + shown(span.low) +
                             " degrees); is it rad? Then write '[" + shown(degrees(low), "rad") +
                             ", " + shown(degrees(high), "rad") + "]'");
    }
    plain(key + "_rate_deg", degrees(rate), "deg/s", kGimbalRate, kAngularRates);
  }

  void camera() {
    const Camera& c = v_.camera;
    if (!kFocal.holds(c.focal_x / c.width)) {
      add_("camera.focal_length",
           shown(c.focal_x, "px") + " for an image " + std::to_string(c.width) +
               " px wide: expected " + shown(kFocal.low * c.width) + " to " +
               shown(kFocal.high * c.width, "px") +
               (c.focal_x < c.width ? "; is it mm? Then multiply it by the pixels per mm" : ""));
    } else if (!kSquareness.holds(c.focal_x / c.focal_y)) {
      add_("camera.focal_length", shown(c.focal_x, "px") + " across and " + shown(c.focal_y, "px") +
                                      " vertically: the pixels of a camera are nearly square");
    }
  }

  const Vehicle& v_;
  const Add& add_;
};

}  // namespace plausible
}  // namespace

void check_plausible(const Vehicle& vehicle,
                     const std::function<void(const std::string&, const std::string&)>& add) {
  plausible::Plausibility(vehicle, add).check();
}

}  // namespace lapwing
