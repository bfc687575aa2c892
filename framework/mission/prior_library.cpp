// SPDX-License-Identifier: Apache-2.0
// What is known of a place: depth images of a first flight in a scene, or files of a real one.
#include <cmath>

#include <lua.hpp>

#include "framework/core/log.h"
#include "framework/core/units.h"
#include "framework/geometry/mesh_file.h"
#include "framework/map/map_file.h"
#include "framework/mission/guard.h"
#include "framework/mission/lua_value.h"
#include "framework/mission/photo_objects.h"
#include "framework/mission/scan_objects.h"
#include "framework/mission/site_objects.h"
#include "framework/picture/mesh_picture.h"
#include "framework/surface/surface_mesh.h"

namespace lapwing {

ParameterTable viewpoint_table() {
  ParameterTable table;
  table.required_numbers("position", 3, "m", "world")
      .number("yaw", 0, "rad", "heading")
      .number("pitch", 0, "rad", "positive up");
  return table;
}

Viewpoint viewpoint_of(const Parameters& given) {
  const auto p = given.numbers("position");
  return {{p[0], p[1], p[2]}, given.number("yaw"), given.number("pitch")};
}

ParameterTable box_table() {
  ParameterTable table;
  table.required_numbers("lower", 3, "m", "lowest corner, world")
      .required_numbers("upper", 3, "m", "highest corner, world");
  return table;
}

namespace {

GroundPolygon polygon_of(const Parameters& given) {
  const auto numbers = given.numbers("corners");
  if (numbers.size() % 2 != 0)
    throw InputError(given.origin("corners"), "corners: expected pairs x, y");
  GroundPolygon corners;
  for (std::size_t i = 0; i < numbers.size(); i += 2)
    corners.emplace_back(numbers[i], numbers[i + 1]);
  return corners;
}

}  // namespace

ParameterTable region_table() {
  ParameterTable hole;
  hole.required_numbers("corners", 0, "m", "x and y of each corner, in order, world");
  ParameterTable prism;
  prism.text("name", "", "name in messages")
      .required_numbers("corners", 0, "m", "x and y of each corner, in order, world")
      .tables("holes", hole, "polygons that do not belong to it")
      .required_number("low", "m", "lower end, world")
      .required_number("high", "m", "upper end, world")
      .number("weight", 1, "", "what a voxel of it counts", {0, 1e6, true});
  ParameterTable table = box_table();
  table.tables("prisms", prism, "parts of the region; absent: all of the box");
  return table;
}

InterestRegion region_of(const Parameters& given) {
  const Eigen::AlignedBox3d box = box_of(given, "the region of interest");
  std::vector<RegionPrism> prisms;
  for (const Parameters& entry : given.tables("prisms")) {
    RegionPrism prism{.name = entry.text("name"),
                      .outline = polygon_of(entry),
                      .holes = {},
                      .low = entry.number("low"),
                      .high = entry.number("high"),
                      .weight = entry.number("weight")};
    for (const Parameters& hole : entry.tables("holes")) prism.holes.push_back(polygon_of(hole));
    prisms.push_back(std::move(prism));
  }
  if (prisms.empty()) return box;
  return InterestRegion(std::move(prisms));
}

Eigen::AlignedBox3d box_of(const Parameters& given, const std::string& what) {
  const auto low = given.numbers("lower"), high = given.numbers("upper");
  const Eigen::AlignedBox3d box(Eigen::Vector3d(low[0], low[1], low[2]),
                                Eigen::Vector3d(high[0], high[1], high[2]));
  if (!(box.min().array() < box.max().array()).all())
    throw InputError(given.origin("lower"), what + ": lower must be below upper in x, y and z");
  return box;
}

ParameterTable pinhole_table() {
  ParameterTable table;
  table.integer("width", 600, "pixels", between(1, 10000))
      .integer("height", 450, "pixels", between(1, 10000))
      .number("focal", 345, "px", "focal length", above(0));
  return table;
}

Pinhole pinhole_of(const Parameters& given) {
  const int width = static_cast<int>(given.integer("width"));
  const int height = static_cast<int>(given.integer("height"));
  const double focal = given.number("focal");
  return {width, height, focal, focal, (width - 1) / 2.0, (height - 1) / 2.0};
}

void add_surface_method(ParameterTable& table) {
  table.choice("method", "auto", {"auto", "poisson", "local"},
               "one field through all points, or each place from the points around it; auto: "
               "poisson for up to 250,000 points");
}

TriangleMesh surface_of(const MissionRun& run, const std::vector<FusedPoint>& points,
                        const Parameters& given) {
  constexpr std::size_t kMostAtOnce = 250000;
  const std::string method = given.text("method");
  const bool local = method == "local" || (method == "auto" && points.size() > kMostAtOnce);
  const std::string what = "surface through " + std::to_string(points.size()) + " points";
  logging::info(what + (local ? ", local" : ", poisson"));
  if (run.settings.progress) run.settings.progress->report(-1, what);
  return surface_from_points(points,
                             {.cell = given.number("cell"),
                              .trim = given.number("trim"),
                              .method = local ? SurfaceMethod::local : SurfaceMethod::poisson,
                              .threads = run.settings.threads},
                             run.settings.cancellation);
}

namespace {

constexpr int kPictureWidth = 720, kPictureHeight = 450;  // pixels, of the scene
constexpr double kMostAir = 1e9;                          // voxels that are said to be free

Prior& prior_argument(lua_State* state) {
  return *object_argument<PriorObject>(state, 1, kPriorType).prior;
}

ParameterTable look_table() {
  ParameterTable noise;
  noise.number("dropped", 0, "", "fraction of pixels without a measurement", between(0, 1))
      .number("sigma", 0, "m", "standard deviation of the depth", between(0, 100));
  ParameterTable table;
  table.table("camera", pinhole_table(), "camera of the depth images")
      .table("noise", noise, "noise of the sensor")
      .number("range", 60, "m", "largest depth", above(0))
      .tables("poses", viewpoint_table(), "poses of the camera", true);
  return table;
}

// prior:look{surface =, poses = {{position =, yaw =, pitch =}}, camera =, range =, noise =}
int look(lua_State* state) {
  MissionRun& run = run_of(state);
  Prior& prior = prior_argument(state);
  const Parameters given = table_argument(state, 2, look_table(), "look", kSurfaceObject);
  lua_getfield(state, 2, "surface");
  const SurfaceObject& surface = object_argument<SurfaceObject>(state, -1, kSurfaceType);
  if (!surface.scene) throw InputError("look: there is nothing left of '" + surface.name + "'");
  const Pinhole pinhole = pinhole_of(given.table("camera"));
  const double range = given.number("range");
  const Parameters& errors = given.table("noise");
  const DepthNoise sensor{errors.number("dropped"), errors.number("sigma")};
  const auto poses = given.tables("poses");
  if (poses.empty()) throw InputError(given.origin("poses"), "look: no pose");
  begin_planning(run);
  if (run.settings.observe_surface) run.settings.observe_surface(surface.scene);
  const Sandbox::ClockPause pause(Sandbox::of(state));
  prior.mapping.map->set_threads(run.settings.threads);
  prior.truth = surface.scene;
  if (!prior.scene)
    prior.scene =
        SceneView{surface.scene,
                  overview(surface.region, {kPictureWidth, kPictureHeight, 720, 720, 359.5, 224.5},
                           radians(60), radians(-35))};
  std::size_t done = 0;
  for (const Parameters& pose : poses) {
    if (run.settings.cancellation && run.settings.cancellation->cancelled()) throw Cancelled();
    if (run.settings.progress)
      run.settings.progress->report(
          static_cast<double>(done) / static_cast<double>(poses.size()),
          "depth image " + std::to_string(done + 1) + " of " + std::to_string(poses.size()));
    const Viewpoint view = viewpoint_of(pose);
    PosedDepthImage image{view.camera(), render_depth(*surface.scene, view.camera(), pinhole, range,
                                                      run.settings.threads)};
    if (sensor.dropped > 0 || sensor.sigma > 0)
      add_noise(image.image, sensor, run.settings.seed + prior.views.size());
    prior.mapping.map->integrate(image);
    prior.fusion->add(image);
    prior.views.push_back(view);
    prior.rays.images.push_back({view.camera(), pinhole, range});
    ++done;
  }
  prior.mapping.source = std::to_string(prior.views.size()) + " depth images";
  return 0;
}

// The largest cubes of voxels that make up a box, as free leaves.
void add_free(const std::array<int, 3>& low, const std::array<int, 3>& high, int level,
              const std::array<int, 3>& at, std::vector<VoxelLeaf>& leaves) {
  const int edge = 1 << level;
  bool within = true;
  for (std::size_t i = 0; i < 3; ++i) {
    if (at[i] > high[i] || at[i] + edge - 1 < low[i]) return;
    within = within && at[i] >= low[i] && at[i] + edge - 1 <= high[i];
  }
  if (within) {
    leaves.push_back({{static_cast<std::uint16_t>(at[0]), static_cast<std::uint16_t>(at[1]),
                       static_cast<std::uint16_t>(at[2])},
                      static_cast<std::uint8_t>(level),
                      0,
                      -std::numeric_limits<float>::infinity()});
    return;
  }
  for (int child = 0; child < 8; ++child)
    add_free(low, high, level - 1,
             {at[0] + (child & 1) * edge / 2, at[1] + (child >> 1 & 1) * edge / 2,
              at[2] + (child >> 2) * edge / 2},
             leaves);
}

constexpr BoundField kFlownIn[] = {
    {"surface?", "lapwing.surface",
     "scene of the simulation: an error if it reaches into the box"}};

// prior:open_air{lower =, upper =}: free as far as nothing was measured there. With `surface`, the
// scene flown in, it is an error when that reaches into the box.
int open_air(lua_State* state) {
  Prior& prior = prior_argument(state);
  const Parameters given = table_argument(state, 2, box_table(), "open_air", kFlownIn);
  const Eigen::AlignedBox3d box = box_of(given, "open_air");
  lua_getfield(state, 2, "surface");
  if (const auto* surface = test_object<SurfaceObject>(state, -1, kSurfaceType)) {
    if (!surface->scene) throw InputError("there is nothing left of '" + surface->name + "'");
    if (surface->scene->box_blocked(box.center(), box.center(), box.sizes() / 2)) {
      double top = box.min().z();
      const TriangleMesh& mesh = surface->scene->mesh();
      for (const Eigen::Vector3d& p : mesh.vertices)
        if (box.contains(p)) top = std::max(top, p.z());
      char text[240];
      std::snprintf(text, sizeof text,
                    "the scene reaches into the air above safe_height = %.4g m, up to "
                    "%.4g m: raise safe_height",
                    box.min().z(), top);
      throw InputError(given.origin(), text);
    }
  }
  const Sandbox::ClockPause pause(Sandbox::of(state));
  const VoxelGrid& grid = prior.mapping.map->grid();
  if (!grid.contains(box.min()) || !grid.contains(box.max()))
    throw InputError(given.origin(), "open_air: the box lies beyond the largest map");
  const double voxels = (box.sizes() / grid.resolution()).prod();
  if (voxels > kMostAir) {
    char text[200];
    std::snprintf(text, sizeof text,
                  "the free air would be %.3g voxels of %.4g m, and %.3g are the most: choose a "
                  "coarser resolution, or a smaller region, reach or height",
                  voxels, grid.resolution(), kMostAir);
    throw InputError(given.origin(), text);
  }
  std::array<int, 3> low, high;
  for (std::size_t i = 0; i < 3; ++i) {
    const auto axis = static_cast<Eigen::Index>(i);
    low[i] = grid.index(box.min()[axis]);
    high[i] = grid.index(box.max()[axis]);
  }
  std::vector<VoxelLeaf> leaves, occupied;
  add_free(low, high, kTreeDepth, {0, 0, 0}, leaves);
  const double threshold = 0.75;
  const float occupied_above = log_odds_of(threshold);
  prior.mapping.map->for_each_leaf([&](const VoxelLeaf& leaf) {
    if (!(leaf.log_odds > occupied_above)) return;
    const int edge = 1 << leaf.level;
    for (int axis = 0; axis < 3; ++axis) {
      const auto i = static_cast<std::size_t>(axis);
      if (leaf.key[axis] > high[i] || leaf.key[axis] + edge - 1 < low[i]) return;
    }
    occupied.push_back(leaf);
  });
  // Of several leaves the last one counts: what was measured stays.
  leaves.insert(leaves.end(), occupied.begin(), occupied.end());
  prior.mapping.map->import(leaves);
  return 0;
}

// prior:simplify(): nothing more is to be measured. The map keeps the states of its voxels, and of
// their probabilities only what the states say, so that equal neighbours are kept as one; points
// are given up, as the mesh is made.
int simplify(lua_State* state) {
  constexpr float kSure = std::numeric_limits<float>::infinity();  // import clamps it
  constexpr int kSlabs = 16;  // one after the other, so that few leaves are held twice
  Prior& prior = prior_argument(state);
  if (!prior.mesh) throw InputError("simplify: the prior has no mesh; reconstruct it");
  const Sandbox::ClockPause pause(Sandbox::of(state));
  prior.fusion.emplace(prior.fusion_options);
  Map& map = *prior.mapping.map;
  const MapSettings& settings = map.settings();
  const auto known = map.bounds();
  if (!known) return 0;
  const int first = known->lower.x, across = (known->upper.x - first) / kSlabs + 1;
  for (int slab = 0; slab < kSlabs; ++slab) {
    std::vector<VoxelLeaf> leaves;
    map.for_each_leaf([&](VoxelLeaf leaf) {
      if ((std::max<int>(leaf.key.x, first) - first) / across != slab) return;
      leaf.log_odds = leaf.log_odds < settings.free_below       ? -kSure
                      : leaf.log_odds > settings.occupied_above ? kSure
                                                                : 0;
      leaves.push_back(leaf);
    });
    map.import(leaves);
  }
  return 0;
}

ParameterTable earlier_table() {
  ParameterTable table;
  table.required_text("map", ".ot or .bt")
      .required_text("mesh", "mesh file, in metres with z up")
      .table("camera", pinhole_table(), "camera of the images of that flight")
      .number("range", 60, "m", "range of those images", above(0));
  return table;
}

// prior:load{map = "a file", mesh = "a file", camera =, range =}: of an earlier flight. From where
// it took its images is not known, so that gaps between rays are taken to be as wide as at the
// range.
int load_prior(lua_State* state) {
  MissionRun& run = run_of(state);
  Prior& prior = prior_argument(state);
  const Parameters given = table_argument(state, 2, earlier_table(), "load");
  const Sandbox::ClockPause pause(Sandbox::of(state));
  const std::string name = given.text("map"), mesh = given.text("mesh");
  const MapFile file = read_map_file(run.files.find(name, "maps"));
  const double resolution = prior.mapping.map->grid().resolution();
  if (std::abs(file.resolution - resolution) > 1e-9 * resolution)
    throw InputError(given.origin("map"),
                     "'" + name + "' has voxels of " + std::to_string(file.resolution) +
                         " m, the mission of " + std::to_string(resolution) + " m");
  prior.mapping.map->import(file.leaves);
  prior.mapping.source = "file '" + name + "'";
  prior.rays.elsewhere = gap_between_rays(pinhole_of(given.table("camera")), given.number("range"));
  MeshFile read = read_mesh(run.files.find(mesh, "meshes"));
  const auto known = prior.mapping.map->bounds();
  if (!known) throw InputError(given.origin("map"), "'" + name + "' has no known voxel");
  // A mesh that belongs to the map has most of its corners at voxels that are not free; at the rim
  // of what is known it may reach beyond by a voxel.
  std::size_t blocked = 0, within = 0;
  const VoxelGrid& grid = prior.mapping.map->grid();
  Eigen::AlignedBox3d rim(grid.center(known->lower), grid.center(known->upper));
  rim.min().array() -= 1.5 * resolution;
  rim.max().array() += 1.5 * resolution;
  for (const Eigen::Vector3d& p : read.mesh.vertices) {
    if (!rim.contains(p)) continue;
    ++within;
    // Near a surface: the voxel itself or one beside it.
    bool near = false;
    for (int axis = 0; axis < 3 && !near; ++axis)
      for (const double side : {-1.0, 0.0, 1.0}) {
        const Eigen::Vector3d q = p + side * resolution * Eigen::Vector3d::Unit(axis);
        near = near ||
               (grid.contains(q) && prior.mapping.map->read(grid.key(q)).state != VoxelState::free);
      }
    blocked += near;
  }
  constexpr double kFits = 0.5;
  const auto all = static_cast<double>(read.mesh.vertices.size());
  if (static_cast<double>(blocked) < kFits * all) {
    char text[300];
    std::snprintf(
        text, sizeof text,
        "the prior mesh '%s' does not fit the map '%s': %.0f %% of its corners lie within "
        "what the map knows, %.0f %% where it is not free; both must be of one flight, in "
        "one frame, in metres",
        mesh.c_str(), name.c_str(), 100 * static_cast<double>(within) / all,
        100 * static_cast<double>(blocked) / all);
    throw InputError(given.origin("mesh"), text);
  }
  for (std::size_t k = 0; k < read.mesh.triangles.size(); ++k)
    prior.earlier.push_back(
        {(read.mesh.corner(k, 0) + read.mesh.corner(k, 1) + read.mesh.corner(k, 2)) / 3,
         read.mesh.normal(k), 1});
  prior.mesh = std::make_shared<MeshScene>(std::move(read.mesh), mesh);
  return 0;
}

ParameterTable reconstruct_table() {
  ParameterTable table;
  table.number("cell", 0.4, "m", "edge of the cells in which triangles are made", above(0))
      .number("trim", 0.8, "m", "surface farther from every point is left out", above(0));
  add_surface_method(table);
  return table;
}

// prior:reconstruct{cell =, trim =}: the mesh, from all that was seen so far.
int reconstruct(lua_State* state) {
  Prior& prior = prior_argument(state);
  const Parameters given = table_argument(state, 2, reconstruct_table(), "reconstruct");
  begin_planning(run_of(state));
  const Sandbox::ClockPause pause(Sandbox::of(state));
  std::vector<FusedPoint> points = prior.fusion->points();
  points.insert(points.end(), prior.earlier.begin(), prior.earlier.end());
  if (points.empty()) {
    char text[160];
    std::snprintf(
        text, sizeof text,
        "the first flight saw no surface within range = %.4g m: raise range, or fly lower",
        prior.fusion_options.range);
    throw InputError(given.origin(), text);
  }
  TriangleMesh mesh;
  try {
    mesh = surface_of(run_of(state), points, given);
  } catch (const InputError& error) {
    throw InputError(given.origin(), std::string("no mesh can be made of what the first flight "
                                                 "saw: ") +
                                         error.what());
  }
  prior.mesh = std::make_shared<MeshScene>(std::move(mesh), "prior");
  return 0;
}

constexpr BoundField kPriorFields[] = {
    {"images", "integer", "depth images that were taken for it"},
    {"triangles", "integer", "number of triangles of its mesh; 0 without a mesh"}};

int prior_field(lua_State* state) {
  const PriorObject& object = object_argument<PriorObject>(state, 1, kPriorType);
  const std::string field = text_argument(state, 2, "prior");
  Value fields = Value::map();
  fields.set("images", static_cast<std::int64_t>(object.prior->views.size()));
  fields.set("triangles", object.prior->mesh ? static_cast<std::int64_t>(
                                                   object.prior->mesh->mesh().triangles.size())
                                             : std::int64_t{0});
  return push_field(state, "a prior", field, fields, kPriorFields);
}

constexpr BoundField kPriorObjects[] = {{"map", "lapwing.map_choice", "map of the prior"}};
ParameterTable prior_table() {
  ParameterTable table;
  table.number("spacing", 0.3, "m", "distance between points of the surface", above(0))
      .number("range", 60, "m", "largest depth that is used for the surface", above(0))
      .number("incidence_deg", 80, "deg", "largest angle between normal and ray, for the surface",
              {1, 90})
      .integer("stride", 2, "fuse every n-th pixel", between(1, 64));
  return table;
}

// run:prior{map = plugin, spacing =, range =, incidence_deg =, stride =}: nothing is known yet.
int prior_of_run(lua_State* state) {
  MissionRun& run = run_of(state);
  const Parameters given = table_argument(state, 2, prior_table(), "prior", kPriorObjects);
  lua_getfield(state, 2, "map");
  const PluginChoice chosen = plugin_choice(state, lua_gettop(state), "map");
  PriorObject object{std::make_shared<Prior>()};
  Prior& prior = *object.prior;
  prior.mapping.plugin = chosen.type;
  prior.mapping.map = run.settings.registry->create<Map>(chosen.type, chosen.parameters, "map");
  prior.fusion_options = {.voxel = given.number("spacing"),
                          .range = given.number("range"),
                          .reach = given.number("range"),
                          .incidence = radians(given.number("incidence_deg")),
                          .stride = static_cast<int>(given.integer("stride"))};
  prior.fusion.emplace(prior.fusion_options);
  new_object(state, kPriorType, std::move(object));
  return 1;
}

}  // namespace

std::span<const Binding> prior_methods_of_run() {
  static const Binding methods[] = {{"prior", &guarded<prior_of_run>,
                                     "(settings: @): lapwing.prior", "an empty prior", &prior_table,
                                     kPriorObjects}};
  return methods;
}

void open_prior_type(lua_State* state) {
  static const Binding methods[] = {
      {"look", &guarded<look>, "(look: @)",
       "integrates depth images of a scene into its map and its points", &look_table,
       kSurfaceObject},
      {"open_air", &guarded<open_air>, "(box: @)",
       "marks a box as free; measurements in it are kept", &box_table, kFlownIn},
      {"simplify", &guarded<simplify>, "()",
       "the map keeps the states of its voxels, not their probabilities, and takes less memory"},
      {"load", &guarded<load_prior>, "(files: @)", "loads map and mesh of an earlier flight",
       &earlier_table},
      {"reconstruct", &guarded<reconstruct>, "(settings: @)",
       "reconstructs its mesh from all images", &reconstruct_table}};
  define_type<PriorObject>(state, kPriorType,
                           {methods, photo_methods_of_prior(), site_methods_of_prior()},
                           &guarded<prior_field>);
  note_fields(state, kPriorType, kPriorFields);
}

}  // namespace lapwing
