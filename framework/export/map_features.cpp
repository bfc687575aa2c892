// SPDX-License-Identifier: Apache-2.0
#include "framework/export/map_features.h"

#include <algorithm>

#include "framework/export/camera_track.h"

namespace lapwing {
namespace {

std::string numbered(const std::string& name, const std::string& kind, std::size_t number) {
  return name.empty() ? kind + " " + std::to_string(number) : name;
}

std::optional<double> recorded_number(const Value& parameters, const char* key) {
  const Value* value = parameters.find(key);
  if (!value || !value->is_number()) return std::nullopt;
  return value->as_number();
}

double twice_area(const std::vector<Eigen::Vector2d>& corners) {
  double sum = 0;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Eigen::Vector2d& a = corners[i];
    const Eigen::Vector2d& b = corners[(i + 1) % corners.size()];
    sum += a.x() * b.y() - a.y() * b.x();
  }
  return sum;
}

}  // namespace

std::vector<MapPoint> map_points(const Plan& plan) {
  std::vector<MapPoint> points;
  for (std::size_t i = 0; i < plan.task.keyframes.size(); ++i) {
    const KeyframeTask& k = plan.task.keyframes[i];
    points.push_back({"keyframe", numbered("", "keyframe", i + 1), k.position, k.time, {}, {}});
  }
  for (std::size_t i = 0; i < plan.task.gates.size(); ++i) {
    const GateTask& gate = plan.task.gates[i];
    points.push_back({"gate", numbered(gate.name, "gate", i + 1), gate.position, {}, {}, {}});
  }
  if (plan.task.scan)
    for (std::size_t i = 0; i < plan.task.scan->views.size(); ++i) {
      const PlannedView& view = plan.task.scan->views[i];
      points.push_back(
          {"view", numbered("", "view", i + 1), view.position, view.time, view.yaw, view.pitch});
    }
  for (std::size_t i = 0; i < plan.environment.subjects.size(); ++i) {
    const Subject& subject = plan.environment.subjects[i];
    points.push_back({"subject",
                      numbered(subject.name, "subject", i + 1),
                      subject.positions.front(),
                      {},
                      {},
                      {}});
  }
  if (!plan.home) return points;
  points.push_back({"home", "home", plan.home->position, {}, {}, {}});
  for (std::size_t i = 0; i < plan.home->rally_points.size(); ++i)
    points.push_back({"rally_point",
                      numbered("", "rally point", i + 1),
                      plan.home->rally_points[i],
                      {},
                      {},
                      {}});
  return points;
}

std::vector<MapZone> map_zones(const Plan& plan) {
  std::vector<MapZone> zones;
  for (std::size_t i = 0; i < plan.environment.obstacles.size(); ++i) {
    const Obstacle& obstacle = plan.environment.obstacles[i];
    if (obstacle.type != "prism" || !obstacle.still()) continue;
    const std::vector<double> numbers = recorded_numbers(obstacle.parameters, "corners");
    MapZone zone;
    zone.name = obstacle.label(i);
    zone.keep_inside = obstacle.side == Side::keep_inside;
    for (std::size_t k = 0; k + 1 < numbers.size(); k += 2)
      zone.corners.emplace_back(numbers[k], numbers[k + 1]);
    if (zone.corners.size() < 3) continue;
    if (twice_area(zone.corners) < 0) std::reverse(zone.corners.begin(), zone.corners.end());
    zone.floor = recorded_number(obstacle.parameters, "floor");
    zone.ceiling = recorded_number(obstacle.parameters, "ceiling");
    zones.push_back(std::move(zone));
  }
  return zones;
}

std::string stated_name(const Plan& plan) {
  return plan.mission + (states_certified(plan) ? "" : " (not certified)");
}

}  // namespace lapwing
