// SPDX-License-Identifier: Apache-2.0
// One pilot's flight round a planned course (thesis 3.7.2, fig. 3.9; reading 3.8).
//
// The controller of 3.8.2 holds height, heading and the way across the course; the stick takes the
// place of the planned acceleration, m r_d'' of (3.14), by the pilot's weight: with weight w
//
//   feed-forward = (1 - w) m r_d'' + w m a_max (forward e_t + left e_n)
//
// e_t is the horizontal direction of the course, e_n left of it, a_max the stick's strength. Level
// gains are such that, held across the course, the full stick of weight 1 ends `reach` away from
// it, critically damped. Along the course nothing is pulled back to a clock: the reference follows
// the pilot's progress, so that a stick pushed forward flies faster than planned, and a corner that
// is cut saves time.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "framework/core/progress.h"
#include "framework/trajectory/trajectory.h"
#include "framework/vehicle/rotor_body.h"
#include "framework/vehicle/stick_log.h"

namespace lapwing {

struct Pilot {
  std::string name;
  StickLog log;
  double weight = 0.5;  // of the stick, 0 to 1
  double strength = 4;  // m/s^2, of a full deflection
  double reach = 3;     // m
  double speed = 1;     // of the reference, times the planned one
  double handicap = 0;  // s, added to the score
};

struct RaceFlightLimits {
  double step = 0.002;         // s, of the controller and of the integration
  double sample_step = 0.02;   // s, between the kept samples
  double off_course = 6;       // m, from the course: out of the race
  double time_factor = 3;      // times the pilot's reference: out of the race
  double finish_radius = 0.5;  // m, of the end of a course that ends at rest
  // Unit vector across the plane in which the course ends; absent: along the course there.
  std::optional<Eigen::Vector3d> finish_direction = std::nullopt;
};

struct RaceSample {
  double time = 0;  // s, from the start
  BodyState state;
  Eigen::Vector3d course = Eigen::Vector3d::Zero();  // m, world: where on the course
  double progress = 0;                               // s, the plan's time of that place
  double deviation = 0;                              // m, from it
  Eigen::Vector2d stick = Eigen::Vector2d::Zero();
};

enum class RaceEnd { finished, off_course, turned_over, time_up };
const char* to_string(RaceEnd end);  // "finished", "left the course", ...

struct RaceFlight {
  std::vector<RaceSample> samples;
  RaceEnd end = RaceEnd::finished;
  double time = 0;                               // s, to the finish or to the end of the flight
  double deviation_mean = 0;                     // m, over time
  double deviation_worst = 0, deviation_at = 0;  // m, s
  double saturated_share = 0;                    // of the time
};

// Flies from the plan's first sample. Throws InputError for a weight outside [0, 1], a strength
// or reach that is not above 0, a speed outside [0.1, 3], a handicap that is not finite and as
// ReferenceMotion does; Cancelled when told to stop.
RaceFlight fly_race(const Trajectory& course, const Vehicle& vehicle, const Pilot& pilot,
                    const RaceFlightLimits& limits = {},
                    const CancellationToken* cancellation = {});

// Where the stick is, for a pilot who sees the time, the vehicle and the plan's time of its place.
using StickSource =
    std::function<Eigen::Vector2d(double time, const BodyState& state, double progress)>;

// The same flight, one step of the limits after the other.
class RaceInProgress {
 public:
  // Throws as fly_race does. The course and the vehicle are needed no longer afterwards.
  RaceInProgress(const Trajectory& course, const Vehicle& vehicle, const Pilot& pilot,
                 const RaceFlightLimits& limits = {});
  ~RaceInProgress();
  RaceInProgress(RaceInProgress&&) noexcept;
  RaceInProgress& operator=(RaceInProgress&&) noexcept;

  bool ended() const;
  double time() const;             // s, of the step that comes next
  const BodyState& state() const;  // at that time
  double progress() const;         // s, the plan's time of the place that was reached
  double deviation() const;        // m, from it
  // Flies one step with the stick as it is at its beginning; after the end nothing.
  void step(const StickSource& stick);
  // What was flown so far, the share of saturated time left out before the end.
  const RaceFlight& flight() const;

 private:
  struct Inside;
  std::unique_ptr<Inside> inside_;
};

// The same with a stick that answers to the flight, in place of the pilot's log.
RaceFlight fly_race(const Trajectory& course, const Vehicle& vehicle, const Pilot& pilot,
                    const StickSource& stick, const RaceFlightLimits& limits = {},
                    const CancellationToken* cancellation = {});

}  // namespace lapwing
