// SPDX-License-Identifier: Apache-2.0
// lapwing fly.
#include "framework/app/fly_command.h"

#include <CLI/CLI.hpp>
#include <chrono>
#include <iostream>

#include "framework/app/flight_keys.h"
#include "framework/app/interruption.h"
#include "framework/app/origin_option.h"
#include "framework/app/progress_line.h"
#include "framework/app/provenance.h"
#include "framework/app/terminal.h"
#include "framework/core/files.h"
#include "framework/core/json.h"
#include "framework/core/number_text.h"
#include "framework/core/units.h"
#include "framework/core/visible_text.h"
#include "framework/export/mission_fences.h"
#include "framework/export/run_folder.h"
#include "framework/fly/flight_summary.h"
#include "framework/fly/flight_wire.h"
#include "framework/mavlink/vocabulary.h"
#include "framework/verify/tolerances.h"

namespace lapwing {
namespace {

constexpr int kMostLogs = 999;
constexpr double kBehind = 0.1;       // s: a period that is so late is not made up for
constexpr double kTickTimeout = 1.0;  // s, for the first tick of a simulator in lockstep
constexpr double kPatience = 20;      // s, for the next ones: it may be busy
constexpr double kSlice = 0.1;        // s, after which Ctrl-C is looked for

// A log that is not there yet.
std::filesystem::path log_name(const FlyRequest& asked, const Plan& plan) {
  if (!asked.log.empty()) {
    for (const char* ending : {".tlog", ".json"})
      if (std::filesystem::exists(asked.log.string() + ending))
        throw InputError("-o: '" + asked.log.string() + ending +
                         "' is there already; the log of a flight is not replaced");
    require_writable(asked.log.string() + ".tlog");
    return asked.log;
  }
  const std::string name = run_folder_name(plan.mission);
  for (int i = 1; i <= kMostLogs; ++i) {
    char number[8];
    std::snprintf(number, sizeof number, "-%03d", i);
    const std::filesystem::path file = std::filesystem::path("flights") / (name + number);
    if (!std::filesystem::exists(file.string() + ".tlog") &&
        !std::filesystem::exists(file.string() + ".json"))
      return file;
  }
  throw InputError("flights/ holds 999 logs of '" + name + "'; name another with -o");
}

// A real vehicle is flown on request alone.
LinkAddress allowed_address(const FlyRequest& asked) {
  const LinkAddress address = link_address_from(asked.to);
  if (asked.lockstep && (address.kind == LinkAddress::Kind::serial || !stays_here(address)))
    throw InputError("--lockstep --to " + asked.to +
                     ": lockstep is for `lapwing autopilot --lockstep` at an address of this "
                     "machine, as udp:127.0.0.1:14540");
  if (asked.real || stays_here(address)) return address;
  throw InputError("--to " + asked.to +
                   ": this leaves the machine, and somebody's vehicle may answer; "
                   "--yes-a-real-vehicle flies it");
}

std::uint64_t microseconds_since_1970() {
  return static_cast<std::uint64_t>(std::chrono::duration_cast<std::chrono::microseconds>(
                                        std::chrono::system_clock::now().time_since_epoch())
                                        .count());
}

// One flight: session, wire, keys and what is said meanwhile.
class LiveRun {
 public:
  LiveRun(const FlyRequest& asked, const Invocation& invocation, const LiveFlight& flight,
          FlightSession& session, Link& link, std::filesystem::path log)
      : asked_(asked),
        invocation_(invocation),
        flight_(flight),
        session_(session),
        wire_(link, mavlink::kOurSystem, mavlink::kComputer),
        keys_planned_(planned_keys_from(asked.press)),
        log_name_(std::move(log)),
        epoch_(microseconds_since_1970()),
        progress_("fly", std::cerr, progress_style_of_stderr(invocation.quiet || invocation.json),
                  columns_of_stderr(), &steady_seconds) {
    if (!keys_.there() && keys_planned_.empty()) session.nobody_resumes();
  }

  // Ctrl-C is a key of the flight from now on: none ends the program under way.
  void fly(const Interruption& interruption) {
    interruption.only_count();
    if (asked_.lockstep)
      fly_in_lockstep(interruption);
    else
      fly_in_real_time(interruption);
    progress_.clear();
  }

