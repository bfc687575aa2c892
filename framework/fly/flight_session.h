// SPDX-License-Identifier: Apache-2.0
// A live flight as a state machine without sockets and clocks: packets and times come from outside.
//
//   searching -> handing the fence over -> checking -> waiting -> settling -> flying -> holding
//
// `waiting`: the pilot arms and enters OFFBOARD (PX4) or GUIDED (ArduPilot). We never arm. The
// place of the vehicle is streamed, because PX4 enters OFFBOARD only under a stream. `settling`:
// from where the vehicle is to the plan's start, slowly; then it must come to rest. `holding`:
// after the plan's end or an abort, the last place is streamed, until the pilot leaves the mode, or
// for `hold` seconds. Settling is watched as the flight is, along a straight way that keeps clear
// of the plan's surroundings; there, silence is an abort.
//
// What goes wrong, and what is done:
//   before the flight                       nothing of the plan is sent; one sentence
//   the vehicle is silent for 1 s, or
//   tells no usable place for 0.5 s         brake along the path and hold; it stays paused when the
//                                           vehicle is heard again, and ends after 10 s; where
//                                           nobody can resume: abort
//   another mode, or disarmed               the stream ends at once: the pilot has the vehicle
//   more than `stray` away for 0.2 s        abort
//   the estimate is not valid, the battery
//   below 10 %, or the vehicle in an
//   emergency                               abort
//   a jump of the vehicle's clock           the plan goes on where it is
// An abort brakes along the path and holds. The end of the stream is, for the vehicle, the loss of
// its setpoints: it does what its own settings say.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "framework/fly/fence_upload.h"
#include "framework/fly/flight_record.h"
#include "framework/fly/gimbal_stream.h"
#include "framework/fly/live_flight.h"
#include "framework/fly/vehicle_report.h"
#include "framework/verify/straight_way.h"

namespace lapwing {

struct SessionOptions {
  std::optional<std::uint8_t> system = std::nullopt;  // of the vehicle; none: the one that answers
  bool enter_mode = false;  // ask for OFFBOARD or GUIDED once the pilot has armed
  bool upload_fence = true;
  bool can_resume = true;  // somebody may press keys; else silence of the vehicle aborts
  GimbalWay gimbal = GimbalWay::automatic;
  double start_tolerance = 1;  // m, at most 5
  double stray = 1;            // m, from what was sent: abort
  double hold = 5;             // s, after the end
  double wait_answer = 10;     // s, for a first heartbeat
  double wait_checks = 8;      // s, for what the vehicle must tell
  double wait_pilot = 300;     // s
};

enum class FlightPhase { searching, fencing, checking, waiting, settling, flying, holding, ended };
enum class FlightEnd { none, flown, aborted, taken_over, link_lost, refused };
enum class FlightKey { pause, resume, abort };

std::string_view to_string(FlightPhase phase);
std::string_view to_string(FlightEnd end);

class FlightSession {
 public:
  static constexpr double kPeriod = 0.02;  // s, of `step`

  // Keeps a reference to the flight. Throws InputError as GimbalStream and StraightWay do.
  FlightSession(const LiveFlight& flight, FlightFrame frame, std::vector<MissionFence> fences,
                const SessionOptions& options);

  void receive(const mavlink::Packet& packet, double now);
  // Every 20 ms: the packets to send, without sender and sequence. Times never go back.
  std::vector<mavlink::Packet> step(double now);
  void press(FlightKey key);
  // There are no keys.
  void nobody_resumes() { options_.can_resume = false; }

  FlightPhase phase() const { return phase_; }
  FlightEnd end() const { return end_; }
  // How it ended, a sentence; "" for a flight as planned.
  const std::string& reason() const { return reason_; }
  bool paused() const { return paused_; }
  double plan_time() const { return pacer_.plan_time(); }
  const FlightRecord& record() const { return record_; }
  const VehicleReport& report() const { return report_; }
  const VehicleClock& clock() const { return clock_; }
  const FlightFrame& frame() const { return frame_; }
  // m, from what was sent, as last measured.
  std::optional<double> error_now() const { return error_now_; }
  std::size_t fence_items() const { return fence_ ? fence_->items() : 0; }
  // For the user, since the last call.
  std::vector<std::string> take_said();

 private:
  using Packets = std::vector<mavlink::Packet>;
  void say(std::string sentence) { said_.push_back(std::move(sentence)); }
  void finish(FlightEnd end, std::string reason);
  void abort(const std::string& reason);
  void enter(FlightPhase phase, double now);
  void keep_company(double now, Packets& packets);
  void ask_for_streams(double now, Packets& packets);
  void search(double now);
  void hand_fence_over(double now, Packets& packets);
  void check(double now);
  void wait(double now, Packets& packets);
  void settle(double now, double step, Packets& packets);
  void fly(double now, double step, Packets& packets);
  void hold(double now, Packets& packets);
  void watch(double now);
  void measure(double now, FlightRecord& record);
  std::vector<std::string> missing(double now) const;
  Setpoint advance(PlanPacer& pacer, double step, bool run);
  void begin_holding(double now);
  void begin_settling(double now);
  void ask_for_mode(double now, bool following, Packets& packets);
  bool pilot_has_it(double now);
  void send(double now, const Setpoint& setpoint, Packets& packets);

  const LiveFlight& flight_;
  FlightFrame frame_;
  std::vector<MissionFence> fences_;
  SessionOptions options_;
  VehicleReport report_;
  VehicleClock clock_;
  PlanPacer pacer_;
  GimbalStream gimbal_;
  StraightWay way_;
  std::unique_ptr<const Trajectory> settling_;
  std::optional<PlanPacer> settling_pacer_;
  FlightRecord record_, settling_record_;
  std::optional<FenceUpload> fence_;
  FlightPhase phase_ = FlightPhase::searching;
  FlightEnd end_ = FlightEnd::none, wanted_end_ = FlightEnd::flown;
  std::string reason_;
  std::vector<std::string> said_;
  std::optional<double> begun_, last_step_;  // s
  double phase_began_ = 0, beat_at_ = -1e9, sync_at_ = -1e9, asked_at_ = -1e9;
  double mode_asked_at_ = -1e9, strays_since_ = -1, rest_since_ = -1, silent_since_ = -1;
  int mode_asked_ = 0, jumps_ = 0;
  std::optional<int> mode_refused_;  // MAV_RESULT
  bool paused_ = false, aborting_ = false, silent_ = false, ends_at_once_ = false;
  std::optional<double> error_now_;
  double measured_at_ = -1, headed_at_ = -1;  // s, of the vehicle
  double placed_at_ = -1;                     // s: when the vehicle's place was last compared
  double busy_until_ = -1e9;                  // s: until then this machine did not listen
  double delay_ = 0;                          // s, that setpoints are sent ahead; changes slowly
  Setpoint held_;                             // where it holds
};

}  // namespace lapwing
