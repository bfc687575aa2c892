// SPDX-License-Identifier: Apache-2.0
// The environment in plan.json.
#include "framework/trajectory/plan_sections.h"

namespace lapwing {
namespace {

Value to_value(const Sphere& sphere) {
  Value value = Value::map();
  value.set("name", sphere.name);
  value.set("center", list_of(sphere.center));
  value.set("radius", sphere.radius);
  return value;
}

Value to_value(const Box& box) {
  Value value = Value::map();
  value.set("name", box.name);
  value.set("lower", list_of(box.lower));
  value.set("upper", list_of(box.upper));
  return value;
}

Value to_value(const Zone& zone) {
  Value corners = Value::list(), value = Value::map();
  for (const Eigen::Vector2d& corner : zone.corners) {
    corners.push_back(Value(Value::List{corner.x(), corner.y()}));
  }
  value.set("name", zone.name);
  value.set("corners", std::move(corners));
  // Only these two infinities mean "no bound"; any other is for the writer to refuse.
  if (zone.floor != -std::numeric_limits<double>::infinity()) value.set("floor", zone.floor);
  if (zone.ceiling != std::numeric_limits<double>::infinity()) value.set("ceiling", zone.ceiling);
  return value;
}

template <class Source>
Value file_to_value(const Source& source) {
  Value value = Value::map();
  value.set("name", source.name);
  value.set("file", source.file);
  value.set("sha256", source.sha256);
  return value;
}
Value to_value(const MeshObstacle& mesh) {
  return file_to_value(mesh);
}
Value to_value(const MapObstacle& map) {
  return file_to_value(map);
}

Value to_value(const Subject& subject) {
  Value positions = Value::list(), value = Value::map();
  for (const Eigen::Vector3d& position : subject.positions) positions.push_back(list_of(position));
  value.set("name", subject.name);
  value.set("times", Value(Value::List(subject.times.begin(), subject.times.end())));
  value.set("positions", std::move(positions));
  value.set("height", subject.height);
  value.set("width", subject.width);
  if (subject.distance != 0) value.set("distance", subject.distance);
  if (!subject.filmed) value.set("filmed", false);
  return value;
}

template <class Entry>
Value entries_of(const std::vector<Entry>& entries) {
  Value list = Value::list();
  for (const Entry& entry : entries) list.push_back(to_value(entry));
  return list;
}

Zone zone_from(Fields& fields) {
  Zone zone;
  zone.name = fields.text("name");
  for (const auto& corner : fields.rows("corners", 2)) {
    zone.corners.emplace_back(corner[0], corner[1]);
  }
  zone.floor = fields.optional_number("floor").value_or(zone.floor);
  zone.ceiling = fields.optional_number("ceiling").value_or(zone.ceiling);
  return zone;
}

Subject subject_from(Fields& fields) {
  Subject subject;
  subject.name = fields.text("name");
  subject.times = fields.numbers("times");
  for (const auto& position : fields.rows("positions", 3)) {
    subject.positions.emplace_back(position[0], position[1], position[2]);
  }
  subject.height = fields.number("height");
  subject.width = fields.number("width");
  subject.distance = fields.optional_number("distance").value_or(0.0);
  if (fields.has("filmed")) subject.filmed = fields.boolean("filmed");
  return subject;
}

template <class Read>
auto read_all(std::vector<Fields> entries, Read read) {
  std::vector<decltype(read(entries.front()))> all;
  for (Fields& entry : entries) {
    all.push_back(read(entry));
    entry.finish();
  }
  return all;
}

}  // namespace

Value environment_to_value(const Environment& environment) {
  Value value = Value::map();
  value.set("margin", environment.margin);
  value.set("spheres", entries_of(environment.spheres));
  value.set("boxes", entries_of(environment.boxes));
  if (!environment.zones.empty()) value.set("zones", entries_of(environment.zones));
  if (!environment.flight_zones.empty())
    value.set("flight_zones", entries_of(environment.flight_zones));
  if (!environment.meshes.empty()) value.set("meshes", entries_of(environment.meshes));
  if (!environment.maps.empty()) value.set("maps", entries_of(environment.maps));
  if (!environment.subjects.empty()) value.set("subjects", entries_of(environment.subjects));
  return value;
}

Environment environment_from(Fields fields) {
  Environment environment;
  environment.margin = fields.number("margin");
  environment.spheres = read_all(fields.tables("spheres"), [](Fields& f) {
    return Sphere{f.text("name"), f.vector3("center"), f.number("radius")};
  });
  environment.boxes = read_all(fields.tables("boxes"), [](Fields& f) {
    return Box{f.text("name"), f.vector3("lower"), f.vector3("upper")};
  });
  environment.zones = read_all(fields.optional_tables("zones"), zone_from);
  environment.flight_zones = read_all(fields.optional_tables("flight_zones"), zone_from);
  environment.meshes = read_all(fields.optional_tables("meshes"), [](Fields& f) {
    return MeshObstacle{f.text("name"), f.text("file"), f.text("sha256")};
  });
  environment.maps = read_all(fields.optional_tables("maps"), [](Fields& f) {
    return MapObstacle{f.text("name"), f.text("file"), f.text("sha256")};
  });
  environment.subjects = read_all(fields.optional_tables("subjects"), subject_from);
  fields.finish();
  return environment;
}

}  // namespace lapwing
