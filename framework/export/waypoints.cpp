// SPDX-License-Identifier: Apache-2.0
#include "framework/export/waypoints.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <set>

#include "framework/core/error.h"
#include "framework/export/keep_clear.h"
#include "framework/geometry/camera_axes.h"
#include "framework/trajectory/interpolate.h"

namespace lapwing {
namespace {

constexpr std::size_t kLongest = 400;  // places, of a line
constexpr double kStill = 0.02;        // m, within which a flight rests
constexpr double kRest = 0.5;          // s
constexpr double kCreep = 0.1;         // m/s, the slowest; who is there early waits

// A place of the path.
struct Place {
  double time;
  Eigen::Vector3d position;
  double yaw, camera_yaw, camera_pitch;
  int subject;
  bool photograph, forced;  // forced: it is a waypoint
};

Place place_at(const Plan& plan, double time) {
  const Sample s = sample_at(plan.trajectory, time);
  return {time, s.position, s.yaw, s.yaw + s.gimbal_yaw, s.gimbal_pitch, -1, false, false};
}

// Seconds between places: so short that between two of them the path leaves their chord by a
// quarter of the tolerance at most.
double step_of(const Plan& plan, double across) {
  double largest = 1e-9;
  for (const Sample& s : plan.trajectory.samples)
    largest = std::max(largest, s.acceleration.norm());
  return std::clamp(std::sqrt(2 * across / largest), 0.02, 0.1);
}

// Where the camera is on a subject that stands still, its place in the list; else -1.
int followed_subject(const Plan& plan, const FramingTask& task, double tolerance) {
  const auto& subjects = plan.environment.subjects;
  int found = -1;
  for (std::size_t i = 0; i < subjects.size(); ++i)
    if (subjects[i].name == task.subject) found = static_cast<int>(i);
  if (found < 0 || !plan.trajectory.has_gimbal) return -1;
  const Subject& subject = subjects[static_cast<std::size_t>(found)];
  for (const Eigen::Vector3d& p : subject.positions)
    if ((p - subject.positions.front()).norm() > 1e-6) return -1;
  const double end = plan.trajectory.samples.back().time;
  for (int i = 0; i <= 200; ++i) {
    const double time =
        std::clamp(task.span.start + (task.span.finish - task.span.start) * i / 200, 0.0, end);
    const Place at = place_at(plan, time);
    const Eigen::Vector3d to = subject.positions.front() - at.position;
    if (to.norm() < 0.1 ||
        std::acos(std::clamp(
            to.normalized().dot(camera_axes(at.camera_yaw, at.camera_pitch).forward), -1.0, 1.0)) >
            tolerance)
      return -1;
  }
  return found;
}

// On the way to a view of a scan the camera, and what turns it, is on that view already.
void aim_at_views(const ScanTask& scan, const Plan& plan, std::vector<Place>& places) {
  std::size_t next = 0;
  for (Place& place : places) {
    while (next + 1 < scan.views.size() && scan.views[next].time < place.time - 1e-9) ++next;
    if (scan.views.empty()) return;
    const double last = plan.trajectory.samples.back().time;
    const Place view = place_at(plan, std::clamp(scan.views[next].time, 0.0, last));
    place.yaw = view.yaw;
    place.camera_yaw = view.camera_yaw;
    place.camera_pitch = view.camera_pitch;
  }
}

std::vector<Place> places_of(const Plan& plan, const WaypointTolerance& tolerance) {
  const double start = plan.trajectory.samples.front().time;
  const double finish = plan.trajectory.samples.back().time;
  struct Followed {
    TimeSpan span;
    int subject;
  };
  std::vector<Followed> followed;
  std::set<double> forced{start, finish}, photographs;
  for (const FramingTask& task : plan.task.framing)
    if (const int subject = followed_subject(plan, task, tolerance.angle); subject >= 0) {
      followed.push_back({task.span, subject});
      forced.insert({std::clamp(task.span.start, start, finish),
                     std::clamp(task.span.finish, start, finish)});
    }
  if (plan.task.scan)
    for (const PlannedView& view : plan.task.scan->views)
      photographs.insert(std::clamp(view.time, start, finish));
  forced.insert(photographs.begin(), photographs.end());
  const double step = step_of(plan, tolerance.across);
  std::vector<Place> places;
  for (auto next = forced.begin(); next != forced.end(); ++next) {
    const double from = *next;
    const double to = std::next(next) == forced.end() ? from : *std::next(next);
    const int parts = std::max(1, static_cast<int>(std::ceil((to - from) / step - 1e-9)));
    for (int i = 0; i < (to > from ? parts : 1); ++i) {
      Place place = place_at(plan, from + (to - from) * i / parts);
      place.forced = i == 0;
      place.photograph = i == 0 && photographs.count(from) > 0;
      for (const Followed& one : followed)
        if (one.span.start <= place.time + 1e-9 && place.time < one.span.finish - 1e-9)
          place.subject = one.subject;
      places.push_back(place);
    }
  }
  if (plan.task.scan) aim_at_views(*plan.task.scan, plan, places);
  return places;
}

// Both ends of every rest are waypoints.
void force_rests(std::vector<Place>& places) {
  for (std::size_t i = 0; i + 1 < places.size();) {
    std::size_t j = i;
    while (j + 1 < places.size() && (places[j + 1].position - places[i].position).norm() < kStill)
      ++j;
    if (places[j].time - places[i].time > kRest) places[i].forced = places[j].forced = true;
    i = std::max(i + 1, j);
  }
}

// What holds for lines between places.
class Lines {
 public:
  Lines(const std::vector<Place>& places, const WaypointTolerance& tolerance, bool gimbal)
      : places_(places), tolerance_(tolerance), gimbal_(gimbal) {}

