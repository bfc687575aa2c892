// SPDX-License-Identifier: Apache-2.0
// Sites from surveyors' data: what scan missions ask of `run` and of their prior.
#include <lua.hpp>

#include <charconv>

#include "framework/geometry/ground_span.h"
#include "framework/mission/guard.h"
#include "framework/mission/lua_value.h"
#include "framework/mission/scan_objects.h"
#include "framework/mission/site_objects.h"
#include "framework/mission/site_terrain.h"
#include "framework/surface/surface_mesh.h"

namespace lapwing {

MapWork site_work_of(const MissionRun& run) {
  return {run.settings.threads, run.settings.cancellation, run.settings.progress};
}

ParameterTable site_reference_table() {
  ParameterTable table;
  table.required_text("file", "file of the data")
      .text("option", "cloud", "option that states the reference, for messages")
      .text("system", "", "reference system; empty: as the file says")
      .optional_numbers("zero", 3, "", "the world's origin in coordinates without a system")
      .optional_number("unit", "m", "metres per unit of coordinates without a system", above(0))
      .optional_number("height_unit", "m", "metres per unit of heights", above(0))
      .required_number("resolution", "m", "edge of a voxel", above(0))
      .number("spacing", 0.4, "m", "distance between points of the surface", above(0))
      .optional_numbers("lower", 2, "m", "lowest corner of what is kept, world x and y")
      .optional_numbers("upper", 2, "m", "highest corner of what is kept, world x and y");
  return table;
}

StatedReference stated_reference(const Parameters& given, const MissionRun& run) {
  StatedReference stated;
  stated.name = given.text("file");
  stated.option = given.text("option");
  stated.system = given.text("system");
  if (given.has("zero")) {
    const auto zero = given.numbers("zero");
    stated.zero = Eigen::Vector3d(zero[0], zero[1], zero[2]);
  }
  if (given.has("unit")) stated.unit = given.number("unit");
  if (given.has("height_unit")) stated.height_unit = given.number("height_unit");
  stated.origin = run.origin;
  return stated;
}

std::optional<Eigen::AlignedBox2d> kept_box(const Parameters& given) {
  if (!given.has("lower") || !given.has("upper")) return std::nullopt;
  const auto low = given.numbers("lower"), high = given.numbers("upper");
  return Eigen::AlignedBox2d(Eigen::Vector2d(low[0], low[1]), Eigen::Vector2d(high[0], high[1]));
}

int push_site(lua_State* state, Site site) {
  MissionRun& run = run_of(state);
  run.settings.print(site.name + ": " + site.description);
  if (site.origin && !run.origin) run.origin = site.origin;
  new_object(state, kSiteType, SiteObject{std::make_shared<Site>(std::move(site))});
  return 1;
}

namespace {

ParameterTable cloud_table() {
  ParameterTable scanner;
  scanner.required_numbers("position", 3, "", "in the coordinates of the cloud");
  ParameterTable table = site_reference_table();
  table.text("columns", "", "columns of a text, as \"x y z\"")
      .text("without", "", "classes of points that are left out, as \"7 18\"")
      .tables("scanners", scanner, "places from which the cloud was measured");
  return table;
}

// "7 18"
std::set<int> classes_in(const Parameters& given) {
  const std::string& text = given.text("without");
  std::set<int> classes;
  for (const char* at = text.data(); at != text.data() + text.size();) {
    if (*at == ' ' || *at == ',') {
      ++at;
      continue;
    }
    int value = 0;
    const auto [end, error] = std::from_chars(at, text.data() + text.size(), value);
    if (error != std::errc{} || value < 0 || value > 255)
      throw InputError(given.origin("without"),
                       "cloud.without: expected numbers of classes from 0 to 255, as \"7 18\"");
    classes.insert(value);
    at = end;
  }
  return classes;
}

// run:read_cloud{file =, resolution =, ...}: a site from a point cloud.
int read_cloud(lua_State* state) {
  MissionRun& run = run_of(state);
  const Parameters given = table_argument(state, 2, cloud_table(), "read_cloud");
  CloudRequest request;
  request.file = run.files.find(given.text("file"), "meshes");
  request.options.columns = given.text("columns");
  request.reference = stated_reference(given, run);
  request.without = classes_in(given);
  for (const Parameters& scanner : given.tables("scanners")) {
    const auto p = scanner.numbers("position");
    request.scanners.emplace_back(p[0], p[1], p[2]);
  }
  request.only = kept_box(given);
  request.resolution = given.number("resolution");
  request.spacing = given.number("spacing");
  const Sandbox::ClockPause pause(Sandbox::of(state));
  return push_site(state, read_site_cloud(request, site_work_of(run)));
}

ParameterTable terrain_table() {
  ParameterTable table = site_reference_table();
  table.text("ground", "", "raster of the terrain without buildings and plants")
      .number("cell", 0.5, "m", "distance between corners of the mesh", above(0));
  return table;
}

// run:read_terrain{file =, ground =, resolution =, ...}: a site from rasters of heights.
int read_terrain(lua_State* state) {
  MissionRun& run = run_of(state);
  const Parameters given = table_argument(state, 2, terrain_table(), "read_terrain");
  TerrainRequest request;
  request.surface_name = given.text("file");
  request.surface = run.files.find(request.surface_name, "meshes");
  request.ground_name = given.text("ground");
  if (!request.ground_name.empty()) request.ground = run.files.find(request.ground_name, "meshes");
  request.reference = stated_reference(given, run);
  request.only = kept_box(given);
  request.resolution = given.number("resolution");
  request.cell = given.number("cell");
  const Sandbox::ClockPause pause(Sandbox::of(state));
  return push_site(state, read_site_terrain(request, site_work_of(run)));
}

// site:ground(x, y): height of the terrain, or nil where it is not known.
int ground_of_site(lua_State* state) {
  const Site& site = *object_argument<SiteObject>(state, 1, kSiteType).site;
  const double x = luaL_checknumber(state, 2), y = luaL_checknumber(state, 3);
  const auto height = site.ground ? site.ground->height(x, y) : std::nullopt;
  if (height)
    lua_pushnumber(state, *height);
  else
    lua_pushnil(state);
  return 1;
}

// site:ground_within{x, y, ...}: the lowest and the highest ground within a polygon, or nil where
// none is known.
int ground_within_site(lua_State* state) {
  const Site& site = *object_argument<SiteObject>(state, 1, kSiteType).site;
  luaL_checktype(state, 2, LUA_TTABLE);
  GroundPolygon polygon;
  const lua_Integer numbers = luaL_len(state, 2);
  for (lua_Integer i = 1; i + 1 <= numbers; i += 2) {
    lua_geti(state, 2, i);
    lua_geti(state, 2, i + 1);
    polygon.emplace_back(luaL_checknumber(state, -2), luaL_checknumber(state, -1));
    lua_pop(state, 2);
  }
  const auto span = site.ground ? ground_span(*site.ground, polygon) : std::nullopt;
  if (!span) {
    lua_pushnil(state);
    return 1;
  }
  lua_pushnumber(state, span->lowest);
  lua_pushnumber(state, span->highest);
  return 2;
}

constexpr BoundField kSiteFields[] = {
    {"name", "string", "name of its file"},
    {"description", "string", "format and size of its data"},
    {"lower", "number[]", "lowest corner of its bounds, m, world"},
    {"upper", "number[]", "highest corner of its bounds, m, world"},
    {"points", "integer", "number of points of its surface"},
    {"scanners", "integer", "number of places from which it was measured"},
    {"notes", "string[]", "sentences for the user"}};

int site_field(lua_State* state) {
  const Site& site = *object_argument<SiteObject>(state, 1, kSiteType).site;
  const std::string field = text_argument(state, 2, "site");
  Value fields = Value::map();
  fields.set("name", site.name);
  fields.set("description", site.description);
  fields.set("lower", list_of(site.bounds.min()));
  fields.set("upper", list_of(site.bounds.max()));
  fields.set("points", static_cast<std::int64_t>(site.points.size()));
  fields.set("scanners", static_cast<std::int64_t>(site.scanners.size()));
  Value::List notes;
  for (const std::string& note : site.notes) notes.emplace_back(note);
  fields.set("notes", Value(std::move(notes)));
  return push_field(state, "a site", field, fields, kSiteFields);
}

constexpr BoundField kSiteObjects[] = {{"site", "lapwing.site", "site whose data are known"}};

ParameterTable add_site_table() {
  ParameterTable table;
  table.number("cell", 0.4, "m", "edge of the cells in which triangles are made", above(0))
      .number("trim", 0.8, "m", "surface farther than this from every point is left out", above(0))
      .choice("free", "sky", {"sky", "scanners", "both"},
              "what is free: open sky above the surface, lines from scanners to points, or both")
      .required_number("ceiling", "m", "height up to which open sky is free, world")
      .number("range", 60, "m", "longest line from a scanner", above(0));
  add_surface_method(table);
  return table;
}

TriangleMesh mesh_of_site(const MissionRun& run, const Site& site, const Parameters& given) {
  if (site.mesh) return *site.mesh;
  try {
    return surface_of(run, site.points, given);
  } catch (const InputError& error) {
    throw InputError(given.origin(), "no mesh can be made of '" + site.name + "': " + error.what());
  }
}

// prior:add_site{site =, ceiling =, ...}: map and mesh from a site's data.
int add_site(lua_State* state) {
  MissionRun& run = run_of(state);
  Prior& prior = *object_argument<PriorObject>(state, 1, kPriorType).prior;
  const Parameters given = table_argument(state, 2, add_site_table(), "add_site", kSiteObjects);
  lua_getfield(state, 2, "site");
  const Site& site = *object_argument<SiteObject>(state, -1, kSiteType).site;
  if (site.resolution != prior.mapping.map->grid().resolution())
    throw InputError(given.origin(), "add_site: site and map have voxels of different sizes");
  begin_planning(run);
  const Sandbox::ClockPause pause(Sandbox::of(state));
  if (run.settings.progress)
    run.settings.progress->report(
        -1, "surface through " + std::to_string(site.points.size()) + " points");
  TriangleMesh mesh = mesh_of_site(run, site, given);
  const std::string& free = given.text("free");
  try {
    map_site(site, mesh,
             {.sky = free != "scanners",
              .scanners = free != "sky",
              .ceiling = given.number("ceiling"),
              .range = given.number("range")},
             *prior.mapping.map);
  } catch (const InputError& error) {
    throw InputError(given.origin(), "'" + site.name + "': " + error.what());
  }
  prior.mesh = std::make_shared<MeshScene>(std::move(mesh), site.name);
  prior.mapping.source = "file '" + site.name + "'";
  prior.rays.elsewhere = site.spacing;
  prior.surveyed = true;
  return 0;
}

}  // namespace

void open_site_library(lua_State* state) {
  static const Binding methods[] = {
      {"ground", &guarded<ground_of_site>, "(x: number, y: number): number?",
       "height of the terrain at a place, m, world; nil where it is not known"},
      {"ground_within", &guarded<ground_within_site>, "(corners: number[]): number?, number?",
       "lowest and highest terrain within a polygon {x, y, ...}, m, world; nil where none is "
       "known"}};
  define_type<SiteObject>(state, kSiteType, {methods}, &guarded<site_field>);
  note_fields(state, kSiteType, kSiteFields);
}

std::span<const Binding> site_methods_of_run() {
  static const Binding methods[] = {
      {"read_cloud", &guarded<read_cloud>, "(cloud: @): lapwing.site",
       "a site from a point cloud: .las, .ply, .pcd, .xyz", &cloud_table},
      {"read_terrain", &guarded<read_terrain>, "(terrain: @): lapwing.site",
       "a site from rasters of heights: GeoTIFF, .asc", &terrain_table}};
  return methods;
}

std::span<const Binding> site_methods_of_prior() {
  static const Binding methods[] = {{"add_site", &guarded<add_site>, "(site: @)",
                                     "sets its map and its mesh from the data of a site",
                                     &add_site_table, kSiteObjects}};
  return methods;
}

}  // namespace lapwing
