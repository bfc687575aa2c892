// SPDX-License-Identifier: Apache-2.0
// Maps and surfaces: what mapping missions ask of `run`.
#include <cmath>

#include <lua.hpp>

#include "framework/geometry/mesh_file.h"
#include "framework/map/map_file.h"
#include "framework/mission/explore_library.h"
#include "framework/mission/guard.h"
#include "framework/mission/lua_value.h"
#include "framework/mission/map_objects.h"
#include "framework/mission/scene_script.h"
#include "framework/mission/vectors.h"

namespace lapwing {
namespace {

MapWork work_of(const MissionRun& run) {
  return {run.settings.threads, run.settings.cancellation, run.settings.progress};
}

Eigen::Vector3d point_argument(lua_State* state, int index, const char* what) {
  const Value given = value_from_lua(state, index, Sandbox::of(state).script_position(state), what);
  if (!given.is_list() || given.as_list().size() != 3)
    throw InputError(std::string(what) + ": expected a place {x, y, z}");
  Eigen::Vector3d p;
  for (int axis = 0; axis < 3; ++axis)
    p(axis) = given.as_list()[static_cast<std::size_t>(axis)].as_number();
  return p;
}

// -- surfaces ------------------------------------------------------------------------------------

int push_surface(lua_State* state, std::string name, TriangleMesh mesh,
                 const Eigen::AlignedBox3d& region, Value moves = Value::map()) {
  SurfaceObject surface{name, nullptr, region, std::move(moves)};
  surface.scene = std::make_shared<MeshScene>(std::move(mesh), name);
  new_object(state, kSurfaceType, std::move(surface));
  return 1;
}

// run:surface(scene): of a scene that a script has made (lapwing.scene).
int surface(lua_State* state) {
  GeneratedScene made = finished_scene(object_argument<SceneObject>(state, 2, kSceneType));
  return push_surface(state, made.name, std::move(made.mesh), made.region, std::move(made.moves));
}

ParameterTable mesh_file_table() {
  return ParameterTable()
      .required_text("file", "a mesh, .obj, .ply, .dae, ...")
      .optional_number("unit", "m", "metres per unit of the file; absent: as the file says",
                       above(0))
      .choice("up", "file", {"file", "x", "y", "z"}, "axis that points up; file: as the file says");
}

// run:read_surface{file =, unit =, up =}: from a mesh file.
int read_surface(lua_State* state) {
  const Parameters given = table_argument(state, 2, mesh_file_table(), "read_surface");
  const std::string& name = given.text("file");
  MeshFileOptions options;
  if (given.has("unit")) options.unit = given.number("unit");
  if (given.text("up") != "file") options.up = up_axis(given.text("up"));
  MeshFile file = read_mesh(run_of(state).files.find(name, "meshes"), options);
  const Eigen::AlignedBox3d bounds = file.mesh.bounds();
  char extent[96];
  std::snprintf(extent, sizeof extent, ", %.4g x %.4g x %.4g m", bounds.sizes().x(),
                bounds.sizes().y(), bounds.sizes().z());
  run_of(state).settings.print(name + ": " + file.description() + extent);
  if (!file.doubt.empty()) run_of(state).settings.print("warning: " + name + ": " + file.doubt);
  return push_surface(state, name, std::move(file.mesh), bounds);
}

SurfaceObject& whole_surface(lua_State* state) {
  SurfaceObject& surface = object_argument<SurfaceObject>(state, 1, kSurfaceType);
  if (!surface.scene) throw InputError("there is nothing left of '" + surface.name + "'");
  return surface;
}

// surface:clearance(p): metres to the nearest triangle, 50 at most.
int clearance(lua_State* state) {
  constexpr double kReach = 50;
  const SurfaceObject& surface = whole_surface(state);
  const auto nearest = surface.scene->nearest(point_argument(state, 2, "clearance"), kReach);
  lua_pushnumber(state, nearest ? nearest->distance : kReach);
  return 1;
}

// surface:covered(p): whether there is a surface straight above.
int covered(lua_State* state) {
  const SurfaceObject& surface = whole_surface(state);
  const Eigen::Vector3d p = point_argument(state, 2, "covered");
  lua_pushboolean(state, surface.scene->blocked({.origin = p, .direction = {0, 0, 1}}));
  return 1;
}

// surface:add_ground(): a plane through its lowest point, 100 m beyond it on every side.
int add_ground(lua_State* state) {
  constexpr double kBeyond = 100;
  SurfaceObject& surface = whole_surface(state);
  TriangleMesh mesh = surface.scene->mesh();
  const Eigen::AlignedBox3d bounds = mesh.bounds();
  const auto first = static_cast<std::int32_t>(mesh.vertices.size());
  const double low_x = bounds.min().x() - kBeyond, high_x = bounds.max().x() + kBeyond;
  const double low_y = bounds.min().y() - kBeyond, high_y = bounds.max().y() + kBeyond;
  const double z = bounds.min().z();
  for (const auto& [x, y] :
       {std::pair{low_x, low_y}, {high_x, low_y}, {high_x, high_y}, {low_x, high_y}})
    mesh.vertices.emplace_back(x, y, z);
  mesh.triangles.push_back({first, first + 1, first + 2});
  mesh.triangles.push_back({first, first + 2, first + 3});
  if (!mesh.colors.empty()) mesh.colors.resize(mesh.triangles.size(), Rgb{150, 145, 130});
  surface.scene = std::make_shared<MeshScene>(std::move(mesh), surface.name);
  return 0;
}

// surface:discard(): deletes the surface; it cannot be used any more.
int discard(lua_State* state) {
  whole_surface(state).scene.reset();
  return 0;
}

constexpr BoundField kSurfaceFields[] = {
    {"name", "string", "name of its scene or file"},
    {"triangles", "integer", "number of triangles"},
    {"lower", "number[]", "lowest corner of its bounds, m"},
    {"upper", "number[]", "highest corner of its bounds, m"},
    {"region", "table", "region of interest: {lower, upper}, m"},
    {"moves", "table", "motions that its scene recommends for explorations"}};

int surface_field(lua_State* state) {
  const SurfaceObject& surface = object_argument<SurfaceObject>(state, 1, kSurfaceType);
  const std::string field = text_argument(state, 2, "surface");
  Value region = Value::map(), fields = Value::map();
  region.set("lower", list_of(surface.region.min()));
  region.set("upper", list_of(surface.region.max()));
  fields.set("name", surface.name);
  if (surface.scene) {
    const TriangleMesh& mesh = surface.scene->mesh();
    const Eigen::AlignedBox3d bounds = mesh.bounds();
    fields.set("triangles", static_cast<std::int64_t>(mesh.triangles.size()));
    fields.set("lower", list_of(bounds.min()));
    fields.set("upper", list_of(bounds.max()));
  }
  fields.set("region", std::move(region));
  fields.set("moves", surface.moves);
  return push_field(state, "a surface", field, fields, kSurfaceFields);
}

// -- maps ----------------------------------------------------------------------------------------

// run:map(plugin): "brick" or {type = "brick", resolution = 0.2, ...}
int map(lua_State* state) {
  MissionRun& run = run_of(state);
  const PluginChoice chosen = plugin_choice(state, 2, "map");
  MapObject object;
  object.mapping = std::make_shared<Mapping>();
  object.mapping->plugin = chosen.type;
  object.mapping->map = run.settings.registry->create<Map>(chosen.type, chosen.parameters, "map");
  new_object(state, kMapType, std::move(object));
  return 1;
}

ParameterTable scan_table() {
  ParameterTable camera;
  camera.integer("width", 160, "pixels", between(1, 10000))
      .integer("height", 120, "pixels", between(1, 10000))
      .number("view_deg", 90, "deg", "angle across", {1, 170});
  ParameterTable noise;
  noise.number("dropped", 0, "", "fraction of pixels without a measurement", between(0, 1))
      .number("sigma", 0, "m", "standard deviation of the depth", between(0, 100));
  ParameterTable pose;
  pose.required_numbers("position", 3, "m", "world")
      .number("yaw", 0, "rad", "heading")
      .number("pitch", 0, "rad", "positive up");
  ParameterTable table;
  table.table("camera", camera, "pinhole camera")
      .table("noise", noise, "noise of the sensor")
      .number("range", 20, "m", "largest depth", above(0))
      .tables("poses", pose, "poses of the camera", true);
  return table;
}

// "300 views", or "76 of 300 views" of a run that was stopped.
std::string scanned(const Mapping& mapping, std::size_t asked, const std::string& what) {
  const auto count = static_cast<std::size_t>(mapping.scans);
  return (count < asked ? std::to_string(count) + " of " : "") + std::to_string(asked) + " " + what;
}

// map:scan{surface =, poses = {{position =, yaw =, pitch =}}, camera =, range =, noise =}
int scan(lua_State* state) {
  MissionRun& run = run_of(state);
  Mapping& mapping = *object_argument<MapObject>(state, 1, kMapType).mapping;
  const Parameters given = table_argument(state, 2, scan_table(), "scan", kSurfaceObject);
  lua_getfield(state, 2, "surface");
  const SurfaceObject& surface = object_argument<SurfaceObject>(state, -1, kSurfaceType);
  if (!surface.scene) throw InputError("there is nothing left of '" + surface.name + "'");
  const Parameters& camera = given.table("camera");
  DepthSensor sensor;
  sensor.range = given.number("range");
  const int width = static_cast<int>(camera.integer("width"));
  const int height = static_cast<int>(camera.integer("height"));
  const double focal = width / 2.0 / std::tan(camera.number("view_deg") * EIGEN_PI / 360);
  sensor.pinhole = {width, height, focal, focal, (width - 1) / 2.0, (height - 1) / 2.0};
  const Parameters& noise = given.table("noise");
  if (noise.number("dropped") > 0 || noise.number("sigma") > 0)
    sensor.noise = DepthNoise{noise.number("dropped"), noise.number("sigma")};
  std::vector<Pose> poses;
  for (const Parameters& pose : given.tables("poses"))
    poses.push_back(
        camera_pose(vector_of(pose.numbers("position")), pose.number("yaw"), pose.number("pitch")));
  if (poses.empty()) throw InputError(given.origin("poses"), "scan: no pose");
  begin_planning(run);
  const Sandbox::ClockPause pause(Sandbox::of(state));
  map_surface(mapping, *surface.scene, poses, sensor, run.settings.seed, work_of(run));
  mapping.source = scanned(mapping, poses.size(), "views") + " of '" + surface.name + "'";
  return 0;
}

// map:scan_folder(name): depth images and poses of a folder.
int scan_folder(lua_State* state) {
  MissionRun& run = run_of(state);
  Mapping& mapping = *object_argument<MapObject>(state, 1, kMapType).mapping;
  const std::string name = text_argument(state, 2, "scan_folder");
  const Sandbox::ClockPause pause(Sandbox::of(state));
  const DepthFolder folder(run.files.find_folder(name));
  begin_planning(run);
  map_folder(mapping, folder, work_of(run));
  mapping.source = scanned(mapping, folder.size(), "depth images") + " of '" + name + "'";
  return 0;
}

// run:map_resolution(name): of a map file.
int map_resolution(lua_State* state) {
  const std::string name = text_argument(state, 2, "map_resolution");
  const Sandbox::ClockPause pause(Sandbox::of(state));
  lua_pushnumber(state, read_map_file(run_of(state).files.find(name, "maps")).resolution);
  return 1;
}

// map:load(name): all voxels of a map file of the same resolution.
int load(lua_State* state) {
  MissionRun& run = run_of(state);
  Mapping& mapping = *object_argument<MapObject>(state, 1, kMapType).mapping;
  const std::string name = text_argument(state, 2, "load");
  const Sandbox::ClockPause pause(Sandbox::of(state));
  const MapFile file = read_map_file(run.files.find(name, "maps"));
  const double resolution = mapping.map->grid().resolution();
  if (std::abs(file.resolution - resolution) > 1e-9 * resolution)
    throw InputError("'" + name + "' has voxels of " + std::to_string(file.resolution) +
                     " m, the map has voxels of " + std::to_string(resolution) + " m");
  try {
    mapping.map->import(file.leaves);
  } catch (const InputError& error) {
    throw InputError("'" + name + "': " + error.what());
  }
  mapping.source = "file '" + name + "'";
  return 0;
}

// map:counts(): {known =, free =, occupied =, bytes =}
int counts(lua_State* state) {
  const Map& map = *object_argument<MapObject>(state, 1, kMapType).mapping->map;
  const VoxelCounts counted = map.counts();
  Value value = Value::map();
  value.set("known", static_cast<std::int64_t>(counted.known));
  value.set("free", static_cast<std::int64_t>(counted.free));
  value.set("occupied", static_cast<std::int64_t>(counted.occupied));
  value.set("bytes", static_cast<std::int64_t>(map.bytes()));
  push_value(state, value);
  return 1;
}

}  // namespace

void open_map_library(lua_State* state) {
  static const Binding methods[] = {
      {"scan", &guarded<scan>, "(look: @)", "integrates depth images of a surface", &scan_table,
       kSurfaceObject},
      {"scan_folder", &guarded<scan_folder>, "(name: string)",
       "integrates depth images from a folder"},
      {"load", &guarded<load>, "(name: string)", "loads a map file of the same resolution"},
      {"counts", &guarded<counts>, "(): table",
       "numbers of voxels and memory: known, free, occupied, bytes"}};
  static const Binding of_surface[] = {
      {"clearance", &guarded<clearance>, "(place: number[]): number",
       "distance to the nearest triangle in m, at most 50"},
      {"covered", &guarded<covered>, "(place: number[]): boolean",
       "whether there is a surface vertically above the place"},
      {"add_ground", &guarded<add_ground>, "()",
       "adds a horizontal plane at its lowest point, which extends 100 m beyond it on every side"},
      {"discard", &guarded<discard>, "()", "deletes the surface; it cannot be used any more"}};
  define_type<MapObject>(state, kMapType, {methods});
  define_type<SurfaceObject>(state, kSurfaceType, {of_surface}, &guarded<surface_field>);
  note_fields(state, kSurfaceType, kSurfaceFields);
}

std::span<const Binding> map_methods_of_run() {
  static const Binding methods[] = {
      {"surface", &guarded<surface>, "(scene: lapwing.scene): lapwing.surface",
       "a surface from a scene"},
      {"read_surface", &guarded<read_surface>, "(mesh: @): lapwing.surface",
       "a surface from a mesh file", &mesh_file_table},
      {"map", &guarded<map>, "(choice: lapwing.map_choice): lapwing.map",
       "an empty map; the `plan` of a mission may return a map instead of a plan"},
      {"map_resolution", &guarded<map_resolution>, "(name: string): number",
       "the edge of a voxel of a map file, m"},
      {"explore", &guarded<explore_surface>, "(settings: @): lapwing.exploration",
       "an exploration of a surface", &explore_table, kExploreObjects}};
  return methods;
}

}  // namespace lapwing