  const mavlink::ParserCounts& counts() const { return wire_.counts(); }
  // Empty where nothing was heard.
  std::filesystem::path log_file() const {
    return log_ ? std::filesystem::path(log_name_.string() + ".tlog") : std::filesystem::path();
  }
  void keep(const Value& summary) const {
    if (log_) write_file_atomically(log_name_.string() + ".json", to_json(summary) + "\n");
  }

 private:
  void take(const Arrival& arrival, double now) {
    for (const mavlink::Packet& packet : arrival.packets) session_.receive(packet, now);
    if (log_ || !session_.report().found()) return;
    // Another flight may have begun a log of this name in the meantime.
    while (!(log_ = TelemetryLog::begin(log_name_.string() + ".tlog")))
      log_name_ = log_name(asked_, flight_.plan);
    wire_.begin_log(*log_, epoch_);
  }

  void step(double now, const Interruption& interruption) {
    press_keys(now, interruption);
    wire_.send(session_.step(now), now);
    tell();
  }

  void press_keys(double now, const Interruption& interruption) {
    for (; interrupted_ < interruption.count(); ++interrupted_) session_.press(FlightKey::abort);
    while (const auto key = keys_.pressed()) session_.press(*key);
    if (!began_ && session_.phase() == FlightPhase::flying) began_ = now;
    while (began_ && next_key_ < keys_planned_.size() &&
           now - *began_ >= keys_planned_[next_key_].at)
      session_.press(keys_planned_[next_key_++].key);
  }

  void tell() {
    for (const std::string& sentence : session_.take_said()) {
      if (invocation_.quiet) continue;
      progress_.clear();
      std::cerr << "lapwing: " << visible_line(sentence) << std::endl;
    }
    if (session_.phase() != FlightPhase::flying) {
      progress_.report(-1, std::string(to_string(session_.phase())));
      return;
    }
    const double duration = flight_.trajectory().duration();
    std::string text =
        plain_number(session_.plan_time(), 3) + " of " + plain_number(duration, 3) + " s";
    if (session_.paused()) text += ", paused";
    if (const auto error = session_.error_now())
      text += ", off by " + plain_number(*error, 2) + " m";
    if (const auto battery = session_.report().battery_percent)
      text += ", battery " + std::to_string(*battery) + " %";
    progress_.report(session_.plan_time() / duration, text);
  }

  void fly_in_real_time(const Interruption& interruption) {
    const double begin = steady_seconds();
    double next = 0;
    while (session_.phase() != FlightPhase::ended) {
      double now = steady_seconds() - begin;
      if (now >= next) {
        step(now, interruption);
        next += FlightSession::kPeriod;
        if (now - next > kBehind) next = now;
        continue;
      }
      const Arrival arrival = wire_.receive(next - now, now);
      now = steady_seconds() - begin;
      take(arrival, now);
    }
  }

  // Time is the simulator's, once it ticks.
  void fly_in_lockstep(const Interruption& interruption) {
    double now = 0;
    bool ticks = false, gone = false;
    while (session_.phase() != FlightPhase::ended) {
      step(now, interruption);
      if (session_.phase() == FlightPhase::ended) break;
      if (!gone) wire_.send_tick(now);
      const std::optional<double> later =
          gone ? std::nullopt : wait_for_tick(now, ticks, interruption);
      if (!ticks && !later && session_.report().found())
        throw InputError("--lockstep: a vehicle answers at " + asked_.to +
                         " but does not tick; lockstep is for `lapwing autopilot --lockstep`");
      gone = gone || (ticks && !later);
      ticks = ticks || later;
      now = later ? std::max(now, *later) : now + (ticks ? FlightSession::kPeriod : kTickTimeout);
    }
    if (!gone) wire_.send_end();
  }

  // What comes before a tick, and its time; nothing where the simulator has left or does not tick
  // in time, or in a second after Ctrl-C.
  std::optional<double> wait_for_tick(double now, bool ticks, const Interruption& interruption) {
    double deadline = steady_seconds() + (ticks ? kPatience : kTickTimeout);
    bool hurries = false;
    for (double left = deadline - steady_seconds(); left > 0; left = deadline - steady_seconds()) {
      const Arrival arrival = wire_.receive(std::min(left, kSlice), now);
      take(arrival, arrival.tick ? *arrival.tick : now + FlightSession::kPeriod);
      if (arrival.tick) return arrival.tick;
      if (arrival.end) return std::nullopt;
      if (hurries || interrupted_ == interruption.count()) continue;
      hurries = true;
      deadline = std::min(deadline, steady_seconds() + kTickTimeout);
    }
    return std::nullopt;
  }

