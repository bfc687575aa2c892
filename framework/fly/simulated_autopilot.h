// SPDX-License-Identifier: Apache-2.0
// An autopilot of our own for rehearsals and tests, that a ground station could not tell from PX4
// or ArduPilot by the messages of a live flight. Without sockets: packets and times come from
// outside.
//
// It stands, disarmed, where the plan begins. Its pilot, where there is one, arms 1 s after
// setpoints come, and switches the mode 1 s later. Armed, it hovers. In OFFBOARD or GUIDED it
// follows the setpoints. 0.5 s without one: it brakes and holds; 10 s later it lands. It never lets
// itself be armed by a command. It leaves out packets for other systems, refuses setpoints without
// a place or in a frame that it does not know, takes what their mask leaves out for zero, and turns
// its gimbal for nobody who has not asked for control of it.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "framework/export/earth_frame.h"
#include "framework/fly/link_faults.h"
#include "framework/fly/live_flight.h"
#include "framework/fly/setpoint_audit.h"
#include "framework/fly/simulated_body.h"
#include "framework/fly/simulated_fence.h"
#include "framework/mavlink/message.h"
#include "framework/mavlink/packet_parser.h"

namespace lapwing {

enum class SimulatedPilot { none, arms, flies };

struct AutopilotOptions {
  bool ardupilot = false;
  SimulatedPilot pilot = SimulatedPilot::none;
  SimulatedFaults faults;
  std::uint64_t seed = 1;
};

class SimulatedAutopilot {
 public:
  static constexpr double kPeriod = 0.02;  // s, of `step`
  static constexpr std::uint8_t kSystem = 1;

  // Keeps a reference. A plan without an origin stands near Lausanne; its world is the local frame.
  // Throws InputError for a vehicle that cannot be simulated.
  SimulatedAutopilot(const LiveFlight& flight, const AutopilotOptions& options);

  // Bytes that arrived by the link, and bytes for it: one datagram each.
  void receive(std::string_view datagram, double now);
  std::vector<std::string> step(double now);

  // Whether a flight has begun and ended: it holds or stands, and nobody sends any more.
  bool over(double now) const;
  bool followed() const { return followed_at_.has_value(); }
  const SetpointAudit& audit() const { return audit_; }
  const BodyState& state() const { return body_.state(); }
  std::string mode_name() const;
  int arm_requests() const { return arm_requests_; }
  const std::vector<MissionFence>& fence() const { return fence_.fences(); }
  // Setpoints, fence, breaches of it, failsafe, mode, place.
  Value to_value() const;

 private:
  enum class Mode { hover, follow, hold, land };
  using Packets = std::vector<mavlink::Packet>;
  double vehicle_time(double now) const { return now + boot_ + jumped_; }
  double following_for(double now) const { return followed_at_ ? now - *followed_at_ : -1; }
  bool link_open(double now) const;
  void take(const mavlink::Packet& packet, double now);
  bool is_for_us(const mavlink::Packet& packet) const;
  void take_setpoint(const Setpoint& setpoint, double stamp, double now);
  void take_global(const mavlink::Packet& packet, double now);
  void take_local(const mavlink::Packet& packet, double now);
  void take_command(std::uint16_t command, const std::array<double, 3>& params, double now);
  void turn_gimbal(double pitch_deg, double yaw_deg);
  std::uint8_t answer_gimbal(std::uint16_t command, const std::array<double, 3>& params);
  std::uint8_t answer_mode(const std::array<double, 3>& params, double now);
  void acknowledge(std::uint16_t command, std::uint8_t result);
  void send_requested(std::uint32_t message);
  void play_pilot(double now);
  void play_faults(double now);
  void change(Mode mode, double now);
  void follow_modes(double now);
  void fly_period(double now);
  void telemetry(double now, Packets& packets);
  void slow_telemetry(double now, Packets& packets);
  std::uint32_t custom_mode() const;

  const LiveFlight& flight_;
  AutopilotOptions options_;
  Plan earth_plan_;
  EarthFrame earth_;
  Eigen::Vector3d home_;  // m, world
  SimulatedBody body_;
  SetpointAudit audit_;
  FaultyChannel incoming_, outgoing_;
  mavlink::PacketParser parser_;
  Packets answers_;
  std::uint8_t sequence_ = 0;
  Mode mode_ = Mode::hover;
  bool armed_ = false, jump_done_ = false, failsafe_ = false, landed_ = false;
  bool denial_told_ = false;
  double boot_ = 120, jumped_ = 0;  // s, of its clock
  double setpoint_at_ = -1e9, stream_began_ = -1e9, slow_at_ = -1e9, heard_at_ = -1e9;
  double mode_at_ = 0, step_at_ = -1;
  std::optional<double> followed_at_, armed_at_;
  Setpoint reference_;  // of the modes that it flies itself
  double reference_speed_ = 0;
  int arm_requests_ = 0, gimbal_messages_ = 0, refused_setpoints_ = 0, for_others_ = 0;
  bool gimbal_owned_ = false;  // somebody asked for control of it
  int gimbal_asked_ = 0;
  double gimbal_pitch_deg_ = 0, gimbal_yaw_deg_ = 0;  // yaw: from north, clockwise
  std::uint8_t sender_ = 0, sender_component_ = 0;    // of the last packet
  SimulatedFence fence_;
};

}  // namespace lapwing
