// SPDX-License-Identifier: Apache-2.0
#include "framework/export/waypoint_flight.h"

#include <algorithm>
#include <cmath>

#include "framework/core/error.h"

namespace lapwing {
namespace {

constexpr double kAcceleration = 3;   // m/s^2
constexpr double kMostSteps = 20000;  // along the way
constexpr double kSlowTurn = 0.1;     // s between samples of a rest
constexpr double kStop = 2.6;         // rad; who turns so far on a line stops
constexpr int kArc = 8;               // chords of a cut corner

double wrapped(double angle) {
  return std::remainder(angle, 2 * M_PI);
}

// A place on the way that is flown.
struct Step {
  Eigen::Vector3d position;
  double cap;           // m/s, the most that may be flown here
  std::size_t towards;  // point that is flown to
};

class Way {
 public:
  Way(const std::vector<FlownPoint>& points, double acceleration)
      : points_(points), acceleration_(acceleration) {
    double length = 0;
    for (std::size_t i = 1; i < points.size(); ++i)
      length += (points[i].position - points[i - 1].position).norm();
    spacing_ = std::max(0.1, length / kMostSteps);
    steps_.push_back({points[0].position, 0, 0});
    reached_.push_back(0);
    for (std::size_t i = 1; i < points.size(); ++i) add_line(i);
  }

  const std::vector<Step>& steps() const { return steps_; }
  // The step at which each point is reached.
  const std::vector<std::size_t>& reached() const { return reached_; }

 private:
  Eigen::Vector3d way(std::size_t i) const { return points_[i].position - points_[i - 1].position; }

  // How far before and behind a point its corner is cut.
  double cut(std::size_t i) const {
    if (i == 0 || i + 1 >= points_.size() || points_[i].hold > 0 || turn(i) > kStop) return 0;
    return std::min({points_[i].radius, way(i).norm() / 2, way(i + 1).norm() / 2});
  }

  // The angle by which the way turns at a point.
  double turn(std::size_t i) const {
    const Eigen::Vector3d in = way(i), out = way(i + 1);
    if (in.norm() < 1e-6 || out.norm() < 1e-6) return 0;
    return std::acos(std::clamp(in.normalized().dot(out.normalized()), -1.0, 1.0));
  }

  double corner_speed(std::size_t i) const {
    const double ordered = std::min(points_[i].speed, points_[i + 1].speed);
    const double bend = std::tan(turn(i) / 2);
    if (bend < 1e-3) return ordered;
    return std::min(ordered, std::sqrt(acceleration_ * cut(i) / bend));
  }

  void add_line(std::size_t i) {
    const Eigen::Vector3d from = steps_.back().position;
    const bool last = i + 1 == points_.size();
    const double off = cut(i);
    const double length = way(i).norm();
    const Eigen::Vector3d to = points_[i].position - (length > 0 ? off / length : 0) * way(i);
    const double left = (to - from).norm();
    const int parts = std::max(1, static_cast<int>(std::ceil(left / spacing_)));
    for (int k = 1; k <= parts; ++k)
      steps_.push_back({from + (to - from) * k / parts, points_[i].speed, i});
    if (last || points_[i].hold > 0) {
      steps_.back().cap = 0;
      reached_.push_back(steps_.size() - 1);
      return;
    }
    const double speed = corner_speed(i);
    steps_.back().cap = std::min(steps_.back().cap, speed);
    if (off <= 0) {
      reached_.push_back(steps_.size() - 1);
      return;
    }
    const Eigen::Vector3d exit = points_[i].position + off / way(i + 1).norm() * way(i + 1);
    for (int k = 1; k <= kArc; ++k) {
      const double s = static_cast<double>(k) / kArc;
      const Eigen::Vector3d place =
          (1 - s) * (1 - s) * to + 2 * s * (1 - s) * points_[i].position + s * s * exit;
      steps_.push_back({place, speed, k <= kArc / 2 ? i : i + 1});
      if (k == kArc / 2) reached_.push_back(steps_.size() - 1);
    }
  }

  const std::vector<FlownPoint>& points_;
  double acceleration_, spacing_ = 0.1;
  std::vector<Step> steps_;
  std::vector<std::size_t> reached_;
};

// The speeds at all steps that caps and acceleration allow.
std::vector<double> speeds_of(const std::vector<Step>& steps, double acceleration) {
  std::vector<double> speeds;
  for (const Step& step : steps) speeds.push_back(step.cap);
  const auto gained = [&](std::size_t i) {
    return 2 * acceleration * (steps[i].position - steps[i - 1].position).norm();
  };
  for (std::size_t i = 1; i < steps.size(); ++i)
    speeds[i] = std::min(speeds[i], std::sqrt(speeds[i - 1] * speeds[i - 1] + gained(i)));
  for (std::size_t i = steps.size(); i-- > 1;)
    speeds[i - 1] = std::min(speeds[i - 1], std::sqrt(speeds[i] * speeds[i] + gained(i)));
  return speeds;
}

// What vehicle and gimbal do over time under the orders.
class Attitude {
 public:
  Attitude(const WaypointFlight& flight, const Vehicle& vehicle)
      : flight_(flight), vehicle_(vehicle) {}

  // Orders of all points up to this one are in force.
  void reach(std::size_t point) {
    while (next_ < flight_.orders.size() && flight_.orders[next_].point <= point)
      order_ = flight_.orders[next_++];
  }

  // After `seconds` on the way to a point; the first call has them already.
  void turn(Sample& sample, std::size_t towards, const Eigen::Vector3d& way, double seconds) {
    const double wish = wished_yaw(sample.position, towards, way);
    const double most = begun_ ? vehicle_.yaw_rate_max * seconds : INFINITY;
    yaw_ += std::clamp(wrapped(wish - yaw_), -most, most);
    sample.yaw = yaw_;
    if (vehicle_.gimbal) turn_gimbal(sample, *vehicle_.gimbal, towards, seconds);
    begun_ = true;
  }

