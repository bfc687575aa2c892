// SPDX-License-Identifier: Apache-2.0
#include "framework/mission/environment_source.h"

#include "framework/core/error.h"
#include "framework/mission/vectors.h"

namespace lapwing {
namespace {

Box box_of(const Parameters& given) {
  const Box box{given.text("name"), vector_of(given.numbers("lower")),
                vector_of(given.numbers("upper"))};
  if (!(box.lower.array() < box.upper.array()).all())
    throw InputError(given.origin("lower"),
                     "box '" + box.name + "': lower must be below upper in x, y and z");
  return box;
}

Zone zone_of(const Parameters& given, const std::string& kind) {
  Zone zone{.name = given.text("name"), .corners = {}};
  const std::string what = kind + " '" + zone.name + "'";
  const auto numbers = given.numbers("corners");
  if (numbers.size() < 6 || numbers.size() % 2 != 0)
    throw InputError(given.origin("corners"),
                     what + ": corners: expected at least three pairs x, y");
  for (std::size_t i = 0; i < numbers.size(); i += 2)
    zone.corners.emplace_back(numbers[i], numbers[i + 1]);
  if (!is_simple_polygon(zone.corners))
    throw InputError(given.origin("corners"),
                     what + ": its edges cross or touch, or corners coincide; list them in turn");
  if (given.has("floor")) zone.floor = given.number("floor");
  if (given.has("ceiling")) zone.ceiling = given.number("ceiling");
  if (!(zone.floor < zone.ceiling))
    throw InputError(given.origin("ceiling"), what + ": its ceiling must be above its floor");
  return zone;
}

Subject subject_of(const Parameters& given) {
  Subject subject;
  subject.name = given.text("name");
  subject.height = given.number("height");
  subject.width = given.number("width");
  subject.distance = given.number("distance");
  subject.filmed = given.boolean("filmed");
  for (const Parameters& point : given.tables("track")) {
    const double time = point.number("time");
    if (!subject.times.empty() && !(time > subject.times.back()))
      throw InputError(point.origin("time"),
                       "track of subject '" + subject.name + "': times must rise");
    subject.times.push_back(time);
    subject.positions.push_back(vector_of(point.numbers("position")));
  }
  if (subject.times.empty())
    throw InputError(given.origin(), "subject '" + subject.name + "': its track is empty");
  return subject;
}

MapObstacle map_of(const Parameters& given, double margin, MissionRun& run) {
  const Box box = box_of(given);
  return run.obstacles.map(run.files.find(given.text("file"), "maps"), box.name, margin,
                           {box.lower, box.upper}, given.text("type"), *run.settings.registry);
}

}  // namespace

ParameterTable shapes_table() {
  const Range far = between(-1e6, 1e6);
  ParameterTable sphere;
  sphere.text("name", "", "for messages")
      .required_numbers("center", 3, "m", "world", far)
      .required_number("radius", "m", "", {0, 1e6, true});
  ParameterTable box;
  box.text("name", "", "for messages")
      .required_numbers("lower", 3, "m", "lowest corner, world", far)
      .required_numbers("upper", 3, "m", "highest corner, world", far);
  ParameterTable zone;
  zone.text("name", "", "for messages")
      .required_numbers("corners", 0, "m", "x and y of each corner in turn, world", far)
      .optional_number("floor", "m", "lowest height that is closed; absent: the ground and below")
      .optional_number("ceiling", "m", "highest height that is closed; absent: all above");
  ParameterTable table;
  table.tables("spheres", sphere, "to keep out of")
      .tables("boxes", box, "to keep out of, parallel to the axes")
      .tables("zones", zone, "not to be flown over")
      .tables("flight_zones", zone, "not to be left, every one of them");
  return table;
}

ParameterTable environment_table() {
  const Range far = between(-1e6, 1e6);
  ParameterTable mesh;
  mesh.text("name", "", "for messages").required_text("file", "a mesh, in metres with z up");
  ParameterTable map;
  map.text("name", "", "for messages")
      .required_numbers("lower", 3, "m", "lowest corner, world", far)
      .required_numbers("upper", 3, "m", "highest corner, world", far)
      .required_text("file", "a map, .ot or .bt")
      .text("type", "brick", "plugin that holds it");
  ParameterTable point;
  point.required_number("time", "s", "from the start of the flight")
      .required_numbers("position", 3, "m", "of its middle, world", far);
  ParameterTable subject;
  subject.required_text("name", "by which it is asked for")
      .number("height", 0, "m", "from foot to top", between(0, 1e5))
      .number("width", 0, "m", "diameter", between(0, 1e5))
      .number("distance", 0, "m", "kept from its middle, judged by the certificate",
              between(0, 1e5))
      .boolean("filmed", true, "else a bystander, whom no camera looks for")
      .tables("track", point, "where it is, straight in between", true);
  ParameterTable table = shapes_table();
  table.tables("meshes", mesh, "to keep away from")
      .tables("maps", map, "occupied or unknown: to keep away from; known to within a box")
      .tables("subjects", subject, "what is filmed")
      .number("margin", 0, "m", "kept from every surface", at_least(0));
  return table;
}

Environment shapes_of(const Parameters& given) {
  Environment environment;
  for (const Parameters& sphere : given.tables("spheres"))
    environment.spheres.push_back(
        {sphere.text("name"), vector_of(sphere.numbers("center")), sphere.number("radius")});
  for (const Parameters& box : given.tables("boxes")) environment.boxes.push_back(box_of(box));
  for (const Parameters& zone : given.tables("zones"))
    environment.zones.push_back(zone_of(zone, "zone"));
  for (const Parameters& zone : given.tables("flight_zones"))
    environment.flight_zones.push_back(zone_of(zone, "flight zone"));
  return environment;
}

Environment environment_of(const Parameters& given, MissionRun& run) {
  Environment environment = shapes_of(given);
  environment.margin = given.number("margin");
  for (const Parameters& mesh : given.tables("meshes"))
    environment.meshes.push_back(run.obstacles.mesh(run.files.find(mesh.text("file"), "meshes"),
                                                    mesh.text("name"), environment.margin,
                                                    run.settings.print));
  for (const Parameters& map : given.tables("maps"))
    environment.maps.push_back(map_of(map, environment.margin, run));
  for (const Parameters& entry : given.tables("subjects")) {
    for (const Subject& other : environment.subjects)
      if (other.name == entry.text("name"))
        throw InputError(entry.origin("name"), "two subjects are named '" + other.name + "'");
    environment.subjects.push_back(subject_of(entry));
  }
  return environment;
}

}  // namespace lapwing
