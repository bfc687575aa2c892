// SPDX-License-Identifier: Apache-2.0
// The plan document: all that a flight needs and all that the verifier may look at.
//
// `plan.json` holds no wall-clock figure: the same script, configuration and seed give the same
// bytes. Sections after the task are opaque to this room.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "framework/core/value.h"
#include "framework/geometry/geodetic_origin.h"
#include "framework/trajectory/environment.h"
#include "framework/trajectory/gate.h"
#include "framework/trajectory/home.h"
#include "framework/trajectory/polyline.h"
#include "framework/trajectory/scan_task.h"
#include "framework/trajectory/stated_constraint.h"
#include "framework/trajectory/time_span.h"
#include "framework/trajectory/trajectory.h"

namespace lapwing {

struct KeyframeTask {
  double time = 0;                                     // s
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  // m
  std::optional<double> yaw = std::nullopt;            // rad
  double tolerance = 0.5;                              // m
  double time_tolerance = 0.1;                         // s
  double yaw_tolerance = 0.1745;                       // rad
};

// Which subject the camera is on, and when. Times outside all of these ask for nothing.
struct FramingTask {
  std::string subject;  // a name of the environment's subjects
  TimeSpan span;
};

struct Task {
  std::vector<KeyframeTask> keyframes;
  std::vector<FramingTask> framing;
  double framing_share = 0.95;  // of the time asked for, cuts excepted, that the middle of the
                                // subject is inside the image
  bool line_of_sight_required = true;  // else the share of it in which obstacles hide no subject
                                       // is reported
  std::vector<GateTask> gates;         // flown through in this order, laps written out
  bool closed_loop_required = true;    // else what the controller makes of it is reported
  std::vector<Points> strokes;         // to draw with light, world
  double drawing_tolerance = 0.05;     // m, of the mean distance between light and strokes
  Eigen::Vector3d drawing_view =
      Eigen::Vector3d::UnitY();  // the way that its spectators look, world
  std::optional<ScanTask> scan;  // to photograph a region
};

struct Plan {
  static constexpr int kFormat = 2;               // format 1 is read and converted
  std::string mission;                            // name as the script gave it
  std::string kind;                               // film, race, ...
  std::optional<GeodeticOrigin> geodetic_origin;  // of the world frame
  std::optional<Home> home;                       // the take-off place, where it is stated
  Value vehicle;                                  // as vehicle/vehicle.h writes it, camera included
  Trajectory trajectory;
  Environment environment;
  std::vector<TimeSpan> cuts;    // footage thrown away; in order, apart from each other
  std::vector<TimeSpan> lights;  // when the light is on; in order, apart from each other
  std::optional<double> budget;  // s of flight
  Task task;
  std::vector<StatedConstraint> constraints;  // of the script
  Value configuration;                        // effective, with overrides
  Value solver;                               // solver report
  Value certificate;                          // as verify writes it
};

// The document. SI and radians; a sample has the fields of its motion model alone; sections that
// are absent (no origin, no home, no budget, null values) have no key.
Value to_value(const Plan& plan);
// Throws InputError listing every missing, misspelt, mistyped or non-finite field, and another
// format number; a digest is not compared (plan_digest.h). It judges form alone: times out of order
// or a vehicle that contradicts itself are for the verifier to report.
Plan plan_from_value(const Value& value);

// The bytes of plan.json, with its digest last; equal plans give equal bytes. Throws Error naming
// the key of a number that is not finite, which JSON cannot hold.
std::string plan_text(const Plan& plan);
void write_plan(const Plan& plan, const std::filesystem::path& path);  // whole or not at all
Plan read_plan(const std::filesystem::path& path);

}  // namespace lapwing
