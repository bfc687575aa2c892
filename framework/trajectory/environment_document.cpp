// SPDX-License-Identifier: Apache-2.0
// The environment in plan.json.
#include <array>
#include <cmath>

#include "framework/trajectory/plan_digest.h"
#include "framework/trajectory/plan_sections.h"

namespace lapwing {
namespace {

const std::vector<std::string> kSides{"keep_out", "keep_inside"};

Value rows_of(const std::vector<Eigen::Vector3d>& places) {
  Value rows = Value::list();
  for (const Eigen::Vector3d& place : places) rows.push_back(list_of(place));
  return rows;
}

Value numbers_of(const std::vector<double>& numbers) {
  return Value(Value::List(numbers.begin(), numbers.end()));
}

Value to_value(const TriangleMesh& mesh, double tolerance) {
  Value value = Value::map(), triangles = Value::list();
  for (const auto& t : mesh.triangles) triangles.push_back(Value(Value::List{t[0], t[1], t[2]}));
  value.set("tolerance", tolerance);
  value.set("vertices", rows_of(mesh.vertices));
  value.set("triangles", std::move(triangles));
  return value;
}

Value to_value(const Obstacle& obstacle) {
  Value value = Value::map();
  value.set("name", obstacle.name);
  value.set("type", obstacle.type);
  value.set("parameters", obstacle.parameters);
  if (obstacle.side == Side::keep_inside) value.set("side", kSides[1]);
  if (!obstacle.opaque) value.set("opaque", false);
  if (!obstacle.times.empty()) {
    Value& track = value.set("track", Value::map());
    track.set("times", numbers_of(obstacle.times));
    track.set("moves", rows_of(obstacle.moves));
  }
  if (obstacle.triangles) value.set("triangles", to_value(*obstacle.triangles, obstacle.tolerance));
  value.set(kRecordChecksum, canonical_sha256(value));
  return value;
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

std::vector<Eigen::Vector3d> places_from(Fields& fields, std::string_view name) {
  std::vector<Eigen::Vector3d> places;
  for (const auto& row : fields.rows(name, 3)) places.emplace_back(row[0], row[1], row[2]);
  return places;
}

std::shared_ptr<const TriangleMesh> triangles_from(Fields fields, double& tolerance) {
  constexpr double kMost = 1e8;
  auto mesh = std::make_shared<TriangleMesh>();
  tolerance = fields.number("tolerance");
  mesh->vertices = places_from(fields, "vertices");
  for (const auto& row : fields.rows("triangles", 3)) {
    std::array<std::int32_t, 3> corners{};
    for (std::size_t k = 0; k < 3; ++k) {
      if (!(row[k] >= 0 && row[k] < kMost) || row[k] != std::floor(row[k]))
        fields.add_error("triangles", "expected places of vertices, from 0");
      else
        corners[k] = static_cast<std::int32_t>(row[k]);
    }
    mesh->triangles.push_back(corners);
  }
  fields.finish();
  return mesh;
}

Obstacle obstacle_from(Fields& fields) {
  Obstacle obstacle;
  obstacle.name = fields.text("name");
  obstacle.type = fields.text("type");
  fields.table("parameters");  // opaque here, but it must be there and be a map
  obstacle.parameters = fields.opaque("parameters");
  if (fields.has("side")) obstacle.side = static_cast<Side>(fields.choice("side", kSides));
  if (fields.has("opaque")) obstacle.opaque = fields.boolean("opaque");
  if (fields.has("track")) {
    Fields track = fields.table("track");
    obstacle.times = track.numbers("times");
    obstacle.moves = places_from(track, "moves");
    track.finish();
  }
  if (fields.has("triangles"))
    obstacle.triangles = triangles_from(fields.table("triangles"), obstacle.tolerance);
  fields.text(kRecordChecksum);  // of what was written; see plan_digest.h
  return obstacle;
}

// Format 1 had a list for each kind of obstacle.
Obstacle plain(std::string name, const char* type) {
  Obstacle obstacle;
  obstacle.name = std::move(name);
  obstacle.type = type;
  return obstacle;
}

Obstacle sphere_from(Fields& fields) {
  Obstacle sphere = plain(fields.text("name"), "sphere");
  sphere.parameters.set("center", list_of(fields.vector3("center")));
  sphere.parameters.set("radius", fields.number("radius"));
  return sphere;
}

Obstacle box_from(Fields& fields) {
  Obstacle box = plain(fields.text("name"), "box");
  box.parameters.set("lower", list_of(fields.vector3("lower")));
  box.parameters.set("upper", list_of(fields.vector3("upper")));
  return box;
}

Obstacle zone_from(Fields& fields) {
  Obstacle zone = plain(fields.text("name"), "prism");
  Value corners = Value::list();
  for (const auto& corner : fields.rows("corners", 2))
    for (const double number : corner) corners.push_back(number);
  zone.parameters.set("corners", std::move(corners));
  for (const char* end : {"floor", "ceiling"})
    if (const auto height = fields.optional_number(end)) zone.parameters.set(end, *height);
  return zone;
}

Obstacle flight_zone_from(Fields& fields) {
  Obstacle zone = zone_from(fields);
  zone.side = Side::keep_inside;
  return zone;
}

Obstacle file_from(Fields& fields, const char* type) {
  Obstacle obstacle = plain(fields.text("name"), type);
  obstacle.parameters.set("file", fields.text("file"));
  obstacle.parameters.set("sha256", fields.text("sha256"));
  return obstacle;
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
  if (environment.accuracy > 0) value.set("accuracy", environment.accuracy);
  if (environment.pilot) {
    Value& pilot = value.set("pilot", Value::map());
    pilot.set("eye", list_of(environment.pilot->eye));
    pilot.set("range", environment.pilot->range);
    pilot.set("beside", environment.pilot->beside);
  }
  value.set("obstacles", entries_of(environment.obstacles));
  if (!environment.subjects.empty()) value.set("subjects", entries_of(environment.subjects));
  return value;
}

Environment environment_from(Fields fields, int format) {
  Environment environment;
  environment.margin = fields.number("margin");
  environment.accuracy = fields.optional_number("accuracy").value_or(0.0);
  if (fields.has("pilot")) {
    Fields pilot = fields.table("pilot");
    environment.pilot = {pilot.vector3("eye"), pilot.number("range"), pilot.number("beside")};
    pilot.finish();
  }
  const auto add = [&](std::vector<Fields> entries, auto read) {
    for (Obstacle& obstacle : read_all(std::move(entries), read))
      environment.obstacles.push_back(std::move(obstacle));
  };
  if (format == 1) {
    add(fields.tables("spheres"), sphere_from);
    add(fields.tables("boxes"), box_from);
    add(fields.optional_tables("zones"), zone_from);
    add(fields.optional_tables("flight_zones"), flight_zone_from);
    add(fields.optional_tables("meshes"), [](Fields& f) { return file_from(f, "mesh"); });
    add(fields.optional_tables("maps"), [](Fields& f) { return file_from(f, "map"); });
  } else {
    add(fields.tables("obstacles"), obstacle_from);
  }
  environment.subjects = read_all(fields.optional_tables("subjects"), subject_from);
  fields.finish();
  return environment;
}

}  // namespace lapwing