  const FlyRequest& asked_;
  const Invocation& invocation_;
  const LiveFlight& flight_;
  FlightSession& session_;
  FlightWire wire_;
  FlightKeys keys_;
  std::vector<PlannedKey> keys_planned_;
  std::size_t next_key_ = 0;
  std::optional<double> began_;  // s, when the plan began
  std::filesystem::path log_name_;
  std::uint64_t epoch_;
  std::optional<TelemetryLog> log_;
  ProgressLine progress_;
  int interrupted_ = 0;  // Ctrl-C, as far as the session knows
};

void print_flight(const FlightSession& session, const LiveFlight& flight, double tolerance,
                  const std::filesystem::path& log) {
  const FlightRecord& record = session.record();
  const bool good = followed_within(session, tolerance);
  const std::string verdict = session.end() != FlightEnd::flown
                                  ? std::string(to_string(session.end()))
                              : good ? "flown"
                                     : "strays";
  std::printf("%s: %s\n", visible_line(flight.plan.mission).c_str(),
              tinted(good ? Tone::good : Tone::bad, verdict).c_str());
  if (!session.reason().empty())
    std::printf("  why                     %s\n", visible_line(session.reason()).c_str());
  std::printf("  plan                    %.4g of %.4g s\n", session.plan_time(),
              flight.trajectory().duration());
  if (record.measured() > 0) {
    std::printf("  distance from the plan  worst %.3f m at %.4g s, mean %.3f m; %.3g m allowed\n",
                record.place_worst().error, record.place_worst().plan_time, record.place_mean(),
                tolerance);
    std::printf("  yaw against the plan    worst %.2f degrees at %.4g s\n",
                degrees(record.yaw_worst().error), record.yaw_worst().plan_time);
  }
  if (!log.empty())
    std::printf("  log                     %s\n", visible_line(log.string()).c_str());
}

ExitStatus refuse_uncertified(const JudgedPlan& judged, const FlyRequest& asked,
                              const Invocation& invocation) {
  std::string failures;
  for (const Check& check : judged.certificate.failures())
    failures += "\n  " + visible_line(to_line(check));
  std::fprintf(stderr, "lapwing: '%s' is not certified, and is not flown:%s\n",
               visible_line(asked.plan.string()).c_str(), failures.c_str());
  if (invocation.json) {
    Value object = Value::map();
    object.set("status", "not_certified");
    print_json(object);
  }
  return ExitStatus::not_certified;
}

ExitStatus status_of(const FlightSession& session, double tolerance, bool interrupted) {
  if (session.end() == FlightEnd::flown)
    return followed_within(session, tolerance) ? ExitStatus::done : ExitStatus::not_certified;
  return interrupted ? ExitStatus::interrupted : ExitStatus::not_certified;
}

ExitStatus fly_plan(const FlyRequest& asked, const Invocation& invocation) {
  const Interruption interruption;
  const LinkAddress address = allowed_address(asked);
  planned_keys_from(asked.press);
  const JudgedPlan judged = judge_file(asked.plan, {.cancellation = &interruption.token(),
                                                    .controllers = controllers_of(invocation)});
  if (!judged.certificate.feasible()) return refuse_uncertified(judged, asked, invocation);
  Plan plan = judged.plan;
  give_origin(plan, asked.origin);
  LiveFlight flight = live_flight_of(plan, asked.plan.parent_path());
  std::vector<MissionFence> fences = mission_fences(flight.plan, flight.said);
  FlightSession session(flight, FlightFrame(flight.plan, asked.frame), std::move(fences),
                        asked.session);
  const std::filesystem::path log = log_name(asked, plan);
  const std::unique_ptr<Link> link = open_link(address);
  if (!invocation.quiet) {
    for (const std::string& sentence : flight.said)
      std::cerr << "lapwing: " << visible_line(sentence) << "\n";
    std::cerr << "lapwing: places are sent as " << session.frame().in_words() << std::endl;
  }
  LiveRun run(asked, invocation, flight, session, *link, log);
  run.fly(interruption);
  const double tolerance = asked.tolerance.value_or(tolerances::kTracking);
  Value summary = flight_summary(session, flight, tolerance, run.counts());
  if (!run.log_file().empty()) summary.set("log", run.log_file().string());
  run.keep(summary);
  if (session.end() == FlightEnd::refused) throw InputError(session.reason());
  if (invocation.json)
    print_json(summary);
  else
    print_flight(session, flight, tolerance, run.log_file());
  return status_of(session, tolerance, interruption.token().cancelled());
}

void add_flight_limits(CLI::App& fly, FlyRequest& asked) {
  const auto number = [&](const char* name, const char* unit, const char* help, double most,
                          double SessionOptions::*field) {
    add_text(fly, name, unit, help, [&asked, name, most, field](const std::string& text) {
      asked.session.*field = read_within(name, text, most);
    });
  };
  number("--start-tolerance", "M",
         "distance from the plan's start from which it begins, at most 5; default: 1", 5,
         &SessionOptions::start_tolerance);
  number("--stray", "M", "distance from what was sent that ends the flight; default: 1", 1000,
         &SessionOptions::stray);
  number("--hold", "S", "time to hold after the end; default: 5", 86400, &SessionOptions::hold);
  number("--answer", "S", "time for a first answer of the vehicle; default: 10", 86400,
         &SessionOptions::wait_answer);
  number("--wait", "S", "time for the pilot to arm and to switch the mode; default: 300", 86400,
         &SessionOptions::wait_pilot);
  add_text(
      fly, "--tolerance", "M", "distance from the plan that counts as followed; default: 0.25",
      [&](const std::string& text) { asked.tolerance = read_within("--tolerance", text, 1000); });
}

void add_flight_ways(CLI::App& fly, FlyRequest& asked) {
  add_text(fly, "--frame", "global|local",
           "global: latitude, longitude, height; local: the plan's world is the vehicle's local "
           "frame; default: global",
           [&](const std::string& word) {
             if (word != "global" && word != "local")
               throw CLI::ValidationError("--frame",
                                          "expected global or local, not '" + word + "'");
             asked.frame = word == "local" ? FlightFrameKind::local : FlightFrameKind::global;
           });
  add_text(fly, "--gimbal", "auto|manager|command|roi|none",
           "how the camera is turned: by GIMBAL_MANAGER_SET_ATTITUDE, by the command 1000, by the "
           "point to look at (195), or not; default: auto",
           [&](const std::string& word) {
             const auto way = gimbal_way_named(word);
             if (!way)
               throw CLI::ValidationError(
                   "--gimbal", "expected auto, manager, command, roi or none, not '" + word + "'");
             asked.session.gimbal = *way;
           });
  add_count(
      fly, "--system", 1, 255, "number of the vehicle; default: the one that answers",
      [&](std::uint64_t system) { asked.session.system = static_cast<std::uint8_t>(system); });
  fly.add_flag("--mode", asked.session.enter_mode,
               "once the pilot has armed, switch to OFFBOARD or GUIDED, and to HOLD or LOITER at "
               "the end");
  fly.add_flag(
      "--keep-fence", [&](std::int64_t) { asked.session.upload_fence = false; },
      "leave the vehicle's fence as it is");
}

}  // namespace

void add_fly_command(CLI::App& app, Invocation& invocation, FlyRequest& asked, Command& command) {
  CLI::App* fly = app.add_subcommand("fly", "fly a certified plan live, over MAVLink");
  add_plan(*fly, asked.plan);
  add_text(*fly, "--to", "udp:HOST:PORT|udpin:HOST:PORT|serial:DEVICE:BAUD",
           "the vehicle: send to it, listen for it, or by a serial line",
           [&](const std::string& text) { asked.to = text; })
      ->required();
  fly->add_flag("--yes-a-real-vehicle", asked.real,
                "the address may be that of a vehicle outside this machine");
  add_text(*fly, "--origin", "LAT,LON,HEIGHT,OF",
           "origin of a plan that has none, as of export; default: none",
           [&](const std::string& text) { asked.origin = text; });
  add_flight_ways(*fly, asked);
  add_flight_limits(*fly, asked);
  add_text(*fly, "-o,--output", "NAME",
           "write NAME.tlog and NAME.json; default: flights/MISSION-NNN",
           [&](const std::string& path) { asked.log = path; });
  fly->add_flag("--lockstep", asked.lockstep,
                "rehearse with `lapwing autopilot --lockstep`, as fast as the machine computes");
  add_text(*fly, "--press", "KEY@S,...",
           "press pause, resume or abort so long after the plan's start; default: none",
           [&](const std::string& text) { asked.press = text; });
  fly->add_flag("--quiet", invocation.quiet, "no progress");
  add_json(*fly, invocation);
  fly->callback([&] { command = [&] { return fly_plan(asked, invocation); }; });
}

}  // namespace lapwing
