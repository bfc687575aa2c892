// SPDX-License-Identifier: Apache-2.0
// The images of a scan: whether the flight is where they are taken, and what of the region they
// see in the map that the plan names (seen_voxels.h).
#include <algorithm>

#include "framework/verify/checks.h"
#include "framework/verify/seen_voxels.h"

namespace lapwing {
namespace {

const BlockedVoxels& map_of_scan(const Flight& flight) {
  const auto& obstacles = flight.plan.environment.obstacles;
  for (std::size_t i = 0; i < obstacles.size(); ++i)
    if (obstacles[i].type == "map" && obstacles[i].name == flight.plan.task.scan->map)
      return *flight.shapes[i]->voxels();
  throw Error("a scan without its map passed the checks of the document");
}

// The motion at a time within the flight, straight between integrated points.
MotionPoint motion_at(Motion& motion, double time) {
  std::size_t low = 0, high = motion.intervals();
  while (low + 1 < high) {
    const std::size_t middle = (low + high) / 2;
    (motion.stated(middle).time <= time ? low : high) = middle;
  }
  if (motion.intervals() == 0) return motion.stated(0);
  const auto points = motion.integrate(low);
  for (std::size_t k = 1; k < points.size(); ++k) {
    if (points[k].time < time && k + 1 < points.size()) continue;
    MotionPoint p = points[k - 1];
    const double h = points[k].time - p.time;
    const double share = h > 0 ? std::clamp((time - p.time) / h, 0.0, 1.0) : 0;
    p.position += share * (points[k].position - p.position);
    p.yaw += share * (points[k].yaw - p.yaw);
    p.gimbal_yaw += share * (points[k].gimbal_yaw - p.gimbal_yaw);
    p.gimbal_pitch += share * (points[k].gimbal_pitch - p.gimbal_pitch);
    return p;
  }
  return points.back();
}

}  // namespace

void list_scan_problems(const Plan& plan, std::vector<std::string>& problems) {
  const ScanTask& scan = *plan.task.scan;
  const auto add = [&](const std::string& text) { problems.push_back("the scan " + text); };
  const Eigen::AlignedBox3d& region = scan.region.bounds();
  if (!sound(region.min()) || !sound(region.max()) ||
      !(region.min().array() < region.max().array()).all())
    add("must have a region with its lower corner below its upper one");
  const Pinhole& camera = scan.camera;
  if (camera.width < 1 || camera.height < 1 || !(camera.focal_x > 0) || !(camera.focal_y > 0) ||
      !sound(camera.focal_x) || !sound(camera.focal_y) || !sound(camera.principal_x) ||
      !sound(camera.principal_y))
    add("must have a camera with pixels and focal lengths");
  if (!(scan.range > 0 && scan.range <= tolerances::kLongestRay))
    add("must have rays longer than 0 m and at most 1000 m");
  if (!(scan.tolerance > 0 && sound(scan.tolerance)) ||
      !(scan.angle_tolerance > 0 && sound(scan.angle_tolerance)))
    add("needs tolerances above 0");
  if (!(scan.seen_share > 0 && scan.seen_share <= 1) || scan.seen < 1)
    add("must state the number of seen voxels, and the share that must be seen again");
  if (scan.views.empty()) add("must have a view");
  if (static_cast<double>(camera.width) * camera.height * static_cast<double>(scan.views.size()) >
      tolerances::kMostRays)
    add("has more than 10^9 pixels in all");
  if (!find_obstacle(plan.environment, "map", scan.map))
    add("sees in a map '" + scan.map + "' that the environment does not name");
  const double finish = plan.trajectory.samples.empty() ? 0 : plan.trajectory.samples.back().time;
  for (std::size_t i = 0; i < scan.views.size(); ++i) {
    const PlannedView& view = scan.views[i];
    const std::string name = "'s view " + std::to_string(i + 1);
    if (!sound(view.time) || !sound(view.position) || !sound(view.yaw) || !sound(view.pitch))
      return add(name + " holds a number that is not finite or beyond 1e7");
    if (view.time < 0 || view.time > finish + tolerances::kSpanTime)
      return add(name + " is not within the flight");
    if (i > 0 && !(view.time > scan.views[i - 1].time))
      return add(name + " is not later than the one before it");
  }
}

void check_views(const Flight& flight, Certificate& certificate) {
  const auto& scan = flight.plan.task.scan;
  if (!scan) {
    for (const char* name : {"view_miss", "view_direction"})
      certificate.checks.push_back(skipped_check(name, "the task has no views"));
    return;
  }
  Worst miss("view_miss", scan->tolerance), direction("view_direction", scan->angle_tolerance);
  for (const PlannedView& view : scan->views) {
    const MotionPoint at = motion_at(flight.motion, view.time);
    miss.see((at.position - view.position).norm(), view.time);
    const Eigen::Vector3d flown = ahead_of(at.yaw + at.gimbal_yaw, at.gimbal_pitch);
    const Eigen::Vector3d wanted = ahead_of(view.yaw, view.pitch);
    direction.see(std::atan2(flown.cross(wanted).norm(), flown.dot(wanted)), view.time);
  }
  certificate.checks.push_back(miss.check());
  certificate.checks.push_back(direction.check());
}

void check_coverage(const Flight& flight, Certificate& certificate) {
  const auto& scan = flight.plan.task.scan;
  if (!scan) {
    certificate.checks.push_back(skipped_check("coverage", "the task has no region to cover"));
    return;
  }
  const std::int64_t count = count_seen(map_of_scan(flight), *scan, scan->views,
                                        [&](double share) { flight.watch.done(share); });
  Check check =
      judged(make_check("coverage"), static_cast<double>(count) / static_cast<double>(scan->seen),
             scan->seen_share, 0, scan->views.back().time, true);
  const std::string said =
      std::to_string(count) + " of the " + std::to_string(scan->seen) +
      " voxels that the plan states as seen by its views (not a share of the region)";
  check.detail = check.detail.empty() ? said : check.detail + "; " + said;
  certificate.checks.push_back(check);
}

}  // namespace lapwing
