#include "framework/mission/flight_library.h"

#include <lua.hpp>

#include "framework/export/light_painting.h"
#include "framework/mission/guard.h"
#include "framework/mission/lua_value.h"
#include "framework/mission/run.h"

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

// run:fly(plan): how it comes out under control in still air; with strokes, how far the light is
// from them.
int fly_plan(lua_State* state) {
  const PlanObject& object = object_argument<PlanObject>(state, 2, kPlanType);
  Value result = Value::map();
  {
    const Sandbox::ClockPause pause(Sandbox::of(state));
    const FlownPath flown = fly(object.plan.trajectory, vehicle_from_value(object.plan.vehicle), {},
                                run_of(state).settings.cancellation);
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

// run:time_path{points = {x, y, z, ...}, spacing =, rounding =, speed =, acceleration =}: {points =
// {x, y, z, ...}, times = {...}}, as fast as the limits allow, from rest to rest.
int time_path(lua_State* state) {
  ParameterTable table;
  table.required_numbers("points", 0, "m", "x, y, z of each point in turn, world")
      .number("spacing", 0.01, "m", "between the points of the answer", above(0))
      .number("rounding", 0, "m", "of corners, standard deviation", at_least(0))
      .required_number("speed", "m/s", "largest", above(0))
      .required_number("acceleration", "m/s^2", "largest, along and across together", above(0));
  const Parameters given = table_argument(state, 2, table, "time_path");
  const Points path = points_of(given, "points");
  const double spacing = given.number("spacing"), length = length_of(path);
  if (!(length > 0)) throw InputError(given.origin("points"), "time_path: the path has no length");
  if (length / spacing > kMostPathPoints)
    throw InputError(given.origin("spacing"), "time_path: more than a million points");
  const Points smooth = rounded(resampled(path, spacing), given.number("rounding"));
  const std::vector<double> times =
      fastest_times(smooth, {given.number("speed"), given.number("acceleration")});
  Value points = Value::list(), result = Value::map();
  for (const Eigen::Vector3d& p : smooth)
    for (int axis = 0; axis < 3; ++axis) points.push_back(p(axis));
  result.set("points", std::move(points));
  result.set("times", Value(Value::List(times.begin(), times.end())));
  push_value(state, result);
  return 1;
}

}  // namespace lapwing
