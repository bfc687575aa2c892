// SPDX-License-Identifier: Apache-2.0
#include "framework/mission/way_library.h"

#include <cmath>

#include <lua.hpp>

#include "framework/mission/environment_space.h"
#include "framework/mission/guard.h"
#include "framework/mission/lua_value.h"
#include "framework/mission/run.h"
#include "framework/path/passages.h"

namespace lapwing {
namespace {

using Way = std::vector<Eigen::Vector3d>;

// Around both places and everything in the way, not below the lower one.
Eigen::AlignedBox3d planning_bounds(const Environment& environment,
                                    const std::vector<KeptBall>& balls, const Eigen::Vector3d& from,
                                    const Eigen::Vector3d& to) {
  constexpr double kRoom = 10;  // m
  Eigen::AlignedBox3d box(from);
  box.extend(to);
  const double floor = box.min().z();
  // Of what has no end, the ends that it has.
  for (const Obstacle& obstacle : environment.obstacles) {
    if (obstacle.side == Side::keep_inside || !obstacle.still() || !obstacle.shape) continue;
    if (obstacle.shape->surrounds()) continue;
    const Eigen::AlignedBox3d bounds = obstacle.shape->bounds();
    for (Eigen::Vector3d end : {bounds.min(), bounds.max()}) {
      for (int i = 0; i < 3; ++i)
        if (!std::isfinite(end(i))) end(i) = i < 2 ? from(i) : floor;
      box.extend(end);
    }
  }
  for (const KeptBall& ball : balls) {
    const Eigen::Vector3d around = Eigen::Vector3d::Constant(ball.distance - environment.margin);
    box.extend(Eigen::Vector3d(ball.center + around));
    box.extend(Eigen::Vector3d(ball.center - around));
  }
  Eigen::Vector3d lower = box.min() - Eigen::Vector3d::Constant(kRoom);
  lower.z() = floor - environment.margin;
  return {lower, box.max() + Eigen::Vector3d::Constant(kRoom)};
}

// Bystanders that stand still, with the distance that is kept from them. One who stands so near to
// an end of the way that no way there keeps the distance is left to the solver.
std::vector<KeptBall> bystanders_of(const Environment& environment, const Eigen::Vector3d& from,
                                    const Eigen::Vector3d& to) {
  std::vector<KeptBall> balls;
  for (const Subject& subject : environment.subjects) {
    if (subject.filmed || subject.positions.size() != 1) continue;
    const Eigen::Vector3d& middle = subject.positions[0];
    if (std::min((from - middle).norm(), (to - middle).norm()) < subject.distance) continue;
    balls.push_back({middle, subject.distance});
  }
  return balls;
}

Way way_of(const Value& given, const Origin& origin, const std::string& what) {
  Way way;
  for (const Value& place : given.is_list() ? given.as_list() : Value::List{}) {
    if (!place.is_list() || place.as_list().size() != 3)
      throw InputError(origin, what + ": expected places {x, y, z}");
    const auto& p = place.as_list();
    way.emplace_back(p[0].as_number(), p[1].as_number(), p[2].as_number());
  }
  if (way.size() < 2) throw InputError(origin, what + ": expected two places or more");
  return way;
}

std::vector<Way> excluded_argument(lua_State* state, const Origin& origin) {
  std::vector<Way> ways;
  lua_getfield(state, 2, "excluded");
  const Value given = value_from_lua(state, -1, origin, "plan_way.excluded");
  lua_pop(state, 1);
  if (given.is_null()) return ways;
  for (const Value& way : given.is_list() ? given.as_list() : Value::List{})
    ways.push_back(way_of(way, origin, "plan_way.excluded"));
  return ways;
}

}  // namespace

ParameterTable way_table() {
  ParameterTable table;
  table.required_numbers("from", 3, "m", "world")
      .required_numbers("to", 3, "m", "world")
      .number("more", 0, "m", "distance in addition to the margin", at_least(0))
      .integer("tries", PassageSearch{}.tries, "attempts of the planner, if paths are excluded",
               between(1, 1000));
  return table;
}

int plan_way(lua_State* state) {
  MissionRun& run = run_of(state);
  const ProblemObject& object = object_argument<ProblemObject>(state, 1, kProblemType);
  const Origin origin = Sandbox::of(state).script_position(state);
  const Parameters given = table_argument(state, 2, way_table(), "plan_way", kWayObjects);
  PassageSearch search;
  search.excluded = excluded_argument(state, origin);
  search.tries = static_cast<int>(given.integer("tries"));
  lua_getfield(state, 2, "planner");
  const PluginChoice chosen = plugin_choice(state, -1, "planner");
  const auto planner =
      run.settings.registry->create<PathPlanner>(chosen.type, chosen.parameters, "planner");
  PathProblem problem;
  problem.start = Eigen::Vector3d(given.numbers("from").data());
  problem.goal = Eigen::Vector3d(given.numbers("to").data());
  const Environment& environment = object.problem->environment();
  const auto balls = bystanders_of(environment, problem.start, problem.goal);
  const auto space = free_space_of(environment, balls, given.number("more"));
  problem.space = space.get();
  problem.bounds = planning_bounds(environment, balls, problem.start, problem.goal);
  if (run.judging) {  // what is asked of the problem after it can be judged without a way
    push_value(state, Value(Value::List{list_of(problem.start), list_of(problem.goal)}));
    return 1;
  }
  PathRequest request;
  request.seed = run.settings.seed;
  request.cancellation = run.settings.cancellation;
  PassageResult found;
  {
    const Sandbox::ClockPause pause(Sandbox::of(state));
    found = find_passage(*planner, problem, request, search);
  }
  const PathReport& report = found.path.report;
  if (report.status == PathStatus::failed) throw PluginError(report.message);
  if (report.status != PathStatus::found) {
    lua_pushnil(state);
    push_text(state, std::string(to_string(report.status)) +
                         (report.message.empty() ? "" : ": " + report.message));
    push_text(state, to_string(report.status));
    return 3;
  }
  Value points = Value::list();
  for (const Eigen::Vector3d& p : found.path.points) points.push_back(list_of(p));
  push_value(state, points);
  return 1;
}

int grow_corridor_of_problem(lua_State* state) {
  const ProblemObject& object = object_argument<ProblemObject>(state, 1, kProblemType);
  const Origin origin = Sandbox::of(state).script_position(state);
  table_argument(state, 2, {}, "grow_corridor", kCorridorWay);
  lua_getfield(state, 2, "way");
  const Way way =
      way_of(value_from_lua(state, -1, origin, "grow_corridor.way"), origin, "grow_corridor.way");
  const Environment& environment = object.problem->environment();
  const auto balls = bystanders_of(environment, way.front(), way.back());
  std::vector<CorridorBox> boxes;
  {
    const Sandbox::ClockPause pause(Sandbox::of(state));
    const auto space = free_space_of(environment, balls, 0);
    boxes =
        grow_corridor(*space, planning_bounds(environment, balls, way.front(), way.back()), way);
  }
  Value list = Value::list();
  for (const CorridorBox& box : boxes) {
    Value entry = Value::map();
    entry.set("from", box.from);
    entry.set("to", box.to);
    entry.set("lower", list_of(box.box.min()));
    entry.set("size", list_of(box.box.sizes()));
    list.push_back(std::move(entry));
  }
  push_value(state, list);
  return 1;
}

}  // namespace lapwing
