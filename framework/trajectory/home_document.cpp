// SPDX-License-Identifier: Apache-2.0
// The take-off place in plan.json.
#include "framework/trajectory/plan_sections.h"

namespace lapwing {

Value home_to_value(const Home& home) {
  Value value = Value::map();
  value.set("position", list_of(home.position));
  if (home.max_height) value.set("max_height", *home.max_height);
  if (home.max_distance) value.set("max_distance", *home.max_distance);
  if (home.rally_points.empty()) return value;
  Value points = Value::list();
  for (const Eigen::Vector3d& point : home.rally_points) points.push_back(list_of(point));
  value.set("rally_points", std::move(points));
  return value;
}

Home home_from(Fields fields) {
  Home home;
  home.position = fields.vector3("position");
  home.max_height = fields.optional_number("max_height");
  home.max_distance = fields.optional_number("max_distance");
  if (fields.has("rally_points"))
    for (const std::vector<double>& row : fields.rows("rally_points", 3))
      home.rally_points.emplace_back(row[0], row[1], row[2]);
  fields.finish();
  return home;
}

}  // namespace lapwing
