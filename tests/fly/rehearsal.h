// SPDX-License-Identifier: Apache-2.0
// A session and a simulated autopilot in one process and in virtual time.
#pragma once

#include <functional>
#include <numbers>

#include "framework/fly/flight_session.h"
#include "framework/fly/simulated_autopilot.h"
#include "framework/mavlink/packet_parser.h"
#include "tests/camera_drone.h"

namespace lapwing {

inline Vehicle flying_drone() {
  Vehicle vehicle = camera_drone();
  vehicle.acceleration_up_max = 3;
  vehicle.acceleration_down_max = 3;
  vehicle.rotors.lag = 0.03;
  vehicle.drag = 0.2;
  vehicle.camera = {"small", 640, 480, 400, 400, 319.5, 239.5};
  vehicle.gimbal = GimbalLimits{-0.5, 0.5, -1.5, 0.5, 1, 1};
  return vehicle;
}

// Round a circle of 6 m in 16 s, rising by 2 m, looking to its centre; from rest to rest, or, with
// `moving`, with an even speed from the start to the end.
inline Plan circle_plan(bool moving = false) {
  Plan plan;
  plan.mission = "circle";
  plan.kind = "film";
  const Vehicle vehicle = flying_drone();
  plan.vehicle = to_value(vehicle);
  plan.trajectory.inputs_held = false;
  plan.trajectory.has_gimbal = true;
  constexpr double kDuration = 16, kStep = 0.05, kRadius = 6, kTurn = 2 * std::numbers::pi;
  for (int i = 0; i * kStep <= kDuration + 1e-9; ++i) {
    const double t = i * kStep / kDuration;
    // Shares of the way with their derivatives: eased, or even.
    const double s = moving ? t : t * t * t * (10 - 15 * t + 6 * t * t);
    const double ds = moving ? 1 / kDuration : t * t * (30 - 60 * t + 30 * t * t) / kDuration;
    const double dds = moving ? 0 : t * (60 - 180 * t + 120 * t * t) / (kDuration * kDuration);
    const double a = kTurn * s, da = kTurn * ds, dda = kTurn * dds;
    Sample sample;
    sample.time = i * kStep;
    sample.position = {kRadius * std::cos(a), kRadius * std::sin(a), 5 + 2 * s};
    sample.velocity = {-kRadius * std::sin(a) * da, kRadius * std::cos(a) * da, 2 * ds};
    sample.acceleration = {-kRadius * (std::cos(a) * da * da + std::sin(a) * dda),
                           -kRadius * (std::sin(a) * da * da - std::cos(a) * dda), 2 * dds};
    sample.yaw = a + std::numbers::pi;
    sample.yaw_rate = da;
    sample.gimbal_pitch = -0.4;
    plan.trajectory.samples.push_back(sample);
  }
  return plan;
}

inline MissionFence square_fence(double half) {
  MissionFence fence;
  fence.name = "field";
  fence.inclusion = true;
  fence.corners = {{-half, -half}, {-half, half}, {half, half}, {half, -half}};
  return fence;
}

// m, of a place from the path, at its samples.
inline double distance_from_path(const Plan& plan, const Eigen::Vector3d& place) {
  double nearest = 1e9;
  for (const Sample& s : plan.trajectory.samples)
    nearest = std::min(nearest, (s.position - place).norm());
  return nearest;
}

class Rehearsal {
 public:
  explicit Rehearsal(const Plan& plan = circle_plan(), AutopilotOptions autopilot = {},
                     SessionOptions session = {}, FlightFrameKind frame = FlightFrameKind::local,
                     std::vector<MissionFence> fences = {})
      : flight_(live_flight_of(plan, ".")),
        autopilot_(flight_, with_pilot(autopilot)),
        session_(flight_, FlightFrame(flight_.plan, frame), std::move(fences), session) {}

  static AutopilotOptions with_pilot(AutopilotOptions options) {
    if (options.pilot == SimulatedPilot::none) options.pilot = SimulatedPilot::flies;
    return options;
  }

  // One period. What the session sends is seen by `sent`.
  void step() {
    std::vector<mavlink::Packet> packets = session_.step(now_);
    for (mavlink::Packet& packet : packets) {
      packet.system = 245, packet.component = 191, packet.sequence = sequence_++;
      if (sent) sent(packet);
      if (!deaf) autopilot_.receive(bytes_of(packet), now_);
    }
    now_ += 0.02;
    for (const std::string& datagram : autopilot_.step(now_))
      for (const mavlink::Packet& packet : parser_.read(datagram, mavlink::Source::datagram))
        hear(packet);
    const bool plan_flown = session_.phase() == FlightPhase::flying;
    if (plan_flown)
      strayed = std::max(strayed, distance_from_path(flight_.plan, autopilot_.state().position));
    for (std::string& sentence : session_.take_said()) said.push_back(std::move(sentence));
  }
  void hear(mavlink::Packet packet) {
    if (!mute && (!received || received(packet))) session_.receive(packet, now_);
  }
  // To the end of the session, or for so long.
  void run(double most = 120) {
    const double end = now_ + most;
    while (now_ < end && session_.phase() != FlightPhase::ended) step();
  }
  void run_until(FlightPhase phase, double most = 60) {
    const double end = now_ + most;
    while (now_ < end && session_.phase() != phase) step();
  }
  // Afterwards: the autopilot alone.
  void drain(double seconds = 15) {
    for (double left = seconds; left > 0; left -= 0.02) autopilot_.step(now_ += 0.02);
  }

  FlightSession& session() { return session_; }
  const FlightSession& session() const { return session_; }
  SimulatedAutopilot& autopilot() { return autopilot_; }
  double now() const { return now_; }
  bool has_said(const std::string& part) const {
    for (const std::string& sentence : said)
      if (sentence.find(part) != std::string::npos) return true;
    return false;
  }

  bool deaf = false, mute = false;  // the way to the vehicle, the way back
  double strayed = 0;               // m from the path, while flying
  std::vector<std::string> said;
  std::function<void(const mavlink::Packet&)> sent;
  // What the session hears may be changed, or lost: false.
  std::function<bool(mavlink::Packet&)> received;

 private:
  LiveFlight flight_;
  SimulatedAutopilot autopilot_;
  FlightSession session_;
  mavlink::PacketParser parser_;
  double now_ = 0;
  std::uint8_t sequence_ = 0;
};

}  // namespace lapwing
