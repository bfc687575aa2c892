// SPDX-License-Identifier: Apache-2.0
// The flight of a list of mission items.
#include <cmath>

#include "framework/core/error.h"
#include "framework/core/units.h"
#include "framework/export/mission_items.h"

namespace lapwing {
namespace {

constexpr int kYawLock = 16;  // of a gimbal's flags: its yaw is that from north

double yaw_of(double heading_deg) {
  return radians(90 - heading_deg);
}

class Reader {
 public:
  Reader(const EarthFrame& frame, const EarthPoint& home, bool ardupilot)
      : frame_(frame), home_(home), ardupilot_(ardupilot) {}

  void take(const MissionItem& item) {
    const auto& p = item.params;
    switch (item.command) {
      case mav::kWaypoint:
        add_point(item);
        break;
      case mav::kDelay:
        if (!flight_.points.empty()) flight_.points.back().hold += p[0];
        break;
      case mav::kChangeSpeed:
        if (p[0] == 1 && p[1] > 0) speed_ = p[1];
        break;
      case mav::kConditionYaw:
        heading_ = yaw_of(p[0]);
        break;
      case mav::kRoi:
        order({reached(), std::nullopt, std::nullopt, false, place(p)});
        break;
      case mav::kRoiNone:
        order({reached(), 0.0, std::nullopt, false, std::nullopt});
        break;
      case mav::kGimbal:
        order_gimbal(radians(p[0]), p[1], (static_cast<int>(p[4]) & kYawLock) != 0);
        break;
      case mav::kMountControl:
        order_gimbal(radians(p[0]), p[2], false);
        break;
      case mav::kPhotograph:
        flight_.photographs.push_back(reached());
        break;
      case mav::kTakeOff:
      case mav::kLand:
      case mav::kReturn:
      case mav::kGimbalOwner:
      case mav::kVideoStart:
      case mav::kVideoStop:
        break;  // they move nothing on the way
      default:
        throw InputError("mission item of command " + std::to_string(item.command) +
                         ": nothing is known of how it is flown");
    }
  }

  const WaypointFlight& flight() const { return flight_; }

 private:
  Eigen::Vector3d place(const std::array<double, 7>& p) const {
    return frame_.local({p[4], p[5], home_.height + p[6]});
  }

  std::size_t reached() const { return flight_.points.empty() ? 0 : flight_.points.size() - 1; }

  void order(CameraOrder order) { flight_.orders.push_back(order); }

  void order_gimbal(double pitch, double yaw_deg, bool from_north) {
    order({reached(), pitch, from_north ? yaw_of(yaw_deg) : -radians(yaw_deg), from_north,
           std::nullopt});
  }

  void add_point(const MissionItem& item) {
    if (item.frame != mav::kRelative)
      throw InputError("mission item of frame " + std::to_string(item.frame) +
                       ": heights above the take-off place (3) are expected");
    FlownPoint point;
    point.position = place(item.params);
    point.speed = speed_;
    point.hold = ardupilot_ ? std::floor(item.params[0]) : item.params[0];
    point.radius = item.params[1];
    point.yaw = heading_ ? heading_ : std::optional(yaw_of(item.params[3]));
    flight_.points.push_back(point);
  }

  const EarthFrame& frame_;
  const EarthPoint& home_;
  bool ardupilot_;
  WaypointFlight flight_;
  double speed_ = 5;  // m/s, of an autopilot that was told none
  std::optional<double> heading_;
};

}  // namespace

FlownFile flight_of(const std::vector<MissionItem>& items, const EarthFrame& frame, EarthPoint home,
                    double home_z, bool ardupilot, const Plan& plan) {
  Eigen::Vector3d ground = frame.local(home);
  ground.z() = home_z;
  home.height = frame.at(ground).height;
  Reader reader(frame, home, ardupilot);
  for (const MissionItem& item : items) reader.take(item);
  return fly_waypoints(reader.flight(), vehicle_from_value(plan.vehicle),
                       plan.trajectory.has_gimbal);
}

}  // namespace lapwing
