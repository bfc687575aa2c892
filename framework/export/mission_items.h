// SPDX-License-Identifier: Apache-2.0
// A plan as a list of MAVLink mission items, and the flight that an autopilot makes of such a list.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "framework/export/earth_frame.h"
#include "framework/export/exporter.h"
#include "framework/export/mission_fences.h"
#include "framework/export/waypoint_flight.h"
#include "framework/export/waypoints.h"

namespace lapwing {

// Commands of MAVLink's common.xml (MAV_CMD).
namespace mav {
inline constexpr int kWaypoint = 16, kReturn = 20, kLand = 21, kTakeOff = 22, kDelay = 93;
inline constexpr int kConditionYaw = 115, kChangeSpeed = 178, kRoi = 195, kRoiNone = 197;
inline constexpr int kMountControl = 205, kGimbal = 1000, kGimbalOwner = 1001;
inline constexpr int kPhotograph = 2000, kVideoStart = 2500, kVideoStop = 2501;
// Frames (MAV_FRAME).
inline constexpr int kGlobal = 0, kNoPlace = 2, kRelative = 3;
}  // namespace mav

// Parameters 5 to 7 of one with a place: latitude and longitude in degrees, height in m above the
// take-off place. NaN: not set.
struct MissionItem {
  int command = mav::kWaypoint;
  int frame = mav::kRelative;
  std::array<double, 7> params{};
};

struct MissionFileOptions {
  WaypointTolerance tolerance;
  bool ardupilot = false;
  int gimbal = mav::kGimbal;     // or kMountControl
  std::optional<double> home_z;  // m, world, of the take-off place
  std::string finish;            // "land", "return", "hover"
  bool take_off = true;
  int part = 0;  // counts from 1; 0: the plan must fit into one file
};
// The parameters of exporters of missions, and what was given for them.
ParameterTable mission_parameters();
MissionFileOptions mission_file_options(const Parameters& given);

struct PlannedMission {
  std::vector<MissionItem> items;
  EarthPoint home;               // the take-off place: the plan's, or below the first waypoint
  double home_z = 0;             // m, world
  double cruise = 0;             // m/s, the fastest leg
  double start = 0, finish = 0;  // s of the plan
  int part = 1, parts = 1;
  std::size_t waypoints = 0;
  std::vector<MissionFence> fences;
  // Degrees north and east, m above the take-off place.
  std::vector<std::array<double, 3>> rally_points;
  std::vector<std::string> said;  // for the user
};

// Throws InputError beginning with `format`: no origin, no length, a take-off to a waypoint that is
// not above its place, a landing from below, with an origin above the ground a waypoint that is
// not above it, climbing, descending or going to the first waypoint through an obstacle, more items
// than the autopilot holds (2000 of PX4, 700 of ArduPilot; it says how many parts there are), a
// part that there is not.
PlannedMission mission_of(const Plan& plan, const MissionFileOptions& options,
                          const std::string& format);

// m above the sea of the take-off place; nothing where the origin does not tell it: a height above
// the ground, or one above the ellipsoid and no model of the geoid. `said` takes a sentence then.
std::optional<double> home_above_sea(const EarthFrame& frame, const EarthPoint& home,
                                     std::vector<std::string>* said);

// The flight of items that were read from a file. Commands that it does not know are InputErrors.
// Heights count from the ground of the take-off place, which is at `home_z` (m, world). ArduPilot
// drops fractions of the seconds to hold at a waypoint.
FlownFile flight_of(const std::vector<MissionItem>& items, const EarthFrame& frame, EarthPoint home,
                    double home_z, bool ardupilot, const Plan& plan);

// What every export says of heights: "heights in the file are above the take-off place ...".
std::string sentence_of_heights(const std::vector<MissionItem>& items, double home_z);

}  // namespace lapwing
