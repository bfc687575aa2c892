// SPDX-License-Identifier: Apache-2.0
// What the vehicle has said of itself so far.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "framework/fly/flight_frame.h"
#include "framework/fly/vehicle_clock.h"

namespace lapwing {

// A place or a heading with the vehicle's time of it, s since its boot.
template <class T>
struct Reported {
  T value{};
  double vehicle_time = 0;
};

struct VehicleReport {
  // Times in s of our clock; before the first message: far in the past.
  static constexpr double kNever = -1e9;
  // s: how old a place or heading, and an estimator's report, may be.
  static constexpr double kFresh = 0.5, kFreshEstimate = 3;

  std::uint8_t system = 0, component = 0;
  std::optional<std::uint8_t> second_system;  // another vehicle that answers too
  double heartbeat_at = kNever, heard_at = kNever, position_at = kNever, yaw_at = kNever,
         estimator_at = kNever;
  std::uint8_t type = 0, autopilot = 0, base_mode = 0, state = 0;
  std::uint32_t mode = 0;
  std::optional<Reported<Eigen::Vector3d>> position, velocity;  // m, m/s, world
  std::optional<Reported<double>> yaw;                          // rad, world
  std::optional<EarthPoint> home, local_origin;
  std::optional<int> battery_percent;
  std::optional<std::uint16_t> estimator;  // ESTIMATOR_STATUS_FLAGS
  // Of SYS_STATUS: attitude, and a sensor of the place on the earth, or of any place.
  std::optional<bool> attitude_healthy;
  bool earth_place_healthy = false, place_healthy = false;
  std::optional<std::uint64_t> capabilities;  // of AUTOPILOT_VERSION
  std::optional<std::uint32_t> software;      // likewise: flight_sw_version
  std::optional<std::uint8_t> landed;         // MAV_LANDED_STATE
  std::optional<std::uint8_t> gimbal_device;  // of GIMBAL_MANAGER_INFORMATION
  std::uint8_t gimbal_component = 0;
  bool has_signatures = false;
  std::vector<std::string> texts;  // STATUSTEXT; whoever shows them empties the list

  bool found() const { return heartbeat_at > kNever; }
  bool armed() const;
  // Whether it follows setpoints: OFFBOARD of PX4, GUIDED of ArduPilot.
  bool follows() const;
  // "PX4", "ArduPilot", or nothing for another autopilot.
  std::optional<std::string> autopilot_name() const;
  // "OFFBOARD" or "GUIDED".
  std::string following_mode_name() const;
  // "OFFBOARD", "HOLD", "mode 5".
  std::string mode_name() const;
  // Estimated place, velocity and attitude are usable; `global`: the place on the earth is needed.
  // Without ESTIMATOR_STATUS, SYS_STATUS tells it: a healthy attitude alone is no place.
  bool estimator_good(bool global) const;
  bool tells_place(double now) const;     // place, velocity and heading are fresh
  bool tells_estimate(double now) const;  // what estimator_good says is fresh
};

// Takes a message of the vehicle that is, or will be, flown: the first autopilot that is heard, or
// the one with the number `wanted`. Others are left out.
void take_report(const mavlink::Packet& packet, double now, std::optional<std::uint8_t> wanted,
                 FlightFrame& frame, VehicleClock& clock, VehicleReport& report);

}  // namespace lapwing
