// SPDX-License-Identifier: Apache-2.0
#include "framework/fly/flight_session.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "framework/core/error.h"
#include "framework/core/number_text.h"
#include "framework/fly/flight_checks.h"
#include "framework/fly/settling.h"
#include "framework/mavlink/vocabulary.h"

namespace lapwing {

using namespace mavlink;

namespace {

constexpr double kSecond = 1.0;        // s, between heartbeats
constexpr double kSyncEvery = 0.5;     // s
constexpr double kAskEvery = 2.0;      // s, for streams and messages that have not come
constexpr double kSilence = 1.0;       // s without a packet: the link is lost
constexpr double kLongSilence = 10.0;  // s
constexpr double kFenceWait = 5.0;     // s, for the place of the vehicle's local frame
constexpr double kStrayTime = 0.2;     // s
constexpr int kLowBattery = 10;        // percent
constexpr double kStreamFirst = 1.0;   // s of setpoints before the mode is asked for
constexpr int kMostModeAsked = 5;
constexpr double kSettled = 0.25, kSettledSpeed = 0.3;    // m, m/s
constexpr double kRestTime = 0.5, kLongestSettling = 15;  // s
constexpr double kLongestStall = 0.5;                     // s without a setpoint
constexpr double kBusy = 0.2;                             // s between steps: this machine was busy
constexpr double kHalfPeriod = FlightSession::kPeriod / 2;
constexpr double kLongestDelay = 0.1;  // s, that a setpoint is sent ahead of its time
constexpr double kDelayChange = 0.01;  // s per s, of that in flight
constexpr double kStartReach = 5;      // m: nobody settles from farther away

Packet our_heartbeat() {
  return Message<kHeartbeat>()
      .set<"type">(kOnboardController)
      .set<"autopilot">(kNoAutopilot)
      .set<"system_status">(kActive)
      .set<"mavlink_version">(3)
      .packet();
}

Packet command(const VehicleReport& report, std::uint16_t number, double first, double second = 0,
               double third = 0) {
  return Message<kCommandLong>()
      .set<"target_system">(report.system)
      .set<"target_component">(report.component)
      .set<"command">(number)
      .set<"param1">(static_cast<float>(first))
      .set<"param2">(static_cast<float>(second))
      .set<"param3">(static_cast<float>(third))
      .packet();
}

}  // namespace

std::string_view to_string(FlightPhase phase) {
  constexpr std::string_view kNames[] = {"searching", "fencing", "checking", "waiting",
                                         "settling",  "flying",  "holding",  "ended"};
  return kNames[static_cast<std::size_t>(phase)];
}

std::string_view to_string(FlightEnd end) {
  constexpr std::string_view kNames[] = {"none",       "flown",     "aborted",
                                         "taken_over", "link_lost", "refused"};
  return kNames[static_cast<std::size_t>(end)];
}

FlightSession::FlightSession(const LiveFlight& flight, FlightFrame frame,
                             std::vector<MissionFence> fences, const SessionOptions& options)
    : flight_(flight),
      frame_(std::move(frame)),
      fences_(std::move(fences)),
      options_(options),
      pacer_(flight.trajectory(), flight.vehicle),
      gimbal_(options.gimbal, flight.plan, frame_),
      way_(flight.plan.environment, flight.folder, flight.trajectory().samples.front().position,
           kStartReach) {
  if (!(options.start_tolerance <= kStartReach))
    throw InputError("a vehicle settles from at most " + plain_number(kStartReach) +
                     " m away (--start-tolerance)");
}

std::vector<std::string> FlightSession::take_said() {
  std::vector<std::string> said;
  said.swap(said_);
  return said;
}

void FlightSession::finish(FlightEnd end, std::string reason) {
  if (phase_ == FlightPhase::ended) return;
  phase_ = FlightPhase::ended;
  end_ = end;
  if (!reason.empty()) reason_ = std::move(reason);
}

void FlightSession::enter(FlightPhase phase, double now) {
  phase_ = phase;
  phase_began_ = now;
}

// Brakes and holds; where nothing of the plan has been sent, it ends.
void FlightSession::abort(const std::string& reason) {
  if (aborting_) {
    if (phase_ == FlightPhase::holding) finish(FlightEnd::aborted, reason_);
    return;
  }
  aborting_ = true;
  wanted_end_ = FlightEnd::aborted;
  reason_ = reason;
  if (phase_ < FlightPhase::settling) return finish(FlightEnd::aborted, reason);
  if (phase_ == FlightPhase::holding) return finish(end_, reason);
  say(reason + ": braking along the path, then holding");
}

void FlightSession::press(FlightKey key) {
  if (phase_ == FlightPhase::ended) return;
  if (key == FlightKey::abort && aborting_ && phase_ != FlightPhase::holding) {
    if (!ends_at_once_) say("the stream ends as soon as the vehicle holds");
    ends_at_once_ = true;
    return;
  }
  if (key == FlightKey::abort) return abort("aborted by the user");
  if (phase_ != FlightPhase::flying || aborting_) return;
  const bool pause = key == FlightKey::pause;
  if (pause == paused_) return;
  if (!pause && silent_) return say("the vehicle is silent: the flight stays paused");
  paused_ = pause;
  say(pause ? "paused" : "resumed");
}

void FlightSession::receive(const Packet& packet, double now) {
  if (phase_ == FlightPhase::ended) return;
  take_report(packet, now, options_.system, frame_, clock_, report_);
  if (!report_.found() || packet.system != report_.system) return;
  if (packet.message == kTimesync) {
    const Message<kTimesync> sync(packet);
    if (sync.get<"tc1">() > 0)
      clock_.answered(static_cast<double>(sync.get<"ts1">()) * 1e-9, now,
                      static_cast<double>(sync.get<"tc1">()) * 1e-9);
  }
  if (packet.message == kCommandAck) {
    const Message<kCommandAck> ack(packet);
    const int result = ack.get<"result">();
    if (ack.get<"command">() == kDoSetMode && result != kAccepted && result != kInProgress)
      mode_refused_ = result;
  }
  if (fence_) fence_->receive(packet, now);
  gimbal_.receive(packet, report_);
  if (std::string said = gimbal_.take_said(); !said.empty()) say(std::move(said));
  for (std::string& text : report_.texts) say("vehicle: " + text);
  report_.texts.clear();
}

// Heartbeat and time, all the while.
void FlightSession::keep_company(double now, Packets& packets) {
  if (now - beat_at_ >= kSecond) {
    beat_at_ = now;
    packets.push_back(our_heartbeat());
  }
  if (report_.found() && now - sync_at_ >= kSyncEvery) {
    sync_at_ = now;
    packets.push_back(Message<kTimesync>()
                          .set<"ts1">(std::llround(now * 1e9))
                          .set<"target_system">(report_.system)
                          .set<"target_component">(report_.component)
                          .packet());
  }
}

void FlightSession::ask_for_streams(double now, Packets& packets) {
  if (now - asked_at_ < kAskEvery) return;
  asked_at_ = now;
  const auto every = [&](std::uint32_t message, double seconds) {
    packets.push_back(command(report_, kSetMessageInterval, message, seconds * 1e6));
  };
  const bool global = frame_.kind() == FlightFrameKind::global;
  if (!report_.tells_place(now)) every(global ? kGlobalPosition : kLocalPosition, 0.05);
  if (!report_.tells_place(now)) every(kAttitude, 0.05);
  if (!report_.tells_estimate(now)) every(kEstimatorStatus, 1);
  if (!report_.battery_percent) every(kSysStatus, 1);
  const auto once = [&](std::uint32_t message) {
    packets.push_back(command(report_, kRequestMessage, message));
  };
  if (!report_.home) once(kHomePosition);
  if (!report_.local_origin) once(kGlobalOrigin);
  if (!report_.capabilities) once(kAutopilotVersion);
  if (flight_.trajectory().has_gimbal && !report_.gimbal_device) once(kGimbalManagerInformation);
}

void FlightSession::search(double now) {
  if (report_.found()) {
    say("vehicle " + std::to_string(report_.system) + ": " +
        report_.autopilot_name().value_or("an autopilot that is not known") + ", " +
        (report_.armed() ? "armed" : "not armed") + ", " + report_.mode_name());
    return enter(FlightPhase::fencing, now);
  }
  if (now - phase_began_ < options_.wait_answer) return;
  finish(FlightEnd::refused, options_.system
                                 ? "no vehicle " + std::to_string(*options_.system) + " answers"
                                 : "nobody answers: no heartbeat of a vehicle for " +
                                       plain_number(options_.wait_answer) + " s");
}

void FlightSession::hand_fence_over(double now, Packets& packets) {
  if (!fence_) {
    const bool places =
        frame_.kind() == FlightFrameKind::global || report_.local_origin.has_value();
    if (!options_.upload_fence || fences_.empty()) {
      say(fences_.empty() ? "the plan has no zones: the vehicle keeps its fence"
                          : "the vehicle keeps its fence, on request");
      return enter(FlightPhase::checking, now);
    }
    if (!places && now - phase_began_ < kFenceWait) return;
    if (!places) {
      say("the zones are not handed over: the local frame has no place on the earth");
      return enter(FlightPhase::checking, now);
    }
    fence_.emplace(fences_, frame_);
  }
  for (Packet& packet : fence_->step(now, report_.system, report_.component))
    packets.push_back(packet);
  if (fence_->state() == FenceUpload::State::failed)
    return finish(FlightEnd::refused, fence_->problem());
  if (fence_->state() != FenceUpload::State::done) return;
  say("the vehicle has the plan's zones as its fence: " + std::to_string(fence_->items()) +
      " corners and circles");
  enter(FlightPhase::checking, now);
}

// What does not hold yet, and what is in the way to the plan's start.
std::vector<std::string> FlightSession::missing(double now) const {
  std::vector<std::string> missing =
      missing_before_flight(report_, frame_, flight_, clock_, options_.start_tolerance, now);
  if (!missing.empty()) return missing;
  const Sample& start = flight_.trajectory().samples.front();
  const std::string blocked = way_.blocked(report_.position->value, start.position, start.time);
  if (!blocked.empty())
    missing.push_back("the straight way from the vehicle to the plan's start is blocked: " +
                      blocked + "; bring it nearer to the start");
  return missing;
}

void FlightSession::check(double now) {
  const std::vector<std::string> missing = this->missing(now);
  if (missing.empty()) {
    if (report_.has_signatures)
      say("the vehicle signs its packets: they are read, and their signatures are not checked; "
          "ours have none");
    say("ready: " + std::string(report_.armed() ? "" : "arm the vehicle") +
        (options_.enter_mode ? (report_.armed() ? "it is armed" : "")
                             : (report_.armed() ? "" : " and ") + std::string("switch it to ") +
                                   report_.following_mode_name()));
    return enter(FlightPhase::waiting, now);
  }
  if (now - phase_began_ < options_.wait_checks) return;
  std::string all = missing.front();
  for (std::size_t i = 1; i < missing.size(); ++i) all += "; " + missing[i];
  finish(FlightEnd::refused, all);
}

// `following`: the mode that follows setpoints; else the one that holds.
void FlightSession::ask_for_mode(double now, bool following, Packets& packets) {
  if (now - mode_asked_at_ < kSecond) return;
  mode_asked_at_ = now;
  ++mode_asked_;
  const std::uint32_t mode = report_.autopilot == kPx4 ? (following ? kPx4Offboard : kPx4Hold)
                             : following               ? kCopterGuided
                                                       : kCopterLoiter;
  const bool px4 = report_.autopilot == kPx4;
  packets.push_back(command(report_, kDoSetMode, kCustomMode, px4 ? mode >> 16 & 0xff : mode,
                            px4 ? mode >> 24 : 0));
}

void FlightSession::wait(double now, Packets& packets) {
  if (now - report_.heard_at > kLongSilence)
    return finish(FlightEnd::refused, "the vehicle fell silent before the flight");
  if (now - std::min(report_.position_at, report_.yaw_at) > kLongSilence)
    return finish(FlightEnd::refused, "the vehicle does not tell its place and heading any more");
  if (!report_.tells_place(now)) return;  // an old place is not streamed
  if (report_.armed() && report_.follows()) return begin_settling(now);
  if (now - phase_began_ > options_.wait_pilot)
    return finish(FlightEnd::refused,
                  report_.armed()
                      ? "the vehicle did not come to " + report_.following_mode_name() +
                            " within " + plain_number(options_.wait_pilot) + " s"
                      : "the pilot did not arm within " + plain_number(options_.wait_pilot) + " s");
  held_ = {};
  held_.position = report_.position->value;
  held_.yaw = report_.yaw->value;
  send(now, held_, packets);
  if (!options_.enter_mode || !report_.armed() || now - phase_began_ < kStreamFirst) return;
  if (mode_refused_)
    return finish(FlightEnd::refused, "the vehicle refuses " + report_.following_mode_name() +
                                          " (MAV_RESULT " + std::to_string(*mode_refused_) + ")");
  if (mode_asked_ >= kMostModeAsked)
    return finish(FlightEnd::refused,
                  "the vehicle does not answer to " + report_.following_mode_name());
  ask_for_mode(now, true, packets);
}

void FlightSession::begin_settling(double now) {
  const std::vector<std::string> missing = this->missing(now);
  if (!missing.empty()) return finish(FlightEnd::refused, missing.front());
  settling_ = std::make_unique<const Trajectory>(settling_way(
      report_.position->value, report_.yaw->value, flight_.trajectory(), flight_.vehicle));
  settling_pacer_.emplace(*settling_, flight_.vehicle);
  clock_.fly();
  delay_ = std::min(clock_.delay(), kLongestDelay);
  jumps_ = clock_.jumps();
  placed_at_ = now;
  rest_since_ = -1;
  say("the vehicle follows: it settles at the plan's start");
  enter(FlightPhase::settling, now);
}

// The next setpoint along a pacer. It is meant for the middle of its period, and for the time of
// its arrival.
Setpoint FlightSession::advance(PlanPacer& pacer, double step, bool run) {
  // Where this machine was busy, the plan has gone on; beyond that the vehicle has given up.
  for (double left = std::min(step, kLongestStall); left > 0; left -= kPeriod)
    pacer.advance(std::min(left, kPeriod), run);
  const double change = kDelayChange * step;
  delay_ += std::clamp(std::min(clock_.delay(), kLongestDelay) - delay_, -change, change);
  return pacer.setpoint();
}

void FlightSession::settle(double now, double step, Packets& packets) {
  if (pilot_has_it(now)) return;
  measure(now, settling_record_);
  watch(now);
  if (phase_ == FlightPhase::ended) return;
  held_ = advance(*settling_pacer_, step, !aborting_);
  settling_record_.sent(held_, now + kHalfPeriod + delay_);
  send(now, held_, packets);
  if (aborting_ && (settling_pacer_->stands() || settling_pacer_->finished())) {
    say("holding");
    return begin_holding(now);
  }
  if (aborting_ || !settling_pacer_->finished()) return;
  const Eigen::Vector3d off = report_.position->value - held_.position;
  const bool rests = off.norm() < kSettled && report_.velocity->value.norm() < kSettledSpeed;
  if (!rests) rest_since_ = -1;
  if (rests && rest_since_ < 0) rest_since_ = now;
  if (rests && now - rest_since_ >= kRestTime) {
    say("flying");
    placed_at_ = now;
    return enter(FlightPhase::flying, now);
  }
  if (now - phase_began_ > settling_->duration() + kLongestSettling)
    abort("the vehicle does not settle at the start");
}

// Whether somebody else steers the vehicle now.
bool FlightSession::pilot_has_it(double now) {
  if (now - report_.heartbeat_at > 2 * kSecond) return false;
  if (report_.armed() && report_.follows()) return false;
  const std::string how = report_.armed() ? "the vehicle left " + report_.following_mode_name() +
                                                " for " + report_.mode_name()
                                          : "the vehicle was disarmed";
  if (phase_ == FlightPhase::holding)
    finish(wanted_end_, reason_);
  else
    finish(FlightEnd::taken_over, how);
  return true;
}

// The link, the battery, the estimate.
void FlightSession::watch(double now) {
  // While this machine was busy, nobody listened.
  const auto since = [&](double at) { return now - std::max(at, busy_until_); };
  const bool unheard = since(report_.heard_at) > kSilence;
  const double placed = std::min({report_.position_at, report_.yaw_at, placed_at_});
  const bool unplaced = since(placed) > VehicleReport::kFresh;
  const bool silent = unheard || unplaced;
  if (silent && !silent_) {
    silent_since_ = now;
    say("the vehicle is silent: braking along the path, then holding");
    paused_ = true;
    const bool settles = phase_ == FlightPhase::settling;
    if (!options_.can_resume || settles)
      abort(unheard ? "the vehicle was silent for " + plain_number(kSilence) + " s"
                    : "the vehicle told no usable place and heading for " +
                          plain_number(VehicleReport::kFresh) + " s");
  }
  if (!silent && silent_ && !aborting_) say("the vehicle is heard again: paused; r resumes");
  silent_ = silent;
  if (silent && now - silent_since_ > kLongSilence)
    return finish(FlightEnd::link_lost,
                  "the vehicle was silent for " + plain_number(kLongSilence) + " s");
  if (clock_.jumps() > jumps_) {
    jumps_ = clock_.jumps();
    say("the vehicle's clock jumped by " + plain_number(clock_.last_jump(), 3) +
        " s: the plan goes on where it is");
  }
  if (aborting_) return;
  if (report_.battery_percent && *report_.battery_percent < kLowBattery)
    abort("the battery is below " + std::to_string(kLowBattery) + " %");
  else if (report_.state > kCritical)
    abort("the vehicle reports an emergency");
  else if (!report_.estimator_good(frame_.kind() == FlightFrameKind::global))
    abort("the vehicle's estimate of its state is not valid any more");
  else if (phase_ == FlightPhase::settling && !silent && !report_.tells_estimate(now))
    abort("the vehicle does not tell any more whether its estimate is valid");
}

// Compares where the vehicle was with what it was sent for that time.
// A report that seems to come from the future is one of now: the clock is known that well only.
void FlightSession::measure(double now, FlightRecord& record) {
  if (report_.position && report_.position->vehicle_time > measured_at_) {
    measured_at_ = report_.position->vehicle_time;
    const double time = std::min(now, clock_.ours_at(measured_at_));
    const auto error = record.placed(report_.position->value, time);
    if (error) {
      error_now_ = error;
      placed_at_ = now;
      if (*error <= options_.stray) strays_since_ = -1;
      if (*error > options_.stray && strays_since_ < 0) strays_since_ = now;
      if (strays_since_ >= 0 && now - strays_since_ >= kStrayTime)
        abort("the vehicle is " + plain_number(*error, 3) + " m from what it was sent, more than " +
              plain_number(options_.stray) + " m (--stray)");
    }
  } else if (report_.position && report_.position->vehicle_time < measured_at_ - kSecond) {
    measured_at_ = headed_at_ = -1;  // its clock jumped back
  }
  if (report_.yaw && report_.yaw->vehicle_time > headed_at_) {
    headed_at_ = report_.yaw->vehicle_time;
    record.headed(report_.yaw->value, std::min(now, clock_.ours_at(headed_at_)));
  }
}

void FlightSession::fly(double now, double step, Packets& packets) {
  if (pilot_has_it(now)) return;
  measure(now, record_);
  watch(now);
  if (phase_ == FlightPhase::ended) return;
  held_ = advance(pacer_, step, !paused_ && !aborting_);
  record_.sent(held_, now + kHalfPeriod + delay_);
  send(now, held_, packets);
  if (!pacer_.finished() && !(aborting_ && pacer_.stands())) return;
  held_ = pacer_.setpoint();
  say(aborting_ ? "holding" : "the plan is flown: holding at its end");
  begin_holding(now);
}

void FlightSession::begin_holding(double now) {
  held_.velocity = held_.acceleration = Eigen::Vector3d::Zero();
  held_.yaw_rate = 0;
  mode_asked_ = 0, mode_asked_at_ = -1e9;
  end_ = wanted_end_;
  enter(FlightPhase::holding, now);
}

void FlightSession::hold(double now, Packets& packets) {
  if (pilot_has_it(now)) return;
  if (now - report_.heard_at > kLongSilence)
    return finish(wanted_end_ == FlightEnd::flown ? FlightEnd::link_lost : wanted_end_,
                  "the vehicle was silent while it held");
  send(now, held_, packets);
  if (ends_at_once_) return finish(wanted_end_, reason_);
  if (now - phase_began_ < options_.hold) return;
  if (!options_.enter_mode || mode_asked_ >= kMostModeAsked) return finish(wanted_end_, reason_);
  ask_for_mode(now, false, packets);
}

void FlightSession::send(double now, const Setpoint& setpoint, Packets& packets) {
  packets.push_back(
      frame_.packet(setpoint, clock_.vehicle_at(now), report_.system, report_.component));
  if (phase_ == FlightPhase::waiting) return;
  for (Packet& packet : gimbal_.step(now, setpoint, report_, frame_)) packets.push_back(packet);
}

std::vector<Packet> FlightSession::step(double now) {
  Packets packets;
  if (!begun_) begun_ = now, phase_began_ = now, last_step_ = now;
  if (now - *last_step_ > kBusy) busy_until_ = now;
  const double passed = clock_.advance(now - *last_step_);
  last_step_ = now;
  if (phase_ == FlightPhase::ended) return packets;
  keep_company(now, packets);
  if (report_.found() && phase_ < FlightPhase::settling) ask_for_streams(now, packets);
  switch (phase_) {
    case FlightPhase::searching:
      search(now);
      break;
    case FlightPhase::fencing:
      hand_fence_over(now, packets);
      break;
    case FlightPhase::checking:
      check(now);
      break;
    case FlightPhase::waiting:
      wait(now, packets);
      break;
    case FlightPhase::settling:
      settle(now, passed, packets);
      break;
    case FlightPhase::flying:
      fly(now, passed, packets);
      break;
    case FlightPhase::holding:
      hold(now, packets);
      break;
    case FlightPhase::ended:
      break;
  }
  return packets;
}

}  // namespace lapwing
