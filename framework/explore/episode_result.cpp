// SPDX-License-Identifier: Apache-2.0
// What an episode ends with, and what follows from its views alone.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "framework/explore/episode.h"

namespace lapwing {

const char* to_string(EpisodeEnd end) {
  switch (end) {
    case EpisodeEnd::steps:
      return "steps";
    case EpisodeEnd::budget:
      return "budget";
    case EpisodeEnd::nothing_to_gain:
      return "nothing_to_gain";
    case EpisodeEnd::no_way:
      return "no_way";
    case EpisodeEnd::time:
      return "time";
    case EpisodeEnd::cancelled:
      return "cancelled";
  }
  return "";
}

std::string explain(EpisodeEnd end) {
  switch (end) {
    case EpisodeEnd::steps:
      return "all requested images are taken";
    case EpisodeEnd::budget:
      return "the next view is beyond the budget of the flight";
    case EpisodeEnd::nothing_to_gain:
      return "nothing left to gain: no reachable view has a utility above 0";
    case EpisodeEnd::no_way:
      return "no view is reachable through known free space";
    case EpisodeEnd::time:
      return "stopped by wall_clock_guard";
    case EpisodeEnd::cancelled:
      return "cancelled";
  }
  return "";
}

double EpisodeResult::efficiency(int most) const {
  double sum = 0;
  for (int t = 0; t < most; ++t) {
    if (steps.empty()) break;
    sum += steps[std::min(static_cast<std::size_t>(t), steps.size() - 1)].observed;
  }
  return sum;
}

double EpisodeResult::efficiency_in_time(double until) const {
  if (!(until > 0)) return 0;
  double sum = 0, observed = 0, since = 0;
  for (const EpisodeStep& step : steps) {
    if (step.time >= until) break;
    sum += observed * (step.time - since);
    observed = step.observed;
    since = step.time;
  }
  return (sum + observed * (until - since)) / until;
}

std::vector<double> replay(const EpisodeSettings& settings, const EpisodeResult& flown,
                           const GroundTruth& truth, ObservedSurface& observed, Map& map) {
  ViewSensor sensor = settings.sensor;
  sensor.noise.reset();
  sensor.stereo.reset();
  map.set_threads(settings.threads);
  std::vector<double> curve;
  for (const EpisodeStep& step : flown.steps) {
    map.integrate(sensor.look(truth.scene(), step.view, settings.threads));
    observed.update(map, step.view);
    curve.push_back(observed.observed());
  }
  return curve;
}

std::vector<Viewpoint> neighbours_of(const Viewpoint& view, double step, double turn) {
  const CameraAxes<double> axes = camera_axes(view.yaw, view.pitch);
  std::vector<Viewpoint> next;
  for (const Eigen::Vector3d& axis : {axes.right, axes.down, axes.forward})
    for (const double sign : {1.0, -1.0}) {
      next.push_back(view);
      next.back().position += sign * step * axis;
    }
  for (const double by : {turn, -turn, std::numbers::pi}) {
    next.push_back(view);
    next.back().yaw = std::remainder(view.yaw + by, 2 * EIGEN_PI);
  }
  return next;
}

}  // namespace lapwing
