// SPDX-License-Identifier: Apache-2.0
// Zones of a plan as fences, which reach from the ground to the sky.
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "framework/trajectory/plan.h"

namespace lapwing {

// A zone that a ground station hands to the vehicle beside the mission.
struct MissionFence {
  std::string name;
  bool inclusion = false;
  std::vector<Eigen::Vector2d> corners;  // m, world, clockwise; empty: a circle
  Eigen::Vector2d center = Eigen::Vector2d::Zero();
  double radius = 0;  // m
};

// Of flight zones and zones as polygons, of balls and upright cylinders as circles. What the flight
// passes above or below, and what the plan's home or a rally point would break, is left out,
// because a fence has no height; `said` takes a sentence on it.
std::vector<MissionFence> mission_fences(const Plan& plan, std::vector<std::string>& said);

}  // namespace lapwing
