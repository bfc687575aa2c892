// SPDX-License-Identifier: Apache-2.0
#include "framework/flight_review/flown_track.h"

#include <algorithm>
#include <cmath>

#include "framework/core/error.h"
#include "framework/flight_review/smooth_path.h"
#include "framework/trajectory/interpolate.h"

namespace lapwing {
namespace {

using Eigen::Vector3d;

constexpr double kLongestGap = 1;      // s, between samples of angles
constexpr double kShortestStep = 0.1;  // s, between knots
constexpr double kLongestStep = 0.5;
constexpr double kSlack = 1e-3;  // s, that a pose may lie outside of the plan

const MotionRecord& velocity_motion() {
  static const MotionRecord motion{"velocity", {{"jerk", "m/s^3", 3, true}}, true, Tracking::none};
  return motion;
}

// Turns an angle by whole turns, so that it is near another.
double near_to(double angle, double other) {
  return other + std::remainder(angle - other, 2 * M_PI);
}

std::optional<double> yaw_at(const FlightLog& log, const FlightAlignment& alignment, double time) {
  const auto yaw = value_at(log, "yaw", time, kLongestGap);
  return yaw ? std::optional((*yaw)[0] + alignment.turn) : std::nullopt;
}

std::optional<Eigen::Vector2d> camera_at(const FlightLog& log, const FlightAlignment& alignment,
                                         double time) {
  const auto camera = value_at(log, "camera", time, kLongestGap);
  if (!camera) return std::nullopt;
  return Eigen::Vector2d((*camera)[0] + alignment.turn, (*camera)[1]);
}

std::vector<FlownPose> poses_of(const FlightLog& log, const FlownSeries& series,
                                const FlightAlignment& alignment, double start, double finish) {
  std::vector<FlownPose> poses;
  for (std::size_t i = 0; i < series.times.size(); ++i) {
    const double time = alignment.plan_time(series.times[i]);
    if (time < start - kSlack || time > finish + kSlack) continue;
    poses.push_back({time, alignment.corrected(series.positions[i]),
                     yaw_at(log, alignment, series.times[i]),
                     camera_at(log, alignment, series.times[i])});
  }
  return poses;
}

// The typical time between two poses, and the longest.
double typical_step(const std::vector<FlownPose>& poses, double& longest) {
  std::vector<double> steps;
  for (std::size_t i = 1; i < poses.size(); ++i) steps.push_back(poses[i].time - poses[i - 1].time);
  longest = *std::max_element(steps.begin(), steps.end());
  const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
  std::nth_element(steps.begin(), middle, steps.end());
  return *middle;
}

CurveSamples samples_of(const std::vector<FlownPose>& poses, const FlightLog& log,
                        const FlightAlignment& alignment) {
  CurveSamples samples;
  samples.values.resize(static_cast<Eigen::Index>(poses.size()), 3);
  for (std::size_t i = 0; i < poses.size(); ++i) {
    samples.times.push_back(poses[i].time);
    samples.values.row(static_cast<Eigen::Index>(i)) = poses[i].position.transpose();
  }
  const LogSeries* velocity = log.find("velocity");
  if (!velocity) return samples;
  FlightAlignment turn_alone;
  turn_alone.turn = alignment.turn;
  samples.rates.resize(static_cast<Eigen::Index>(velocity->size()), 3);
  for (std::size_t i = 0; i < velocity->size(); ++i) {
    samples.rate_times.push_back(alignment.plan_time(velocity->times[i]));
    const double* v = &velocity->values[3 * i];
    samples.rates.row(static_cast<Eigen::Index>(i)) =
        turn_alone.corrected({v[0], v[1], v[2]}).transpose();
  }
  return samples;
}

// The plan's state, at rest before and after it.
Sample planned_at(const Plan& plan, double time) {
  const auto& samples = plan.trajectory.samples;
  return sample_at(plan.trajectory, std::clamp(time, samples.front().time, samples.back().time));
}

// Fills in yaw and gimbal of all samples: as logged, else as planned.
void turn_samples(const Plan& plan, const FlightLog& log, const FlightAlignment& alignment,
                  FlownTrack& path) {
  auto& samples = path.trajectory.samples;
  for (Sample& s : samples) {
    const double planned_time = s.time + path.start, log_time = planned_time + alignment.clock;
    const Sample planned = planned_at(plan, planned_time);
    const double before = &s == &samples.front() ? planned.yaw : (&s - 1)->yaw;
    const auto yaw = yaw_at(log, alignment, log_time);
    s.yaw = near_to(yaw.value_or(planned.yaw), before);
    if (!plan.trajectory.has_gimbal) continue;
    // A gimbal holds its direction in the world.
    const auto camera =
        camera_at(log, alignment, log_time)
            .value_or(Eigen::Vector2d(planned.yaw + planned.gimbal_yaw, planned.gimbal_pitch));
    const double gimbal = &s == &samples.front() ? planned.gimbal_yaw : (&s - 1)->gimbal_yaw;
    s.gimbal_yaw = near_to(camera.x() - s.yaw, gimbal);
    s.gimbal_pitch = camera.y();
  }
  for (std::size_t i = 0; i < samples.size(); ++i) {
    Sample& s = samples[i];
    if (i + 1 == samples.size()) {
      if (i > 0) s.yaw_rate = samples[i - 1].yaw_rate;
      continue;
    }
    const Sample& next = samples[i + 1];
    const double h = next.time - s.time;
    s.yaw_rate = (next.yaw - s.yaw) / h;
    s.gimbal_yaw_rate = (next.gimbal_yaw - s.gimbal_yaw) / h;
    s.gimbal_pitch_rate = (next.gimbal_pitch - s.gimbal_pitch) / h;
  }
}

}  // namespace

FlownTrack flown_track(const Plan& plan, const FlightLog& log, const FlownSeries& series,
                       const FlightAlignment& alignment) {
  FlownTrack path;
  path.start = std::max(plan.trajectory.samples.front().time, alignment.plan_time(series.start()));
  path.finish = std::min(alignment.end, alignment.plan_time(series.finish()));
  path.poses = poses_of(log, series, alignment, path.start, path.finish);
  if (path.poses.size() < 4 || !(path.finish > path.start))
    throw InputError("only " + std::to_string(path.poses.size()) +
                     " positions of the log lie within the plan: too few to compare");
  path.start = std::max(path.start, path.poses.front().time);
  path.finish = std::min(path.finish, path.poses.back().time);
  for (const FlownPose& pose : path.poses) {
    path.yaw_known = path.yaw_known || pose.yaw.has_value();
    path.camera_known = path.camera_known || pose.camera.has_value();
  }
  const double typical = typical_step(path.poses, path.longest_gap);
  const SmoothCurve curve(samples_of(path.poses, log, alignment), path.start, path.finish,
                          std::clamp(2 * typical, kShortestStep, kLongestStep));
  path.smoothing = curve.residual();
  path.trajectory.motion = velocity_motion();
  path.trajectory.has_gimbal = plan.trajectory.has_gimbal;
  for (std::size_t k = 0; k <= curve.intervals(); ++k) {
    Sample s;
    s.time = k == 0 ? 0 : curve.time(k) - path.start;
    s.position = curve.at(curve.time(k));
    s.velocity = curve.at(curve.time(k), 1);
    s.acceleration = curve.at(curve.time(k), 2);
    const double inside = curve.time(std::min(k, curve.intervals() - 1)) + 0.5 * curve.step();
    s.columns.set("jerk", Vector3d(curve.at(inside, 3)));
    path.trajectory.samples.push_back(s);
  }
  turn_samples(plan, log, alignment, path);
  for (const double time : log.photographs)
    if (const double at = alignment.plan_time(time); at >= path.start && at <= path.finish)
      path.photographs.push_back(at);
  return path;
}

}  // namespace lapwing
