// SPDX-License-Identifier: Apache-2.0
// Views that are taken in passing, tours of such passes, and the flight that a solution makes of
// one.
#include <algorithm>
#include <cmath>
#include <numbers>

#include <lua.hpp>

#include "framework/core/log.h"
#include "framework/core/units.h"
#include "framework/mission/guard.h"
#include "framework/mission/lua_value.h"
#include "framework/mission/run.h"
#include "framework/mission/scan_objects.h"
#include "framework/mission/vectors.h"
#include "framework/trajectory/interpolate.h"
#include "framework/view/pass_tour.h"

namespace lapwing {
namespace {

ParameterTable pass_table() {
  ParameterTable table;
  table.required_numbers("from", 3, "m", "place of the first image")
      .required_numbers("to", 3, "m", "place of the last image, at the same height")
      .integer("images", 2, "number of images, evenly spaced, both ends included",
               between(2, 100000))
      .number("yaw", 0, "rad", "yaw of the camera relative to the course")
      .number("pitch", 0, "rad", "pitch of the camera, positive upwards");
  return table;
}

ParameterTable pass_graph_table() {
  ParameterTable table;
  table.table("region", region_table(), "region of interest")
      .table("allowed", box_table(), "box for the centre of the vehicle; all of it must be free")
      .tables("passes", pass_table(), "straight and level passes, with images along them", true)
      .numbers("body", {1, 1, 0.5}, "m", "half edges of the box of the vehicle")
      .number("mesh_room", 1, "m", "additional distance from the prior mesh", at_least(0))
      .table("camera", pinhole_table(), "camera of the images")
      .integer("across", 0, "pixels per row in the evaluation of views; 0: all", between(0, 10000))
      .number("range", 60, "m", "length of a ray", above(0))
      .optional_number("usable_range", "m",
                       "distance beyond which an image shows nothing of use; absent: any", above(0))
      .number("usable_incidence_deg", 90, "deg",
              "known angle of incidence beyond which an image shows nothing of use",
              {.minimum = 0, .maximum = 90, .minimum_excluded = true});
  return table;
}

// The views of all passes, and their numbers, pass by pass.
std::vector<Viewpoint> views_of_passes(const std::vector<Parameters>& passes, ScanWork& work) {
  std::vector<Viewpoint> views;
  for (const Parameters& pass : passes) {
    const Eigen::Vector3d from = vector_of(pass.numbers("from")),
                          to = vector_of(pass.numbers("to"));
    const Eigen::Vector3d way = to - from;
    if (!(way.head<2>().norm() > 0) || way.z() != 0)
      throw InputError(pass.origin(), "a pass must be level and have a length");
    const double course = std::atan2(way.y(), way.x());
    const double yaw = std::remainder(course + pass.number("yaw"), 2 * std::numbers::pi);
    const auto count = static_cast<int>(pass.integer("images"));
    work.passes.emplace_back();
    work.courses.push_back(course);
    for (int k = 0; k < count; ++k) {
      work.passes.back().push_back(static_cast<int>(views.size()));
      views.push_back(
          {from + static_cast<double>(k) / (count - 1) * way, yaw, pass.number("pitch")});
    }
  }
  return views;
}

// Without the images at both ends that tell nothing, and without passes that tell nothing at all.
void trim_passes(ScanWork& work) {
  const ViewScore& score = *work.graph.score;
  const auto tells = [&](int view) { return score.alone(view) > 0; };
  std::vector<std::vector<int>> passes;
  std::vector<double> courses;
  for (std::size_t p = 0; p < work.passes.size(); ++p) {
    const std::vector<int>& pass = work.passes[p];
    const auto first = std::find_if(pass.begin(), pass.end(), tells);
    if (first == pass.end()) continue;
    const auto last = std::find_if(pass.rbegin(), pass.rend(), tells).base();
    passes.emplace_back(first, last);
    courses.push_back(work.courses[p]);
  }
  work.passes = std::move(passes);
  work.courses = std::move(courses);
}

constexpr BoundField kPassGraphObjects[] = {
    {"prior", "lapwing.prior", "known map and mesh"},
    {"vehicle", "lapwing.vehicle", "vehicle"},
    {"rules?", "lapwing.flight_rules", "zones and a pilot that the flight keeps"},
    {"information", "lapwing.information", "information of a view about a voxel"}};

void check_air(const ScanWork& work, double mesh_room, const Parameters& given) {
  const Eigen::AlignedBox3d& air = work.allowed;
  const Eigen::Vector3d middle = air.center(), half = air.sizes() / 2 + work.body;
  if (const std::string why = forbidden_by(*work.rules, middle, half); !why.empty())
    throw InputError(given.origin("allowed"),
                     "zones reach into the air that passes and turns need, or the pilot's range "
                     "does not: a flight in passing keeps all of it free (" +
                         why + ")");
  if (work.rules->pilot)
    throw InputError(given.origin("rules"),
                     "a line of sight to a pilot is for flights that rest at their views");
  if (space_of(*work.prior, mesh_room)->swept_box_free(middle, middle, half)) return;
  char text[300];
  std::snprintf(text, sizeof text,
                "the air for turns is not known to be free between (%.4g, %.4g, %.4g) and (%.4g, "
                "%.4g, %.4g): raise safe_height, or use a map that shows this air",
                air.min().x(), air.min().y(), air.min().z(), air.max().x(), air.max().y(),
                air.max().z());
  throw InputError(given.origin("allowed"), text);
}

// run:pass_graph{prior =, vehicle =, information =, region =, allowed =, passes =, ...}
int pass_graph_of_run(lua_State* state) {
  MissionRun& run = run_of(state);
  const Parameters given =
      table_argument(state, 2, pass_graph_table(), "pass_graph", kPassGraphObjects);
  auto work = std::make_shared<ScanWork>();
  lua_getfield(state, 2, "prior");
  work->prior = object_argument<PriorObject>(state, -1, kPriorType).prior;
  if (!work->prior->mesh) throw InputError("pass_graph: the prior has no mesh; reconstruct it");
  lua_getfield(state, 2, "vehicle");
  work->vehicle = object_argument<Vehicle>(state, -1, kVehicleType);
  if (!work->vehicle.gimbal)
    throw InputError(
        "vehicle '" + work->vehicle.name +
        "' has no gimbal: images in passing need a camera that looks down or sideways");
  lua_getfield(state, 2, "information");
  const PluginChoice information = plugin_choice(state, lua_gettop(state), "information");
  work->allowed = box_of(given.table("allowed"), "the box for the vehicle");
  work->body = vector_of(given.numbers("body"));
  work->rules = rules_argument(state, 2);
  const Sandbox::ClockPause pause(Sandbox::of(state));
  const auto coarser = make_sight(*work, run, given, information);
  check_air(*work, given.number("mesh_room"), given);
  begin_planning(run);
  std::vector<Viewpoint> views = views_of_passes(given.tables("passes"), *work);
  work->graph =
      score_given_views(*coarser, *work->information, std::move(views), run.settings.threads,
                        run.settings.cancellation, run.settings.progress);
  trim_passes(*work);
  for (const std::vector<int>& pass : work->passes)
    for (std::size_t k = 1; k < pass.size(); ++k) {
      const auto& all = work->graph.candidates.viewpoints;
      const Eigen::Vector3d &a = all[static_cast<std::size_t>(pass[k - 1])].position,
                            &b = all[static_cast<std::size_t>(pass[k])].position;
      work->graph.motions.motions.push_back({pass[k - 1], pass[k], {a, b}, (b - a).norm()});
    }
  work->islands =
      ViewIslands(work->graph.candidates.viewpoints.size(), work->graph.motions.motions);
  logging::info("passes that see the region: " + std::to_string(work->passes.size()) + " of " +
                std::to_string(given.tables("passes").size()) + ", with " +
                std::to_string(work->graph.candidates.viewpoints.size()) + " views in all");
  new_object(state, kGraphType, GraphObject{std::move(work)});
  return 1;
}

constexpr BoundField kPassTourObjects[] = {{"graph", "lapwing.scan_graph", "graph of passes"}};
ParameterTable pass_tour_table() {
  ParameterTable table;
  table.required_number("budget", "s", "flight time", above(0))
      .required_number("speed", "m/s", "speed of the whole flight", above(0))
      .required_number("radius", "m", "radius of the turns", above(0))
      .number("lead", 0, "m", "straight flight before the first and after the last image of a pass",
              at_least(0))
      .integer("images", 0, "largest number of images; 0: any number", at_least(0))
      .integer("iterations", 200, "iterations of the search", at_least(0));
  return table;
}

PassSettings settings_of(const Parameters& given, const ScanWork& work) {
  const GimbalLimits& gimbal = *work.vehicle.gimbal;
  return {.speed = given.number("speed"),
          .radius = given.number("radius"),
          .lead = given.number("lead"),
          .climb = std::min(work.vehicle.climb_speed_max, work.vehicle.descent_speed_max),
          .gimbal = {gimbal.yaw_min, gimbal.yaw_max, gimbal.pitch_min, gimbal.pitch_max,
                     gimbal.yaw_rate_max, gimbal.pitch_rate_max},
          .allowed = work.allowed};
}

// run:pass_tour{graph =, budget =, speed =, radius =, lead =, images =, iterations =}
int pass_tour_of_run(lua_State* state) {
  MissionRun& run = run_of(state);
  const Parameters given =
      table_argument(state, 2, pass_tour_table(), "pass_tour", kPassTourObjects);
  lua_getfield(state, 2, "graph");
  TourObject tour;
  tour.work = object_argument<GraphObject>(state, -1, kGraphType).work;
  const ScanWork& work = *tour.work;
  if (work.passes.empty())
    throw InputError("pass_tour: the graph has no passes; make it with pass_graph");
  tour.solver = "passes";
  tour.budget = given.number("budget");
  PassRequest request{.budget = tour.budget,
                      .iterations = given.integer("iterations"),
                      .seed = run.settings.seed,
                      .cancellation = run.settings.cancellation,
                      .progress = run.settings.progress};
  if (given.integer("images") > 0) request.image_limit = static_cast<int>(given.integer("images"));
  const Sandbox::ClockPause pause(Sandbox::of(state));
  const PassProblem problem(work.graph.candidates.viewpoints, work.passes, work.courses,
                            *work.graph.score, settings_of(given, work));
  PassTour found = find_pass_tour(problem, request);
  tour.report = std::move(found.report);
  tour.passing = std::make_shared<PassFlight>(problem.flight_of(found.order));
  for (const PassFlight::Shot& shot : tour.passing->shots) tour.walk.push_back(shot.view);
  run.solve_seconds += tour.report.wall_seconds;
  logging::info("passes: " + tour.report.message + ", score " + std::to_string(tour.report.score) +
                " of " + std::to_string(tour.report.reachable_score) + ", " +
                std::to_string(tour.report.seconds_used) + " s");
  new_object(state, kTourType, std::move(tour));
  return 1;
}

// Angles of the gimbal at the samples: held along passes, turned evenly between them.
void hold_gimbal(Trajectory& trajectory, const std::vector<PassFlight::Hold>& holds) {
  constexpr double kSame = 1e-9;  // s
  auto& samples = trajectory.samples;
  trajectory.has_gimbal = true;
  for (Sample& s : samples) s.gimbal_yaw = holds.front().yaw, s.gimbal_pitch = holds.front().pitch;
  for (std::size_t i = 1; i < holds.size(); ++i) {
    const PassFlight::Hold &a = holds[i - 1], &b = holds[i];
    std::size_t first = 0, last = samples.size() - 1;
    while (first < samples.size() && samples[first].time < a.to - kSame) ++first;
    while (last > 0 && samples[last].time > b.from + kSame) --last;
    if (first >= last)
      throw InputError(
          "scan_plan: the flight's steps are too long to turn the gimbal between two "
          "passes");
    const double seconds = samples[last].time - samples[first].time;
    for (std::size_t k = first; k < samples.size(); ++k) {
      Sample& s = samples[k];
      const double share = std::min(1.0, (s.time - samples[first].time) / seconds);
      s.gimbal_yaw = k < last ? a.yaw + share * (b.yaw - a.yaw) : b.yaw;
      s.gimbal_pitch = k < last ? a.pitch + share * (b.pitch - a.pitch) : b.pitch;
      s.gimbal_yaw_rate = k < last ? (b.yaw - a.yaw) / seconds : 0;
      s.gimbal_pitch_rate = k < last ? (b.pitch - a.pitch) / seconds : 0;
    }
  }
}

}  // namespace

Value flight_of_passes(const TourObject& tour) {
  const PassFlight& flight = *tour.passing;
  const auto place = [](const Eigen::Vector3d& p) {
    return Value(Value::List{p.x(), p.y(), p.z()});
  };
  Value times = Value::list(), positions = Value::list(), yaws = Value::list();
  for (std::size_t k = 0; k < flight.times.size(); ++k) {
    times.push_back(flight.times[k]);
    positions.push_back(place(flight.positions[k]));
    yaws.push_back(flight.courses[k]);
  }
  Value images = Value::list();
  for (const PassFlight::Shot& shot : flight.shots) {
    Value image = Value::map();
    image.set("time", shot.time);
    image.set(
        "position",
        place(
            tour.work->graph.candidates.viewpoints[static_cast<std::size_t>(shot.view)].position));
    images.push_back(std::move(image));
  }
  Value value = Value::map();
  value.set("duration", flight.duration());
  value.set("times", std::move(times));
  value.set("positions", std::move(positions));
  value.set("yaws", std::move(yaws));
  value.set("images", std::move(images));
  return value;
}

PassedFlight passed_flight(const TourObject& tour, const SolutionObject& solution) {
  const PassFlight& wanted = *tour.passing;
  PassedFlight flown;
  flown.trajectory = solution.problem->trajectory(solution.result.point.stages);
  if (flown.trajectory.motion.column("orientation") || flown.trajectory.samples.size() < 2)
    throw InputError("scan_plan: the flight is not a solution of a model with a yaw");
  if (flown.trajectory.duration() < wanted.shots.back().time)
    throw InputError("scan_plan: the flight ends before the last image of its tour");
  hold_gimbal(flown.trajectory, wanted.holds);
  for (const PassFlight::Shot& shot : wanted.shots) {
    const Sample s = sample_at(flown.trajectory, shot.time);
    const Viewpoint& view =
        tour.work->graph.candidates.viewpoints[static_cast<std::size_t>(shot.view)];
    flown.views.push_back({shot.time, s.position, s.yaw + s.gimbal_yaw, s.gimbal_pitch, {}});
    flown.miss = std::max(flown.miss, (s.position - view.position).norm());
    const double across = std::abs(s.yaw_rate) * s.velocity.head<2>().norm();
    flown.bank = std::max(flown.bank, std::atan(across / kGravity));
  }
  return flown;
}

std::span<const Binding> pass_methods_of_run() {
  static const Binding methods[] = {
      {"pass_graph", &guarded<pass_graph_of_run>, "(settings: @): lapwing.scan_graph",
       "views along straight passes over a region, for a vehicle that cannot stand still",
       &pass_graph_table, kPassGraphObjects},
      {"pass_tour", &guarded<pass_tour_of_run>, "(settings: @): lapwing.tour",
       "a tour of passes within a budget", &pass_tour_table, kPassTourObjects}};
  return methods;
}

}  // namespace lapwing
