// SPDX-License-Identifier: Apache-2.0
// How much of a region the images of several tours locate accurately enough.
#include <algorithm>

#include <lua.hpp>

#include "framework/map/known_surface.h"
#include "framework/mission/fleet_objects.h"
#include "framework/mission/guard.h"
#include "framework/mission/lua_value.h"
#include "framework/mission/scan_record.h"

namespace lapwing {
namespace {

constexpr BoundField kAccuracyObjects[] = {{"team", "lapwing.team", "tours whose images count"}};

ParameterTable accuracy_table() {
  ParameterTable table;
  table
      .required_number("accuracy", "m", "largest standard deviation, in the worst direction",
                       above(0))
      .number("pixel_error", 0.5, "px", "standard deviation of a point in an image", above(0))
      .boolean("reachable", false,
               "count images at all views that some tour can reach, not at those of the tours");
  return table;
}

// Views of the tours that are flown: those with an image elsewhere than at their start.
std::vector<int> views_of_team(const TeamObject& team, bool reachable) {
  if (reachable) return team.reachable;
  std::vector<int> views;
  for (const TourObject& tour : team.tours)
    if (TourProblem::images_of(tour.walk) > 1)
      views.insert(views.end(), tour.walk.begin(), tour.walk.end());
  std::sort(views.begin(), views.end());
  views.erase(std::unique(views.begin(), views.end()), views.end());
  return views;
}

// run:accurate_area{team =, accuracy =, pixel_error =, reachable =}: m^2, m^2
int accurate_area_of_run(lua_State* state) {
  MissionRun& run = run_of(state);
  const Parameters given =
      table_argument(state, 2, accuracy_table(), "accurate_area", kAccuracyObjects);
  lua_getfield(state, 2, "team");
  const TeamObject& team = object_argument<TeamObject>(state, -1, kTeamType);
  if (team.tours.empty()) throw InputError("accurate_area: a team without tours shows nothing");
  AccurateArea area;
  {
    const Sandbox::ClockPause pause(Sandbox::of(state));
    area =
        accurate_area(*team.tours.front().work, views_of_team(team, given.boolean("reachable")),
                      given.number("accuracy"), given.number("pixel_error"), run.settings.threads);
  }
  lua_pushnumber(state, area.accurate);
  lua_pushnumber(state, area.known);
  return 2;
}

}  // namespace

std::span<const Binding> accuracy_methods_of_run() {
  static const Binding methods[] = {
      {"accurate_area", &guarded<accurate_area_of_run>, "(asked: @): number, number",
       "m^2 of the known surface of the region that images locate that accurately, and all of it",
       &accuracy_table, kAccuracyObjects}};
  return methods;
}

}  // namespace lapwing
