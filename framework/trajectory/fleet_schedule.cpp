// SPDX-License-Identifier: Apache-2.0
// How: a tour is sampled every kStep, and is straight between two samples. Starts are multiples of
// kStep, so that the samples of two tours coincide, and the distance between two of them is that of
// a segment of relative motion from the origin. While a drone climbs or lands it is a ray that
// points down from its home. kRoom covers what lies between the samples.
#include "framework/trajectory/fleet_schedule.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "framework/core/error.h"
#include "framework/trajectory/interpolate.h"

namespace lapwing {
namespace {

using Eigen::Vector3d;

constexpr double kStep = 0.1;  // s
constexpr int kStartSteps = 5;
constexpr double kRoom = 0.05;  // m

// A tour with the climb before it and the landing after it, step by step.
struct Timeline {
  std::string drone;
  std::vector<Vector3d> places;  // in flight, one per step
  int margin = 0;                // steps of a climb and of a landing
  int start = 0;                 // step at which the tour begins, once it is scheduled

  int flight() const { return static_cast<int>(places.size()) - 1; }
  int first() const { return start - margin; }
  int last() const { return start + flight() + margin; }
  bool flies(int step) const { return step >= start && step < start + flight(); }
  const Vector3d& at(int step) const {
    return places[static_cast<std::size_t>(std::clamp(step - start, 0, flight()))];
  }
};

Timeline timeline_of(const TourToFly& tour, double swap) {
  const Trajectory& trajectory = *tour.trajectory;
  if (trajectory.samples.empty()) throw Error("a tour of a fleet has no samples");
  Timeline timeline;
  timeline.drone = tour.drone;
  timeline.margin = static_cast<int>(std::ceil(swap / 2 / kStep));
  const double first = trajectory.samples.front().time, duration = trajectory.duration();
  const int steps = std::max(1, static_cast<int>(std::ceil(duration / kStep)));
  for (int k = 0; k <= steps; ++k)
    timeline.places.push_back(
        sample_at(trajectory, first + std::min(duration, k * kStep)).position);
  return timeline;
}

// Nearest to the origin on the way from `a` to `b`, m.
template <class Vector>
double nearest(const Vector& a, const Vector& b) {
  const Vector way = b - a;
  const double length = way.squaredNorm();
  const double share = length > 0 ? std::clamp(-a.dot(way) / length, 0.0, 1.0) : 0;
  return (a + share * way).norm();
}

// Of the way from `a` to `b`, relative to a home, from the line that goes down from there.
double nearest_to_line_below(const Vector3d& a, const Vector3d& b) {
  const auto beside = [](const Vector3d& from, const Vector3d& to) {
    return nearest(Eigen::Vector2d(from.head<2>()), Eigen::Vector2d(to.head<2>()));
  };
  if (a.z() <= 0 && b.z() <= 0) return beside(a, b);
  if (a.z() >= 0 && b.z() >= 0) return nearest(a, b);
  const Vector3d level = a + a.z() / (a.z() - b.z()) * (b - a);
  const Vector3d &low = a.z() < 0 ? a : b, &high = a.z() < 0 ? b : a;
  return std::min(beside(low, level), nearest(level, high));
}

// Within one step; both drones are on their timelines.
double distance(const Timeline& a, const Timeline& b, int step) {
  if (a.flies(step) && b.flies(step))
    return nearest(Vector3d(b.at(step) - a.at(step)), Vector3d(b.at(step + 1) - a.at(step + 1)));
  if (!a.flies(step) && !b.flies(step)) return (b.at(step) - a.at(step)).head<2>().norm();
  const Timeline &waits = a.flies(step) ? b : a, &moves = a.flies(step) ? a : b;
  const Vector3d& home = waits.at(step);
  return nearest_to_line_below(moves.at(step) - home, moves.at(step + 1) - home);
}

bool apart(const Timeline& a, const Timeline& b, double separation) {
  const int end = std::min(a.last(), b.last());
  for (int step = std::max(a.first(), b.first()); step < end; ++step)
    if (distance(a, b, step) < separation + kRoom) return false;
  return true;
}

int rounded_up(int step) {
  return (step + kStartSteps - 1) / kStartSteps * kStartSteps;
}

class Scheduler {
 public:
  Scheduler(std::span<const TourToFly> tours, const FleetRules& rules)
      : rules_(rules), swap_steps_(static_cast<int>(std::ceil(rules.swap / kStep - 1e-9))) {
    for (const TourToFly& tour : tours) timelines_.push_back(timeline_of(tour, rules.swap));
  }

  std::vector<ScheduledTour> run() {
    std::vector<std::size_t> left(timelines_.size());
    for (std::size_t i = 0; i < left.size(); ++i) left[i] = i;
    while (!left.empty()) {
      auto soonest = left.begin();
      int start = 0;
      for (auto tour = left.begin(); tour != left.end(); ++tour) {
        const int begins = earliest(timelines_[*tour]);
        if (tour != left.begin() && begins >= start) continue;
        soonest = tour;
        start = begins;
      }
      take(*soonest, start);
      left.erase(soonest);
    }
    std::stable_sort(done_.begin(), done_.end(),
                     [](const ScheduledTour& a, const auto& b) { return a.start < b.start; });
    return done_;
  }

 private:
  int earliest(Timeline timeline) const {
    const auto ready = ready_.find(timeline.drone);
    timeline.start = ready == ready_.end() ? 0 : ready->second;
    while (!free(timeline)) timeline.start += kStartSteps;
    return timeline.start;
  }

  bool free(const Timeline& timeline) const {
    if (rules_.separation <= 0) return true;
    return std::all_of(done_.begin(), done_.end(), [&](const ScheduledTour& other) {
      const Timeline& flown = timelines_[other.tour];
      return flown.drone == timeline.drone || apart(flown, timeline, rules_.separation);
    });
  }

  void take(std::size_t tour, int start) {
    Timeline& timeline = timelines_[tour];
    timeline.start = start;
    ready_[timeline.drone] = rounded_up(start + timeline.flight() + swap_steps_);
    done_.push_back({tour, start * kStep, ++batteries_[timeline.drone]});
  }

  const FleetRules& rules_;
  int swap_steps_;
  std::vector<Timeline> timelines_;
  std::vector<ScheduledTour> done_;
  std::map<std::string, int> ready_;  // step from which a drone may begin
  std::map<std::string, int> batteries_;
};

}  // namespace

std::vector<ScheduledTour> fleet_schedule(std::span<const TourToFly> tours,
                                          const FleetRules& rules) {
  return Scheduler(tours, rules).run();
}

}  // namespace lapwing
