// SPDX-License-Identifier: Apache-2.0
#include "framework/mission/flight_library.h"

#include <algorithm>
#include <limits>

#include <lua.hpp>

#include "framework/export/light_painting.h"
#include "framework/mission/controller_source.h"
#include "framework/mission/guard.h"
#include "framework/mission/lua_value.h"
#include "framework/mission/run.h"
#include "framework/trajectory/gate_passage.h"
#include "framework/trajectory/keyframe_timing.h"
#include "framework/vehicle/monte_carlo.h"
#include "framework/vehicle/pursuit.h"
#include "framework/vehicle/smooth_leg.h"

namespace lapwing {

namespace {
constexpr double kMostPathPoints = 1e6;
}

// x, y, z of each point in turn.
Points points_of(const Parameters& given, const std::string& key) {
  const auto numbers = given.numbers(key);
  if (numbers.size() < 6 || numbers.size() % 3 != 0)
    throw InputError(given.origin(key), key + ": expected x, y, z of two points or more");
  Points points;
  for (std::size_t i = 0; i < numbers.size(); i += 3)
    points.emplace_back(numbers[i], numbers[i + 1], numbers[i + 2]);
  return points;
}

namespace {

// run:fly(plan): how it comes out under control in still air; with strokes, how far the light is
// from them.
int fly_plan(lua_State* state) {
  const PlanObject& object = object_argument<PlanObject>(state, 2, kPlanType);
  begin_planning(run_of(state));
  Value result = Value::map();
  {
    const Sandbox::ClockPause pause(Sandbox::of(state));
    const MissionRun& run = run_of(state);
    const Vehicle vehicle = vehicle_from_value(object.plan.vehicle);
    FlightConditions conditions;
    conditions.disturbances = vehicle.disturbances;
    const FlownPath flown = plan_as_named(object.plan.trajectory, vehicle, *run.settings.registry)
                                ->fly(conditions, run.settings.cancellation);
    result.set("lost", flown.lost);
    result.set("position_error", flown.position_error_worst);
    result.set("yaw_error", flown.yaw_error_worst);
    if (!object.plan.task.strokes.empty()) {
      const DrawingError error = drawing_error(object.plan, flown);
      result.set("mean_drawing_error", error.mean);
      result.set("worst_drawing_error", error.worst);
    }
  }
  push_value(state, result);
  return 1;
}

constexpr BoundField kFlownPlan[] = {{"plan", "lapwing.plan", "plan to fly"}};

ParameterTable fly_runs_table() {
  ParameterTable table;
  table.integer("runs", 20, "flights, with seeds in turn", between(1, 100000))
      .integer("seed", 1, "of the first", at_least(0))
      .number("mass_error", 0, "", "largest error of the mass, as a fraction; drawn uniformly",
              between(0, 0.9))
      .number("wind", 0, "m/s", "mean, towards the east", between(0, 150))
      .number("gust", 0, "m/s", "standard deviation of each horizontal axis", between(0, 150));
  return table;
}

// Whether the flight came to its end, through all gates of the plan.
bool is_through(const Plan& plan, const FlownPath& flown) {
  constexpr double kAllowed = 1e-3;  // m, as the certificate allows
  if (flown.lost || !flown.finished) return false;
  std::vector<PathPoint> path;
  for (const FlownSample& s : flown.samples) path.push_back({s.time, s.state.position});
  std::size_t from = 0;
  double share = 0;
  for (const GateTask& gate : plan.task.gates) {
    const GatePassage passage = gate_passage(gate, path, from, kAllowed, share);
    if (!(passage.outside <= kAllowed)) return false;
    from = passage.after;
    share = passage.share;
  }
  return true;
}

// run:fly_runs{plan =, runs =, mass_error =, wind =, gust =, seed =}: flights under drawn
// conditions and those of the vehicle's file.
int fly_plan_often(lua_State* state) {
  const Parameters given = table_argument(state, 2, fly_runs_table(), "fly_runs", kFlownPlan);
  lua_getfield(state, 2, "plan");
  const PlanObject& object = object_argument<PlanObject>(state, -1, kPlanType);
  const MissionRun& run = run_of(state);
  begin_planning(run_of(state));
  Value result = Value::map();
  {
    const Sandbox::ClockPause pause(Sandbox::of(state));
    const Vehicle vehicle = vehicle_from_value(object.plan.vehicle);
    FlightConditions spread;
    spread.wind_mean = given.number("wind");
    spread.wind_gust = given.number("gust");
    spread.mass_error = given.number("mass_error");
    spread.disturbances = vehicle.disturbances;
    spread.seed = static_cast<std::uint64_t>(given.integer("seed"));
    const auto controlled = plan_as_named(object.plan.trajectory, vehicle, *run.settings.registry);
    const std::vector<SeededRun> flown =
        fly_runs(*controlled, spread, static_cast<int>(given.integer("runs")), run.settings.threads,
                 run.settings.cancellation);
    int through = 0;
    double position = 0, longest = 0;
    for (const SeededRun& one : flown) {
      through += is_through(object.plan, one.path);
      position = std::max(position, one.path.position_error_worst);
      longest = std::max(longest, one.path.duration());
    }
    result.set("through", through);
    result.set("runs", given.integer("runs"));
    result.set("position_error", position);
    result.set("duration", longest);
  }
  push_value(state, result);
  return 1;
}

constexpr BoundField kPathVehicle[] = {
    {"vehicle?", "lapwing.vehicle",
     "vehicle whose limits hold, in addition to speed and acceleration"}};

ParameterTable time_path_table() {
  ParameterTable table;
  table.required_numbers("points", 0, "m", "x, y, z of each point in turn, world")
      .number("spacing", 0.01, "m", "distance between the points of the result", above(0))
      .number("rounding", 0, "m", "rounding of corners, standard deviation", at_least(0))
      .number("share", 1, "", "fraction of the limits of the vehicle that is used", {0, 1, true})
      .optional_number("speed", "m/s", "largest", above(0))
      .optional_number("acceleration", "m/s^2",
                       "largest acceleration, along and across the path together", above(0));
  return table;
}

// run:time_path{points = {x, y, z, ...}, spacing =, rounding =, vehicle =, share =, speed =,
// acceleration =}: {points = {x, y, z, ...}, times = {...}}, as fast as all limits that are given
// allow, from rest to rest.
int time_path(lua_State* state) {
  const Parameters given = table_argument(state, 2, time_path_table(), "time_path", kPathVehicle);
  lua_getfield(state, 2, "vehicle");
  const Vehicle* vehicle =
      lua_isnil(state, -1) ? nullptr : &object_argument<Vehicle>(state, -1, kVehicleType);
  if (!vehicle && !(given.has("speed") && given.has("acceleration")))
    throw InputError(given.origin(), "time_path: expected a vehicle, or speed and acceleration");
  const Points path = points_of(given, "points");
  const double spacing = given.number("spacing"), length = length_of(path);
  if (!(length > 0)) throw InputError(given.origin("points"), "time_path: the path has no length");
  if (length / spacing > kMostPathPoints)
    throw InputError(given.origin("spacing"), "time_path: more than a million points");
  const Points smooth = rounded(resampled(path, spacing), given.number("rounding"));
  const double infinite = std::numeric_limits<double>::infinity();
  const PathLimits asked{given.has("speed") ? given.number("speed") : infinite,
                         given.has("acceleration") ? given.number("acceleration") : infinite};
  const std::vector<double> times =
      vehicle ? fastest_times(smooth, within(motion_limits(*vehicle, given.number("share")), asked))
              : fastest_times(smooth, asked);
  Value points = Value::list(), result = Value::map();
  for (const Eigen::Vector3d& p : smooth)
    for (int axis = 0; axis < 3; ++axis) points.push_back(p(axis));
  result.set("points", std::move(points));
  result.set("times", Value(Value::List(times.begin(), times.end())));
  push_value(state, result);
  return 1;
}

ParameterTable path_distance_table() {
  ParameterTable table;
  table.required_numbers("points", 0, "m", "x, y, z of each in turn, world")
      .required_numbers("path", 0, "m", "likewise");
  return table;
}

// run:path_distance{points = {x, y, z, ...}, path = {x, y, z, ...}}: how far the farthest of the
// points is from the path, m.
int path_distance(lua_State* state) {
  const Parameters given = table_argument(state, 2, path_distance_table(), "path_distance");
  const std::vector<Points> path = {points_of(given, "path")};
  double worst = 0;
  for (const Eigen::Vector3d& p : points_of(given, "points"))
    worst = std::max(worst, distance_to(path, p));
  lua_pushnumber(state, worst);
  return 1;
}

ParameterTable keyframe_stops_table() {
  ParameterTable table;
  table.required_numbers("points", 0, "m", "x, y, z of each point of the path in turn, world")
      .required_numbers("keyframes", 0, "m", "x, y, z of each keyframe in turn, world");
  return table;
}

// run:keyframe_stops{points = {x, y, z, ...}, keyframes = {x, y, z, ...}}: numbers of points,
// from 1.
int stops_of_keyframes(lua_State* state) {
  const Parameters given = table_argument(state, 2, keyframe_stops_table(), "keyframe_stops");
  Value list = Value::list();
  for (const std::size_t stop :
       keyframe_stops(points_of(given, "points"), points_of(given, "keyframes")))
    list.push_back(static_cast<std::int64_t>(stop + 1));
  push_value(state, list);
  return 1;
}

ParameterTable keyframe_times_table() {
  ParameterTable wish;
  wish.optional_number("time", "s", "wished time: exact, or preferred with a time_weight")
      .optional_number("time_weight", "1/s^2", "weight of the squared distance from `time`",
                       at_least(0))
      .optional_number("earliest", "s", "not before")
      .optional_number("latest", "s", "not after");
  ParameterTable table;
  table.tables("wishes", wish, "wish of each keyframe; the first one is passed at 0 s", true)
      .required_numbers("legs", 0, "s", "shortest duration of each leg", above(0));
  return table;
}

// run:keyframe_times{wishes = {...}, legs = {...}}: the cheapest times; or nil and the number of
// the keyframe that can have none of its times.
int times_of_keyframes(lua_State* state) {
  const Parameters given = table_argument(state, 2, keyframe_times_table(), "keyframe_times");
  const auto number = [](const Parameters& entry, const char* key) {
    return entry.has(key) ? std::optional(entry.number(key)) : std::nullopt;
  };
  std::vector<TimeWish> wishes;
  for (const Parameters& entry : given.tables("wishes")) {
    wishes.push_back({number(entry, "time"), number(entry, "time_weight"),
                      number(entry, "earliest"), number(entry, "latest")});
    if (wishes.back().time_weight && !wishes.back().time)
      throw InputError(entry.origin("time_weight"), "keyframe_times: a time_weight needs a time");
  }
  const auto legs = given.numbers("legs");
  if (legs.size() + 1 != wishes.size())
    throw InputError(given.origin("legs"), "keyframe_times: " + std::to_string(wishes.size()) +
                                               " wishes need one leg fewer, got " +
                                               std::to_string(legs.size()));
  const KeyframeTimes found = cheapest_times(wishes, legs);
  if (found.refused) {
    lua_pushnil(state);
    lua_pushinteger(state, static_cast<lua_Integer>(*found.refused + 1));
    return 2;
  }
  push_value(state, Value(Value::List(found.times.begin(), found.times.end())));
  return 1;
}

ParameterTable pursue_table() {
  const PursuitSettings standard;
  ParameterTable view;
  view.integer("point", 1, "number of the path point, from 1", at_least(1))
      .number("yaw", 0, "rad", "heading");
  ParameterTable table;
  table.required_numbers("points", 0, "m", "x, y, z of each point in turn, world")
      .tables("views", view, "places of images")
      .number("speed", standard.speed, "m/s", "speed between views", above(0))
      .number("view_speed", standard.view_speed, "m/s", "near a view", above(0))
      .number("slow_within", standard.slow_within, "m",
              "distance from a view within which view_speed holds", above(0))
      .number("lookahead", standard.lookahead, "m", "distance of the pursued point", above(0))
      .number("acceleration", standard.acceleration, "m/s^2", "largest", above(0))
      .boolean("stop", standard.stop, "whether to stop at every view")
      .number("pause", standard.pause, "s", "pause at every view", between(0, 3600));
  return table;
}

// run:pursue{vehicle =, points = {x, y, z, ...}, views = {{point =, yaw =}, ...}, speed =, ...}:
// {duration =, views = {{arrival =, departure =, miss =}, ...}, lost =, position_error =}, as the
// whole quadrotor flies it in still air.
int pursue_path(lua_State* state) {
  const Parameters given = table_argument(state, 2, pursue_table(), "pursue", kVehicleObject);
  lua_getfield(state, 2, "vehicle");
  const Vehicle& vehicle = object_argument<Vehicle>(state, -1, kVehicleType);
  PursuitSettings settings;
  settings.speed = given.number("speed");
  settings.view_speed = given.number("view_speed");
  settings.slow_within = given.number("slow_within");
  settings.lookahead = given.number("lookahead");
  settings.acceleration = given.number("acceleration");
  settings.stop = given.boolean("stop");
  settings.pause = given.number("pause");
  std::vector<PursuitView> views;
  for (const Parameters& entry : given.tables("views"))
    views.push_back({static_cast<std::size_t>(entry.integer("point") - 1), entry.number("yaw")});
  const Points path = points_of(given, "points");
  begin_planning(run_of(state));
  Value passed = Value::list(), result = Value::map();
  {
    const Sandbox::ClockPause pause(Sandbox::of(state));
    const Pursuit pursuit = pursue(path, views, vehicle, settings);
    const MissionRun& run = run_of(state);
    const FlownPath flown = plan_as_named(pursuit.trajectory, vehicle, *run.settings.registry)
                                ->fly({}, run.settings.cancellation);
    for (const ViewPassed& view_passed : pursuit.views) {
      Value entry = Value::map();
      entry.set("arrival", view_passed.arrival);
      entry.set("departure", view_passed.departure);
      entry.set("miss", view_passed.miss);
      passed.push_back(std::move(entry));
    }
    result.set("duration", pursuit.trajectory.duration());
    result.set("lost", flown.lost);
    result.set("position_error", flown.position_error_worst);
  }
  result.set("views", std::move(passed));
  push_value(state, result);
  return 1;
}

}  // namespace

std::span<const Binding> flight_methods_of_run() {
  static const Binding methods[] = {
      {"fly", &guarded<fly_plan>, "(plan: lapwing.plan): table",
       "the simulated flight in still air: position_error, yaw_error, lost; for a drawing also "
       "mean_drawing_error, worst_drawing_error"},
      {"fly_runs", &guarded<fly_plan_often>, "(flights: @): table",
       "{through, runs, position_error, duration}: simulates many flights with random errors; "
       "gives "
       "the number that finish through all gates, the worst distance and the longest time",
       &fly_runs_table, kFlownPlan},
      {"time_path", &guarded<time_path>, "(path: @): table",
       "{points, times}: points of the path at equal distances, and the time of each; from rest to "
       "rest, as fast as the limits allow",
       &time_path_table, kPathVehicle},
      {"path_distance", &guarded<path_distance>, "(places: @): number",
       "largest distance of the points from the path, m", &path_distance_table},
      {"keyframe_stops", &guarded<stops_of_keyframes>, "(places: @): integer[]",
       "for each keyframe in order: the index of the nearest path point", &keyframe_stops_table},
      {"keyframe_times", &guarded<times_of_keyframes>, "(asked: @): number[]?, integer?",
       "the times of lowest cost that meet every wish; the cost is the duration plus the weighted "
       "squared differences from preferred times; otherwise nil and the keyframe whose wish cannot "
       "be met",
       &keyframe_times_table},
      {"pursue", &guarded<pursue_path>, "(path: @): table",
       "the simulated flight along straight lines by pure pursuit: duration, views, lost, "
       "position_error",
       &pursue_table, kVehicleObject}};
  return methods;
}

}  // namespace lapwing
