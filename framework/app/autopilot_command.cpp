// SPDX-License-Identifier: Apache-2.0
// lapwing autopilot.
#include <CLI/CLI.hpp>
#include <iostream>

#include "framework/app/fly_command.h"
#include "framework/app/interruption.h"
#include "framework/app/origin_option.h"
#include "framework/app/plan_sources.h"
#include "framework/app/progress_line.h"
#include "framework/app/provenance.h"
#include "framework/config/shipped.h"
#include "framework/core/visible_text.h"
#include "framework/fly/flight_wire.h"
#include "framework/fly/udp_link.h"

namespace lapwing {
namespace {

constexpr double kTickPatience = 20;  // s for a tick: the other side is gone
constexpr double kLongestEnd = 60;    // s simulated, to come to rest when the other side has left
constexpr double kGiveUp = 0.2;       // s that it makes up for when the machine was busy

class AutopilotRun {
 public:
  AutopilotRun(const AutopilotRequest& asked, SimulatedAutopilot& autopilot, Link& link,
               const CancellationToken& token)
      : asked_(asked), autopilot_(autopilot), link_(link), token_(token) {}

  void fly() { asked_.lockstep ? fly_in_lockstep() : fly_in_real_time(); }

 private:
  void pass_period(double now) {
    for (const std::string& datagram : autopilot_.step(now)) link_.send(datagram);
  }

  void fly_in_real_time() {
    const double begin = steady_seconds();
    double next = SimulatedAutopilot::kPeriod;
    while (!token_.cancelled() && !(asked_.once && autopilot_.over(next))) {
      const double now = steady_seconds() - begin;
      if (now >= next) {
        if (now - next > kGiveUp) next = now;
        pass_period(next);
        next += SimulatedAutopilot::kPeriod;
        continue;
      }
      if (const auto datagram = link_.receive(next - now)) autopilot_.receive(*datagram, next);
    }
  }

  // Everything up to a tick; false where the other side has left.
  bool hear_period(double now) {
    for (double silent = 0; !token_.cancelled();) {
      const auto datagram = link_.receive(1);
      if (!datagram) {
        if (heard_ && ++silent >= kTickPatience) return false;
        continue;
      }
      heard_ = true;
      Arrival arrival;
      if (!take_tick(*datagram, arrival))
        autopilot_.receive(*datagram, now);
      else
        return !arrival.end;
    }
    return false;
  }

  void fly_in_lockstep() {
    double now = 0;
    while (hear_period(now)) {
      now += SimulatedAutopilot::kPeriod;
      pass_period(now);
      link_.send(tick_of(now));
    }
    const double left = now;
    while (!token_.cancelled() && !autopilot_.over(now) && now - left < kLongestEnd)
      pass_period(now += SimulatedAutopilot::kPeriod);
  }

