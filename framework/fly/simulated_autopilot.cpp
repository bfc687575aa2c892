// SPDX-License-Identifier: Apache-2.0
#include "framework/fly/simulated_autopilot.h"

#include <algorithm>
#include <cmath>

#include "framework/core/error.h"
#include "framework/core/units.h"
#include "framework/fly/flight_frame.h"
#include "framework/mavlink/message.h"
#include "framework/mavlink/vocabulary.h"

namespace lapwing {

using Eigen::Vector3d;
using namespace mavlink;

namespace {

constexpr double kStreamLoss = 0.5;                   // s without a setpoint: hold
constexpr double kLandAfter = 10;                     // s of holding after that
constexpr double kPilotArms = 1, kPilotSwitches = 2;  // s after setpoints come
constexpr double kModeStream = 0.5;                   // s of setpoints that the mode needs
constexpr double kBrake = 3;                          // m/s^2, of the modes that it flies itself
constexpr double kSink = 0.7;                         // m/s, landing
constexpr double kQuiet = 2;  // s without a packet: nobody is there any more
constexpr double kE7 = 1e7;
constexpr double kGroundAboveSea = 400;  // m, of an origin that does not tell it

Plan with_some_origin(const Plan& plan) {
  Plan placed;
  placed.mission = plan.mission;
  placed.geodetic_origin = origin_above_home(plan);
  if (!placed.geodetic_origin)
    placed.geodetic_origin = GeodeticOrigin{46.5191, 6.5668, 395, HeightOf::sea, 0};
  return placed;
}

Vector3d start_of(const LiveFlight& flight, const SimulatedFaults& faults) {
  return flight.trajectory().samples.front().position + faults.offset * Vector3d::UnitX();
}

std::int32_t e7(double degrees) {
  return static_cast<std::int32_t>(std::llround(degrees * kE7));
}

std::int32_t millimetres(double metres) {
  return static_cast<std::int32_t>(std::llround(metres * 1000));
}

std::int16_t centimetres(double metres) {
  return static_cast<std::int16_t>(std::clamp(std::lround(metres * 100), -32768L, 32767L));
}

// Roll, pitch and yaw of a body with y left and z up in the axes of one with y right and z down.
Vector3d tilt_of(const Eigen::Quaterniond& q) {
  const Eigen::Matrix3d r = q.toRotationMatrix();
  const double pitch = std::asin(std::clamp(r(2, 0), -1.0, 1.0));
  const double roll = std::atan2(r(2, 1), r(2, 2));
  return {roll, pitch, turned_yaw(std::atan2(r(1, 0), r(0, 0)))};
}

// What the mask leaves out is zero; the yaw is then `yaw`. Nothing where places are left out, or
// accelerations are forces: this vehicle follows places.
template <class Target>
std::optional<Setpoint> setpoint_of(const Target& target, double yaw) {
  const std::uint16_t mask = target.template get<"type_mask">();
  if (mask & (kIgnorePosition | kForceSet)) return std::nullopt;
  const auto kept = [mask](std::uint16_t ignored, const Vector3d& v) -> Vector3d {
    return mask & ignored ? Vector3d::Zero() : v;
  };
  Setpoint setpoint;
  setpoint.velocity =
      kept(kIgnoreVelocity, east_north_up(target.template get<"vx">(), target.template get<"vy">(),
                                          target.template get<"vz">()));
  setpoint.acceleration = kept(
      kIgnoreAcceleration, east_north_up(target.template get<"afx">(), target.template get<"afy">(),
                                         target.template get<"afz">()));
  setpoint.yaw = mask & kIgnoreYaw ? yaw : turned_yaw(target.template get<"yaw">());
  setpoint.yaw_rate = mask & kIgnoreYawRate ? 0 : -target.template get<"yaw_rate">();
  return setpoint;
}

}  // namespace

SimulatedAutopilot::SimulatedAutopilot(const LiveFlight& flight, const AutopilotOptions& options)
    : flight_(flight),
      options_(options),
      earth_plan_(with_some_origin(flight.plan)),
      earth_(earth_plan_, std::nullopt, "autopilot"),
      home_(flight.plan.home ? flight.plan.home->position : Vector3d::Zero()),
      body_(flight.vehicle, start_of(flight, options.faults),
            flight.trajectory().samples.front().yaw),
      audit_(flight.vehicle),
      incoming_(options_.faults, options.seed),
      outgoing_(options_.faults, options.seed + 1),
      fence_(earth_, earth_.at(home_).height, options_.faults.refuse_fence) {
  reference_ = body_.setpoint();
}

std::uint32_t SimulatedAutopilot::custom_mode() const {
  switch (mode_) {
    case Mode::hover:
      return options_.ardupilot ? kCopterLoiter : kPx4Position;
    case Mode::follow:
      return options_.ardupilot ? kCopterGuided : kPx4Offboard;
    case Mode::hold:
      return options_.ardupilot ? kCopterBrake : kPx4Hold;
    default:
      return options_.ardupilot ? kCopterLand : kPx4Land;
  }
}

std::string SimulatedAutopilot::mode_name() const {
  constexpr const char* kNames[] = {"hover", "follow", "hold", "land"};
  return kNames[static_cast<int>(mode_)];
}

bool SimulatedAutopilot::link_open(double now) const {
  const SimulatedFaults& faults = options_.faults;
  const double since = following_for(now) - faults.gap_at;
  return !(followed_at_ && faults.gap > 0 && since >= 0 && since < faults.gap);
}

void SimulatedAutopilot::receive(std::string_view datagram, double now) {
  if (!datagram.empty()) incoming_.push(std::string(datagram), now, link_open(now));
}

void SimulatedAutopilot::change(Mode mode, double now) {
  if (mode == mode_) return;
  mode_ = mode;
  mode_at_ = now;
  if (mode == Mode::follow) {
    if (!followed_at_) followed_at_ = now;
    return;
  }
  if (mode == Mode::land) return;
  // It brakes from what it flies.
  reference_ = body_.setpoint();
  reference_.position = body_.state().position;
  reference_.velocity = body_.state().velocity;
  reference_.acceleration = Vector3d::Zero();
  reference_.yaw_rate = 0;
}

void SimulatedAutopilot::take_setpoint(const Setpoint& setpoint, double stamp, double now) {
  if (now - setpoint_at_ > kStreamLoss) stream_began_ = now;
  setpoint_at_ = now;
  if (mode_ != Mode::follow) return;
  audit_.take(setpoint, stamp, now);
  body_.aim(setpoint);
}

void SimulatedAutopilot::take_local(const Packet& packet, double now) {
  const Message<kLocalTarget> target(packet);
  auto setpoint = setpoint_of(target, body_.setpoint().yaw);
  if (!setpoint || target.get<"coordinate_frame">() != kFrameLocalNed) {
    ++refused_setpoints_;
    return;
  }
  setpoint->position = east_north_up(target.get<"x">(), target.get<"y">(), target.get<"z">());
  take_setpoint(*setpoint, target.get<"time_boot_ms">() * 1e-3, now);
}

void SimulatedAutopilot::take_global(const Packet& packet, double now) {
  const Message<kGlobalTarget> target(packet);
  auto setpoint = setpoint_of(target, body_.setpoint().yaw);
  const std::uint8_t frame = target.get<"coordinate_frame">();
  const bool relative = frame == kFrameRelativeInt || frame == kFrameRelative;
  if (!setpoint || !(relative || frame == kFrameGlobalInt || frame == kFrameGlobal)) {
    ++refused_setpoints_;
    return;
  }
  // Heights of an origin above the ground are those above home.
  const bool ground = earth_.heights() == HeightOf::ground;
  const double height = target.get<"alt">() + (relative && !ground ? earth_.at(home_).height : 0) -
                        (ground && !relative ? kGroundAboveSea : 0);
  setpoint->position =
      earth_.local({target.get<"lat_int">() / kE7, target.get<"lon_int">() / kE7, height});
  take_setpoint(*setpoint, target.get<"time_boot_ms">() * 1e-3, now);
}

void SimulatedAutopilot::acknowledge(std::uint16_t command, std::uint8_t result) {
  answers_.push_back(Message<kCommandAck>()
                         .set<"command">(command)
                         .set<"result">(result)
                         .set<"target_system">(sender_)
                         .set<"target_component">(sender_component_)
                         .packet());
}

std::uint8_t SimulatedAutopilot::answer_mode(const std::array<double, 3>& params, double now) {
  if (options_.faults.refuse_mode) return kDenied;
  const std::uint32_t wanted = options_.ardupilot ? static_cast<std::uint32_t>(params[1])
                                                  : px4_mode(static_cast<std::uint32_t>(params[1]),
                                                             static_cast<std::uint32_t>(params[2]));
  if (wanted == (options_.ardupilot ? kCopterGuided : kPx4Offboard)) {
    const bool stream = now - setpoint_at_ < kStreamLoss && now - stream_began_ > kModeStream;
    if (!armed_ || (!stream && !options_.ardupilot)) return kTemporarilyRejected;
    change(Mode::follow, now);
    return kAccepted;
  }
  if (wanted == (options_.ardupilot ? kCopterLoiter : kPx4Hold)) {
    change(Mode::hold, now);
    return kAccepted;
  }
  return kUnsupported;
}

void SimulatedAutopilot::send_requested(std::uint32_t message) {
  const GeodeticPoint origin = earth_.origin().point();
  const EarthPoint home = earth_.at(home_);
  const double ground = earth_.heights() == HeightOf::ground ? kGroundAboveSea : 0;
  if (message == kHomePosition)
    answers_.push_back(Message<kHomePosition>()
                           .set<"latitude">(e7(home.latitude_deg))
                           .set<"longitude">(e7(home.longitude_deg))
                           .set<"altitude">(millimetres(home.height + ground))
                           .packet());
  if (message == kGlobalOrigin)
    answers_.push_back(
        Message<kGlobalOrigin>()
            .set<"latitude">(e7(origin.latitude_deg))
            .set<"longitude">(e7(origin.longitude_deg))
            .set<"altitude">(millimetres(earth_.at(Vector3d::Zero()).height + ground))
            .packet());
  if (message == kAutopilotVersion)
    answers_.push_back(Message<kAutopilotVersion>()
                           .set<"capabilities">(1u << 13)
                           .set<"flight_sw_version">(0x010e0000)
                           .packet());
  if (message == kGimbalManagerInformation && flight_.vehicle.gimbal) {
    const GimbalLimits& gimbal = *flight_.vehicle.gimbal;
    answers_.push_back(Message<kGimbalManagerInformation>()
                           .set<"gimbal_device_id">(1)
                           .set<"pitch_min">(static_cast<float>(gimbal.pitch_min))
                           .set<"pitch_max">(static_cast<float>(gimbal.pitch_max))
                           .packet());
  }
}

void SimulatedAutopilot::take_command(std::uint16_t command, const std::array<double, 3>& params,
                                      double now) {
  switch (command) {
    case kDoSetMode:
      return acknowledge(command, answer_mode(params, now));
    case kComponentArmDisarm:
      ++arm_requests_;
      return acknowledge(command, kDenied);
    case kRequestMessage:
      send_requested(static_cast<std::uint32_t>(params[0]));
      return acknowledge(command, kAccepted);
    case kSetMessageInterval:
      return acknowledge(command, kAccepted);
    case kGimbalPitchYaw:
    case kGimbalConfigure:
      return acknowledge(command, answer_gimbal(command, params));
    case kDoSetRoiLocation:
      return acknowledge(command, kAccepted);
    default:
      return acknowledge(command, kUnsupported);
  }
}

// Only whoever has asked for control (-2 in the first place: whoever asks) turns the gimbal.
std::uint8_t SimulatedAutopilot::answer_gimbal(std::uint16_t command,
                                               const std::array<double, 3>& params) {
  if (options_.faults.refuse_gimbal) return kDenied;
  if (command == kGimbalConfigure) {
    ++gimbal_asked_;
    gimbal_owned_ = gimbal_owned_ || params[0] == -2;
    return kAccepted;
  }
  if (!gimbal_owned_) return kDenied;
  turn_gimbal(params[0], params[1]);
  return kAccepted;
}

void SimulatedAutopilot::turn_gimbal(double pitch_deg, double yaw_deg) {
  if (!gimbal_owned_) return;
  ++gimbal_messages_;
  gimbal_pitch_deg_ = pitch_deg;
  gimbal_yaw_deg_ = yaw_deg;
}

// Packets for all are for us; those for others are left out.
bool SimulatedAutopilot::is_for_us(const Packet& packet) const {
  const auto named = [](const auto& message) {
    const std::uint8_t target = message.template get<"target_system">();
    return target == kSystem || target == 0;
  };
  switch (packet.message) {
    case kLocalTarget:
      return named(Message<kLocalTarget>(packet));
    case kGlobalTarget:
      return named(Message<kGlobalTarget>(packet));
    case kMissionCount:
      return named(Message<kMissionCount>(packet));
    case kMissionItemInt:
      return named(Message<kMissionItemInt>(packet));
    case kCommandLong:
      return named(Message<kCommandLong>(packet));
    case kCommandInt:
      return named(Message<kCommandInt>(packet));
    case kGimbalManagerSetAttitude:
      return named(Message<kGimbalManagerSetAttitude>(packet));
    case kTimesync:
      return named(Message<kTimesync>(packet));
    default:
      return true;
  }
}

void SimulatedAutopilot::take(const Packet& packet, double now) {
  heard_at_ = now;
  if (!is_for_us(packet)) {
    ++for_others_;
    return;
  }
  sender_ = packet.system, sender_component_ = packet.component;
  switch (packet.message) {
    case kLocalTarget:
      return take_local(packet, now);
    case kGlobalTarget:
      return take_global(packet, now);
    case kMissionCount:
    case kMissionItemInt:
      if (auto answer = fence_.receive(packet, now)) answers_.push_back(std::move(*answer));
      return;
    case kCommandLong: {
      const Message<kCommandLong> m(packet);
      return take_command(m.get<"command">(),
                          {m.get<"param1">(), m.get<"param2">(), m.get<"param3">()}, now);
    }
    case kCommandInt: {
      const Message<kCommandInt> m(packet);
      return take_command(m.get<"command">(),
                          {m.get<"param1">(), m.get<"param2">(), m.get<"param3">()}, now);
    }
    case kGimbalManagerSetAttitude: {
      const Message<kGimbalManagerSetAttitude> m(packet);
      const double w = m.get<"q">(0), x = m.get<"q">(1), y = m.get<"q">(2), z = m.get<"q">(3);
      return turn_gimbal(degrees(std::asin(std::clamp(2 * (w * y - z * x), -1.0, 1.0))),
                         degrees(std::atan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z))));
    }
    case kTimesync: {
      const Message<kTimesync> m(packet);
      if (m.get<"tc1">() != 0) return;
      answers_.push_back(Message<kTimesync>()
                             .set<"tc1">(std::llround(vehicle_time(now) * 1e9))
                             .set<"ts1">(m.get<"ts1">())
                             .packet());
      return;
    }
    default:
      return;
  }
}

