// SPDX-License-Identifier: Apache-2.0
// City models as surfaces in the world frame.
#include <lua.hpp>

#include "framework/geometry/mesh_scene.h"
#include "framework/mission/guard.h"
#include "framework/mission/lua_value.h"
#include "framework/mission/map_objects.h"
#include "framework/mission/site_objects.h"
#include "framework/survey/city_model.h"

namespace lapwing {
namespace {

ParameterTable city_table() {
  return ParameterTable()
      .required_text("file", "file of the model, .gml")
      .text("option", "city", "option that states the reference, for messages")
      .text("system", "", "reference system; empty: as the file says")
      .optional_numbers("zero", 3, "", "the world's origin in coordinates without a system")
      .optional_number("unit", "m", "metres per unit of coordinates without a system", above(0))
      .optional_number("height_unit", "m", "metres per unit of heights", above(0));
}

std::string counted(std::size_t count, const char* one, const char* many) {
  return std::to_string(count) + " " + (count == 1 ? one : many);
}

// "CityGML, 120 objects of level 2, 3400 triangles, 150 x 150 x 7.3 m"
std::string description_of(const CityModel& model, const Eigen::AlignedBox3d& bounds) {
  std::string text = "CityGML";
  for (const auto& [level, count] : model.objects)
    text += ", " + counted(count, "object", "objects") + " of level " + std::to_string(level);
  char extent[96];
  std::snprintf(extent, sizeof extent, ", %.4g x %.4g x %.4g m", bounds.sizes().x(),
                bounds.sizes().y(), bounds.sizes().z());
  return text + ", " + counted(model.mesh.triangles.size(), "triangle", "triangles") + extent;
}

// From the coordinates of the file to the world's.
std::vector<std::string> bring_to_world(CityModel& model, StatedReference stated, MissionRun& run) {
  Eigen::AlignedBox3d given;
  for (const Eigen::Vector3d& p : model.mesh.vertices) given.extend(p);
  stated.system_of_data = model.system;
  stated.sample = given.center();
  stated.lowest = given.min().z();
  SiteReference found = refer_site(stated);
  if (found.origin && !run.origin) run.origin = found.origin;
  if (stated.system.empty() && model.system.empty()) require_no_degrees(stated, given);
  for (Eigen::Vector3d& p : model.mesh.vertices) {
    p = found.frame.to_world(p);
    if (!(p.norm() < kFarthestSite))
      throw InputError("'" + stated.name + "': a corner lies more than " +
                       std::to_string(static_cast<int>(kFarthestSite / 1000)) +
                       " km from the world's origin");
  }
  return std::move(found.notes);
}

// run:read_city{file =, system =, zero =, ...}: a surface of the buildings of a city model.
int read_city(lua_State* state) {
  MissionRun& run = run_of(state);
  const Parameters given = table_argument(state, 2, city_table(), "read_city");
  const std::string& name = given.text("file");
  const auto file = run.files.find(name, "meshes");
  const Sandbox::ClockPause pause(Sandbox::of(state));
  CityModel model = read_city_model(file);
  std::vector<std::string> notes = bring_to_world(model, stated_reference(given, run), run);
  weld(model.mesh, 0);
  if (model.mesh.triangles.empty()) throw InputError("'" + name + "': its polygons have no area");
  const auto left_out = [&](std::size_t count, const char* one, const char* many) {
    if (count > 0) notes.push_back("'" + name + "': left out: " + counted(count, one, many));
  };
  left_out(model.prototypes, "prototype of objects", "prototypes of objects");
  left_out(model.flat, "polygon without area", "polygons without area");
  SurfaceObject surface{name, nullptr, model.mesh.bounds()};
  run.settings.print(name + ": " + description_of(model, surface.region));
  for (const std::string& note : notes) run.settings.print("note: " + note);
  surface.scene = std::make_shared<MeshScene>(std::move(model.mesh), name);
  new_object(state, kSurfaceType, std::move(surface));
  return 1;
}

}  // namespace

std::span<const Binding> city_methods_of_run() {
  static const Binding methods[] = {{"read_city", &guarded<read_city>, "(city: @): lapwing.surface",
                                     "reads a surface from a city model in CityGML", &city_table}};
  return methods;
}

}  // namespace lapwing
