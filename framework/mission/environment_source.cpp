// SPDX-License-Identifier: Apache-2.0
#include "framework/mission/environment_source.h"

#include "framework/core/checksum.h"
#include "framework/core/error.h"
#include "framework/core/files.h"
#include "framework/core/json.h"
#include "framework/map/map.h"
#include "framework/mission/vectors.h"
#include "framework/verify/judged_shape.h"

namespace lapwing {
namespace {

// The parameters that the lists of an environment share with the plugins, as a record.
Obstacle listed(const Parameters& given, const char* type,
                std::initializer_list<const char*> keys) {
  Obstacle obstacle;
  obstacle.name = given.text("name");
  obstacle.type = type;
  for (const char* key : keys)
    if (const Value* value = given.value().find(key); value && !value->is_null())
      obstacle.parameters.set(key, *value);
  return obstacle;
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

// What shapes use while they are opened for a mission.
class MissionShapes final : public ShapeSetting {
 public:
  explicit MissionShapes(MissionRun& run) : run_(run) {}
  std::filesystem::path find(const std::string& file, const std::string& folder) override {
    return run_.files.find(file, folder);
  }
  KeptFile keep(const std::string& bytes, const std::string& ending) override {
    return run_.obstacles.keep_copy(bytes, ending);
  }
  std::filesystem::path kept(const std::string& file) const override {
    return run_.obstacles.folder() / file;
  }
  std::shared_ptr<Map> make_map(const std::string& plugin, double resolution) override {
    return made_map(*run_.settings.registry, plugin, resolution);
  }
  void tell(const std::string& line) override { run_.settings.print(line); }

  static std::shared_ptr<Map> made_map(const Registry& registry, const std::string& plugin,
                                       double resolution) {
    Value parameters = Value::map();
    parameters.set("resolution", resolution);
    return registry.create<Map>(plugin, parameters, "the map of an obstacle");
  }

 private:
  MissionRun& run_;
};

// What they use where a plan document names their files.
class RecordedShapes final : public ShapeSetting {
 public:
  RecordedShapes(const Registry& registry, std::filesystem::path folder)
      : registry_(registry), folder_(std::move(folder)) {}
  std::filesystem::path find(const std::string& file, const std::string&) override {
    file_ = file;
    return folder_ / file;
  }
  // A recorded file is a copy already.
  KeptFile keep(const std::string&, const std::string&) override {
    return {file_, sha256(read_file(folder_ / file_, std::size_t{1} << 30))};
  }
  std::filesystem::path kept(const std::string& file) const override { return folder_ / file; }
  std::shared_ptr<Map> make_map(const std::string& plugin, double resolution) override {
    return MissionShapes::made_map(registry_, plugin, resolution);
  }
  void tell(const std::string&) override {}

 private:
  const Registry& registry_;
  std::filesystem::path folder_;
  std::string file_;
};

// The shape of an obstacle, `number` in its list, opened where `wanted` says so; null otherwise.
template <class Wanted>
std::shared_ptr<const Shape> opened(const Obstacle& obstacle, std::size_t number,
                                    const Registry& registry, ShapeSetting& setting,
                                    const Wanted& wanted) {
  try {
    std::shared_ptr<Shape> shape = registry.create<Shape>(obstacle.type, obstacle.parameters);
    if (!wanted(*shape)) return nullptr;
    in_plugin(
        *shape, "open", [&] { shape->open(setting); }, CallLength::lengthy);
    return shape;
  } catch (const InputError& error) {
    // Whoever asks knows the line; it is not said twice.
    std::string said = error.what();
    const std::string line = InputError(obstacle.parameters.origin(), "").what();
    if (said.starts_with(line)) said.erase(0, line.size());
    throw InputError(obstacle.label(number) + ": " + said);
  }
}

// A box, for the parts of surfaces that have no end: about what has an end.
Eigen::AlignedBox3d drawn_region(const Environment& environment,
                                 const Eigen::AlignedBox3d& region) {
  constexpr double kRoom = 500;  // m
  Eigen::AlignedBox3d box = region;
  if (box.isEmpty()) box.extend(Eigen::Vector3d(Eigen::Vector3d::Zero()));
  for (const Obstacle& obstacle : environment.obstacles) {
    const Eigen::AlignedBox3d bounds = obstacle.shape->bounds();
    if (bounds.min().allFinite() && bounds.max().allFinite()) box.extend(bounds);
  }
  const Eigen::Vector3d room = Eigen::Vector3d::Constant(kRoom);
  return {box.min() - room, box.max() + room};
}

}  // namespace

ParameterTable shapes_table() {
  const Range far = between(-1e6, 1e6);
  ParameterTable sphere;
  sphere.text("name", "", "name in messages")
      .required_numbers("center", 3, "m", "world", far)
      .required_number("radius", "m", "", {0, 1e6, true});
  ParameterTable box;
  box.text("name", "", "name in messages")
      .required_numbers("lower", 3, "m", "lowest corner, world", far)
      .required_numbers("upper", 3, "m", "highest corner, world", far);
  ParameterTable zone;
  zone.text("name", "", "name in messages")
      .required_numbers("corners", 0, "m", "x and y of each corner, in order, world", far)
      .optional_number("floor", "m", "lower end; absent: none")
      .optional_number("ceiling", "m", "upper end; absent: none");
  ParameterTable table;
  table.tables("spheres", sphere, "spheres that the flight stays out of")
      .tables("boxes", box, "boxes that the flight stays out of")
      .tables("zones", zone, "zones that the flight stays out of")
      .tables("flight_zones", zone, "zones that the flight stays inside of");
  return table;
}

ParameterTable environment_table() {
  const Range far = between(-1e6, 1e6);
  ParameterTable mesh;
  mesh.text("name", "", "name in messages").required_text("file", "mesh file, in metres with z up");
  ParameterTable map;
  map.text("name", "", "name in messages")
      .required_numbers("lower", 3, "m", "lowest corner, world", far)
      .required_numbers("upper", 3, "m", "highest corner, world", far)
      .required_text("file", "map file, .ot or .bt")
      .text("type", "brick", "plugin that holds it");
  ParameterTable region;
  region.optional_numbers("lower", 3, "m", "lowest corner, world", far)
      .optional_numbers("upper", 3, "m", "highest corner", far);
  ParameterTable point;
  point.required_number("time", "s", "time from the start of the flight")
      .required_numbers("position", 3, "m", "position of its centre, world", far);
  ParameterTable subject;
  subject.required_text("name", "name, to which keyframes refer")
      .number("height", 0, "m", "height from foot to top", between(0, 1e5))
      .number("width", 0, "m", "diameter", between(0, 1e5))
      .number("distance", 0, "m", "distance from its centre that the certificate requires",
              between(0, 1e5))
      .boolean("filmed", true, "false: a bystander, who is not filmed")
      .tables("track", point, "positions, linear in between", true);
  ParameterTable table = shapes_table();
  table.tables("meshes", mesh, "meshes that the flight stays out of")
      .tables("maps", map, "occupied and unknown voxels are obstacles, within a box")
      .tables("subjects", subject, "subjects and bystanders")
      .table("region", region, "box in which distances of maps are computed; absent: everywhere")
      .number("margin", 0, "m", "distance from every surface", at_least(0));
  return table;
}

std::vector<Obstacle> shapes_of(const Parameters& given) {
  std::vector<Obstacle> obstacles;
  for (const Parameters& sphere : given.tables("spheres"))
    obstacles.push_back(listed(sphere, "sphere", {"center", "radius"}));
  for (const Parameters& box : given.tables("boxes"))
    obstacles.push_back(listed(box, "box", {"lower", "upper"}));
  for (const Parameters& zone : given.tables("zones"))
    obstacles.push_back(listed(zone, "prism", {"corners", "floor", "ceiling"}));
  for (const Parameters& zone : given.tables("flight_zones")) {
    obstacles.push_back(listed(zone, "prism", {"corners", "floor", "ceiling"}));
    obstacles.back().side = Side::keep_inside;
  }
  return obstacles;
}

ParameterTable obstacle_table() {
  ParameterTable point;
  point.required_number("time", "s", "time from the start of the flight")
      .required_numbers("move", 3, "m", "displacement", between(-1e6, 1e6));
  ParameterTable table;
  table.text("name", "", "name in messages")
      .choice("side", "keep_out", {"keep_out", "keep_inside"}, "where the flight stays")
      .boolean("opaque", true, "whether it hides subjects; false for closed airspace")
      .tables("track", point, "displacements, linear in between; absent: it stands still");
  return table;
}

Obstacle obstacle_from(const Value& given, const std::string& what) {
  if (!given.is_map())
    throw InputError(given.origin(),
                     what + ": expected a table with `type`, got " + given.describe_type());
  const ParameterTable common = obstacle_table();
  Value own = Value::map();
  own.with_origin(given.origin());
  Obstacle obstacle;
  for (const auto& [key, value] : given.as_map()) {
    if (key == "type")
      obstacle.type = value.as_text();
    else if (common.find(key))
      own.set(key, value);
    else
      obstacle.parameters.set(key, value);
  }
  if (obstacle.type.empty())
    throw InputError(given.origin(), what + ": expected `type`, the plugin of its shape");
  const Parameters checked = check(common, own, what);
  obstacle.parameters.with_origin(given.origin());
  obstacle.name = checked.text("name");
  obstacle.side = checked.text("side") == "keep_out" ? Side::keep_out : Side::keep_inside;
  obstacle.opaque = checked.boolean("opaque");
  for (const Parameters& point : checked.tables("track")) {
    if (!obstacle.times.empty() && !(point.number("time") > obstacle.times.back()))
      throw InputError(point.origin("time"), what + ": track: times must rise");
    obstacle.times.push_back(point.number("time"));
    obstacle.moves.push_back(vector_of(point.numbers("move")));
  }
  return obstacle;
}

void open_shapes(Environment& environment, const Eigen::AlignedBox3d& region, MissionRun& run) {
  MissionShapes setting(run);
  setting.margin = environment.margin;
  setting.region = region;
  const Registry& registry = *run.settings.registry;
  for (std::size_t i = 0; i < environment.obstacles.size(); ++i) {
    Obstacle& obstacle = environment.obstacles[i];
    if (obstacle.shape) continue;
    const PluginEntry& entry =
        registry.find(Shape::kKind, obstacle.type, obstacle.parameters.origin());
    if (!entry.preset_of.empty()) obstacle.type = entry.preset_of;
    Value key = Value::map();
    key.set("type", obstacle.type);
    key.set("parameters", obstacle.parameters);
    key.set("margin", setting.margin);
    if (!region.isEmpty())
      key.set("region", Value(Value::List{region.min().x(), region.min().y(), region.min().z(),
                                          region.max().x(), region.max().y(), region.max().z()}));
    std::shared_ptr<const Shape>& shape = run.obstacles.shape(to_json(key, -1));
    if (!shape)
      shape = opened(obstacle, i + 1, registry, setting, [](const Shape&) { return true; });
    obstacle.shape = shape;
    obstacle.parameters = shape->record();
    if (obstacle.side == Side::keep_inside && !shape->solid())
      throw InputError(obstacle.label(i + 1) + ": it has no inside that a flight could stay in");
  }
  // Fine enough for the eye, coarse enough for a document; the flight keeps it beside the margin.
  constexpr double kTolerance = 5e-3;  // m
  for (Obstacle& obstacle : environment.obstacles) {
    if (judged_by_itself(obstacle.type) || obstacle.triangles) continue;
    obstacle.tolerance = kTolerance;
    obstacle.triangles = std::make_shared<TriangleMesh>(
        obstacle.shape->triangles(kTolerance, drawn_region(environment, region)));
  }
}

void open_recorded_shapes(Environment& environment, const Registry& registry,
                          const std::filesystem::path& folder) {
  RecordedShapes setting(registry, folder);
  setting.margin = environment.margin;
  for (std::size_t i = 0; i < environment.obstacles.size(); ++i) {
    Obstacle& obstacle = environment.obstacles[i];
    if (!obstacle.shape)
      obstacle.shape = opened(obstacle, i + 1, registry, setting,
                              [](const Shape& shape) { return !shape.surrounds(); });
  }
}

Environment environment_of(const Parameters& given, const Value& obstacles, MissionRun& run) {
  Environment environment;
  environment.obstacles = shapes_of(given);
  environment.margin = given.number("margin");
  for (const Parameters& mesh : given.tables("meshes"))
    environment.obstacles.push_back(listed(mesh, "mesh", {"file"}));
  for (const Parameters& map : given.tables("maps")) {
    environment.obstacles.push_back(listed(map, "map", {"file", "lower", "upper"}));
    environment.obstacles.back().parameters.set("voxels", map.text("type"));
  }
  if (!obstacles.is_null() && !(obstacles == Value::map()))
    for (const Value& entry : obstacles.as_list())
      environment.obstacles.push_back(obstacle_from(
          entry, "obstacles[" + std::to_string(environment.obstacles.size() + 1) + "]"));
  Eigen::AlignedBox3d region;
  const Parameters& asked = given.table("region");
  if (asked.has("lower") != asked.has("upper"))
    throw InputError(asked.origin(), "region: expected lower and upper");
  if (asked.has("lower"))
    region = {vector_of(asked.numbers("lower")), vector_of(asked.numbers("upper"))};
  open_shapes(environment, region, run);
  for (const Parameters& entry : given.tables("subjects")) {
    for (const Subject& other : environment.subjects)
      if (other.name == entry.text("name"))
        throw InputError(entry.origin("name"), "two subjects are named '" + other.name + "'");
    environment.subjects.push_back(subject_of(entry));
  }
  return environment;
}

}  // namespace lapwing