void SimulatedAutopilot::play_pilot(double now) {
  const bool stream = now - setpoint_at_ < kStreamLoss;
  if (options_.pilot == SimulatedPilot::none || !stream || followed_at_) return;
  if (!armed_ && now - stream_began_ > kPilotArms) {
    if (options_.faults.refuse_arming) {
      if (!denial_told_)
        answers_.push_back(Message<kStatusText>()
                               .set<"severity">(kWarning)
                               .set_text<"text">("Arming denied")
                               .packet());
      denial_told_ = true;
      return;
    }
    armed_ = true;
    armed_at_ = now;
  }
  if (armed_ && options_.pilot == SimulatedPilot::flies && now - stream_began_ > kPilotSwitches) {
    if (options_.faults.refuse_mode) return;
    change(Mode::follow, now);
  }
}

void SimulatedAutopilot::play_faults(double now) {
  const SimulatedFaults& faults = options_.faults;
  if (!followed_at_) return;
  if (!jump_done_ && faults.jump != 0 && following_for(now) >= faults.jump_at)
    jumped_ += faults.jump, jump_done_ = true;
  if (faults.takeover_at && following_for(now) >= *faults.takeover_at && mode_ == Mode::follow)
    change(Mode::hover, now);
}

// Modes that it flies itself: brake, hold, sink.
void SimulatedAutopilot::follow_modes(double now) {
  if (mode_ == Mode::follow && now - setpoint_at_ > kStreamLoss) {
    failsafe_ = true;
    change(Mode::hold, now);
  }
  if (failsafe_ && mode_ == Mode::hold && now - mode_at_ > kLandAfter) change(Mode::land, now);
  if (mode_ == Mode::follow) return;
  const double speed = reference_.velocity.norm();
  if (mode_ != Mode::land) {
    const double slower = std::max(0.0, speed - kBrake * kPeriod);
    reference_.acceleration =
        speed > 0 ? Vector3d(-kBrake / speed * reference_.velocity) : Vector3d::Zero();
    if (slower == 0) reference_.acceleration.setZero();
    const Vector3d next =
        speed > 0 ? Vector3d(slower / speed * reference_.velocity) : Vector3d::Zero();
    reference_.position += 0.5 * kPeriod * (reference_.velocity + next);
    reference_.velocity = next;
  } else {
    const double ground = std::min(0.0, flight_.trajectory().samples.front().position.z());
    const bool down = reference_.position.z() <= ground;
    reference_.velocity = down ? Vector3d::Zero() : Vector3d(0, 0, -kSink);
    reference_.acceleration.setZero();
    reference_.position += kPeriod * reference_.velocity;
    if (down && !landed_) landed_ = true, armed_ = false;
  }
  body_.aim(reference_);
}

