// SPDX-License-Identifier: Apache-2.0
#include "framework/export/mission_fences.h"

#include <algorithm>

#include "framework/export/map_features.h"

namespace lapwing {
namespace {

bool inside(const std::vector<Eigen::Vector2d>& corners, const Eigen::Vector2d& p) {
  bool in = false;
  for (std::size_t i = 0, j = corners.size() - 1; i < corners.size(); j = i++) {
    const Eigen::Vector2d &a = corners[i], &b = corners[j];
    if ((a.y() > p.y()) != (b.y() > p.y()) &&
        p.x() < (b.x() - a.x()) * (p.y() - a.y()) / (b.y() - a.y()) + a.x())
      in = !in;
  }
  return in;
}

bool holds(const MissionFence& fence, const Eigen::Vector2d& p) {
  return fence.corners.empty() ? (p - fence.center).norm() < fence.radius
                               : inside(fence.corners, p);
}

// Of a ball or an upright cylinder that stands still.
bool add_circle(const Obstacle& obstacle, std::size_t number, std::vector<MissionFence>& fences) {
  const bool ball = obstacle.type == "sphere";
  if ((!ball && obstacle.type != "cylinder") || !obstacle.still()) return false;
  const auto place = recorded_numbers(obstacle.parameters, ball ? "center" : "base");
  const Value* radius = obstacle.parameters.find("radius");
  if (place.size() != 3 || !radius || !radius->is_number()) return false;
  MissionFence fence;
  fence.name = obstacle.label(number);
  fence.inclusion = obstacle.side == Side::keep_inside;
  fence.center = {place[0], place[1]};
  fence.radius = radius->as_number();
  fences.push_back(fence);
  return true;
}

}  // namespace

std::vector<MissionFence> mission_fences(const Plan& plan, std::vector<std::string>& said) {
  std::vector<MissionFence> all, kept;
  for (const MapZone& zone : map_zones(plan)) {
    MissionFence fence;
    fence.name = zone.name;
    fence.inclusion = zone.keep_inside;
    fence.corners.assign(zone.corners.rbegin(), zone.corners.rend());
    all.push_back(fence);
  }
  for (std::size_t i = 0; i < plan.environment.obstacles.size(); ++i)
    add_circle(plan.environment.obstacles[i], i, all);
  std::string passed, on_ground;
  const auto add = [](std::string& list, const std::string& name) {
    list += (list.empty() ? "" : ", ") + name;
  };
  for (const MissionFence& fence : all) {
    const auto breached = [&](const Eigen::Vector3d& p) {
      return holds(fence, p.head<2>()) != fence.inclusion;
    };
    const auto& samples = plan.trajectory.samples;
    const bool home = plan.home && (breached(plan.home->position) ||
                                    std::any_of(plan.home->rally_points.begin(),
                                                plan.home->rally_points.end(), breached));
    if (std::any_of(samples.begin(), samples.end(),
                    [&](const Sample& s) { return breached(s.position); }))
      add(passed, fence.name);
    else if (home)
      add(on_ground, fence.name);
    else
      kept.push_back(fence);
  }
  if (!passed.empty())
    said.push_back("no fence is made of what the flight passes above or below: " + passed);
  if (!on_ground.empty())
    said.push_back("no fence is made of what home or a rally point would break: " + on_ground);
  return kept;
}

}  // namespace lapwing
