// SPDX-License-Identifier: Apache-2.0
#include "framework/export/flown_comparison.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "framework/core/number_text.h"
#include "framework/core/units.h"
#include "framework/export/plan_progress.h"
#include "framework/geometry/camera_axes.h"
#include "framework/trajectory/interpolate.h"
#include "framework/vehicle/vehicle.h"
#include "framework/verify/tolerances.h"
#include "framework/verify/verify.h"

namespace lapwing {
namespace {

Eigen::Vector3d axis_of(const Sample& s) {
  return camera_axes(s.yaw + s.gimbal_yaw, s.gimbal_pitch).forward;
}

double angle_between(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return std::acos(std::clamp(a.dot(b), -1.0, 1.0));
}

void compare_samples(const Plan& plan, const FlownFile& flown, const PlanProgress& progress,
                     FlownComparison& result) {
  const auto& samples = flown.trajectory.samples;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const double time = progress.times()[i];
    const Sample wanted = sample_at(plan.trajectory, time);
    const double across = progress.across(i);
    if (across > result.across) result.across = across, result.across_time = time;
    const double late = samples[i].time - (time - flown.start);
    if (std::abs(late) > std::abs(result.late)) result.late = late, result.late_time = time;
    const double heading = std::abs(std::remainder(samples[i].yaw - wanted.yaw, 2 * M_PI));
    if (heading > result.heading) result.heading = heading, result.heading_time = time;
    if (!flown.trajectory.has_gimbal) continue;
    const double camera = angle_between(axis_of(samples[i]), axis_of(wanted));
    if (camera > result.camera) result.camera = camera, result.camera_time = time;
  }
  result.longer = samples.back().time - (flown.finish - flown.start);
}

// Whether images of a scan can be compared: some files do not hold the camera.
bool films(const Plan& plan, const FlownFile& flown) {
  return plan.task.scan && flown.trajectory.has_gimbal == plan.trajectory.has_gimbal;
}

// Views of the part of the file, with the images nearest to them in order.
void compare_images(const Plan& plan, const FlownFile& flown, FlownComparison& result) {
  std::size_t wanted = 0;
  for (const PlannedView& view : plan.task.scan->views)
    if (view.time >= flown.start - 1e-6 && view.time <= flown.finish + 1e-6) {
      const std::size_t number = wanted++;
      if (number >= flown.photographs.size()) continue;
      const Sample s = sample_at(flown.trajectory, flown.photographs[number]);
      result.image_distance = std::max(result.image_distance, (s.position - view.position).norm());
      result.image_angle = std::max(
          result.image_angle, angle_between(axis_of(s), camera_axes(view.yaw, view.pitch).forward));
    }
  result.images_missed = wanted - std::min(wanted, flown.photographs.size());
}

// The plan with the flight in the place of its own. Its time begins with the part that the file is
// of, so the times of what moves count from there. What was asked for at times, at their times.
Plan plan_as_flown(const Plan& plan, const FlownFile& flown, const PlanProgress& progress) {
  Plan made;
  made.mission = plan.mission;
  made.kind = plan.kind;
  made.geodetic_origin = plan.geodetic_origin;
  made.home = plan.home;
  made.vehicle = plan.vehicle;
  made.environment = plan.environment;
  made.trajectory = flown.trajectory;
  for (Obstacle& obstacle : made.environment.obstacles)
    for (double& time : obstacle.times) time -= flown.start;
  for (Subject& subject : made.environment.subjects)
    for (double& time : subject.times) time -= flown.start;
  made.task.framing_share = plan.task.framing_share;
  made.task.line_of_sight_required = plan.task.line_of_sight_required;
  made.task.closed_loop_required = false;
  const auto& samples = plan.trajectory.samples;
  if (flown.start <= samples.front().time && flown.finish >= samples.back().time)
    made.task.gates = plan.task.gates;
  const double end = flown.trajectory.samples.back().time;
  if (flown.trajectory.has_gimbal)
    for (const FramingTask& task : plan.task.framing) {
      TimeSpan span{std::min(end, progress.flown_time(task.span.start)),
                    std::min(end, progress.flown_time(task.span.finish))};
      if (span.finish > span.start + 1e-3) made.task.framing.push_back({task.subject, span});
    }
  return made;
}

std::set<std::string> failed_checks(const Value& certificate) {
  std::set<std::string> names;
  if (!certificate.is_map()) return names;
  for (const Check& check : Certificate::from_value(certificate).failures())
    names.insert(check.name);
  return names;
}

// Limits of paths that the plan itself passes: its motion does not have them. A race turns its
// heading as fast as its body may roll.
std::set<std::string> passed_limits(const Plan& plan) {
  const Vehicle vehicle = vehicle_from_value(plan.vehicle);
  std::set<std::string> names;
  for (const Sample& s : plan.trajectory.samples) {
    const auto judge = [&](const char* name, double rate, double limit) {
      if (rate > limit * (1 + tolerances::kLimitShare)) names.insert(name);
    };
    judge("speed_across", s.velocity.head<2>().norm(), vehicle.speed_across_max);
    judge("climb_speed", s.velocity.z(), vehicle.climb_speed_max);
    judge("descent_speed", -s.velocity.z(), vehicle.descent_speed_max);
    judge("yaw_rate", std::abs(s.yaw_rate), vehicle.yaw_rate_max);
  }
  return names;
}

void judge_flight(const Plan& plan, const Plan& flown, const std::filesystem::path& folder,
                  FlownComparison& result) {
  const Certificate certificate = verify(flown, {.folder = folder});
  std::set<std::string> known = failed_checks(plan.certificate);
  known.merge(passed_limits(plan));
  for (const Check& check : certificate.checks) {
    if (!check.required || !check.skipped.empty() || check.pass || known.count(check.name)) {
      const bool told = check.name == "clearance" || check.name == "subject_distance" ||
                        check.name == "flight_zone" || check.name == "framing" ||
                        check.name == "height_above_home" || check.name == "distance_from_home" ||
                        check.name == "pilot_distance" || check.name == "pilot_sight";
      if (told && check.skipped.empty()) result.sentences.push_back("flown so: " + to_line(check));
      continue;
    }
    (check.group == CheckGroup::safety ? result.refusals : result.sentences)
        .push_back("flown so: " + to_line(check));
  }
}

// m, s and degrees of a comparison mean nothing below a thousandth.
std::string thousandths(double value) {
  return plain_number(std::round(value * 1e3) / 1e3 + 0.0, 3);
}

std::string at_time(double time) {
  return " (at " + plain_number(time, 4) + " s)";
}

void say(const Plan& plan, const FlownFile& flown, FlownComparison& r) {
  std::string line = "as a vehicle flies the file, it is at most " + thousandths(r.across) +
                     " m across the path of the plan" + at_time(r.across_time) + " and " +
                     thousandths(std::abs(r.late)) + (r.late < 0 ? " s early" : " s late") +
                     at_time(r.late_time);
  if (flown.trajectory.has_gimbal)
    line += "; its camera is at most " + thousandths(degrees(r.camera)) +
            " deg from that of the plan" + at_time(r.camera_time);
  else
    line += "; its heading is at most " + thousandths(degrees(r.heading)) +
            " deg from that of the plan" + at_time(r.heading_time);
  r.sentences.push_back(line);
  const std::string longer = thousandths(std::abs(r.longer));
  r.sentences.push_back(longer == "0"
                            ? "it takes as long as the plan, without take-off and landing"
                            : "it takes " + longer + " s " + (r.longer < 0 ? "less" : "more") +
                                  " than the plan, without take-off and landing");
  if (!films(plan, flown)) return;
  std::string images = "its images are at most " + thousandths(r.image_distance) + " m and " +
                       thousandths(degrees(r.image_angle)) + " deg from their views";
  if (r.images_missed > 0) images += "; " + std::to_string(r.images_missed) + " are not taken";
  r.sentences.push_back(images);
}

}  // namespace

FlownComparison compare_flown(const Plan& plan, const FlownFile& flown,
                              const std::filesystem::path& folder) {
  FlownComparison result;
  const PlanProgress progress(plan.trajectory, flown.trajectory, flown.start, flown.finish);
  compare_samples(plan, flown, progress, result);
  if (films(plan, flown)) compare_images(plan, flown, result);
  say(plan, flown, result);
  judge_flight(plan, plan_as_flown(plan, flown, progress), folder, result);
  return result;
}

}  // namespace lapwing
