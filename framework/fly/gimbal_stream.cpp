// SPDX-License-Identifier: Apache-2.0
#include "framework/fly/gimbal_stream.h"

#include <cmath>
#include <limits>

#include "framework/core/error.h"
#include "framework/core/units.h"
#include "framework/mavlink/vocabulary.h"

namespace lapwing {

using namespace mavlink;

namespace {

constexpr double kCommandEvery = 0.2;  // s
constexpr double kControlEvery = 1;    // s, for control of the gimbal

constexpr std::uint32_t kLocks = kRollLock | kPitchLock | kYawLock;

// The component that manages the gimbal.
std::uint8_t manager_of(const VehicleReport& report) {
  return report.gimbal_device ? report.gimbal_component : report.component;
}

float single(double number) {
  return static_cast<float>(number);
}

// Yaw about down, then pitch about right.
void set_attitude(Message<kGimbalManagerSetAttitude>& message, double yaw, double pitch) {
  const double cy = std::cos(yaw / 2), sy = std::sin(yaw / 2);
  const double cp = std::cos(pitch / 2), sp = std::sin(pitch / 2);
  const double q[] = {cy * cp, -sy * sp, cy * sp, sy * cp};
  for (std::size_t i = 0; i < 4; ++i) message.set<"q">(single(q[i]), i);
  const float unset = std::numeric_limits<float>::quiet_NaN();
  message.set<"angular_velocity_x">(unset)
      .set<"angular_velocity_y">(unset)
      .set<"angular_velocity_z">(unset);
}

Packet attitude_packet(const Setpoint& setpoint, const VehicleReport& report) {
  Message<kGimbalManagerSetAttitude> message;
  message.set<"target_system">(report.system)
      .set<"target_component">(manager_of(report))
      .set<"flags">(kLocks)
      .set<"gimbal_device_id">(report.gimbal_device.value_or(0));
  set_attitude(message, turned_yaw(setpoint.yaw + setpoint.gimbal_yaw), setpoint.gimbal_pitch);
  return message.packet();
}

Packet command_packet(const Setpoint& setpoint, const VehicleReport& report) {
  const float unset = std::numeric_limits<float>::quiet_NaN();
  return Message<kCommandLong>()
      .set<"target_system">(report.system)
      .set<"target_component">(manager_of(report))
      .set<"command">(kGimbalPitchYaw)
      .set<"param1">(single(degrees(setpoint.gimbal_pitch)))
      .set<"param2">(single(degrees(turned_yaw(setpoint.yaw + setpoint.gimbal_yaw))))
      .set<"param3">(unset)
      .set<"param4">(unset)
      .set<"param5">(single(kLocks))
      .packet();
}

// The gimbal is to listen to us.
Packet owner_packet(const VehicleReport& report) {
  return Message<kCommandLong>()
      .set<"target_system">(report.system)
      .set<"target_component">(manager_of(report))
      .set<"command">(kGimbalConfigure)
      .set<"param1">(-2)  // the sender of this command
      .set<"param2">(-2)
      .set<"param3">(-1)  // as it is
      .set<"param4">(-1)
      .packet();
}

Packet target_packet(const EarthPoint& point, bool relative, const VehicleReport& report) {
  return Message<kCommandInt>()
      .set<"target_system">(report.system)
      .set<"target_component">(report.component)
      .set<"frame">(relative ? kFrameRelativeInt : kFrameGlobalInt)
      .set<"command">(kDoSetRoiLocation)
      .set<"x">(static_cast<std::int32_t>(std::llround(point.latitude_deg * 1e7)))
      .set<"y">(static_cast<std::int32_t>(std::llround(point.longitude_deg * 1e7)))
      .set<"z">(single(point.height))
      .packet();
}

}  // namespace

std::optional<GimbalWay> gimbal_way_named(std::string_view word) {
  if (word == "auto") return GimbalWay::automatic;
  if (word == "manager") return GimbalWay::manager;
  if (word == "command") return GimbalWay::command;
  if (word == "roi") return GimbalWay::target;
  if (word == "none") return GimbalWay::none;
  return std::nullopt;
}

GimbalStream::GimbalStream(GimbalWay way, const Plan& plan, const FlightFrame& frame) : way_(way) {
  if (way == GimbalWay::target && !plan.trajectory.has_target)
    throw InputError("--gimbal roi: the plan has no points to look at; use manager or command");
  if (way == GimbalWay::target && frame.kind() == FlightFrameKind::local)
    throw InputError(
        "--gimbal roi: points to look at are places on the earth; the local frame has "
        "none");
  if (!plan.trajectory.has_gimbal && way != GimbalWay::target) way_ = GimbalWay::none;
}

GimbalWay GimbalStream::way_now(const VehicleReport& report) const {
  if (way_ != GimbalWay::automatic) return way_;
  return report.gimbal_device ? GimbalWay::manager : GimbalWay::command;
}

void GimbalStream::receive(const Packet& packet, const VehicleReport& report) {
  if (packet.message != kCommandAck || packet.component != manager_of(report) || answered_) return;
  const Message<kCommandAck> ack(packet);
  const std::uint8_t target = ack.get<"target_system">();
  if (ack.get<"command">() != kGimbalConfigure || (target != 0 && target != kOurSystem)) return;
  const int result = ack.get<"result">();
  if (result == kInProgress || result == kTemporarilyRejected) return;
  answered_ = true;
  if (result != kAccepted)
    said_ = "the vehicle's gimbal does not listen to us (MAV_RESULT " + std::to_string(result) +
            "): the camera may look elsewhere";
}

std::string GimbalStream::take_said() {
  std::string said;
  said.swap(said_);
  return said;
}

std::vector<Packet> GimbalStream::step(double now, const Setpoint& setpoint,
                                       const VehicleReport& report, const FlightFrame& frame) {
  std::vector<Packet> packets;
  const GimbalWay way = way_now(report);
  if (way == GimbalWay::none) return packets;
  if (!answered_ && way != GimbalWay::target && now - asked_at_ >= kControlEvery) {
    packets.push_back(owner_packet(report));
    asked_at_ = now;
  }
  if (way == GimbalWay::manager) {
    packets.push_back(attitude_packet(setpoint, report));
    return packets;
  }
  if (now - sent_at_ < kCommandEvery) return packets;
  sent_at_ = now;
  if (way == GimbalWay::command) {
    packets.push_back(command_packet(setpoint, report));
  } else if (const auto point = frame.on_earth(setpoint.target)) {
    packets.push_back(target_packet(*point, frame.heights_above_home(), report));
  }
  return packets;
}

}  // namespace lapwing
