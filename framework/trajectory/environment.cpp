// SPDX-License-Identifier: Apache-2.0
#include "framework/trajectory/environment.h"

#include <algorithm>
#include <map>
#include <string_view>

namespace lapwing {
namespace {

// The value of a track, straight between its times.
Eigen::Vector3d on_track(const std::vector<double>& times,
                         const std::vector<Eigen::Vector3d>& places, double time) {
  const auto next = std::upper_bound(times.begin(), times.end(), time);
  if (next == times.begin()) return places.front();
  if (next == times.end()) return places.back();
  const auto i = static_cast<std::size_t>(next - times.begin());
  const double share = (time - times[i - 1]) / (times[i] - times[i - 1]);
  return places[i - 1] + share * (places[i] - places[i - 1]);
}

// The least distance to obstacles of one side, taken with `sign`.
NearestObstacle least(const Environment& environment, const Eigen::Vector3d& p, double time,
                      Side side, double sign) {
  NearestObstacle nearest;
  std::map<std::string_view, int> count;  // of a type
  for (const Obstacle& obstacle : environment.obstacles) {
    if (obstacle.side != side) continue;
    const int number = ++count[obstacle.type];
    if (!obstacle.shape) continue;
    const double distance = sign * obstacle.shape->distance(p - obstacle.moved(time), nullptr);
    if (!(distance < nearest.distance)) continue;
    nearest.distance = distance;
    nearest.name =
        obstacle.name.empty() ? obstacle.type + " " + std::to_string(number) : obstacle.name;
  }
  return nearest;
}

}  // namespace

Eigen::Vector3d Subject::position(double time) const {
  return on_track(times, positions, time);
}

Eigen::Vector3d Obstacle::moved(double time) const {
  return times.empty() ? Eigen::Vector3d(Eigen::Vector3d::Zero()) : on_track(times, moves, time);
}

double Obstacle::speed() const {
  double speed = 0;
  for (std::size_t k = 1; k < times.size(); ++k)
    speed = std::max(speed, (moves[k] - moves[k - 1]).norm() / (times[k] - times[k - 1]));
  return speed;
}

std::string Obstacle::label(std::size_t number) const {
  const std::string kind = side == Side::keep_inside
                               ? type == "prism" ? "flight zone" : "inside of " + type
                           : type == "prism" ? "zone"
                                             : type;
  return name.empty() ? kind + " " + std::to_string(number) : kind + " '" + name + "'";
}

std::vector<double> recorded_numbers(const Value& parameters, std::string_view key) {
  std::vector<double> numbers;
  const Value* found = parameters.is_map() ? parameters.find(key) : nullptr;
  if (!found || !found->is_list()) return numbers;
  for (const Value& number : found->as_list()) {
    if (!number.is_number()) return {};
    numbers.push_back(number.as_number());
  }
  return numbers;
}

const Obstacle* find_obstacle(const Environment& environment, std::string_view type,
                              std::string_view name) {
  for (const Obstacle& obstacle : environment.obstacles)
    if (obstacle.type == type && obstacle.name == name) return &obstacle;
  return nullptr;
}

NearestObstacle nearest_obstacle(const Environment& environment, const Eigen::Vector3d& p,
                                 double time) {
  return least(environment, p, time, Side::keep_out, 1);
}

NearestObstacle least_inside(const Environment& environment, const Eigen::Vector3d& p,
                             double time) {
  return least(environment, p, time, Side::keep_inside, -1);
}

}  // namespace lapwing
