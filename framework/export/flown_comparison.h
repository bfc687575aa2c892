// SPDX-License-Identifier: Apache-2.0
// How far the flight that a vehicle makes of a file is from the plan, and what it breaks.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "framework/export/exporter.h"

namespace lapwing {

struct FlownComparison {
  // At most, and the time of the plan (s) at which. The flight is compared with the place of the
  // plan that it has come to, so that a flight that is late is not far.
  double across = 0, across_time = 0;    // m
  double late = 0, late_time = 0;        // s; negative: early
  double camera = 0, camera_time = 0;    // rad, between optical axes; of a plan with a gimbal
  double heading = 0, heading_time = 0;  // rad, of the vehicle
  double longer = 0;                     // s that the flight takes more than the plan's part
  // Of the images of a scan: how many are not taken, and the worst of the others.
  std::size_t images_missed = 0;
  double image_distance = 0, image_angle = 0;  // m, rad

  std::vector<std::string> sentences;  // for the user
  std::vector<std::string> refusals;   // what the flight breaks and the plan does not
};

// The verifier judges the flight in the place of the plan's: obstacles, flight zones, distances
// from subjects, speeds, flight time. `folder`, the plan's, holds the meshes of its environment.
// What the plan's own certificate states as failed is no reason to refuse, nor is a limit of speed
// or yaw rate that the plan itself passes.
FlownComparison compare_flown(const Plan& plan, const FlownFile& flown,
                              const std::filesystem::path& folder);

}  // namespace lapwing