void SimulatedAutopilot::fly_period(double now) {
  play_pilot(now);
  play_faults(now);
  follow_modes(now);
  if (!armed_) return;  // it stands
  constexpr int kSteps = static_cast<int>(kPeriod / SimulatedBody::kStep + 0.5);
  for (int i = 0; i < kSteps; ++i) body_.advance();
  fence_.watch(body_.state().position.head<2>());
}

void SimulatedAutopilot::telemetry(double now, Packets& packets) {
  const auto ms = static_cast<std::uint32_t>(std::llround(vehicle_time(now) * 1000));
  const BodyState& state = body_.state();
  const Vector3d& p = state.position;
  const Vector3d& v = state.velocity;
  const EarthPoint point = earth_.at(p);
  const double home = earth_.at(home_).height;
  const bool ground = earth_.heights() == HeightOf::ground;
  const auto single = [](double number) { return static_cast<float>(number); };
  packets.push_back(Message<kLocalPosition>()
                        .set<"time_boot_ms">(ms)
                        .set<"x">(single(p.y()))
                        .set<"y">(single(p.x()))
                        .set<"z">(single(-p.z()))
                        .set<"vx">(single(v.y()))
                        .set<"vy">(single(v.x()))
                        .set<"vz">(single(-v.z()))
                        .packet());
  packets.push_back(
      Message<kGlobalPosition>()
          .set<"time_boot_ms">(ms)
          .set<"lat">(e7(point.latitude_deg))
          .set<"lon">(e7(point.longitude_deg))
          .set<"alt">(millimetres(point.height + (ground ? kGroundAboveSea : 0)))
          .set<"relative_alt">(millimetres(ground ? point.height : point.height - home))
          .set<"vx">(centimetres(v.y()))
          .set<"vy">(centimetres(v.x()))
          .set<"vz">(centimetres(-v.z()))
          .set<"hdg">(65535)
          .packet());
  const Vector3d tilt = tilt_of(state.orientation);
  packets.push_back(Message<kAttitude>()
                        .set<"time_boot_ms">(ms)
                        .set<"roll">(single(tilt.x()))
                        .set<"pitch">(single(tilt.y()))
                        .set<"yaw">(single(turned_yaw(body_.yaw())))
                        .set<"rollspeed">(single(state.body_rates.x()))
                        .set<"pitchspeed">(single(-state.body_rates.y()))
                        .set<"yawspeed">(single(-state.body_rates.z()))
                        .packet());
}

