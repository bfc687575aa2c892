// SPDX-License-Identifier: Apache-2.0
// lapwing fly, and the simulated autopilot for its rehearsals.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "framework/app/command_line.h"
#include "framework/app/command_options.h"
#include "framework/fly/flight_session.h"
#include "framework/fly/simulated_autopilot.h"

namespace lapwing {

struct FlyRequest {
  std::filesystem::path plan;
  std::string to;      // of --to
  std::string origin;  // of --origin; "" for none
  FlightFrameKind frame = FlightFrameKind::global;
  SessionOptions session;
  std::filesystem::path log;        // without ending; empty: flights/MISSION-NNN
  std::optional<double> tolerance;  // m; absent: a certificate's
  bool real = false;                // --yes-a-real-vehicle
  bool lockstep = false;
  std::string press;  // of --press
};

struct AutopilotRequest {
  std::filesystem::path plan, vehicle;
  std::string origin;
  std::uint16_t port = 14540;
  AutopilotOptions options;
  std::vector<std::string> faults;
  bool lockstep = false, once = false;
};

void add_fly_command(CLI::App& app, Invocation& invocation, FlyRequest& asked, Command& command);
void add_autopilot_command(CLI::App& app, Invocation& invocation, AutopilotRequest& asked,
                           Command& command);

}  // namespace lapwing
