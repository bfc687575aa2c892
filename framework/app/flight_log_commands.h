// SPDX-License-Identifier: Apache-2.0
// lapwing compare, log and vehicle: what comes home from a flight.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "framework/app/command_options.h"

namespace lapwing {

struct FlightLogRequest {
  std::filesystem::path plan, log;
  std::string format;  // of --format; "" by content
  std::string origin;  // of --origin
  std::string base;    // of --base; "" for the default
  std::filesystem::path target;
  std::optional<double> clock;  // of --time-offset, s
  bool no_offset = false, turn = false;
};

void add_flight_log_commands(CLI::App& app, Invocation& invocation, FlightLogRequest& asked,
                             Command& command);

ExitStatus compare_flight(const FlightLogRequest& asked, const Invocation& invocation);
ExitStatus show_flight_log(const FlightLogRequest& asked, const Invocation& invocation);
ExitStatus vehicle_from_log(const FlightLogRequest& asked, const Invocation& invocation);

}  // namespace lapwing
