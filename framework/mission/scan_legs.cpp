// SPDX-License-Identifier: Apache-2.0
// The legs of a tour as problems of their own, and the flight that their solutions make.
#include <algorithm>
#include <cmath>

#include "framework/core/number_text.h"
#include "framework/core/units.h"
#include "framework/mission/run.h"
#include "framework/mission/scan_objects.h"

namespace lapwing {
namespace {

constexpr double kLegPlace = 0.01;  // m, by which a leg may miss its views
constexpr double kLegYaw = 0.01;    // rad, likewise
constexpr double kLegSpeed = 0.01;  // m/s, at rest

const Viewpoint& stop_of(const TourObject& tour, std::size_t i) {
  return tour.work->graph.candidates.viewpoints[static_cast<std::size_t>(tour.walk[i])];
}

const ViewMotion& leg_motion(const TourObject& tour, std::size_t leg) {
  return tour.work->graph.motions
      .motions[tour.work->motion_between(tour.walk[leg], tour.walk[leg + 1])];
}

double turn_between(double from, double to) {
  return std::remainder(to - from, 2 * EIGEN_PI);
}

void check_end(const Sample& s, const Viewpoint& view, std::size_t leg, const char* which) {
  const double miss = (s.position - view.position).norm();
  const double turned = std::abs(turn_between(s.yaw, view.yaw));
  const double speed = s.velocity.norm();
  if (miss <= kLegPlace && turned <= kLegYaw && speed <= kLegSpeed) return;
  throw InputError("scan_plan: leg " + std::to_string(leg + 1) + " " + which + " " +
                   plain_number(miss, 3) + " m and " + plain_number(degrees(turned), 3) +
                   " degrees away from its view, at " + plain_number(speed, 3) +
                   " m/s; expected a solution from view to view, at rest in both");
}

// The vehicle at rest, as it is at the end of a leg: what it does not hover by is zero.
Sample at_rest(const Vehicle& vehicle, const MotionRecord& motion, Sample s) {
  s.velocity.setZero();
  s.acceleration.setZero();
  s.yaw_rate = 0;
  for (const MotionColumn& column : motion.columns)
    s.columns.set(column.name, std::vector<double>(static_cast<std::size_t>(column.size), 0.0));
  if (motion.column("force"))
    s.columns.set("force", Eigen::Vector3d(0, 0, vehicle.mass * kGravity));
  return s;
}

}  // namespace

double LegFlight::seconds(const Points& way, const Viewpoint& from, const Viewpoint& to) const {
  double most = path_length(way) / flight.speed + view_seconds;
  Points points = way;
  for (const bool back : {false, true}) {
    const Viewpoint &a = back ? to : from, &b = back ? from : to;
    if (back) std::reverse(points.begin(), points.end());
    const double flown = smooth ? smooth_leg_seconds(points, turn_between(a.yaw, b.yaw),
                                                     b.pitch - a.pitch, vehicle, *smooth) +
                                      flight.pause
                                : pursue(points, stops_of(points, a, b, vehicle), vehicle, flight)
                                          .trajectory.duration() -
                                      flight.pause;
    most = std::max(most, flown);
  }
  return most;
}

Value legs_of(const TourObject& tour) {
  Value legs = Value::list();
  for (std::size_t i = 0; i + 1 < tour.walk.size(); ++i) {
    const ViewMotion& motion = leg_motion(tour, i);
    Points way = motion.points;
    if (motion.a != tour.walk[i]) std::reverse(way.begin(), way.end());
    Value points = Value::list();
    for (const Eigen::Vector3d& p : way)
      for (int axis = 0; axis < 3; ++axis) points.push_back(p(axis));
    const double from = stop_of(tour, i).yaw;
    Value leg = Value::map();
    leg.set("points", std::move(points));
    leg.set("yaw_from", from);
    leg.set("yaw_to", from + turn_between(from, stop_of(tour, i + 1).yaw));
    leg.set("seconds",
            tour.work->leg_seconds(tour.walk[i], tour.walk[i + 1]) - tour.work->flight.pause);
    legs.push_back(std::move(leg));
  }
  return legs;
}

Pursuit joined_flight(const TourObject& tour, const std::vector<const SolutionObject*>& solutions) {
  if (solutions.size() + 1 != tour.walk.size())
    throw InputError("scan_plan: expected a solution for each of the tour's " +
                     std::to_string(tour.walk.size() - 1) + " legs, got " +
                     std::to_string(solutions.size()));
  const double pause = tour.work->flight.pause;
  const Vehicle& vehicle = tour.work->vehicle;
  Pursuit flight;
  flight.views.push_back({0, pause, 0});
  auto& samples = flight.trajectory.samples;
  double clock = pause;
  for (std::size_t leg = 0; leg < solutions.size(); ++leg) {
    const SolutionObject& solution = *solutions[leg];
    const Trajectory flown = solution.problem->trajectory(solution.result.point.stages);
    if (flown.motion.column("orientation") || flown.samples.size() < 2)
      throw InputError("scan_plan: leg " + std::to_string(leg + 1) +
                       " is not a solution of a model with a yaw, such as 'quadrotor'");
    check_end(flown.samples.front(), stop_of(tour, leg), leg, "begins");
    check_end(flown.samples.back(), stop_of(tour, leg + 1), leg, "ends");
    if (samples.empty()) {
      flight.trajectory.inputs_held = flown.inputs_held;
      flight.trajectory.motion = flown.motion;
      samples.push_back(at_rest(vehicle, flown.motion, flown.samples.front()));
      samples.back().time = 0;
    }
    const double around =
        2 * EIGEN_PI *
        std::round((samples.back().yaw - flown.samples.front().yaw) / (2 * EIGEN_PI));
    for (Sample s : flown.samples) {
      s.time += clock;
      s.yaw += around;
      samples.push_back(s);
    }
    clock = samples.back().time;
    samples.back() = at_rest(vehicle, flown.motion, samples.back());
    flight.views.push_back(
        {clock, clock + pause, (samples.back().position - stop_of(tour, leg + 1).position).norm()});
    clock += pause;
  }
  if (pause > 0) {
    samples.push_back(samples.back());
    samples.back().time = clock;
  }
  return flight;
}

}  // namespace lapwing
