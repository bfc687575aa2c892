// SPDX-License-Identifier: Apache-2.0
// Several plans as one fleet: when each of them is flown, and what their views see together.
#include <algorithm>

#include <lua.hpp>

#include "framework/core/parallel.h"
#include "framework/mission/fleet_objects.h"
#include "framework/mission/guard.h"
#include "framework/mission/lua_value.h"
#include "framework/mission/scan_record.h"
#include "framework/trajectory/fleet_schedule.h"

namespace lapwing {
namespace {

constexpr BoundField kFleetObjects[] = {
    {"team", "lapwing.team", "tours that the plans fly"},
    {"plans", "lapwing.plan[]", "plans of its tours"},
    {"drones", "string[]", "name of the drone that flies each plan"},
    {"notes?", "string[]", "sentences for the user"},
    {"figures?", "table", "figures of all tours, for --json"}};

ParameterTable fleet_table() {
  ParameterTable table;
  table
      .number("separation", 0, "m", "smallest distance of two drones in flight; 0: any",
              at_least(0))
      .number("swap", 0, "s",
              "smallest time between two tours of a drone: landing, change of the battery, climb",
              at_least(0))
      .number("reserve", 0, "s", "flight time that is left of a battery after its tour",
              at_least(0))
      .number("pixel_error", 0.5, "px", "standard deviation of a point in an image", above(0));
  return table;
}

// The plans listed, in the script's order.
std::vector<const PlanObject*> plans_argument(lua_State* state, int table) {
  std::vector<const PlanObject*> plans;
  if (lua_getfield(state, table, "plans") != LUA_TTABLE)
    throw InputError("fleet: plans: expected a list of plans");
  const int list = lua_gettop(state);
  for (lua_Integer i = 1; lua_rawgeti(state, list, i) != LUA_TNIL; ++i) {
    plans.push_back(&object_argument<PlanObject>(state, -1, kPlanType));
    if (!plans.back()->plan.task.scan) throw InputError("fleet: plans: expected plans of scans");
    lua_pop(state, 1);
  }
  lua_pop(state, 1);
  if (plans.empty()) throw InputError("fleet: plans: expected at least one plan");
  return plans;
}

std::vector<std::string> texts_argument(lua_State* state, int table, const char* key,
                                        const Origin& origin) {
  lua_getfield(state, table, key);
  const Value given = value_from_lua(state, lua_gettop(state), origin, std::string("fleet.") + key);
  lua_pop(state, 1);
  std::vector<std::string> texts;
  if (given.is_list())
    for (const Value& entry : given.as_list()) {
      if (!entry.is_text())
        throw InputError(origin, std::string("fleet: ") + key + ": expected texts");
      texts.push_back(entry.as_text());
    }
  return texts;
}

// Voxels of the region that all views together see.
std::int64_t seen_by_all(const std::vector<PlanObject>& plans, const VisibleVoxels& visible,
                         int threads) {
  std::vector<Viewpoint> views;
  for (const PlanObject& made : plans)
    for (const PlannedView& view : made.plan.task.scan->views)
      views.push_back({view.position, view.yaw, view.pitch});
  std::vector<std::vector<VoxelKey>> seen(views.size());
  parallel_for(views.size(), threads,
               [&](std::size_t i) { seen[i] = visible.voxels_from(views[i]); });
  std::vector<VoxelKey> all;
  for (const auto& one : seen) all.insert(all.end(), one.begin(), one.end());
  std::sort(all.begin(), all.end());
  return std::unique(all.begin(), all.end()) - all.begin();
}

// The plans in the order in which they are flown, and who flies them when.
void schedule(const std::vector<const PlanObject*>& plans, const std::vector<std::string>& drones,
              FleetObject& made) {
  Fleet& fleet = made.document;
  std::vector<TourToFly> tours;
  for (std::size_t i = 0; i < plans.size(); ++i)
    tours.push_back({drones[i], &plans[i]->plan.trajectory});
  for (const ScheduledTour& flown : fleet_schedule(tours, {fleet.separation, fleet.swap})) {
    fleet.tours.push_back(
        {drones[flown.tour], flown.battery, flown.start, fleet_plan_name(fleet.tours.size()), ""});
    made.plans.push_back(*plans[flown.tour]);
  }
}

// What the images of all tours that are flown will show.
void tell_fleet(const TeamObject& team, double pixel_error, MissionRun& run, FleetObject& made) {
  std::vector<TourObject> flown;
  for (const TourObject& tour : team.tours)
    if (TourProblem::images_of(tour.walk) > 1) flown.push_back(tour);
  if (flown.empty()) throw InputError("fleet: no tour of the team takes an image");
  const auto record = record_of_fleet(flown, pixel_error, run.settings.threads);
  tell_scan(*record, run, {made.block, made.notes, made.told});
  const auto plan = std::make_shared<const Plan>(made.plans.front().plan);
  made.scan = record;
  made.late_sections = [record, plan](const Plan&) { return fleet_sections(*plan, *record); };
}

// run:fleet{team =, plans =, drones =, separation =, swap =, reserve =, pixel_error =, notes =,
// figures =}
int fleet_of_run(lua_State* state) {
  MissionRun& run = run_of(state);
  const Origin origin = Sandbox::of(state).script_position(state);
  const Parameters given = table_argument(state, 2, fleet_table(), "fleet", kFleetObjects);
  lua_getfield(state, 2, "team");
  const TeamObject& team = object_argument<TeamObject>(state, -1, kTeamType);
  if (team.tours.empty()) throw InputError("fleet: a team without tours makes no fleet");
  const std::vector<const PlanObject*> plans = plans_argument(state, 2);
  const std::vector<std::string> drones = texts_argument(state, 2, "drones", origin);
  if (drones.size() != plans.size())
    throw InputError(origin, "fleet: expected one name of a drone for each of the " +
                                 std::to_string(plans.size()) + " plans, got " +
                                 std::to_string(drones.size()));
  FleetObject made;
  made.notes = texts_argument(state, 2, "notes", origin);
  lua_getfield(state, 2, "figures");
  made.block = value_from_lua(state, lua_gettop(state), origin, "fleet.figures");
  made.report = report_of(team.report);
  made.solver = team.solver;
  Fleet& fleet = made.document;
  fleet.mission = run.name;
  fleet.kind = run.kind;
  fleet.separation = given.number("separation");
  fleet.swap = given.number("swap");
  fleet.reserve = given.number("reserve");
  fleet.solver = to_value(team.report, team.solver);
  {
    const Sandbox::ClockPause pause(Sandbox::of(state));
    schedule(plans, drones, made);
    fleet.seen = seen_by_all(made.plans, *team.tours.front().work->visible, run.settings.threads);
    fleet.seen_share = made.plans.front().plan.task.scan->seen_share;
    tell_fleet(team, given.number("pixel_error"), run, made);
  }
  new_object(state, kFleetType, std::move(made));
  return 1;
}

constexpr BoundField kFleetFields[] = {
    {"duration", "number", "s until the last tour ends"},
    {"swaps", "integer", "changes of batteries"},
    {"views", "table[]", "views of all tours: {position, yaw, pitch}, m and rad"}};

int fleet_field(lua_State* state) {
  const FleetObject& made = object_argument<FleetObject>(state, 1, kFleetType);
  double end = 0;
  Value views = Value::list(), fields = Value::map();
  for (std::size_t t = 0; t < made.plans.size(); ++t) {
    const Plan& plan = made.plans[t].plan;
    end = std::max(end, made.document.tours[t].start + plan.trajectory.duration());
    for (const PlannedView& view : plan.task.scan->views) {
      Value entry = Value::map();
      entry.set("position", list_of(view.position));
      entry.set("yaw", view.yaw);
      entry.set("pitch", view.pitch);
      views.push_back(std::move(entry));
    }
  }
  fields.set("duration", end);
  fields.set("swaps", swaps_of(made.document));
  fields.set("views", std::move(views));
  const std::string field = text_argument(state, 2, "fleet");
  return push_field(state, "a fleet", field, fields, kFleetFields);
}

}  // namespace

void open_fleet_library(lua_State* state) {
  open_team_type(state);
  define_type<FleetObject>(state, kFleetType, {}, &guarded<fleet_field>);
  note_fields(state, kFleetType, kFleetFields);
}

std::span<const Binding> fleet_methods_of_run() {
  static const Binding own[] = {{"fleet", &guarded<fleet_of_run>, "(made: @): lapwing.fleet",
                                 "plans that several batteries or drones fly as one", &fleet_table,
                                 kFleetObjects}};
  static const std::vector<Binding> all = [] {
    std::vector<Binding> list;
    for (const std::span<const Binding> part :
         {team_methods_of_run(), accuracy_methods_of_run(), std::span<const Binding>(own)})
      list.insert(list.end(), part.begin(), part.end());
    return list;
  }();
  return all;
}

}  // namespace lapwing
