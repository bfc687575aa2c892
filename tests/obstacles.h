// SPDX-License-Identifier: Apache-2.0
// Obstacles of tests, as plans record them; `with_shapes` opens those that need no file.
#pragma once

#include "framework/plugin/registry.h"
#include "framework/trajectory/environment.h"
#include "framework/verify/judged_shape.h"

namespace lapwing {

inline Value numbers_value(std::initializer_list<double> numbers) {
  return Value(Value::List(numbers.begin(), numbers.end()));
}
inline Value place_value(const Eigen::Vector3d& p) {
  return numbers_value({p.x(), p.y(), p.z()});
}

inline Obstacle obstacle_at(const std::string& name, const std::string& type,
                            std::vector<std::pair<std::string, Value>> parameters) {
  Obstacle obstacle;
  obstacle.name = name;
  obstacle.type = type;
  for (auto& [key, value] : parameters) obstacle.parameters.set(key, std::move(value));
  return obstacle;
}

inline Obstacle sphere_at(const std::string& name, const Eigen::Vector3d& center, double radius) {
  return obstacle_at(name, "sphere", {{"center", place_value(center)}, {"radius", radius}});
}
inline Obstacle box_at(const std::string& name, const Eigen::Vector3d& lower,
                       const Eigen::Vector3d& upper) {
  return obstacle_at(name, "box", {{"lower", place_value(lower)}, {"upper", place_value(upper)}});
}

inline Value corners_value(const std::vector<Eigen::Vector2d>& corners) {
  Value list = Value::list();
  for (const Eigen::Vector2d& corner : corners) {
    list.push_back(corner.x());
    list.push_back(corner.y());
  }
  return list;
}
inline Obstacle zone_at(const std::string& name, const std::vector<Eigen::Vector2d>& corners,
                        double floor = -std::numeric_limits<double>::infinity(),
                        double ceiling = std::numeric_limits<double>::infinity()) {
  Obstacle zone = obstacle_at(name, "prism", {{"corners", corners_value(corners)}});
  if (floor != -std::numeric_limits<double>::infinity()) zone.parameters.set("floor", floor);
  if (ceiling != std::numeric_limits<double>::infinity()) zone.parameters.set("ceiling", ceiling);
  return zone;
}
inline Obstacle flight_zone_at(const std::string& name, const std::vector<Eigen::Vector2d>& corners,
                               double floor = -std::numeric_limits<double>::infinity(),
                               double ceiling = std::numeric_limits<double>::infinity()) {
  Obstacle zone = zone_at(name, corners, floor, ceiling);
  zone.side = Side::keep_inside;
  return zone;
}

inline Obstacle file_at(const std::string& name, const char* type, const std::string& file,
                        const std::string& sha256) {
  return obstacle_at(name, type, {{"file", file}, {"sha256", sha256}});
}

// The signed distance from a shape that has a closed form: by the verifier's code, which is not
// that of the plugins.
inline double signed_distance(const Obstacle& obstacle, const Eigen::Vector3d& p) {
  return judged_form(obstacle)->distance(p, std::numeric_limits<double>::infinity());
}

// The obstacles of one type and side alone.
inline Environment only(Environment environment, const std::string& type,
                        Side side = Side::keep_out) {
  std::erase_if(environment.obstacles, [&](const Obstacle& obstacle) {
    return obstacle.type != type || obstacle.side != side;
  });
  return environment;
}

inline Environment with_shapes(Environment environment) {
  static const Registry registry({LAPWING_BUILD_DIR "/lib/plugins"});
  for (Obstacle& obstacle : environment.obstacles)
    if (!obstacle.shape)
      obstacle.shape = registry.create<Shape>(obstacle.type, obstacle.parameters);
  return environment;
}

}  // namespace lapwing