  bool hold(std::size_t i, std::size_t j) const {
    if (j == i + 1) return true;
    for (std::size_t k = i + 1; k < j; ++k)
      if (places_[k].forced) return false;
    return half_turn(i, j) <= tolerance_.angle && straight(i, j);
  }

  // Whether no longer line from i holds either: what it turns, and that forced places lie on it,
  // only grow.
  bool hopeless(std::size_t i, std::size_t j) const {
    return (j > i + 1 && places_[j - 1].forced) || half_turn(i, j) > tolerance_.angle;
  }

  // Half the angle through which the camera, or the vehicle, turns on the line.
  double half_turn(std::size_t i, std::size_t j) const {
    if (gimbal_ && places_[i].subject >= 0) return 0;
    double low = INFINITY, high = -INFINITY, lowest = INFINITY, highest = -INFINITY;
    for (std::size_t k = i + 1; k <= j; ++k) {
      const double yaw = gimbal_ ? places_[k].camera_yaw : places_[k].yaw;
      low = std::min(low, yaw), high = std::max(high, yaw);
      lowest = std::min(lowest, places_[k].camera_pitch);
      highest = std::max(highest, places_[k].camera_pitch);
    }
    return std::max(high - low, gimbal_ ? highest - lowest : 0.0) / 2;
  }

 private:
  bool straight(std::size_t i, std::size_t j) const {
    const Place &a = places_[i], &b = places_[j];
    const Eigen::Vector3d way = b.position - a.position;
    const double length = way.norm(), across = 0.7 * tolerance_.across;
    for (std::size_t k = i + 1; k < j; ++k) {
      const Eigen::Vector3d to = places_[k].position - a.position;
      if (length < kStill) {
        if (to.norm() > kStill) return false;
        continue;
      }
      const double along = std::clamp(way.dot(to) / length, 0.0, length);
      if ((to - along / length * way).norm() > across) return false;
      const double time = a.time + along / length * (b.time - a.time);
      if (std::abs(time - places_[k].time) > tolerance_.time) return false;
    }
    return true;
  }

