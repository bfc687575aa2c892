// SPDX-License-Identifier: Apache-2.0
#include "framework/flight_review/flight_errors.h"

#include <algorithm>
#include <cmath>

#include "framework/export/plan_progress.h"
#include "framework/geometry/camera_axes.h"
#include "framework/trajectory/interpolate.h"
#include "framework/vehicle/monte_carlo.h"

namespace lapwing {
namespace {

using Eigen::Vector3d;

constexpr double kHovers = 0.05;  // m/s, below which a plan has no direction

Sample planned_at_pose(const Plan& plan, double time) {
  const auto& samples = plan.trajectory.samples;
  return sample_at(plan.trajectory, std::clamp(time, samples.front().time, samples.back().time));
}

// The plan's velocity; of a path without one, from its places.
Vector3d velocity_at(const Plan& plan, double time) {
  const double first = plan.trajectory.samples.front().time;
  const double last = plan.trajectory.samples.back().time;
  if (time < first || time > last) return Vector3d::Zero();
  return planned_at_pose(plan, time).velocity;
}

void add_places(const Plan& plan, const FlownTrack& flown, std::vector<ErrorSeries>& errors) {
  ErrorSeries distance{"distance", "between flight and plan at the same time", "m", false, {}, {}};
  ErrorSeries along{"along", "along the path of the plan, ahead positive", "m", true, {}, {}};
  ErrorSeries across{"across", "across the path, to the left positive", "m", true, {}, {}};
  ErrorSeries height{"height", "above the plan", "m", true, {}, {}};
  for (const FlownPose& pose : flown.poses) {
    const Vector3d miss = pose.position - planned_at_pose(plan, pose.time).position;
    const Eigen::Vector2d way = velocity_at(plan, pose.time).head<2>();
    const double speed = way.norm();
    const Eigen::Vector2d flat = miss.head<2>();
    for (ErrorSeries* series : {&distance, &along, &across, &height})
      series->times.push_back(pose.time);
    distance.values.push_back(miss.norm());
    along.values.push_back(speed > kHovers ? flat.dot(way) / speed : 0);
    across.values.push_back(speed > kHovers ? (way.x() * flat.y() - way.y() * flat.x()) / speed
                                            : flat.norm());
    height.values.push_back(miss.z());
  }
  for (ErrorSeries* series : {&distance, &along, &across, &height})
    errors.push_back(std::move(*series));
}

// The time of the plan at which it is nearest to where the flight ends.
double reached_end(const Plan& plan, const FlownTrack& flown) {
  const auto& samples = plan.trajectory.samples;
  const Vector3d end = flown.trajectory.samples.back().position;
  if (flown.finish >= samples.back().time - 1e-6) return samples.back().time;
  double best = flown.finish, least = INFINITY;
  for (double t = std::max(samples.front().time, flown.finish - 10);
       t <= std::min(samples.back().time, flown.finish + 10); t += 0.02) {
    const double miss =
        (sample_at(plan.trajectory, t).position - end).norm() + 1e-3 * std::abs(t - flown.finish);
    if (miss < least) least = miss, best = t;
  }
  return best;
}

void add_progress(const Plan& plan, const FlownTrack& flown, std::vector<ErrorSeries>& errors) {
  const double first = std::max(plan.trajectory.samples.front().time, flown.start);
  const double last = reached_end(plan, flown);
  if (!(last > first)) return;
  ErrorSeries path{"path", "from the place of the plan that the flight has come to", "m", false, {},
                   {}};
  ErrorSeries late{"late", "behind the plan at that place, late positive", "s", true, {}, {}};
  const PlanProgress progress(plan.trajectory, flown.trajectory, first, last);
  const auto& samples = flown.trajectory.samples;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const double time = samples[i].time + flown.start;
    path.times.push_back(time);
    path.values.push_back(progress.across(i));
    // Where the plan hovers, any time is the time of its place.
    if (velocity_at(plan, progress.times()[i]).norm() < 4 * kHovers) continue;
    late.times.push_back(time);
    late.values.push_back(time - progress.times()[i]);
  }
  errors.push_back(std::move(path));
  if (!late.times.empty()) errors.push_back(std::move(late));
}

void add_angles(const Plan& plan, const FlownTrack& flown, std::vector<ErrorSeries>& errors) {
  ErrorSeries yaw{"yaw", "of the vehicle, counter-clockwise positive", "rad", true, {}, {}};
  ErrorSeries camera{"camera", "between the optical axes", "rad", false, {}, {}};
  for (const FlownPose& pose : flown.poses) {
    const Sample planned = planned_at_pose(plan, pose.time);
    if (pose.yaw) {
      yaw.times.push_back(pose.time);
      yaw.values.push_back(std::remainder(*pose.yaw - planned.yaw, 2 * M_PI));
    }
    if (!pose.camera || !plan.trajectory.has_gimbal) continue;
    const Vector3d wanted =
        camera_axes(planned.yaw + planned.gimbal_yaw, planned.gimbal_pitch).forward;
    const Vector3d shown = camera_axes(pose.camera->x(), pose.camera->y()).forward;
    camera.times.push_back(pose.time);
    camera.values.push_back(std::atan2(wanted.cross(shown).norm(), wanted.dot(shown)));
  }
  if (!yaw.times.empty()) errors.push_back(std::move(yaw));
  if (!camera.times.empty()) errors.push_back(std::move(camera));
}

std::vector<double> absolute(const std::vector<double>& values) {
  std::vector<double> result;
  for (const double value : values) result.push_back(std::abs(value));
  return result;
}

}  // namespace

double ErrorSeries::median() const {
  return quantile(0.5);
}

double ErrorSeries::quantile(double share) const {
  return quantile_of(absolute(values), share);
}

double ErrorSeries::mean() const {
  double sum = 0;
  for (const double value : values) sum += value;
  return sum / static_cast<double>(values.size());
}

std::size_t ErrorSeries::worst() const {
  const std::vector<double> sizes = absolute(values);
  return static_cast<std::size_t>(std::max_element(sizes.begin(), sizes.end()) - sizes.begin());
}

std::vector<ErrorSeries> flight_errors(const Plan& plan, const FlownTrack& flown) {
  std::vector<ErrorSeries> errors;
  add_places(plan, flown, errors);
  add_progress(plan, flown, errors);
  add_angles(plan, flown, errors);
  return errors;
}

const ErrorSeries* find_error(const std::vector<ErrorSeries>& errors, std::string_view name) {
  for (const ErrorSeries& series : errors)
    if (series.name == name) return &series;
  return nullptr;
}

}  // namespace lapwing
