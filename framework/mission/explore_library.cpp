// SPDX-License-Identifier: Apache-2.0
#include "framework/mission/explore_library.h"

#include <cmath>

#include <lua.hpp>

#include "framework/core/number_text.h"
#include "framework/core/units.h"
#include "framework/explore/episode_replay.h"
#include "framework/geometry/depth_smoothing.h"
#include "framework/map/map_file.h"
#include "framework/mission/exploration.h"
#include "framework/mission/guard.h"
#include "framework/mission/lua_value.h"
#include "framework/mission/map_objects.h"
#include "framework/mission/value_path.h"
#include "framework/mission/vectors.h"

namespace lapwing {
ParameterTable explore_table() {
  ParameterTable camera;
  camera.integer("width", 160, "pixels", between(1, 10000))
      .integer("height", 120, "pixels", between(1, 10000))
      .number("view_deg", 90, "deg", "angle across", {1, 170})
      .number("pitch_deg", -10, "deg", "positive up", between(-89, 89));
  ParameterTable noise;
  noise.number("dropped", 0, "", "fraction of pixels without a measurement", between(0, 1))
      .number("sigma", 0, "m", "standard deviation of the depth", between(0, 100))
      .number("smooth_to", 0, "m",
              "standard deviation to which the noise is smoothed before depth is mapped; 0: it is "
              "not",
              between(0, 100));
  ParameterTable start;
  start.required_numbers("position", 3, "m", "world").number("yaw", 0, "rad", "heading");
  ParameterTable bounds;
  bounds.required_numbers("lower", 3, "m", "corner").required_numbers("upper", 3, "m", "corner");
  const EpisodeSettings standard;
  ParameterTable table;
  table.table("camera", camera, "pinhole camera")
      .table("noise", noise, "noise of the sensor")
      .optional_number("stereo_baseline", "m",
                       "distance of a pair of cameras, which measures depth", above(0))
      .number("range", standard.sensor.range, "m", "largest depth", above(0))
      .number("step", standard.step, "m", "step to a neighbour", above(0))
      .number("turn_deg", 25, "deg", "turn to a neighbour", between(1, 180))
      .number("body", standard.body, "m", "edge of the box that must be free", above(0))
      .number("clear", standard.clear, "m", "edge of the box that is free at the start", above(0))
      .integer("visits", standard.visits, "largest number of images from a viewpoint",
               between(1, 100))
      .choice("efficiency", "images", {"images", "seconds"},
              "what the views are chosen for: surface for each image, or for each second of flight")
      .integer("lookahead", 1, "length of the evaluated view sequences",
               between(1, EpisodeSettings::kMostLookahead))
      .integer("steps", standard.steps, "images", between(1, 1000000))
      .number("speed", standard.speed, "m/s", "speed between viewpoints", above(0))
      .number("turn_rate_deg", 60, "deg/s", "turn rate on the spot", above(0))
      .number("acceleration", 0, "m/s^2", "of moves from rest to rest; 0: at once", at_least(0))
      .number("turn_acceleration_deg", 0, "deg/s^2", "likewise, of turns", at_least(0))
      .number("pause", standard.pause, "s", "pause for an image", at_least(0))
      .optional_number("budget", "s", "flight time", above(0))
      .optional_number("wall_clock_guard", "s", "limit of computing time", above(0))
      .tables("bounds", bounds, "bounding box of the flight, at most one")
      .tables("start", start, "start, at most one; none: drawn with the seed of the run")
      .boolean("ground", false, "add a ground plane under the surface, and explore above it")
      .boolean("compare", false, "run the oracle from the same start");
  return table;
}

namespace {

constexpr const char* kExplorationType = "exploration";
struct ExplorationObject {
  std::shared_ptr<Exploration> exploration;
};

EpisodeSettings settings_of(const Parameters& given, const MissionRun& run) {
  EpisodeSettings s;
  const Parameters& camera = given.table("camera");
  s.sensor.pinhole = centered_pinhole(static_cast<int>(camera.integer("width")),
                                      static_cast<int>(camera.integer("height")),
                                      radians(camera.number("view_deg")));
  s.sensor.range = given.number("range");
  const Parameters& noise = given.table("noise");
  if (noise.number("dropped") > 0 || noise.number("sigma") > 0)
    s.sensor.noise = DepthNoise{noise.number("dropped"), noise.number("sigma")};
  s.sensor.smooth_to = noise.number("smooth_to");
  if (s.sensor.smooth_to > 0)
    if (const std::string why =
            why_not_smoothed(noise.number("sigma"), s.sensor.smooth_to, noise.number("dropped"));
        !why.empty())
      throw InputError(noise.origin("smooth_to"), "smooth_to: " + why);
  if (given.has("stereo_baseline")) {
    s.sensor.stereo.emplace();
    s.sensor.stereo->baseline = given.number("stereo_baseline");
  }
  s.step = given.number("step");
  s.turn = radians(given.number("turn_deg"));
  s.body = given.number("body");
  s.clear = given.number("clear");
  s.visits = static_cast<int>(given.integer("visits"));
  s.per_second = given.text("efficiency") == "seconds";
  s.lookahead = static_cast<int>(given.integer("lookahead"));
  s.steps = static_cast<int>(given.integer("steps"));
  s.speed = given.number("speed");
  s.turn_rate = radians(given.number("turn_rate_deg"));
  s.acceleration = given.number("acceleration");
  s.turn_acceleration = radians(given.number("turn_acceleration_deg"));
  s.pause = given.number("pause");
  if (given.has("budget")) s.budget = given.number("budget");
  if (given.has("wall_clock_guard")) s.wall_clock_guard = given.number("wall_clock_guard");
  const auto& bounds = given.tables("bounds");
  if (bounds.size() > 1) throw InputError(given.origin("bounds"), "bounds: at most one box");
  if (bounds.size() == 1) {
    s.bounds.emplace(vector_of(bounds[0].numbers("lower")), vector_of(bounds[0].numbers("upper")));
    if (!((s.bounds->sizes().array() > 0).all()))
      throw InputError(given.origin("bounds"), "bounds: lower must be below upper");
  }
  s.seed = run.settings.seed;
  s.threads = run.settings.threads;
  s.cancellation = run.settings.cancellation;
  s.progress = run.settings.progress;
  return s;
}

// -- exploration:plan ----------------------------------------------------------------------------

ParameterTable explored_plan_table() {
  ParameterTable table;
  table
      .number("margin", 0.4, "m", "distance from obstacles that the certificate requires",
              at_least(0))
      .text("note", "", "sentence for the user");
  return table;
}

int plan_exploration(lua_State* state) {
  MissionRun& run = run_of(state);
  const std::shared_ptr<Exploration> flown =
      object_argument<ExplorationObject>(state, 1, kExplorationType).exploration;
  const Exploration& e = *flown;
  const Parameters given = table_argument(state, 2, explored_plan_table(), "plan", kVehicleObject);
  // A ball within the box that was kept free.
  if (given.number("margin") > e.settings.body / 2)
    throw InputError(given.origin("margin"), "margin: at most half of the body's edge, " +
                                                 plain_number(e.settings.body / 2) + " m");
  lua_getfield(state, 2, "vehicle");
  const Vehicle& vehicle = object_argument<Vehicle>(state, -1, kVehicleType);
  PlanObject made;
  made.solver = e.record.utility;
  made.report.status = e.result.end == EpisodeEnd::cancelled ? SolveStatus::cancelled
                       : e.result.steps.empty()              ? SolveStatus::infeasible
                       : e.result.end == EpisodeEnd::time    ? SolveStatus::time_limit
                                                             : SolveStatus::feasible;
  made.report.iterations = static_cast<int>(e.result.steps.size());
  made.report.message =
      (e.result.steps.empty() ? "no image was taken: " : "") + explain(e.result.end);
  made.notes.push_back(std::to_string(e.result.steps.size()) + " images: " + explain(e.result.end));
  if (!given.text("note").empty()) made.notes.push_back(given.text("note"));
  made.block_name = "exploration";
  made.block = Value::map();
  made.block.set("efficiency", e.record.efficiency);
  made.block.set("observed_surface", e.result.observed());
  made.block.set("surface", e.result.surface);
  made.block.set("images", static_cast<std::int64_t>(e.result.steps.size()));
  made.block.set("length", e.result.length());
  made.block.set("end", to_string(e.result.end));
  if (e.record.oracle_efficiency > 0)
    made.block.set("relative_efficiency", e.record.efficiency / e.record.oracle_efficiency);
  made.sections = exploration_sections(e.record);
  made.exploration = std::shared_ptr<const ExplorationRecord>(flown, &e.record);

  Plan& document = made.plan;
  document.mission = run.name;
  document.kind = run.kind;
  document.vehicle = to_value(vehicle);
  document.trajectory = trajectory_of(e, vehicle);
  document.budget = e.settings.budget;
  document.geodetic_origin = run.origin;
  document.home = run.home;
  document.configuration = run.configuration;
  document.solver = to_value(made.report, made.solver);
  Obstacle obstacle;
  obstacle.name = "explored map";
  obstacle.type = "map";
  obstacle.parameters.set("file", "map.ot");
  obstacle.parameters.set("sha256", run.obstacles.keep("map.ot", map_file_bytes(".ot", *e.map)));
  document.environment.obstacles.push_back(std::move(obstacle));
  document.environment.margin = given.number("margin");
  new_object(state, kPlanType, std::move(made));
  return 1;
}

Value triple_of(const Eigen::Vector3d& v) {
  Value list = Value::list();
  for (int i = 0; i < 3; ++i) list.push_back(v[i]);
  return list;
}

Value viewpoint_value(const Viewpoint& view) {
  Value value = Value::map();
  value.set("position", triple_of(view.position));
  value.set("yaw", view.yaw);
  value.set("pitch", view.pitch);
  return value;
}

constexpr BoundField kExplorationFields[] = {
    {"end", "string", "reason of the end, as one word"},
    {"reason", "string", "reason of the end, as a sentence"},
    {"images", "integer", "number of images"},
    {"efficiency", "number",
     "the observed surface summed over images (thesis 5.6), or its mean over the flight"},
    {"observed_surface", "number", "observed voxels of the surface at the end"},
    {"surface", "number", "visible voxels of the surface"},
    {"length", "number", "length of the path, m"},
    {"flight", "number", "flight time in s, images included"},
    {"seconds", "number", "computing time in s"},
    {"relative", "number?",
     "efficiency relative to the oracle from the same start, with `compare`"},
    {"views", "table[]", "{position, yaw, pitch} of every image, m and rad"},
    {"cleared", "table", "box assumed free at the start: {lower, upper}, m"}};

int exploration_field(lua_State* state) {
  const Exploration& e =
      *object_argument<ExplorationObject>(state, 1, kExplorationType).exploration;
  const std::string field = text_argument(state, 2, "exploration");
  Value fields = Value::map();
  fields.set("end", to_string(e.result.end));
  fields.set("reason", explain(e.result.end));
  fields.set("images", static_cast<std::int64_t>(e.result.steps.size()));
  fields.set("efficiency", e.record.efficiency);
  fields.set("observed_surface", e.result.observed());
  fields.set("surface", e.result.surface);
  fields.set("length", e.result.length());
  fields.set("flight",
             e.result.steps.empty() ? 0.0 : e.result.steps.back().time + e.settings.pause);
  fields.set("seconds", e.seconds);
  fields.set("relative", e.record.oracle_efficiency > 0
                             ? Value(e.record.efficiency / e.record.oracle_efficiency)
                             : Value());
  Value& views = fields.set("views", Value::list());
  for (const EpisodeStep& step : e.result.steps) views.push_back(viewpoint_value(step.view));
  Value& cleared = fields.set("cleared", Value::map());
  const Eigen::AlignedBox3d box = cleared_box(e.map->grid(), e.start.position, e.settings.clear);
  // Within the voxels at its ends.
  const double inside = e.map->grid().resolution() / 2;
  cleared.set("lower", triple_of(box.min().array() + inside));
  cleared.set("upper", triple_of(box.max().array() - inside));
  return push_field(state, "an exploration", field, fields, kExplorationFields);
}

// The world that is explored, and the region of interest in it.
GroundTruth truth_for(const SurfaceObject& surface, const Parameters& given, double resolution) {
  std::shared_ptr<const MeshScene> scene = surface.scene;
  Eigen::AlignedBox3d region = surface.region;
  if (given.boolean("ground")) {
    OpenWorld open = with_floor(scene->mesh());
    scene = std::make_shared<MeshScene>(std::move(open.mesh), surface.name);
    region = open.region;
  }
  const auto& starts = given.tables("start");
  std::optional<Eigen::Vector3d> inside;
  if (!starts.empty()) inside = vector_of(starts[0].numbers("position"));
  return {std::move(scene), region, resolution, inside};
}

Viewpoint start_in(const GroundTruth& truth, const Parameters& given,
                   const EpisodeSettings& settings, std::uint64_t seed) {
  const double pitch = radians(given.table("camera").number("pitch_deg"));
  const auto& starts = given.tables("start");
  if (!starts.empty())
    return {vector_of(starts[0].numbers("position")), starts[0].number("yaw"), pitch};
  Random random(seed);
  return random_start(truth, settings.clear, settings.sensor.range / 2, pitch, random,
                      settings.bounds);
}

// With the options to set, as the mission calls them.
[[noreturn]] void fail_at_start(const StartError& error, const MissionRun& run) {
  const bool scan = at_path(run.configuration, "exploration") != nullptr;
  throw InputError(std::string(error.what()) + "; smaller moves may help: " +
                   (scan ? "--set exploration.clear=METRES"
                         : "--set moves.clear=METRES --set moves.step=METRES"));
}

void tell_image(const Exploration& e, const EpisodeMoment& moment,
                std::vector<Eigen::Vector3f> grown, const GroundTruth& truth,
                const MissionRun& run) {
  if (!run.settings.observe_image) return;
  const EpisodeStep& step = moment.taken;
  TakenImage image;
  image.utility = e.record.utility;
  image.image = moment.step + 1;
  image.asked = e.settings.steps;
  image.surface = static_cast<double>(truth.size());
  image.resolution = e.map->grid().resolution();
  image.taken = image_of(step);
  if (!e.settings.sensor.noise && !e.settings.sensor.stereo) image.observed = step.observed;
  image.grown = std::move(grown);
  image.sight = e.record.sights.back();
  run.settings.observe_image(image);
}

}  // namespace

int explore_surface(lua_State* state) try {
  MissionRun& run = run_of(state);
  const Parameters given = table_argument(state, 2, explore_table(), "explore", kExploreObjects);
  lua_getfield(state, 2, "surface");
  const SurfaceObject& surface = object_argument<SurfaceObject>(state, -1, kSurfaceType);
  lua_getfield(state, 2, "map");
  const PluginChoice map = plugin_choice(state, -1, "map");
  lua_getfield(state, 2, "utility");
  const PluginChoice chosen = plugin_choice(state, -1, "utility");
  const Registry& registry = *run.settings.registry;
  auto e = std::make_shared<Exploration>();
  e->settings = settings_of(given, run);
  e->settings.show_truth = needs_truth(registry, chosen.type);
  e->settings.list_candidates = true;
  if (given.tables("start").size() > 1)
    throw InputError(given.origin("start"), "start: at most one");
  const auto utility = registry.create<ViewUtility>(chosen.type, chosen.parameters, "utility");
  const auto new_map = [&registry, map] {
    return registry.create<Map>(map.type, map.parameters, "map");
  };
  e->map = new_map();
  const Sandbox::ClockPause pause(Sandbox::of(state));
  const GroundTruth truth = truth_for(surface, given, e->map->grid().resolution());
  e->start = start_in(truth, given, e->settings, run.settings.seed);
  std::shared_ptr<EpisodeReplay> replay;
  if (run.settings.observe_episode) {
    replay = std::make_shared<EpisodeReplay>(
        EpisodeWorld{e->settings, e->start, truth.shared_scene(), new_map});
    run.settings.observe_episode(replay);
    if (run.settings.episode_alone) throw Cancelled();
  }
  begin_planning(run);
  ObservedSurface observed(truth, e->settings.sensor, new_map);
  e->record.utility = chosen.type;
  e->record.cut = cut_height(truth.scene(), e->start);
  Moments moments(e->settings.steps, e->record.cut.value_or(HUGE_VAL));
  std::optional<Growth> growth;
  if (run.settings.record_steps) growth.emplace();
  e->result = explore(
      e->settings, e->start, truth, observed, *utility, *e->map,
      [&](const EpisodeMoment& moment) {
        moments.look(moment.step + 1, *e->map);
        if (replay) replay->took(moment.taken.view);
        if (growth) tell_image(*e, moment, growth->look(moment.step + 1, *e->map), truth, run);
      },
      [&](const EpisodeChoice& choice) {
        if (growth) e->record.sights.push_back(sight_of(choice.known, choice.view));
      });
  if (growth) e->record.growth = std::move(*growth).grown(*e->map);
  observe_truly(e->result, e->settings, truth, new_map);
  e->record.moments = std::move(moments).shown(static_cast<int>(e->result.steps.size()), *e->map);
  record_flight(*e);
  record_grids(*e);
  run.solve_seconds += e->seconds;
  const bool stopped = e->result.end == EpisodeEnd::cancelled || e->result.end == EpisodeEnd::time;
  if (given.boolean("compare") && !stopped) compare_with_oracle(*e, truth, new_map, registry);
  new_object(state, kExplorationType, ExplorationObject{std::move(e)});
  return 1;
} catch (const StartError& error) {
  fail_at_start(error, run_of(state));
}

std::vector<Section> sections_of_exploration(lua_State* state, int index) {
  const auto& object = object_argument<ExplorationObject>(state, index, kExplorationType);
  return exploration_sections(object.exploration->record);
}

bool needs_truth(const Registry& registry, const std::string& utility) {
  const auto& extensions = registry.find("utility", utility).extensions;
  return std::find(extensions.begin(), extensions.end(), kNeedsGroundTruth) != extensions.end();
}

void open_explore_library(lua_State* state) {
  static const Binding methods[] = {
      {"plan", &guarded<plan_exploration>, "(wanted: @): lapwing.plan",
       "the flown path as a plan, in its map", &explored_plan_table, kVehicleObject}};
  define_type<ExplorationObject>(state, kExplorationType, {methods}, &guarded<exploration_field>);
  note_fields(state, kExplorationType, kExplorationFields);
}

}  // namespace lapwing