  const std::vector<Place>& places_;
  const WaypointTolerance& tolerance_;
  bool gimbal_;
};

double middle(const std::vector<Place>& places, std::size_t i, std::size_t j,
              double Place::*angle) {
  double low = places[j].*angle, high = low;
  for (std::size_t k = i + 1; k <= j; ++k) {
    low = std::min(low, places[k].*angle);
    high = std::max(high, places[k].*angle);
  }
  return (low + high) / 2;
}

PlannedWaypoint waypoint_of(const std::vector<Place>& places, std::size_t i, std::size_t j) {
  const Place &a = places[i], &b = places[j];
  PlannedWaypoint made{b.time, b.position};
  // An image wants the direction at its end.
  made.yaw = b.photograph ? b.yaw : middle(places, i, j, &Place::yaw);
  made.camera_yaw = b.photograph ? b.camera_yaw : middle(places, i, j, &Place::camera_yaw);
  made.camera_pitch = b.photograph ? b.camera_pitch : middle(places, i, j, &Place::camera_pitch);
  made.subject = a.subject;
  made.photograph = b.photograph;
  return made;
}

}  // namespace

std::vector<std::size_t> fewest_steps(
    std::size_t count, std::size_t most, const std::function<bool(std::size_t, std::size_t)>& holds,
    const std::function<bool(std::size_t, std::size_t)>& hopeless) {
  constexpr std::size_t kNone = ~std::size_t{0};
  std::vector<std::size_t> steps(count, kNone), before(count, kNone);
  if (count == 0) return {};
  steps[0] = 0;
  for (std::size_t i = 0; i < count; ++i)
    for (std::size_t j = i + 1; j < count && j - i <= most; ++j) {
      if (j > i + 1 && hopeless(i, j)) break;
      if (steps[i] + 1 < steps[j] && holds(i, j)) steps[j] = steps[i] + 1, before[j] = i;
    }
  std::vector<std::size_t> ends;
  for (std::size_t at = count - 1; at != kNone; at = before[at]) ends.push_back(at);
  std::reverse(ends.begin(), ends.end());
  return ends;
}

std::vector<PlannedWaypoint> fewest_waypoints(const Plan& plan, const WaypointTolerance& tolerance,
                                              const std::string& format) {
  if (plan.trajectory.samples.size() < 2)
    throw InputError(format + ": the flight of '" + plan.mission +
                     "' has no length: nothing to fly from and to");
  for (const Sample& s : plan.trajectory.samples)
    if (!s.position.allFinite() || !std::isfinite(s.yaw + s.gimbal_yaw + s.gimbal_pitch))
      throw InputError(format + ": a number of the plan is not finite");
  std::vector<Place> places = places_of(plan, tolerance);
  force_rests(places);
  const Lines lines(places, tolerance, plan.trajectory.has_gimbal);
  const std::vector<std::size_t> ends = fewest_steps(
      places.size(), kLongest, [&](std::size_t i, std::size_t j) { return lines.hold(i, j); },
      [&](std::size_t i, std::size_t j) { return lines.hopeless(i, j); });
  std::vector<PlannedWaypoint> made{waypoint_of(places, 0, 0)};
  for (std::size_t k = 1; k < ends.size(); ++k)
    made.push_back(waypoint_of(places, ends[k - 1], ends[k]));
  const auto join_rests = [&] {
    for (std::size_t k = 1; k < made.size(); ++k)
      if ((made[k].position - made[k - 1].position).norm() < kStill)
        made[k].position = made[k - 1].position;
  };
  join_rests();
  keep_clear(made, plan.environment);
  join_rests();
  for (std::size_t k = 1; k < made.size(); ++k) {
    const double length = (made[k].position - made[k - 1].position).norm();
    const double time = made[k].time - made[k - 1].time;
    made[k].speed = length > 0 ? std::max(kCreep, length / time) : 0;
    made[k].hold = length > 0 ? time - length / made[k].speed : time;
    if (made[k].hold < 1e-9) made[k].hold = 0;
  }
  return made;
}

}  // namespace lapwing
