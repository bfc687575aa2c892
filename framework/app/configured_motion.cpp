// SPDX-License-Identifier: Apache-2.0
// How a plan's vehicle moves, and how its obstacles do, against its configuration.
#include <Eigen/Core>

#include "framework/app/configured_task.h"
#include "framework/app/stated_values.h"
#include "framework/core/number_text.h"

namespace lapwing {
namespace {

// The motions of the vehicle models that are shipped.
struct ModelMotion {
  const char* model;
  const char* motion;
};
constexpr ModelMotion kMotions[] = {{"quadrotor", "force"},
                                    {"gimbal", "force"},
                                    {"quadrotor_full", "rotors"},
                                    {"velocity", "velocity"},
                                    {"fixed_wing", "coordinated_turn"}};

// A plugin is stated by its name, or by a table with its name as `type`.
std::string stated_plugin(const Value& table, const char* key) {
  const Value* value = table.find(key);
  if (!value) return "";
  return value->is_map() ? stated_text(*value, "type") : stated_text(table, key);
}

}  // namespace

void compare_motion(const Plan& plan, ConfigurationComparison& found) {
  const std::string model = stated_plugin(plan.configuration, "model");
  if (model.empty()) return;
  for (const ModelMotion& one : kMotions) {
    if (one.model != model) continue;
    if (plan.trajectory.motion.name != one.motion)
      found.faults.push_back("the motion is '" + plan.trajectory.motion.name +
                             "' in the plan, and the model of its configuration, '" + model +
                             "', has the motion '" + one.motion + "'");
    return;
  }
  found.not_compared.push_back("the motion: the model '" + model + "' is not one of Lapwing's own");
}

void compare_ground(const Plan& plan, ConfigurationComparison& found) {
  const auto asked = stated_number(plan.configuration, "ground");
  if (!asked) return;
  for (const Obstacle& obstacle : plan.environment.obstacles) {
    if (obstacle.type != "half_space" || obstacle.side != Side::keep_out || !obstacle.still())
      continue;
    const auto point = recorded_numbers(obstacle.parameters, "point"),
               normal = recorded_numbers(obstacle.parameters, "normal");
    if (point.size() == 3 && same_vector(normal, Eigen::Vector3d(0, 0, 1)) &&
        (point[2] > *asked || same_number(point[2], *asked)))
      return;
  }
  found.faults.push_back("the ground of its configuration, at " + plain_number(*asked) +
                         " m, is not in the plan");
}

bool same_track(const Value& stated, const Obstacle& obstacle) {
  const Value::List& points = stated_tables(stated, "track");
  if (points.size() != obstacle.times.size() || points.size() != obstacle.moves.size())
    return false;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto time = stated_number(points[i], "time");
    const auto move = stated_numbers(points[i], "move");
    if (!time || !move || !same_number(*time, obstacle.times[i]) ||
        !same_vector(*move, obstacle.moves[i]))
      return false;
  }
  return true;
}

}  // namespace lapwing
