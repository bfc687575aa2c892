// SPDX-License-Identifier: Apache-2.0
// From a tour to a plan: stop-and-shoot along its motions, the images that it takes, what it has to
// keep away from.
#include <algorithm>
#include <cmath>

#include <lua.hpp>

#include "framework/core/parallel.h"
#include "framework/core/units.h"
#include "framework/export/small_camera.h"
#include "framework/geometry/mesh_file.h"
#include "framework/map/map_file.h"
#include "framework/mission/explore_library.h"
#include "framework/mission/guard.h"
#include "framework/mission/lua_value.h"
#include "framework/mission/run.h"
#include "framework/mission/scan_look.h"
#include "framework/mission/scan_objects.h"
#include "framework/mission/scan_record.h"

namespace lapwing {
namespace {

constexpr const char* kMapName = "known";
constexpr double kMatchingShare = 0.1;  // of what an image tells on average

// The walk in space: all corners are stops; at some of them a view is taken.
struct Walk {
  std::vector<Eigen::Vector3d> points;
  std::vector<PursuitView> stops;
  std::vector<double> pitches;  // rad, per stop
  std::vector<int> views;       // per stop, -1 where there is none or it was taken before
};

void add_stop(Walk& walk, const Eigen::Vector3d& point, double yaw, double pitch, int view,
              double least = 0) {
  walk.stops.push_back({walk.points.size(), yaw, least});
  walk.points.push_back(point);
  walk.pitches.push_back(pitch);
  walk.views.push_back(view);
}

Walk walk_of(const TourObject& tour) {
  const ScanWork& work = *tour.work;
  const auto at = [&](int v) -> const Viewpoint& {
    return work.graph.candidates.viewpoints[static_cast<std::size_t>(v)];
  };
  std::vector<char> taken(work.graph.candidates.viewpoints.size(), 0);
  Walk walk;
  const Viewpoint& start = at(tour.walk.front());
  taken[static_cast<std::size_t>(tour.walk.front())] = 1;
  add_stop(walk, start.position, start.yaw, start.pitch, tour.walk.front());
  for (std::size_t i = 1; i < tour.walk.size(); ++i) {
    const int a = tour.walk[i - 1], b = tour.walk[i];
    const ViewMotion& motion = work.graph.motions.motions[work.motion_between(a, b)];
    std::vector<Eigen::Vector3d> points = motion.points;
    if (motion.a != a) std::reverse(points.begin(), points.end());
    const std::vector<PursuitView> stops = stops_of(points, at(a), at(b), work.vehicle);
    for (std::size_t k = 1; k < points.size(); ++k) {
      const bool there = k + 1 == points.size();
      char& done = taken[static_cast<std::size_t>(b)];
      const int view = there && !done ? b : -1;
      if (there) done = 1;
      const double share = static_cast<double>(k) / static_cast<double>(points.size() - 1);
      add_stop(walk, points[k], stops[k].yaw, at(a).pitch + share * (at(b).pitch - at(a).pitch),
               view, stops[k].least);
    }
  }
  return walk;
}

// The same without the corners between views.
Walk views_of(const TourObject& tour) {
  const auto& viewpoints = tour.work->graph.candidates.viewpoints;
  std::vector<char> taken(viewpoints.size(), 0);
  Walk walk;
  for (const int v : tour.walk) {
    const Viewpoint& view = viewpoints[static_cast<std::size_t>(v)];
    char& done = taken[static_cast<std::size_t>(v)];
    add_stop(walk, view.position, view.yaw, view.pitch, done ? -1 : v);
    done = 1;
  }
  return walk;
}

// Turns the gimbal at an even rate between two stops, as late as they allow, so that it points
// where it should when the vehicle comes to rest.
void turn_gimbal(Trajectory& trajectory, const Walk& walk, const std::vector<ViewPassed>& passed) {
  trajectory.has_gimbal = true;
  std::size_t next = 0;
  double pitch = walk.pitches.front();
  auto& samples = trajectory.samples;
  for (std::size_t k = 0; k < samples.size(); ++k) {
    Sample& s = samples[k];
    s.gimbal_pitch = pitch;
    while (next < passed.size() && passed[next].arrival <= s.time + 1e-9) ++next;
    if (k + 1 == samples.size() || next == passed.size()) continue;
    // In the pause of a stop the camera keeps still.
    if (next > 0 && s.time < passed[next - 1].departure - 1e-9) continue;
    const double left = passed[next].arrival - s.time, h = samples[k + 1].time - s.time;
    const double missing = walk.pitches[next] - pitch;
    s.gimbal_pitch_rate = left > h ? missing / left : missing / h;
    pitch += h * s.gimbal_pitch_rate;
  }
}

// Whether the images before and after one could not be matched without it: no motion joins them.
bool joins_its_neighbours(const ScanWork& work, const std::vector<int>& views, std::size_t k) {
  if (k == 0 || k + 1 >= views.size() || views[k - 1] == views[k + 1]) return false;
  return !work.find_motion(views[k - 1], views[k + 1]);
}

// A view is there for matching if those before and after it need it, and it tells next to nothing
// itself. Of passes, which have no motions, by the latter alone.
std::vector<ViewKind> kinds_of(const ScanWork& work, const std::vector<int>& views) {
  ScoreState state(*work.graph.score);
  for (const int v : views) state.add(v);
  const double mean = state.score() / static_cast<double>(std::max<std::size_t>(views.size(), 1));
  std::vector<ViewKind> kinds;
  for (std::size_t k = 0; k < views.size(); ++k) {
    const bool little = state.loss(views[k]) < kMatchingShare * mean;
    const bool needed = !work.passes.empty() || joins_its_neighbours(work, views, k);
    kinds.push_back(little && needed ? ViewKind::matching : ViewKind::planned);
  }
  return kinds;
}

// The numbers of the views that a walk takes images of, in its order.
std::vector<int> images_of(const Walk& walk) {
  std::vector<int> views;
  for (const int view : walk.views)
    if (view >= 0) views.push_back(view);
  return views;
}

std::vector<PlannedView> planned_views(const ScanWork& work, const Walk& walk,
                                       const Pursuit& flown) {
  std::vector<PlannedView> views;
  for (std::size_t i = 0; i < walk.stops.size(); ++i) {
    if (walk.views[i] < 0) continue;
    const Viewpoint& v = work.graph.candidates.viewpoints[static_cast<std::size_t>(walk.views[i])];
    views.push_back({flown.views[i].departure, v.position, v.yaw, v.pitch, {}});
  }
  return views;
}

// `views`: the numbers of what is taken, one for each of `taken`.
ScanTask task_of_scan(const ScanWork& work, const std::vector<int>& views,
                      std::vector<PlannedView> taken, int threads) {
  const SightSettings& sight = work.visible->settings();
  ScanTask task;
  task.region = sight.region;
  task.camera = sight.pinhole;
  task.range = sight.range;
  task.map = kMapName;
  task.views = std::move(taken);
  const std::vector<ViewKind> kinds = kinds_of(work, views);
  for (std::size_t i = 0; i < kinds.size(); ++i) task.views[i].kind = kinds[i];
  std::vector<std::vector<VoxelKey>> seen(views.size());
  parallel_for(views.size(), threads, [&](std::size_t i) {
    seen[i] = work.visible->voxels_from(
        work.graph.candidates.viewpoints[static_cast<std::size_t>(views[i])]);
  });
  std::vector<VoxelKey> all;
  for (const auto& one : seen) all.insert(all.end(), one.begin(), one.end());
  std::sort(all.begin(), all.end());
  task.seen = std::unique(all.begin(), all.end()) - all.begin();
  return task;
}

// A tour with its views where they were flown, for what is told of it.
TourObject flown_tour(const TourObject& tour, const std::vector<PlannedView>& views) {
  auto work = std::make_shared<ScanWork>(*tour.work);
  for (std::size_t i = 0; i < views.size(); ++i)
    work->graph.candidates.viewpoints[static_cast<std::size_t>(tour.walk[i])] = {
        views[i].position, views[i].yaw, views[i].pitch};
  TourObject flown = tour;
  flown.work = std::move(work);
  return flown;
}

// How exactly the views of passes were flown.
std::string miss_in_words(const PassedFlight& flight) {
  char text[120];
  std::snprintf(text, sizeof text,
                "images at most %.2g m from their places on the passes, banked by at most %.2g "
                "degrees",
                flight.miss, degrees(flight.bank));
  return text;
}

SolveStatus status_of(TourStatus status) {
  switch (status) {
    case TourStatus::optimal:
      return SolveStatus::optimal;
    case TourStatus::feasible:
      return SolveStatus::feasible;
    case TourStatus::infeasible:
      return SolveStatus::infeasible;
    case TourStatus::iteration_limit:
      return SolveStatus::iteration_limit;
    case TourStatus::time_limit:
      return SolveStatus::time_limit;
    case TourStatus::cancelled:
      return SolveStatus::cancelled;
    case TourStatus::unsupported:
      return SolveStatus::unsupported;
    case TourStatus::failed:
      break;
  }
  return SolveStatus::numerical_error;
}

std::vector<std::string> texts_of(const Value& list) {
  std::vector<std::string> texts;
  if (list.is_list())
    for (const Value& entry : list.as_list()) texts.push_back(entry.as_text());
  return texts;
}

// The solutions listed under `legs`; empty where there are none.
std::vector<const SolutionObject*> legs_argument(lua_State* state, int table) {
  std::vector<const SolutionObject*> legs;
  if (lua_getfield(state, table, "legs") == LUA_TNIL) return legs;
  if (!lua_istable(state, -1)) throw InputError("scan_plan: legs: expected a list of solutions");
  const int list = lua_gettop(state);
  for (lua_Integer i = 1; lua_rawgeti(state, list, i) != LUA_TNIL; ++i) {
    legs.push_back(&object_argument<SolutionObject>(state, -1, kSolutionType));
    lua_pop(state, 1);
  }
  lua_pop(state, 1);
  return legs;
}

// Files of what is known, and the rules that the graph was made with; no margin.
Environment environment_of_scan(const ScanWork& work, MissionRun& run) {
  Environment environment;
  const auto keep = [&](const char* name, const char* type, const char* file,
                        const std::string& bytes) {
    Obstacle obstacle;
    obstacle.name = name;
    obstacle.type = type;
    obstacle.parameters.set("file", file);
    obstacle.parameters.set("sha256", run.obstacles.keep(file, bytes));
    environment.obstacles.push_back(std::move(obstacle));
  };
  keep("prior", "mesh", "prior.ply", ply_bytes(work.prior->mesh->mesh()));
  keep(kMapName, "map", "map.ot", map_file_bytes(".ot", *work.prior->mapping.map));
  for (const Obstacle& zone : work.rules->zones.obstacles) environment.obstacles.push_back(zone);
  environment.pilot = work.rules->pilot;
  environment.accuracy = work.rules->accuracy;
  return environment;
}

constexpr BoundField kScanPlanObjects[] = {
    {"tour", "lapwing.tour", "flown tour"},
    {"legs?", "lapwing.solution[]", "solutions from view to view; absent: pure pursuit"},
    {"flight?", "lapwing.solution", "solution of a tour of passes"},
    {"explored?", "lapwing.exploration", "exploration before it, for the report"},
    {"shares?", "lapwing.plan",
     "earlier plan of the same graph, with which it shares the files of map and mesh"},
    {"notes?", "string[]", "sentences for the user"},
    {"figures?", "table", "figures of the tour, for --json"},
    kStatedSections};
ParameterTable scan_plan_table() {
  ParameterTable table;
  table
      .number("margin", 0.4, "m", "distance from occupied and unknown voxels, and from the mesh",
              at_least(0))
      .required_number("budget", "s", "flight time", above(0))
      .number("seen_share", ScanTask{}.seen_share, "",
              "fraction of the voxels that must be seen again", {0, 1, true})
      .number("pixel_error", 0.5, "px", "standard deviation of a point in an image", above(0))
      .boolean("part_of_fleet", false,
               "run:fleet tells what the images show, of all its plans together")
      .boolean("closed_loop_required", true, "false: tracking under control is reported only");
  return table;
}

// run:scan_plan{tour =, flight =, margin =, budget =, closed_loop_required =, seen_share =,
// notes =, part_of_fleet =, shares =, figures =, sections =, legs =, explored =}
int scan_plan_of_run(lua_State* state) {
  MissionRun& run = run_of(state);
  const Origin origin = Sandbox::of(state).script_position(state);
  const Parameters given =
      table_argument(state, 2, scan_plan_table(), "scan_plan", kScanPlanObjects);
  lua_getfield(state, 2, "tour");
  const TourObject& tour = object_argument<TourObject>(state, -1, kTourType);
  if (tour.walk.size() < 2) throw InputError("scan_plan: a tour of one view is not a flight");
  lua_getfield(state, 2, "notes");
  const Value notes = value_from_lua(state, lua_gettop(state), origin, "scan_plan.notes");
  lua_getfield(state, 2, "figures");
  const ScanWork& work = *tour.work;
  PlanObject made;
  made.block = value_from_lua(state, lua_gettop(state), origin, "scan_plan.figures");
  const std::vector<const SolutionObject*> legs = legs_argument(state, 2);
  const SolutionObject* flight = nullptr;
  if (lua_getfield(state, 2, "flight") != LUA_TNIL)
    flight = &object_argument<SolutionObject>(state, -1, kSolutionType);
  if ((flight != nullptr) != (tour.passing != nullptr) || (flight && !legs.empty()))
    throw InputError(
        "scan_plan: a tour of passes has a solution as its 'flight', others have none");
  const PlanObject* shared = nullptr;
  if (lua_getfield(state, 2, "shares") != LUA_TNIL)
    shared = &object_argument<PlanObject>(state, -1, kPlanType);
  made.block_name = "tour";
  made.sections = stated_sections(state, 2, "scan_plan.sections");
  if (lua_getfield(state, 2, "explored") != LUA_TNIL)
    for (Section& section : sections_of_exploration(state, -1))
      made.sections.push_back(std::move(section));
  made.notes = texts_of(notes);
  made.report = report_of(tour.report);
  made.solver = tour.solver;
  Plan& plan = made.plan;
  {
    const Sandbox::ClockPause pause(Sandbox::of(state));
    const TourObject* told = &tour;  // the tour that the report is of
    std::optional<TourObject> passed;
    std::vector<int> images;
    if (tour.passing) {
      PassedFlight flown = passed_flight(tour, *flight);
      passed = flown_tour(tour, flown.views);
      told = &*passed;
      made.notes.push_back(miss_in_words(flown));
      plan.trajectory = std::move(flown.trajectory);
      plan.task.scan = task_of_scan(work, tour.walk, std::move(flown.views), run.settings.threads);
      images = tour.walk;
    } else {
      const Walk walk = legs.empty() ? walk_of(tour) : views_of(tour);
      Pursuit flown = legs.empty() ? pursue(walk.points, walk.stops, work.vehicle, work.flight)
                                   : joined_flight(tour, legs);
      images = images_of(walk);
      plan.task.scan =
          task_of_scan(work, images, planned_views(work, walk, flown), run.settings.threads);
      plan.trajectory = std::move(flown.trajectory);
      if (work.vehicle.gimbal) turn_gimbal(plan.trajectory, walk, flown.views);
    }
    plan.mission = run.name;
    plan.kind = run.kind;
    plan.vehicle = to_value(work.vehicle);
    plan.budget = given.number("budget");
    plan.task.closed_loop_required = given.boolean("closed_loop_required");
    plan.task.scan->seen_share = given.number("seen_share");
    plan.environment = shared ? shared->plan.environment : environment_of_scan(work, run);
    plan.environment.margin = given.number("margin");
    plan.geodetic_origin = run.origin;
    plan.home = run.home;
    plan.configuration = run.configuration;
    plan.solver = to_value(tour.report, tour.solver);
    if (given.boolean("part_of_fleet")) {
      const auto record = record_of_tour(*told);
      made.late_sections = [record](const Plan& of) { return tour_sections(of, *record); };
    } else {
      const auto record = record_of_scan(*told, given.number("pixel_error"), run.settings.threads);
      tell_scan(*record, run, {made.block, made.notes, made.told});
      made.late_sections = [record](const Plan& of) { return scan_sections(of, *record); };
      made.scan = record;
    }
    if (run.settings.keep_tours)
      made.kept = std::make_shared<const KeptTour>(
          KeptTour{told->work, std::move(images), told->reachable});
    const std::string small = warning_of_small_camera(plan.task.scan->camera);
    if (!small.empty()) made.notes.push_back(small);
  }
  new_object(state, kPlanType, std::move(made));
  return 1;
}

}  // namespace

SolveReport report_of(const TourReport& tour) {
  SolveReport report;
  report.status = status_of(tour.status);
  report.message = tour.message;
  report.iterations = static_cast<int>(tour.iterations);
  report.cost = std::numeric_limits<double>::quiet_NaN();
  report.seconds = tour.wall_seconds;
  return report;
}

std::span<const Binding> scan_plan_methods_of_run() {
  static const Binding methods[] = {{"scan_plan", &guarded<scan_plan_of_run>,
                                     "(wanted: @): lapwing.plan", "a tour as a plan",
                                     &scan_plan_table, kScanPlanObjects}};
  return methods;
}

}  // namespace lapwing