 private:
  // Of the line to a point, how much of it lies behind a place.
  double share(const Eigen::Vector3d& place, std::size_t towards) const {
    if (towards == 0) return 1;
    const Eigen::Vector3d& from = flight_.points[towards - 1].position;
    const Eigen::Vector3d way = flight_.points[towards].position - from;
    const double length = way.squaredNorm();
    return length > 0 ? std::clamp(way.dot(place - from) / length, 0.0, 1.0) : 1;
  }

  double wished_yaw(const Eigen::Vector3d& place, std::size_t towards,
                    const Eigen::Vector3d& way) const {
    if (order_.target) {
      const Eigen::Vector3d to = *order_.target - place;
      if (to.head<2>().norm() > 0.05) return std::atan2(to.y(), to.x());
      return yaw_;
    }
    if (flight_.evenly) {
      const double to = flight_.points[towards].yaw.value_or(0);
      if (towards == 0) return to;
      const double from = flight_.points[towards - 1].yaw.value_or(0);
      return from + share(place, towards) * wrapped(to - from);
    }
    if (flight_.points[towards].yaw) return *flight_.points[towards].yaw;
    return way.head<2>().norm() > 1e-3 ? std::atan2(way.y(), way.x()) : yaw_;
  }

  void turn_gimbal(Sample& sample, const GimbalLimits& limits, std::size_t towards,
                   double seconds) {
    double pitch = order_.pitch.value_or(0), yaw = 0;
    if (flight_.evenly) {
      const double to = flight_.points[towards].pitch;
      const double from = towards > 0 ? flight_.points[towards - 1].pitch : to;
      pitch = from + share(sample.position, towards) * (to - from);
    } else if (order_.target) {
      const Eigen::Vector3d to = *order_.target - sample.position;
      pitch = std::atan2(to.z(), to.head<2>().norm());
      yaw = wrapped(std::atan2(to.y(), to.x()) - yaw_);
    } else if (order_.yaw) {
      yaw = wrapped(order_.yaw_in_world ? *order_.yaw - yaw_ : *order_.yaw);
    }
    const auto seek = [&](double& angle, double wish, double low, double high, double rate) {
      const double most = begun_ ? rate * seconds : INFINITY;
      angle += std::clamp(std::clamp(wish, low, high) - angle, -most, most);
    };
    seek(pitch_, pitch, limits.pitch_min, limits.pitch_max, limits.pitch_rate_max);
    seek(gimbal_yaw_, yaw, limits.yaw_min, limits.yaw_max, limits.yaw_rate_max);
    sample.gimbal_pitch = pitch_;
    sample.gimbal_yaw = gimbal_yaw_;
  }

  const WaypointFlight& flight_;
  const Vehicle& vehicle_;
  CameraOrder order_;
  std::size_t next_ = 0;
  bool begun_ = false;
  double yaw_ = 0, pitch_ = 0, gimbal_yaw_ = 0;
};

// Seconds between two steps; short ones between two stops are sped up and braked.
double seconds_between(double length, double before, double after, double acceleration) {
  const double sum = before + after;
  return sum > 1e-9 ? 2 * length / sum : 2 * std::sqrt(length / acceleration);
}

}  // namespace

FlownFile fly_waypoints(const WaypointFlight& flight, const Vehicle& vehicle, bool has_gimbal) {
  if (flight.points.size() < 2) throw InputError("a flight needs two waypoints at least");
  const double acceleration = vehicle.acceleration_across_max > 0
                                  ? std::min(kAcceleration, vehicle.acceleration_across_max)
                                  : kAcceleration;
  const Way way(flight.points, acceleration);
  const std::vector<Step>& steps = way.steps();
  const std::vector<double> speeds = speeds_of(steps, acceleration);
  FlownFile flown;
  flown.trajectory.motion = path_motion();
  flown.trajectory.has_gimbal = has_gimbal;
  Attitude attitude(flight, vehicle);
  attitude.reach(0);  // it was ordered before the flight began
  double time = 0;
  std::size_t point = 0;
  const auto add = [&](std::size_t i, double seconds) {
    time += seconds;
    Sample sample;
    sample.time = time;
    sample.position = steps[i].position;
    const Eigen::Vector3d along = i > 0 ? Eigen::Vector3d(steps[i].position - steps[i - 1].position)
                                        : Eigen::Vector3d(steps[1].position - steps[0].position);
    attitude.turn(sample, steps[i].towards, along, seconds);
    flown.trajectory.samples.push_back(sample);
  };
  for (std::size_t i = 0; i < steps.size(); ++i) {
    const double length = i == 0 ? 0 : (steps[i].position - steps[i - 1].position).norm();
    if (i == 0 || length > 1e-9)
      add(i, i == 0 ? 0 : seconds_between(length, speeds[i - 1], speeds[i], acceleration));
    for (; point < way.reached().size() && way.reached()[point] == i; ++point) {
      flown.reached.push_back(time);
      const double hold = flight.points[point].hold;
      const int parts = static_cast<int>(std::ceil(hold / kSlowTurn));
      for (int k = 0; k < parts; ++k) add(i, hold / parts);
      attitude.reach(point);  // what is ordered next is done when the time to hold is over
    }
  }
  for (const std::size_t taken : flight.photographs)
    if (taken < flown.reached.size())
      flown.photographs.push_back(flown.reached[taken] + flight.points[taken].hold);
  return flown;
}

}  // namespace lapwing
