// SPDX-License-Identifier: Apache-2.0
// The report page of a plan that was flown in simulation.
#pragma once

#include <filesystem>
#include <vector>

#include "framework/export/report.h"
#include "framework/export/runs_report.h"
#include "framework/trajectory/plan.h"
#include "framework/vehicle/closed_loop.h"
#include "framework/verify/certificate.h"

namespace lapwing {

// What was flown, and what came of it.
struct Simulation {
  std::string controller;
  FlightConditions conditions;
  FlownPath path;
  // Least distances of the flown path from obstacles and subjects, against what the plan keeps.
  std::vector<Check> distances;

  bool too_near() const;
  // "wind 5 m/s towards 90 degrees, gusts 1 m/s, seed 2; mass 10 % above the plan's"
  std::string conditions_in_words() const;
};

// "clearance 0.42 m at 3.1 s, 0.5 m are required: box 'wall'"
std::string distance_in_words(const Check& check);

// `folder` holds the meshes of the plan's environment.
Report simulation_report(const Plan& plan, const Vehicle& vehicle, const Simulation& simulation,
                         const std::filesystem::path& folder);

}  // namespace lapwing
