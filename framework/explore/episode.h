// SPDX-License-Identifier: Apache-2.0
// An exploration: look, update the map, score the views that could be reached, go to the best one,
// look again (thesis 5.3, 5.4.1, 5.4.4).
//
// The map is all that the explorer knows. It starts in a box that is taken to be free; from every
// viewpoint nine neighbours may be added to the viewpoints it could go to: six steps along the axes
// of its camera, two turns, one turn about. A viewpoint is added when its body can move there
// through voxels that are known to be free, and left out once it was measured from twice. Values
// are re-scored lazily: what was scored for an older map is taken for an upper bound, which is
// exact for the oracle alone (reading 5.6).
#pragma once

#include <functional>
#include <optional>

#include "framework/core/progress.h"
#include "framework/explore/ground_truth.h"
#include "framework/explore/view_utility.h"
#include "framework/explore/viewpoint_graph.h"

namespace lapwing {

struct EpisodeSettings {
  static constexpr int kMostLookahead = 4;  // 9^3 ways from each view

  ViewSensor sensor;
  double step = 2.5;                       // m, to a neighbour
  double turn = 0.4363323129985824;        // rad, to a neighbour: 25 degrees
  double body = 1;                         // m, edge of the box that must be free
  double clear = 6;                        // m, edge of the box that is free at the start
  bool per_second = false;                 // the largest value for each second; else for each image
  int visits = 2;                          // images from a viewpoint, then it is left out
  int lookahead = 1;                       // views of the ways that are valued (lookahead.h)
  int steps = 200;                         // images
  double speed = 2;                        // m/s
  double turn_rate = 1;                    // rad/s
  double acceleration = 0;                 // m/s^2; 0: moves begin and end at once
  double turn_acceleration = 0;            // rad/s^2; likewise, both or none
  double pause = 0.5;                      // s, at rest for an image
  std::optional<double> budget;            // s of flight
  std::optional<double> wall_clock_guard;  // s
  std::optional<Eigen::AlignedBox3d> bounds;  // the explorer stays inside
  bool show_truth = false;                    // to a utility that needs it
  bool list_candidates = false;               // at the end: takes as long as many steps
  std::uint64_t seed = 1;                     // of the sensor's noise
  int threads = 1;                            // results are the same for any number
  const CancellationToken* cancellation = nullptr;
  Progress* progress = nullptr;
};

enum class EpisodeEnd {
  steps,            // all that were asked for
  budget,           // the next view is beyond the seconds of flight
  nothing_to_gain,  // no view that could be reached has a value above 0
  no_way,           // no view that could be reached is left
  time,             // the wall clock's guard: another run may end elsewhere
  cancelled,
};
const char* to_string(EpisodeEnd end);
// A sentence for the user.
std::string explain(EpisodeEnd end);

// One image.
struct EpisodeStep {
  Viewpoint view;
  double value = 0;            // the utility's when it was chosen
  double observed = 0;         // ObsSurf (5.2) afterwards; 0 without a truth
  double length = 0;           // m flown so far
  double time = 0;             // s flown so far, until the image is taken
  double seconds = 0;          // wall clock of choosing and mapping, without the simulated camera
  int scored = 0;              // views scored for it
  std::vector<Viewpoint> way;  // from the view before (left out) to this one
};

struct ScoredView {
  Viewpoint view;
  double value = 0;
};

struct EpisodeResult {
  EpisodeEnd end = EpisodeEnd::steps;
  std::vector<EpisodeStep> steps;
  // What could be reached at the end, all for the last map; where asked for, and not stopped.
  std::vector<ScoredView> candidates;
  double surface = 0;  // voxels there were to find; 0 without a truth

  double observed() const { return steps.empty() ? 0 : steps.back().observed; }
  double time() const { return steps.empty() ? 0 : steps.back().time; }  // s
  double length() const { return steps.empty() ? 0 : steps.back().length; }
  // (5.6) up to `most` images: the sum over time of the observed surface, which stays as it is
  // after an early end. Before the first image it is 0.
  double efficiency(int most) const;
  // The same over the time of the flight: the observed surface, integrated from take-off to
  // `until` s, over `until`. It stays as it is after an early end.
  double efficiency_in_time(double until) const;
};

// As the settings say.
inline MoveTimes move_times(const EpisodeSettings& s) {
  return {s.speed, s.turn_rate, s.acceleration, s.turn_acceleration};
}

// Told after every image. `neighbours` could be reached from the viewpoint, in their fixed order.
struct EpisodeMoment {
  int step = 0;  // from 0 on
  const EpisodeView& known;
  std::span<const Viewpoint> neighbours;
  const EpisodeStep& taken;
};
using EpisodeObserver = std::function<void(const EpisodeMoment&)>;

// Told before every image, when its view is chosen and the map is the one that it was chosen by.
struct EpisodeChoice {
  int step = 0;  // from 0 on
  const EpisodeView& known;
  const Viewpoint& view;
};
using ChoiceObserver = std::function<void(const EpisodeChoice&)>;

// `map` is empty and counts observations. `truth` is the simulated world; `observed` belongs to it
// and is asked by a utility that needs it. All outlive the call.
//
// InputError: a start whose box is not free in the world, outside the bounds, or without a
// neighbour that could be reached; a map that does not count observations or has another maximum
// range than the camera; whatever the utility's require_fit throws; settings without sense.
EpisodeResult explore(const EpisodeSettings& settings, const Viewpoint& start,
                      const GroundTruth& truth, ObservedSurface& observed,
                      const ViewUtility& utility, Map& map, const EpisodeObserver& observer = {},
                      const ChoiceObserver& before = {});

// The same viewpoints again with a camera without noise, as table 5.4 does: what of the surface
// they would have observed after each image.
std::vector<double> replay(const EpisodeSettings& settings, const EpisodeResult& flown,
                           const GroundTruth& truth, ObservedSurface& observed, Map& map);

// The nine neighbours of a viewpoint, in their fixed order: right, left, down, up, ahead, back,
// left turn, right turn, about.
std::vector<Viewpoint> neighbours_of(const Viewpoint& view, double step, double turn);

}  // namespace lapwing
