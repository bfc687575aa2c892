// SPDX-License-Identifier: Apache-2.0
#include "framework/fly/vehicle_report.h"

#include <algorithm>
#include <cmath>

#include "framework/mavlink/vocabulary.h"

namespace lapwing {

using namespace mavlink;

namespace {

constexpr double kMilli = 1e-3;
constexpr double kPerDegree = 1e7;  // degE7

template <class Place>
EarthPoint earth_point_of(const Place& place) {
  return {place.template get<"latitude">() / kPerDegree,
          place.template get<"longitude">() / kPerDegree,
          place.template get<"altitude">() * kMilli};
}

void take_heartbeat(const Packet& packet, double now, VehicleReport& report) {
  const Message<kHeartbeat> beat(packet);
  report.heartbeat_at = now;
  report.type = beat.get<"type">();
  report.autopilot = beat.get<"autopilot">();
  report.base_mode = beat.get<"base_mode">();
  report.mode = beat.get<"custom_mode">();
  report.state = beat.get<"system_status">();
}

void take_position(const Eigen::Vector3d& place, const Eigen::Vector3d& velocity,
                   std::uint32_t boot_ms, double now, VehicleClock& clock, VehicleReport& report) {
  if (!place.allFinite() || !velocity.allFinite()) return;
  const double time = boot_ms * kMilli;
  clock.telemetry(now, time);
  report.position = {place, time};
  report.velocity = {velocity, time};
  report.position_at = now;
}

// A place on the earth in a frame that has none is not used, and the other way.
void take_place(const Packet& packet, double now, const FlightFrame& frame, VehicleClock& clock,
                VehicleReport& report) {
  const bool global = frame.kind() == FlightFrameKind::global;
  if (packet.message == kLocalPosition && !global) {
    const Message<kLocalPosition> m(packet);
    take_position(frame.position_of(m), east_north_up(m.get<"vx">(), m.get<"vy">(), m.get<"vz">()),
                  m.get<"time_boot_ms">(), now, clock, report);
  } else if (packet.message == kGlobalPosition && global) {
    const Message<kGlobalPosition> m(packet);
    take_position(frame.position_of(m),
                  0.01 * east_north_up(m.get<"vx">(), m.get<"vy">(), m.get<"vz">()),
                  m.get<"time_boot_ms">(), now, clock, report);
  }
}

void take_status(const Packet& packet, double now, VehicleReport& report) {
  const Message<kSysStatus> m(packet);
  if (m.get<"battery_remaining">() >= 0) report.battery_percent = m.get<"battery_remaining">();
  const std::uint32_t enabled = m.get<"onboard_control_sensors_enabled">();
  const std::uint32_t healthy = enabled & m.get<"onboard_control_sensors_health">();
  if (!(enabled & kAttitudeSystem)) return;
  report.attitude_healthy = healthy & kAttitudeSystem;
  report.earth_place_healthy = healthy & kGpsSensor;
  report.place_healthy = healthy & (kGpsSensor | kFlowSensor | kVisionSensor);
  if (!report.estimator) report.estimator_at = now;
}

void take_version(const Packet& packet, VehicleReport& report) {
  const Message<kAutopilotVersion> m(packet);
  report.capabilities = m.get<"capabilities">();
  report.software = m.get<"flight_sw_version">();
}

// Of a gimbal, which may be a component of its own.
void take_gimbal(const Packet& packet, VehicleReport& report) {
  if (packet.message != kGimbalManagerInformation) return;
  report.gimbal_device = Message<kGimbalManagerInformation>(packet).get<"gimbal_device_id">();
  report.gimbal_component = packet.component;
}

void take_message(const Packet& packet, double now, FlightFrame& frame, VehicleClock& clock,
                  VehicleReport& report) {
  switch (packet.message) {
    case kHeartbeat:
      return take_heartbeat(packet, now, report);
    case kLocalPosition:
    case kGlobalPosition:
      return take_place(packet, now, frame, clock, report);
    case kAttitude: {
      const Message<kAttitude> m(packet);
      if (!std::isfinite(m.get<"yaw">())) return;
      report.yaw = {turned_yaw(m.get<"yaw">()), m.get<"time_boot_ms">() * kMilli};
      report.yaw_at = now;
      return;
    }
    case kSysStatus:
      return take_status(packet, now, report);
    case kBatteryStatus: {
      const Message<kBatteryStatus> m(packet);
      if (m.get<"id">() == 0 && m.get<"battery_remaining">() >= 0)
        report.battery_percent = m.get<"battery_remaining">();
      return;
    }
    case kEstimatorStatus:
      report.estimator = Message<kEstimatorStatus>(packet).get<"flags">();
      report.estimator_at = now;
      return;
    case kHomePosition:
      report.home = earth_point_of(Message<kHomePosition>(packet));
      return;
    case kGlobalOrigin:
      report.local_origin = earth_point_of(Message<kGlobalOrigin>(packet));
      frame.place_local_frame(report.local_origin->latitude_deg, report.local_origin->longitude_deg,
                              report.local_origin->height);
      return;
    case kExtendedSysState:
      report.landed = Message<kExtendedSysState>(packet).get<"landed_state">();
      return;
    case kAutopilotVersion:
      return take_version(packet, report);
    case kStatusText:
      report.texts.push_back(Message<kStatusText>(packet).text<"text">());
      return;
    default:
      return;
  }
}

}  // namespace

bool VehicleReport::armed() const {
  return base_mode & kArmed;
}

bool VehicleReport::follows() const {
  if (!(base_mode & kCustomMode)) return false;
  return autopilot == kPx4 ? (mode >> 16 & 0xff) == kPx4Offboard >> 16 : mode == kCopterGuided;
}

std::optional<std::string> VehicleReport::autopilot_name() const {
  if (autopilot == kPx4) return "PX4";
  if (autopilot == kArduPilot) return "ArduPilot";
  return std::nullopt;
}

std::string VehicleReport::following_mode_name() const {
  return autopilot == kPx4 ? "OFFBOARD" : "GUIDED";
}

std::string VehicleReport::mode_name() const {
  if (follows()) return following_mode_name();
  if (autopilot == kPx4) {
    if (mode == kPx4Hold) return "HOLD";
    if (mode == kPx4Position) return "POSITION";
    if (mode == kPx4Land) return "LAND";
    return "mode " + std::to_string(mode >> 16 & 0xff) + "." + std::to_string(mode >> 24);
  }
  if (mode == kCopterLoiter) return "LOITER";
  if (mode == kCopterBrake) return "BRAKE";
  if (mode == kCopterLand) return "LAND";
  return "mode " + std::to_string(mode);
}

bool VehicleReport::estimator_good(bool global) const {
  if (!estimator)
    return attitude_healthy.value_or(false) && (global ? earth_place_healthy : place_healthy);
  const std::uint16_t needed = kAttitudeGood | kVelocityAcrossGood | kVelocityUpGood;
  const std::uint16_t place = global ? kAbsolutePlaceGood : kAbsolutePlaceGood | kRelativePlaceGood;
  const std::uint16_t height = global ? kHeightGood : kHeightGood | kHeightAboveGroundGood;
  return (*estimator & needed) == needed && (*estimator & place) && (*estimator & height) &&
         !(*estimator & (kGpsGlitch | kAccelerometerError));
}

bool VehicleReport::tells_place(double now) const {
  return position && yaw && now - std::min(position_at, yaw_at) < kFresh;
}

bool VehicleReport::tells_estimate(double now) const {
  return now - estimator_at < kFreshEstimate;
}

void take_report(const Packet& packet, double now, std::optional<std::uint8_t> wanted,
                 FlightFrame& frame, VehicleClock& clock, VehicleReport& report) {
  if (wanted && packet.system != *wanted) return;
  if (packet.message == kHeartbeat && packet.component == kAutopilotComponent) {
    const std::uint8_t autopilot = Message<kHeartbeat>(packet).get<"autopilot">();
    if (autopilot == kNoAutopilot) return;
    if (!report.found()) report.system = packet.system, report.component = packet.component;
    if (packet.system != report.system) report.second_system = packet.system;
  }
  if (!report.found() && packet.message != kHeartbeat) return;
  if (packet.system != report.system) return;
  take_gimbal(packet, report);
  if (packet.component != report.component) return;
  report.heard_at = now;
  report.has_signatures = report.has_signatures || packet.has_signature;
  take_message(packet, now, frame, clock, report);
}

}  // namespace lapwing