void SimulatedAutopilot::slow_telemetry(double now, Packets& packets) {
  packets.push_back(
      Message<kHeartbeat>()
          .set<"type">(kQuadrotor)
          .set<"autopilot">(options_.ardupilot ? kArduPilot : kPx4)
          .set<"base_mode">(static_cast<std::uint8_t>(kCustomMode | (armed_ ? kArmed : 0)))
          .set<"custom_mode">(custom_mode())
          .set<"system_status">(armed_ ? kActive : kStandby)
          .set<"mavlink_version">(3)
          .packet());
  const SimulatedFaults& faults = options_.faults;
  const bool bad =
      faults.lose_estimate || (faults.unwell_at && following_for(now) >= *faults.unwell_at);
  const std::uint16_t good = kAttitudeGood | kVelocityAcrossGood | kVelocityUpGood |
                             kRelativePlaceGood | kAbsolutePlaceGood | kHeightGood;
  packets.push_back(Message<kEstimatorStatus>()
                        .set<"time_usec">(static_cast<std::uint64_t>(vehicle_time(now) * 1e6))
                        .set<"flags">(bad ? std::uint16_t{kAttitudeGood} : good)
                        .packet());
  const double used = armed_at_ ? 100 * (now - *armed_at_) / flight_.vehicle.flight_time : 0;
  packets.push_back(
      Message<kSysStatus>()
          .set<"onboard_control_sensors_enabled">(kAttitudeSystem | kGpsSensor)
          .set<"onboard_control_sensors_health">(bad ? 0 : kAttitudeSystem | kGpsSensor)
          .set<"battery_remaining">(static_cast<std::int8_t>(std::max(0.0, faults.battery - used)))
          .packet());
  packets.push_back(
      Message<kExtendedSysState>().set<"landed_state">(landed_ ? kOnGround : kInAir).packet());
}

