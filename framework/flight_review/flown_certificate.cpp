// SPDX-License-Identifier: Apache-2.0
#include "framework/flight_review/flown_certificate.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "framework/geometry/camera_axes.h"
#include "framework/trajectory/interpolate.h"
#include "framework/verify/verify.h"

namespace lapwing {
namespace {

// Checks that say something of a flown path. Others speak of the document, of inputs and of what
// the controller would make of them.
const std::set<std::string>& judged_names() {
  static const std::set<std::string> names{"speed_across",
                                           "climb_speed",
                                           "descent_speed",
                                           "acceleration_across",
                                           "acceleration_up",
                                           "acceleration_down",
                                           "yaw_rate",
                                           "gimbal_yaw",
                                           "gimbal_pitch",
                                           "gimbal_yaw_rate",
                                           "gimbal_pitch_rate",
                                           "clearance",
                                           "flight_zone",
                                           "pilot_distance",
                                           "pilot_sight",
                                           "subject_distance",
                                           "height_above_home",
                                           "distance_from_home",
                                           "height_above_ground",
                                           "flight_time",
                                           "budget",
                                           "keyframe_miss",
                                           "keyframe_yaw",
                                           "framing",
                                           "whole_subject",
                                           "line_of_sight",
                                           "gates",
                                           "drawing",
                                           "coverage",
                                           "jerk"};
  return names;
}

double clamped_time(const Trajectory& trajectory, double time) {
  return std::clamp(time, trajectory.samples.front().time, trajectory.samples.back().time);
}

double angle_of(const Sample& s, const PlannedView& view) {
  const Eigen::Vector3d a = camera_axes(s.yaw + s.gimbal_yaw, s.gimbal_pitch).forward;
  const Eigen::Vector3d b = camera_axes(view.yaw, view.pitch).forward;
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

// Of each planned view within the part that was flown, the nearest image.
void match_views(const Plan& plan, const FlownTrack& flown, FlownCertificate& result,
                 ScanTask& scan) {
  const bool images = !flown.photographs.empty();
  result.views_by_time = !images;
  scan.views.clear();
  std::size_t number = 0;
  for (const PlannedView& view : plan.task.scan->views) {
    ++number;
    if (view.time < flown.start - 1 || view.time > flown.finish + 1) continue;
    double time = view.time;
    if (images)
      time = *std::min_element(
          flown.photographs.begin(), flown.photographs.end(),
          [&](double a, double b) { return std::abs(a - view.time) < std::abs(b - view.time); });
    const Sample s =
        sample_at(flown.trajectory, clamped_time(flown.trajectory, time - flown.start));
    FlownView found{number, time, (s.position - view.position).norm(), angle_of(s, view), false};
    found.taken = found.distance <= scan.tolerance && found.angle <= scan.angle_tolerance;
    result.views.push_back(found);
    PlannedView shown = view;
    shown.time = s.time;
    shown.position = s.position;
    shown.yaw = s.yaw + s.gimbal_yaw;
    shown.pitch = s.gimbal_pitch;
    if (scan.views.empty() || shown.time > scan.views.back().time + 1e-3)
      scan.views.push_back(shown);
  }
}

void clip(std::vector<TimeSpan>& spans, double start, double end) {
  std::vector<TimeSpan> kept;
  for (const TimeSpan& span : spans) {
    const TimeSpan moved{std::max(0.0, span.start - start), std::min(end, span.finish - start)};
    if (moved.finish > moved.start + 1e-3) kept.push_back(moved);
  }
  spans = std::move(kept);
}

// The plan with the flight in its place. Times count from the part that is compared.
Plan plan_as_flown(const Plan& plan, const FlownTrack& flown, FlownCertificate& result) {
  Plan made = plan;
  made.certificate = Value();
  made.constraints.clear();
  made.trajectory = flown.trajectory;
  const double start = flown.start, end = flown.trajectory.samples.back().time;
  for (Obstacle& obstacle : made.environment.obstacles)
    for (double& time : obstacle.times) time -= start;
  for (Subject& subject : made.environment.subjects)
    for (double& time : subject.times) time -= start;
  clip(made.cuts, start, end);
  clip(made.lights, start, end);
  made.task.closed_loop_required = false;
  std::vector<FramingTask> framing;
  for (const FramingTask& task : plan.task.framing) {
    std::vector<TimeSpan> span{task.span};
    clip(span, start, end);
    if (!span.empty()) framing.push_back({task.subject, span[0]});
  }
  made.task.framing = flown.trajectory.has_gimbal ? framing : std::vector<FramingTask>();
  std::erase_if(made.task.keyframes, [&](KeyframeTask& keyframe) {
    keyframe.time -= start;
    return keyframe.time < -1e-6 || keyframe.time > end + 1e-6;
  });
  if (made.task.scan) match_views(plan, flown, result, *made.task.scan);
  if (made.task.scan && made.task.scan->views.empty()) made.task.scan.reset();
  return made;
}

std::optional<Certificate> certificate_of(const Plan& plan) {
  if (!plan.certificate.is_map()) return std::nullopt;
  return Certificate::from_value(plan.certificate);
}

}  // namespace

std::vector<FlownCheck> FlownCertificate::broken() const {
  std::vector<FlownCheck> found;
  for (const bool new_ones : {true, false})
    for (const FlownCheck& check : checks)
      if (!check.flown.pass && check.flown.required && check.planned_pass == new_ones)
        found.push_back(check);
  return found;
}

const FlownCheck* FlownCertificate::find(std::string_view name) const {
  for (const FlownCheck& check : checks)
    if (check.flown.name == name) return &check;
  return nullptr;
}

FlownCertificate judge_flown(const Plan& plan, const FlownTrack& flown,
                             const std::filesystem::path& folder) {
  FlownCertificate result;
  const Plan made = plan_as_flown(plan, flown, result);
  const std::optional<Certificate> planned = certificate_of(plan);
  const Certificate certificate = verify(made, {.folder = folder});
  const Check* document = certificate.find("document");
  if (document && !document->pass) {
    result.not_judged.push_back("the limits could not be judged: " + document->detail);
    return result;
  }
  for (const Check& check : certificate.checks) {
    if (!judged_names().count(check.name) || !check.skipped.empty()) continue;
    FlownCheck one{check, std::nullopt, true};
    one.flown.at += flown.start;
    const Check* before = planned ? planned->find(check.name) : nullptr;
    if (before && before->skipped.empty()) {
      one.planned = before->worst;
      one.planned_pass = before->pass;
    }
    result.checks.push_back(std::move(one));
  }
  if (!plan.constraints.empty())
    result.not_judged.emplace_back("constraints of the script are not judged");
  if (!flown.yaw_known)
    result.not_judged.emplace_back(
        "the log holds no yaw: what depends on it is judged with the "
        "planned one");
  if (plan.trajectory.has_gimbal && !flown.camera_known)
    result.not_judged.emplace_back(
        "the log holds no direction of the camera: framing and images "
        "are judged with the planned one");
  return result;
}

}  // namespace lapwing
