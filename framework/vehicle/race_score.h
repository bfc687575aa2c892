// SPDX-License-Identifier: Apache-2.0
// What a race flown by hand is worth (reading 3.8): the time of all laps, plus a price for straying
// and for gates that were not flown through. The lower wins.
#pragma once

#include <string>
#include <vector>

#include "framework/trajectory/gate.h"
#include "framework/trajectory/trajectory.h"
#include "framework/vehicle/race_flight.h"

namespace lapwing {

struct RaceRules {
  double deviation_price = 5;  // s per metre of mean deviation
  double gate_price = 10;      // s per gate that was missed
};

struct RaceScore {
  bool finished = false;  // who does not finish has no score
  double time = 0;        // s, of all laps
  double straying = 0;    // s, for the mean deviation
  double gates = 0;       // s, for gates that were missed
  double handicap = 0;    // s
  std::vector<std::string> missed;
  double total() const { return time + straying + gates + handicap; }
};

struct RacedPilot {
  Pilot pilot;
  RaceFlight flight;
  RaceScore score;
};

// As usual, but that a course which ends in a gate ends in that gate's plane.
RaceFlightLimits race_limits(const Trajectory& course, const std::vector<GateTask>& gates);

// Gates in order, laps written out, each looked for while the pilot was nearer to it than to its
// neighbours along the course: one that is missed is not waited for, and costs no other.
RaceScore score_of(const RaceFlight& flight, const Trajectory& course,
                   const std::vector<GateTask>& gates, double handicap,
                   const RaceRules& rules = {});

// The score as it stood at each sample, s: what `score_of` would say had the race ended there; a
// gate counts as missed from when the next one is passed, or the race ends. `under_way`: it goes on
// after the last sample, and gates ahead cost nothing yet.
std::vector<double> score_over_time(const RaceFlight& flight, const Trajectory& course,
                                    const std::vector<GateTask>& gates, double handicap,
                                    const RaceRules& rules = {}, bool under_way = false);

}  // namespace lapwing