std::vector<std::string> SimulatedAutopilot::step(double now) {
  for (const std::string& datagram : incoming_.pop(now))
    for (const Packet& packet : parser_.read(datagram, Source::datagram)) take(packet, now);
  fly_period(now);
  Packets packets;
  packets.swap(answers_);
  telemetry(now, packets);
  if (now - slow_at_ >= 1) slow_telemetry(now, packets), slow_at_ = now;
  if (auto request = fence_.step(now)) packets.push_back(std::move(*request));
  for (Packet& packet : packets) {
    packet.system = kSystem, packet.component = kAutopilotComponent;
    packet.sequence = sequence_++;
    outgoing_.push(bytes_of(packet), now, link_open(now));
  }
  return outgoing_.pop(now);
}

bool SimulatedAutopilot::over(double now) const {
  if (now - heard_at_ < kQuiet || heard_at_ < 0) return false;
  if (!followed_at_) return true;
  return mode_ != Mode::follow && body_.state().velocity.norm() < 0.1;
}

Value SimulatedAutopilot::to_value() const {
  Value value = Value::map();
  value.set("setpoints", audit_.to_value());
  value.set("followed", followed());
  value.set("mode", mode_name());
  value.set("failsafe", failsafe_);
  value.set("armed", armed_);
  value.set("arm_requests", arm_requests_);
  value.set("fence_items", static_cast<std::int64_t>(fence_.items()));
  value.set("fences", static_cast<std::int64_t>(fence_.fences().size()));
  value.set("fence_breaches", static_cast<std::int64_t>(fence_.breaches()));
  value.set("gimbal_messages", gimbal_messages_);
  value.set("gimbal_pitch_deg", gimbal_pitch_deg_);
  value.set("gimbal_yaw_deg", gimbal_yaw_deg_);
  value.set("gimbal_asked", gimbal_asked_);
  value.set("refused_setpoints", refused_setpoints_);
  value.set("packets_for_others", for_others_);
  value.set("lost_packets", static_cast<std::int64_t>(parser_.counts().lost));
  value.set("damaged_packets", static_cast<std::int64_t>(parser_.counts().bad_checksums));
  Value& place = value.set("position", Value::list());
  for (int i = 0; i < 3; ++i) place.push_back(body_.state().position[i]);
  value.set("speed", body_.state().velocity.norm());
  return value;
}

}  // namespace lapwing
