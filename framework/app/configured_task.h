// SPDX-License-Identifier: Apache-2.0
// What a plan's own configuration says of its obstacles and its task.
#pragma once

#include <string>
#include <vector>

#include "framework/trajectory/plan.h"

namespace lapwing {

struct ConfigurationComparison {
  std::vector<std::string> faults;        // where the plan asks for less, a sentence each
  std::vector<std::string> not_compared;  // what was left out and why, a phrase each
};

// Compares a plan with its configuration: origin, home and motion of every kind; obstacles with
// their tracks and whether they hide subjects, ground, zones, margin, keyframes with their times,
// yaws and tolerances, subjects, framing, cuts, bystanders, constraints and budget of films; gates
// of races; region, zones, pilot, camera, margin, budget and tolerances of scans; tolerance and
// view of light paintings. A plan may ask for more. What the configuration leaves to a file or to
// the script, and missions of other kinds, are said to be not compared.
ConfigurationComparison compare_with_configuration(const Plan& plan);

// ---- parts, by the kind of mission --------------------------------------------------------------

void compare_film(const Plan& plan, ConfigurationComparison& found);
void compare_race(const Plan& plan, ConfigurationComparison& found);
void compare_scan(const Plan& plan, ConfigurationComparison& found);
void compare_light_painting(const Plan& plan, ConfigurationComparison& found);
// Of scans: zones, regions as polygons, the pilot, the accuracy of the position.
void compare_flight_rules(const Plan& plan, ConfigurationComparison& found);
void compare_surroundings(const Plan& plan, ConfigurationComparison& found);
// That the motion is the one of the stated model.
void compare_motion(const Plan& plan, ConfigurationComparison& found);
// That there is level ground, at least as high as stated.
void compare_ground(const Plan& plan, ConfigurationComparison& found);

// Whether an obstacle moves as the stated one.
bool same_track(const Value& stated, const Obstacle& obstacle);

// Whether a zone has the corners, the floor and the ceiling that are stated.
bool same_zone(const Value& stated, const Obstacle& zone);

// "the margin is 0.1 m in the plan and 0.5 m in its configuration"
std::string otherwise(const std::string& what, const std::string& here, const std::string& asked);
// The fault that a number is above, below, or not what the configuration states; none where it
// states nothing.
enum class Than { above, below, other };
void compare_number(const std::string& what, double here, std::optional<double> asked,
                    const std::string& unit, Than wrong, ConfigurationComparison& found);

}  // namespace lapwing