  const AutopilotRequest& asked_;
  SimulatedAutopilot& autopilot_;
  Link& link_;
  const CancellationToken& token_;
  bool heard_ = false;
};

void print_autopilot(const SimulatedAutopilot& autopilot) {
  const Value value = autopilot.to_value();
  const Value& setpoints = value.at("setpoints");
  std::printf("%s\n", autopilot.followed() ? "followed setpoints" : "never followed setpoints");
  std::printf("  setpoints               %lld, %.3g a second, at most %.3g s apart\n",
              static_cast<long long>(setpoints.at("count").as_integer()),
              setpoints.at("rate").as_number(), setpoints.at("gap_worst").as_number());
  std::printf("  of the limits           speed %.0f %%, acceleration %.0f %%, yaw rate %.0f %%\n",
              100 * setpoints.at("speed_share_worst").as_number(),
              100 * setpoints.at("acceleration_share_worst").as_number(),
              100 * setpoints.at("yaw_rate_share_worst").as_number());
  std::printf("  beyond them, or jumps   %lld\n",
              static_cast<long long>(setpoints.at("beyond_limits").as_integer()));
  std::printf("  fence                   %lld items, left %lld times\n",
              static_cast<long long>(value.at("fence_items").as_integer()),
              static_cast<long long>(value.at("fence_breaches").as_integer()));
  std::printf("  ends                    in %s%s, at %.2f m/s\n", autopilot.mode_name().c_str(),
              value.at("failsafe").as_boolean() ? " after setpoints stopped" : "",
              value.at("speed").as_number());
}

ExitStatus run_autopilot(AutopilotRequest& asked, const Invocation& invocation) {
  const Interruption interruption;
  for (const std::string& fault : asked.faults) add_fault(fault, asked.options.faults);
  Plan plan = read_plan_file(asked.plan);
  give_origin(plan, asked.origin);
  LiveFlight flight = live_flight_of(plan, asked.plan.parent_path());
  if (!asked.vehicle.empty())
    flight.vehicle = *read_vehicle_file(asked.vehicle, shipped_folder("configs")).vehicle;
  SimulatedAutopilot autopilot(flight, asked.options);
  const std::unique_ptr<Link> link =
      open_udp({LinkAddress::Kind::udp_listening, "127.0.0.1", asked.port});
  std::cerr << "lapwing: a simulated vehicle listens at udp:127.0.0.1:" << link->port()
            << std::endl;
  AutopilotRun(asked, autopilot, *link, interruption.token()).fly();
  if (invocation.json)
    print_json(autopilot.to_value());
  else
    print_autopilot(autopilot);
  return autopilot.audit().beyond() == 0 ? ExitStatus::done : ExitStatus::not_certified;
}

}  // namespace

void add_autopilot_command(CLI::App& app, Invocation& invocation, AutopilotRequest& asked,
                           Command& command) {
  CLI::App* autopilot = app.add_subcommand(
      "autopilot", "a simulated vehicle on this machine, to rehearse live flights with");
  add_plan(*autopilot, asked.plan);
  add_text(*autopilot, "--vehicle", "FILE",
           "vehicle file, or its name in configs/, of the vehicle; default: that of the plan",
           [&](const std::string& path) { asked.vehicle = path; });
  add_text(*autopilot, "--origin", "LAT,LON,HEIGHT,OF",
           "origin of a plan that has none, as of export; default: a place near Lausanne",
           [&](const std::string& text) { asked.origin = text; });
  add_count(*autopilot, "--port", 0, 65535,
            "port on 127.0.0.1 to listen at; 0: one that is free; default: 14540",
            [&](std::uint64_t port) { asked.port = static_cast<std::uint16_t>(port); });
  add_text(*autopilot, "--as", "px4|ardupilot", "whose modes it has; default: px4",
           [&](const std::string& word) {
             if (word != "px4" && word != "ardupilot")
               throw CLI::ValidationError("--as", "expected px4 or ardupilot, not '" + word + "'");
             asked.options.ardupilot = word == "ardupilot";
           });
  add_text(*autopilot, "--pilot", "arm|fly",
           "play the pilot: arm, or arm and switch to OFFBOARD or GUIDED; default: nobody arms",
           [&](const std::string& word) {
             if (word != "arm" && word != "fly")
               throw CLI::ValidationError("--pilot", "expected arm or fly, not '" + word + "'");
             asked.options.pilot = word == "fly" ? SimulatedPilot::flies : SimulatedPilot::arms;
           });
  add_repeated(*autopilot, "--fault", "NAME=VALUE", asked.faults,
               "lost=SHARE, late=S, noise=SHARE, gap=S[@T], jump=S[@T], takeover=T, unwell=T, "
               "refuse=arm|mode|fence|gimbal, estimate=bad, battery=PERCENT, offset=M; repeatable; "
               "default: none");
  add_seed(*autopilot, asked.options.seed, "seed of the faults; default: 1");
  autopilot->add_flag("--lockstep", asked.lockstep,
                      "time passes as `lapwing fly --lockstep` and this command compute it");
  autopilot->add_flag("--once", asked.once, "end with the first flight");
  add_json(*autopilot, invocation);
  autopilot->callback([&] { command = [&] { return run_autopilot(asked, invocation); }; });
}

}  // namespace lapwing
