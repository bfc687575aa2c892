// SPDX-License-Identifier: Apache-2.0
// A plan's world in the frames that vehicles understand, and back.
//
//   world:   x east, y north, z up; yaw 0 along east, counter-clockwise
//   vehicle: north, east, down; yaw 0 along north, clockwise: yaw_NED = 90 degrees - yaw
//
// `global`: latitude, longitude and height of the plan's origin (SET_POSITION_TARGET_GLOBAL_INT).
// Heights are those above the sea; of an origin above the ground, those above the vehicle's home,
// which is the plan's home or, without one, on the ground of the origin.
// `local`: the plan's world is the vehicle's own local frame, whose origin is where its estimator
// began (SET_POSITION_TARGET_LOCAL_NED).
#pragma once

#include <optional>
#include <string>

#include "framework/export/earth_frame.h"
#include "framework/fly/plan_pacer.h"
#include "framework/mavlink/message.h"

namespace lapwing {

enum class FlightFrameKind { global, local };

class FlightFrame {
 public:
  // Throws InputError for `global` without an origin, and where its height cannot be converted to
  // one above the sea.
  FlightFrame(const Plan& plan, FlightFrameKind kind);

  FlightFrameKind kind() const { return kind_; }
  bool heights_above_home() const { return earth_ && earth_->heights() == HeightOf::ground; }
  // "heights above the sea", for the user.
  std::string in_words() const;

  // The setpoint as a packet, for a vehicle whose time is `vehicle_time` (s).
  mavlink::Packet packet(const Setpoint& setpoint, double vehicle_time, std::uint8_t system,
                         std::uint8_t component) const;
  // Latitude and longitude of a place of the world; nothing where nobody knows them.
  std::optional<EarthPoint> on_earth(const Eigen::Vector3d& p_W) const;
  // The vehicle tells where its local frame is on the earth.
  void place_local_frame(double latitude_deg, double longitude_deg, double height);

  // m, world.
  Eigen::Vector3d position_of(const mavlink::Message<mavlink::kLocalPosition>& message) const;
  Eigen::Vector3d position_of(const mavlink::Message<mavlink::kGlobalPosition>& message) const;

 private:
  FlightFrameKind kind_;
  std::optional<EarthFrame> earth_;
  std::optional<GeodeticPoint> local_origin_;
};

// The plan's origin, for the earth; one above the ground is above the level of the plan's home.
std::optional<GeodeticOrigin> origin_above_home(const Plan& plan);

// Of the world, rad, from one of the vehicle's frame, and back: the map is its own inverse. In
// (-pi, pi].
double turned_yaw(double yaw);
Eigen::Vector3d east_north_up(double north, double east, double down);

}  // namespace lapwing
