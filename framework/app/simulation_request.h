// SPDX-License-Identifier: Apache-2.0
// What `lapwing simulate` is asked for, and its options.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "framework/app/command_line.h"
#include "framework/app/command_options.h"
#include "framework/app/item_command.h"
#include "framework/vehicle/closed_loop.h"

namespace lapwing {

struct SimulationRequest {
  FlightConditions conditions;
  // What the command line states, in place of what the vehicle's file does.
  std::vector<std::pair<double Disturbances::*, double>> stated;
  std::string controller;           // NAME[:KEY=VALUE,...]; "": the plan's
  int runs = 0;                     // 0: one flight, under the conditions as they are
  std::filesystem::path kept;       // a folder of files of the runs; empty: they are not kept
  ItemOptions items;                // an item is a run that is kept
  std::optional<double> tolerance;  // m, of the distance from the plan; absent: a certificate's
};

void add_simulate_command(CLI::App& app, Invocation& invocation, std::filesystem::path& plan,
                          SimulationRequest& asked, std::filesystem::path& target,
                          Command& command);

// With what the request states in place of the vehicle's own.
FlightConditions conditions_of(const SimulationRequest& asked, const Vehicle& vehicle);

}  // namespace lapwing
