// SPDX-License-Identifier: Apache-2.0
// lapwing scan check: the photographs of a flight against the views of its plan.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "framework/app/command_line.h"

namespace lapwing {

struct ScanCheckRequest {
  std::filesystem::path folder;         // of photographs (JPEG with positions), or a COLMAP model
  std::filesystem::path plan;           // plan.json of a scan
  std::filesystem::path photos;         // whose positions place a COLMAP model; empty: none
  bool placed = false;                  // a COLMAP model is in metres, in the frame of the plan
  double gps_accuracy = 5;              // m, of positions that place a model
  double within = 3;                    // m, between a view and its photograph
  double angle_deg = 15;                // likewise, where directions are known
  std::optional<double> height_offset;  // m, of the photographs above the plan; absent: estimated
  std::filesystem::path rest;           // the mission for what is missing; empty: not written
};

// Prints what is missing, and writes the mission that is asked for, if anything is. `done` where
// every view has its photograph, else `not_certified`. InputError for a plan of no scan or without
// an origin where positions on the earth need one, photographs without positions, a model that
// nothing places.
ExitStatus check_scan(const ScanCheckRequest& asked, const Invocation& invocation);

// A mission in Lua: a tour of those views of a scan (places in its list), planned on the map and
// the mesh of its run, with the options of the plan that do not concern its first flight.
struct Plan;
std::string rest_mission(const Plan& plan, const std::vector<std::size_t>& missing);

}  // namespace lapwing
