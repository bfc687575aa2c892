// SPDX-License-Identifier: Apache-2.0
// The camera's direction for the vehicle's gimbal, in one of the ways that vehicles take it.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "framework/fly/vehicle_report.h"

namespace lapwing {

enum class GimbalWay {
  automatic,  // manager where one has announced itself, else command
  manager,    // GIMBAL_MANAGER_SET_ATTITUDE with every setpoint
  command,    // MAV_CMD_DO_GIMBAL_MANAGER_PITCHYAW (1000), 5 a second
  target,     // MAV_CMD_DO_SET_ROI_LOCATION (195): the point to look at, 5 a second
  none,
};

// Nothing for another word than auto, manager, command, roi, none.
std::optional<GimbalWay> gimbal_way_named(std::string_view word);

class GimbalStream {
 public:
  // Throws InputError for `target` of a plan without targets, or in a frame without a place on the
  // earth.
  GimbalStream(GimbalWay way, const Plan& plan, const FlightFrame& frame);

  // The answer to the request for control of the gimbal, from its manager.
  void receive(const mavlink::Packet& packet, const VehicleReport& report);
  // A sentence for the user, once: the gimbal is not ours. Else "".
  std::string take_said();

  // What is to be sent with this setpoint. Control of the gimbal
  // (MAV_CMD_DO_GIMBAL_MANAGER_CONFIGURE, 1001) is asked for every second until its manager
  // answers. Angles are those of the earth: yaw from north, clockwise, pitch positive up, roll
  // level.
  std::vector<mavlink::Packet> step(double now, const Setpoint& setpoint,
                                    const VehicleReport& report, const FlightFrame& frame);

 private:
  GimbalWay way_now(const VehicleReport& report) const;

  GimbalWay way_;
  bool answered_ = false;
  std::string said_;
  double sent_at_ = -1e9, asked_at_ = -1e9;  // s
};

}  // namespace lapwing
