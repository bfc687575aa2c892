// SPDX-License-Identifier: Apache-2.0
// The graph of views that tours are planned on.
#include <algorithm>
#include <cmath>

#include <lua.hpp>

#include "framework/core/log.h"
#include "framework/core/parallel.h"
#include "framework/core/units.h"
#include "framework/mission/graph_change.h"
#include "framework/mission/guard.h"
#include "framework/mission/hidden_parts.h"
#include "framework/mission/lua_value.h"
#include "framework/mission/scan_objects.h"

namespace lapwing {

namespace {

const Vehicle& vehicle_argument(lua_State* state, int table) {
  lua_getfield(state, table, "vehicle");
  return object_argument<Vehicle>(state, -1, kVehicleType);
}

ParameterTable candidates_table() {
  const CandidateSettings standard;
  ParameterTable table;
  table.integer("most", standard.most, "views", between(1, 100000))
      .integer("least", standard.least, "number below which random free places are added",
               between(0, 100000))
      .integer("directions", standard.directions,
               "viewing directions per place, if there are many places", between(1, 1000))
      .number("step", standard.step, "m", "distance of neighbouring places at the region", above(0))
      .number("step_growth", standard.step_growth, "",
              "growth of that distance, per metre from the region", at_least(0))
      .number("distance_apart", standard.distance_apart, "m",
              "smallest distance of two candidates, unless their angle differs", above(0))
      .number("angle_apart_deg", 15, "deg",
              "smallest angle of two candidates, unless their place differs", between(0, 180))
      .number("pitch_min_deg", -90, "deg", "lowest pitch of the camera", between(-90, 0))
      .number("pitch_max_deg", 0, "deg", "highest", between(-90, 90));
  return table;
}

ParameterTable motions_table() {
  const MotionSettings standard;
  ParameterTable table;
  table
      .integer("neighbours", standard.neighbours,
               "number of matching views to which a view is connected", between(1, 1000))
      .integer("among", standard.among, "number of nearest views from which these are chosen",
               between(1, 100000))
      .number("alpha", standard.alpha, "", "smallest common content of connected views, (4.8)",
              between(0, 1))
      .number("longest_detour", standard.longest_detour, "",
              "longest path of a motion, in straight lines", at_least(1))
      .integer("coarse", ScanGraphSettings{}.coarse_across, "pixels per row of compared views",
               between(1, 10000));
  return table;
}

ParameterTable flight_table() {
  const PursuitSettings standard;
  ParameterTable table;
  table.number("speed", standard.speed, "m/s", "speed between views", above(0))
      .number("view_speed", standard.view_speed, "m/s", "near a view", above(0))
      .number("slow_within", standard.slow_within, "m",
              "distance from a view within which view_speed holds", above(0))
      .number("lookahead", standard.lookahead, "m", "distance of the pursued point", above(0))
      .number("acceleration", standard.acceleration, "m/s^2", "largest", above(0))
      .number("pause", 0.5, "s", "rest at a view, for the image", between(0, 60))
      .number("view_seconds", 3, "s", "time added to a leg for the view at its end", at_least(0))
      .boolean("smooth", false, "legs by a trajectory solver, instead of pure pursuit")
      .number("stray", SmoothLegSettings{}.stray, "m",
              "largest distance of a smooth leg from its path", above(0));
  return table;
}

ParameterTable ball_table() {
  ParameterTable table;
  table.required_numbers("position", 3, "m", "middle, world")
      .number("within", 1, "m", "radius", above(0));
  return table;
}

ParameterTable graph_table() {
  ParameterTable table;
  table.table("region", region_table(), "region of interest")
      .table("allowed", box_table(), "box for the centre of the vehicle")
      .tables("pinned", viewpoint_table(), "views that every tour is to take; each must be free")
      .tables("viewless", ball_table(),
              "balls where no view is taken; the needed starts may lie there")
      .tables("starts", viewpoint_table(), "places from which candidates grow, if they are free",
              true)
      .boolean("fixed", true,
               "tours begin at the first of the starts; false: at the first of those "
               "that are connected to most views")
      .integer("needed", 1, "number of starts, the first ones, that must be free", between(0, 1000))
      .boolean("loops", false,
               "tours begin and end at any of the needed starts; false: at the first one, and "
               "end at the second one, if it is needed")
      .numbers("body", {1, 1, 0.5}, "m", "half edges of the vehicle's box")
      .number("mesh_room", 1, "m", "additional distance from the prior mesh", at_least(0))
      .table("candidates", candidates_table(), "candidate views")
      .table("motions", motions_table(), "motions between views")
      .table("camera", pinhole_table(), "camera of the images")
      .integer("across", 0, "pixels per row in the evaluation of candidates; 0: all",
               between(0, 10000))
      .number("range", 60, "m", "length of a ray", above(0))
      .optional_number("usable_range", "m",
                       "distance beyond which an image shows nothing of use; absent: any", above(0))
      .number("usable_incidence_deg", 90, "deg",
              "known angle of incidence beyond which an image shows nothing of use",
              {.minimum = 0, .maximum = 90, .minimum_excluded = true})
      .table("flight", flight_table(), "speeds along a tour")
      .boolean("each", false, "every view scores 1, whatever it shows");
  return table;
}

Eigen::Vector3d vector3_of(std::span<const double> numbers) {
  return {numbers[0], numbers[1], numbers[2]};
}

ScanGraphSettings graph_settings(const Parameters& given, const MissionRun& run) {
  ScanGraphSettings s;
  const Parameters& candidates = given.table("candidates");
  const InterestRegion region = region_of(given.table("region"));
  s.candidates.region = region.bounds();
  for (const RegionPrism& prism : region.prisms())
    s.candidates.aims.push_back({prism.bounds(), prism.weight * prism.area()});
  s.candidates.allowed = box_of(given.table("allowed"), "the box for the vehicle");
  s.candidates.half = vector3_of(given.numbers("body"));
  s.candidates.step = candidates.number("step");
  s.candidates.step_growth = candidates.number("step_growth");
  s.candidates.distance_apart = candidates.number("distance_apart");
  s.candidates.angle_apart = radians(candidates.number("angle_apart_deg"));
  s.candidates.pitch_min = radians(candidates.number("pitch_min_deg"));
  s.candidates.pitch_max = radians(candidates.number("pitch_max_deg"));
  s.candidates.most = static_cast<int>(candidates.integer("most"));
  s.candidates.least = static_cast<int>(candidates.integer("least"));
  for (const Parameters& ball : given.tables("viewless"))
    s.candidates.viewless.push_back({vector3_of(ball.numbers("position")), ball.number("within")});
  s.candidates.directions = static_cast<int>(candidates.integer("directions"));
  const Parameters& motions = given.table("motions");
  s.motions.allowed = s.candidates.allowed;
  s.motions.half = s.candidates.half;
  s.motions.neighbours = static_cast<int>(motions.integer("neighbours"));
  s.motions.among = static_cast<int>(motions.integer("among"));
  s.motions.alpha = motions.number("alpha");
  s.motions.longest_detour = motions.number("longest_detour");
  s.coarse_across = static_cast<int>(motions.integer("coarse"));
  s.seed = run.settings.seed;
  s.threads = run.settings.threads;
  return s;
}

// The first `needed` must be free; of the others those count that are.
std::vector<Viewpoint> free_starts(const std::vector<Parameters>& given, std::size_t needed,
                                   bool loops, const FreeSpace& space,
                                   const CandidateSettings& settings, const FlightRules& rules) {
  std::vector<Viewpoint> starts;
  for (const Parameters& entry : given) {
    const Viewpoint view = viewpoint_of(entry);
    const Eigen::Vector3d& p = view.position;
    const bool needed_here = starts.size() < needed;
    const bool free = settings.allowed.contains(p) && space.swept_box_free(p, p, settings.half);
    if (free && (needed_here || !is_viewless(settings.viewless, p))) starts.push_back(view);
    if (free || starts.size() >= needed) continue;
    char text[300];
    std::snprintf(
        text, sizeof text,
        "no free %s: at (%.4g, %.4g, %.4g) the map does not show free space "
        "for a box of %.3g x %.3g x %.3g m%s",
        starts.empty() || loops ? "start" : "finish", p.x(), p.y(), p.z(), 2 * settings.half.x(),
        2 * settings.half.y(), 2 * settings.half.z(),
        settings.allowed.contains(p) ? "" : ", and it lies outside the space of the tour");
    const std::string forbidden = forbidden_by(rules, p, settings.half);
    const std::string why = !forbidden.empty() ? ", and " + forbidden
                            : rules.pilot      ? ", or the pilot does not see this place"
                                               : "";
    throw InputError(entry.origin(), text + why);
  }
  if (starts.empty() && given.empty()) throw InputError("no free start: none is given");
  const bool hidden = std::any_of(given.begin(), given.end(), [&](const Parameters& entry) {
    return is_viewless(settings.viewless, viewpoint_of(entry).position);
  });
  if (starts.empty() && hidden)
    throw InputError("no free start: none of " + std::to_string(given.size()) +
                     " places is free and outside of the balls where views are forbidden");
  if (starts.empty())
    throw InputError("no free start: none of " + std::to_string(given.size()) + " places is free" +
                     (rules.empty() ? "" : " and allowed by the zones and the pilot's sight"));
  return starts;
}

// Adds the pinned views behind the starts; every one must be free.
void add_pinned(const std::vector<Parameters>& given, const FreeSpace& space,
                const CandidateSettings& settings, const FlightRules& rules,
                std::vector<Viewpoint>& starts, std::vector<int>& pinned) {
  for (std::size_t k = 0; k < given.size(); ++k) {
    const Viewpoint view = viewpoint_of(given[k]);
    const Eigen::Vector3d& p = view.position;
    std::string why = is_viewless(settings.viewless, p) ? "it lies where views are forbidden"
                                                        : forbidden_by(rules, p, settings.half);
    if (why.empty() && !settings.allowed.contains(p)) why = "it lies outside the space of the tour";
    if (why.empty() && !space.swept_box_free(p, p, settings.half))
      why = "map and mesh leave the vehicle no room there";
    if (!why.empty()) {
      char place[120];
      std::snprintf(place, sizeof place, "pinned view %zu at (%.4g, %.4g, %.4g): ", k + 1, p.x(),
                    p.y(), p.z());
      throw InputError(given[k].origin(), place + why);
    }
    pinned.push_back(static_cast<int>(starts.size()));
    starts.push_back(view);
  }
}

// The graph, into the work. What sees nothing says what the rules have to do with it.
void make_graph(ScanWork& work, const FreeSpace& space, const VisibleVoxels& visible,
                const std::vector<Viewpoint>& starts, const ScanGraphSettings& settings,
                const MissionRun& run) {
  try {
    work.graph = make_scan_graph(space, visible, *work.information, starts, settings,
                                 run.settings.cancellation, run.settings.progress);
  } catch (const NothingSeen& error) {
    if (work.rules->empty()) throw;
    throw InputError(std::string(error.what()) +
                     ", or the zones and the pilot's sight allow no place that sees it: "
                     "100 % of it stays unseen");
  }
}

// What each motion takes.
std::vector<double> seconds_of_motions(const ScanWork& work, int threads,
                                       const CancellationToken* cancellation) {
  const auto& motions = work.graph.motions.motions;
  const auto& views = work.graph.candidates.viewpoints;
  std::vector<double> seconds(motions.size(), 0);
  parallel_for(motions.size(), threads, [&](std::size_t k) {
    if (cancellation && cancellation->cancelled()) return;
    const ViewMotion& motion = motions[k];
    seconds[k] = work.LegFlight::seconds(motion.points, views[static_cast<std::size_t>(motion.a)],
                                         views[static_cast<std::size_t>(motion.b)]);
  });
  if (cancellation && cancellation->cancelled()) throw Cancelled();
  return seconds;
}

constexpr BoundField kGraphObjects[] = {
    {"prior", "lapwing.prior", "known map and mesh"},
    {"vehicle", "lapwing.vehicle", "vehicle"},
    {"rules?", "lapwing.flight_rules", "zones and a pilot that the flight keeps"},
    {"information", "lapwing.information", "information of a view about a voxel"},
    {"planner", "lapwing.path_planner", "planner of paths around obstacles"},
    {"like?", "lapwing.scan_graph",
     "graph of another region, other zones or starts, on the same prior: for an estimate its views "
     "and motions are kept as far as they are allowed, and none are looked for"}};

constexpr BoundField kTileObjects[] = {
    kGraphObjects[0], kGraphObjects[1],
    kGraphObjects[2], kGraphObjects[3],
    kGraphObjects[4], {"solver", "lapwing.tour_solver", "solver of the tour that chooses views"}};

void log_graph(const std::string& what, const ScanGraph& graph) {
  logging::info(what + ": " + std::to_string(graph.candidates.viewpoints.size()) + " (" +
                std::to_string(graph.candidates.blocked) + " places blocked, " +
                std::to_string(graph.candidates.crowded) +
                " too near to others); motions: " + std::to_string(graph.motions.motions.size()) +
                " of " + std::to_string(graph.motions.tried) + " (" +
                std::to_string(graph.motions.unmatched) + " unmatched, " +
                std::to_string(graph.motions.blocked) + " blocked, " +
                std::to_string(graph.motions.planned) +
                " around obstacles); voxels: " + std::to_string(graph.voxels.size()) +
                "; memory of the score: " + std::to_string(graph.score->bytes() >> 20) + " MiB");
}

// All that a graph is made of, as its table has it.
struct GraphMaking {
  std::shared_ptr<ScanWork> work;
  ScanGraphSettings settings;
  std::shared_ptr<PathPlanner> planner;
  std::shared_ptr<const VisibleVoxels> sight;
  std::unique_ptr<FreeSpace> space;
};

// `within`: of a part of the region, else null.
GraphMaking graph_making(lua_State* state, const MissionRun& run, const Parameters& given,
                         const Eigen::AlignedBox3d* within = nullptr) {
  GraphMaking made;
  lua_getfield(state, 2, "prior");
  made.work = std::make_shared<ScanWork>();
  ScanWork& work = *made.work;
  work.prior = object_argument<PriorObject>(state, -1, kPriorType).prior;
  if (!work.prior->mesh) throw InputError("scan_graph: the prior has no mesh; reconstruct it");
  work.vehicle = vehicle_argument(state, 2);
  work.rules = rules_argument(state, 2);
  const PluginChoice information = choice_at(state, 2, "information");
  const PluginChoice planner = choice_at(state, 2, "planner");
  made.settings = graph_settings(given, run);
  made.planner =
      run.settings.registry->create<PathPlanner>(planner.type, planner.parameters, "planner");
  made.settings.motions.planner = made.planner.get();
  made.settings.motions.search_near = !work.rules->empty();
  const Parameters& flight = given.table("flight");
  work.flight = {.speed = flight.number("speed"),
                 .view_speed = flight.number("view_speed"),
                 .slow_within = flight.number("slow_within"),
                 .lookahead = flight.number("lookahead"),
                 .acceleration = flight.number("acceleration"),
                 .stop = true,
                 .pause = flight.number("pause")};
  work.view_seconds = flight.number("view_seconds");
  if (flight.boolean("smooth"))
    work.smooth = {work.flight.speed, work.flight.acceleration, flight.number("stray")};
  const Sandbox::ClockPause pause(Sandbox::of(state));
  made.sight = make_sight(work, run, given, information, within);
  made.space =
      ruled(space_of(*work.prior, given.number("mesh_room")), *work.rules, work.prior->mapping.map);
  work.allowed = made.settings.candidates.allowed;
  work.body = made.settings.candidates.half;
  work.mesh_room = given.number("mesh_room");
  return made;
}

// run:scan_graph{prior =, vehicle =, region =, allowed =, starts =, ...}
int scan_graph_of_run(lua_State* state) {
  MissionRun& run = run_of(state);
  const Parameters given = table_argument(state, 2, graph_table(), "scan_graph", kGraphObjects);
  lua_getfield(state, 2, "like");
  const auto* like = test_object<GraphObject>(state, -1, kGraphType);
  if (like) require_known(*like->work, region_of(given.table("region")), run);
  const GraphMaking made = graph_making(state, run, given);
  const std::shared_ptr<ScanWork>& work = made.work;
  const ScanGraphSettings& settings = made.settings;
  const Sandbox::ClockPause pause(Sandbox::of(state));
  const bool begun = like && given.tables("starts").empty();  // at those of the graph before
  std::vector<Viewpoint> starts =
      begun ? std::vector<Viewpoint>()
            : free_starts(given.tables("starts"), static_cast<std::size_t>(given.integer("needed")),
                          given.boolean("loops"), *made.space, settings.candidates, *work->rules);
  const std::size_t first_pinned = starts.size();
  add_pinned(given.tables("pinned"), *made.space, settings.candidates, *work->rules, starts,
             work->pinned);
  if (like) {
    const std::vector<Viewpoint> pinned(starts.begin() + static_cast<std::ptrdiff_t>(first_pinned),
                                        starts.end());
    starts.resize(first_pinned);
    change_graph(*like->work, *work, *made.space, *made.sight, starts, pinned, settings,
                 run.settings.cancellation);
  } else {
    begin_planning(run);
    make_graph(*work, *made.space, *made.sight, starts, settings, run);
  }
  if (given.boolean("each"))
    work->graph.score = std::make_shared<const ViewScore>(
        additive_score(std::vector<double>(work->graph.candidates.viewpoints.size(), 1)));
  if (!work->pinned.empty())
    work->pinned_score =
        std::make_shared<const ViewScore>(with_bonus(*work->graph.score, work->pinned));
  if (!work->rules->empty() && !like)
    work->hidden =
        hidden_parts(*work, *space_of(*work->prior, given.number("mesh_room")), *made.sight, starts,
                     settings, work->forbidden, run.settings.cancellation);
  work->seconds = seconds_of_motions(*work, settings.threads, run.settings.cancellation);
  const ScanGraph& graph = work->graph;
  work->islands = ViewIslands(graph.candidates.viewpoints.size(), graph.motions.motions);
  if (!given.boolean("fixed"))
    work->home =
        work->islands.best_start(graph.candidates.given - static_cast<int>(work->pinned.size()));
  log_graph("candidates", graph);
  new_object(state, kGraphType, GraphObject{made.work});
  return 1;
}

ParameterTable tile_table() {
  ParameterTable table = graph_table();
  table.table("tile", box_table(), "part of the region; what is beside it counts nothing")
      .required_number("budget", "s", "flight time of the tour that chooses views", above(0))
      .integer("iterations", 0, "iterations of the solver; 0: its default", at_least(0));
  return table;
}

// The views of a tour, each once, in their order.
Value views_of(const std::vector<Viewpoint>& views, std::vector<int> walk) {
  std::sort(walk.begin(), walk.end());
  walk.erase(std::unique(walk.begin(), walk.end()), walk.end());
  Value list = Value::list();
  for (const int number : walk) {
    const Viewpoint& view = views[static_cast<std::size_t>(number)];
    Value entry = Value::map();
    Value& position = entry.set("position", Value::list());
    for (int axis = 0; axis < 3; ++axis) position.push_back(view.position[axis]);
    entry.set("yaw", view.yaw);
    entry.set("pitch", view.pitch);
    list.push_back(std::move(entry));
  }
  return list;
}

// Candidates of a part of a large region, of which one tour chooses; all else is given up again.
Value chosen_views(GraphMaking& made, const Parameters& given, const TourSolver& solver,
                   const MissionRun& run) {
  ScanWork& work = *made.work;
  const ScanGraphSettings& settings = made.settings;
  std::vector<Viewpoint> starts;
  for (const Parameters& entry : given.tables("starts")) {
    const Viewpoint view = viewpoint_of(entry);
    if (settings.candidates.allowed.contains(view.position) &&
        made.space->swept_box_free(view.position, view.position, settings.candidates.half))
      starts.push_back(view);
  }
  if (starts.empty()) return Value::list();
  try {
    work.graph = make_scan_graph(*made.space, *made.sight, *work.information, starts, settings,
                                 run.settings.cancellation);
  } catch (const NothingSeen&) {
    return Value::list();
  }
  work.seconds = seconds_of_motions(work, settings.threads, run.settings.cancellation);
  work.islands = ViewIslands(work.graph.candidates.viewpoints.size(), work.graph.motions.motions);
  work.home = work.islands.best_start(work.graph.candidates.given);
  log_graph("tile", work.graph);
  TourDefinition definition = tour_definition(work, "tile_views");
  definition.budget = given.number("budget");
  TourRequest request;
  request.seed = run.settings.seed;
  request.bound = false;
  if (given.integer("iterations") > 0) request.iteration_limit = given.integer("iterations");
  request.cancellation = run.settings.cancellation;
  const TourResult result = solver.solve(TourProblem(std::move(definition)), request);
  if (result.report.status == TourStatus::failed) throw PluginError(result.report.message);
  if (run.settings.cancellation && run.settings.cancellation->cancelled()) throw Cancelled();
  return views_of(work.graph.candidates.viewpoints, result.walk);
}

// run:tile_views{tile =, budget =, solver =, ... as scan_graph}: {{position =, yaw =, pitch =}}
int tile_views_of_run(lua_State* state) {
  MissionRun& run = run_of(state);
  const Parameters given = table_argument(state, 2, tile_table(), "tile_views", kTileObjects);
  const Eigen::AlignedBox3d tile = box_of(given.table("tile"), "the part of the region");
  const PluginChoice chosen = choice_at(state, 2, "solver");
  const auto solver =
      run.settings.registry->create<TourSolver>(chosen.type, chosen.parameters, "tour.solver");
  GraphMaking made = graph_making(state, run, given, &tile);
  begin_planning(run);
  CandidateSettings& candidates = made.settings.candidates;
  const std::vector<ViewAim> aims = std::move(candidates.aims);
  candidates.region = candidates.region.intersection(tile);
  candidates.aims.clear();
  for (const ViewAim& aim : aims)
    if (const Eigen::AlignedBox3d part = aim.box.intersection(tile); !part.isEmpty())
      candidates.aims.push_back({part, aim.share * part.volume() / aim.box.volume()});
  const bool empty = candidates.region.isEmpty() || (!aims.empty() && candidates.aims.empty());
  const Sandbox::ClockPause pause(Sandbox::of(state));
  push_value(state, empty ? Value::list() : chosen_views(made, given, *solver, run));
  return 1;
}

// "12 of 300 candidates are connected to the start by motions; 200 are connected to a start near
// (1.5, 20, 8)": the last where they are more.
std::string reach_in_words(const ScanWork& work, int start) {
  std::string text = std::to_string(work.islands.joined(start)) + " of " +
                     std::to_string(work.graph.candidates.viewpoints.size()) +
                     " candidates are connected to the start by motions";
  const auto& views = work.graph.candidates.viewpoints;
  const auto other = work.islands.largest_beside(start, views);
  if (other && other->views > work.islands.joined(start)) {
    const Eigen::Vector3d& p = views[static_cast<std::size_t>(other->middle)].position;
    char place[100];
    std::snprintf(place, sizeof place, " are connected to a start near (%.4g, %.4g, %.4g)", p.x(),
                  p.y(), p.z());
    text += "; " + std::to_string(other->views) + place;
  }
  return text;
}

constexpr BoundField kGraphFields[] = {
    {"candidates", "integer", "views"},
    {"motions", "integer", "number of motions between two views"},
    {"planned", "integer", "number of motions around obstacles"},
    {"unmatched", "integer", "pairs whose images do not match"},
    {"blocked", "integer", "pairs without a free path"},
    {"voxels", "integer", "number of scored voxels"},
    {"total", "number", "score of full information about all voxels"},
    {"home", "integer", "candidate at which tours begin, from 1"},
    {"joined", "integer", "number of views connected to `home`, including itself"},
    {"joined_from", "integer[]",
     "the same of each of the free starts, in their order, then of each pinned view"},
    {"reach", "string", "sentence with the number of views connected to the start"},
    {"hidden", "table[]",
     "what zones and the pilot's sight hide: {name, visible, hidden}, m^2 of the known surface; "
     "the first one of all regions together, name ''"}};

int graph_field(lua_State* state) {
  const ScanWork& work = *object_argument<GraphObject>(state, 1, kGraphType).work;
  const ScanGraph& graph = work.graph;
  Value fields = Value::map();
  fields.set("candidates", static_cast<std::int64_t>(graph.candidates.viewpoints.size()));
  fields.set("motions", static_cast<std::int64_t>(graph.motions.motions.size()));
  fields.set("planned", graph.motions.planned);
  fields.set("unmatched", graph.motions.unmatched);
  fields.set("blocked", graph.motions.blocked);
  fields.set("voxels", static_cast<std::int64_t>(graph.voxels.size()));
  fields.set("total", graph.score->total());
  fields.set("home", static_cast<std::int64_t>(work.home + 1));
  fields.set("joined", work.islands.joined(work.home));
  Value& joined_from = fields.set("joined_from", Value::list());
  for (int start = 0; start < graph.candidates.given; ++start)
    joined_from.push_back(std::int64_t{work.islands.joined(start)});
  fields.set("reach", reach_in_words(work, work.home));
  Value& hidden = fields.set("hidden", Value::list());
  for (const HiddenPart& part : work.hidden) {
    Value entry = Value::map();
    entry.set("name", part.name);
    entry.set("visible", part.visible);
    entry.set("hidden", part.hidden);
    hidden.push_back(std::move(entry));
  }
  const std::string field = text_argument(state, 2, "scan graph");
  return push_field(state, "a scan graph", field, fields, kGraphFields);
}

}  // namespace

void open_graph_type(lua_State* state) {
  define_type<GraphObject>(state, kGraphType, {}, &guarded<graph_field>);
  note_fields(state, kGraphType, kGraphFields);
}

std::span<const Binding> graph_methods_of_run() {
  static const Binding methods[] = {
      {"scan_graph", &guarded<scan_graph_of_run>, "(settings: @): lapwing.scan_graph",
       "candidate views of a region, and motions between them", &graph_table, kGraphObjects},
      {"tile_views", &guarded<tile_views_of_run>, "(settings: @): table[]",
       "views of one tour over a part of a large region: {position, yaw, pitch}; none where "
       "nothing is free, or nothing is seen",
       &tile_table, kTileObjects}};
  return methods;
}

}  // namespace lapwing
