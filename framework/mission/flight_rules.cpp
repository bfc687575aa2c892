// SPDX-License-Identifier: Apache-2.0
#include "framework/mission/flight_rules.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <lua.hpp>

#include "framework/core/number_text.h"
#include "framework/mission/environment_source.h"
#include "framework/mission/environment_space.h"
#include "framework/mission/guard.h"
#include "framework/mission/lua_value.h"
#include "framework/mission/scan_objects.h"
#include "framework/mission/vectors.h"
#include "framework/path/pilot_sight.h"

namespace lapwing {
namespace {

using Eigen::Vector3d;

ParameterTable pilot_table() {
  const Range far = between(-1e6, 1e6);
  ParameterTable table;
  table.optional_numbers("position", 3, "m", "eye of the pilot, world; absent: no pilot", far)
      .number("range", PilotPlace{}.range, "m", "largest distance of the vehicle from the eye",
              {0, 1e5, true})
      .number("beside", PilotPlace{}.beside, "m",
              "distance from the eye within which nothing hides the vehicle", between(0, 100));
  return table;
}

ParameterTable rules_table() {
  ParameterTable table;
  table
      .number("margin", 0, "m",
              "distance from zones that the certificate requires, accuracy included", at_least(0))
      .number("accuracy", 0, "m", "accuracy of the position in flight", at_least(0))
      .table("pilot", pilot_table(), "a pilot who must see the vehicle all the time");
  return table;
}

constexpr BoundField kRulesObjects[] = {
    {"zones?", "lapwing.shape[]", "shapes that the flight keeps out of, or inside of"}};

// run:flight_rules{zones =, margin =, accuracy =, pilot = {position =, range =, beside =}}
int flight_rules_of_run(lua_State* state) {
  MissionRun& run = run_of(state);
  const Parameters given = table_argument(state, 2, rules_table(), "flight_rules", kRulesObjects);
  lua_getfield(state, 2, "zones");
  const Value zones = value_from_lua(state, -1, given.origin(), "flight_rules.zones");
  auto rules = std::make_shared<FlightRules>();
  Value margin = Value::map();
  margin.set("margin", given.number("margin"));
  margin.with_origin(given.origin());
  rules->zones = environment_of(check(environment_table(), margin, "flight_rules"),
                                zones.is_list() && zones.as_list().empty() ? Value() : zones, run);
  rules->accuracy = given.number("accuracy");
  const Parameters& pilot = given.table("pilot");
  if (pilot.has("position"))
    rules->pilot = {vector_of(pilot.numbers("position")), pilot.number("range"),
                    pilot.number("beside")};
  new_object(state, kFlightRulesType, FlightRulesObject{std::move(rules)});
  return 1;
}

ParameterTable place_table() {
  ParameterTable table;
  table.required_numbers("position", 3, "m", "middle of the vehicle, world")
      .numbers("body", {1, 1, 0.5}, "m", "half edges of its box");
  return table;
}

// rules:forbids{position =, body =}: why, or nil.
int forbids(lua_State* state) {
  const auto& object = object_argument<FlightRulesObject>(state, 1, kFlightRulesType);
  const Parameters given = table_argument(state, 2, place_table(), "forbids");
  const std::string why = forbidden_by(*object.rules, vector_of(given.numbers("position")),
                                       vector_of(given.numbers("body")));
  if (why.empty())
    lua_pushnil(state);
  else
    push_text(state, why);
  return 1;
}

// Places of a lattice in a box, reached from one of them by free steps along the axes.
class Flood {
 public:
  Flood(const FreeSpace& space, const Eigen::AlignedBox3d& box, const Vector3d& half, double step)
      : space_(space), box_(box), half_(half) {
    // So few that the answer takes about a second.
    constexpr double kMost = 100'000;
    const auto count = [&] {
      double all = 1;
      for (int i = 0; i < 3; ++i) {
        count_[i] = 1 + static_cast<int>(std::floor(box_.sizes()[i] / step));
        all *= count_[i];
      }
      return all;
    };
    while (count() > kMost) step *= 1.2;
    step_ = step;
    states_.assign(static_cast<std::size_t>(count()), kNotTried);
  }

  // The share of all free places that are reached.
  double reached_from(const Vector3d& from) {
    std::int64_t reached = 0, open = 0;
    std::vector<std::array<int, 3>> front;
    const auto visit = [&](const std::array<int, 3>& at, const Vector3d& before) {
      for (int i = 0; i < 3; ++i)
        if (at[static_cast<std::size_t>(i)] < 0 || at[static_cast<std::size_t>(i)] >= count_[i])
          return;
      char& state = states_[place(at)];
      if (state == kReached || !space_.swept_box_free(before, middle(at), half_)) return;
      state = kReached;
      ++reached;
      front.push_back(at);
    };
    // The places round the start.
    std::array<int, 3> low;
    for (std::size_t i = 0; i < 3; ++i) {
      const auto axis = static_cast<Eigen::Index>(i);
      low[i] = static_cast<int>(std::floor((from[axis] - box_.min()[axis]) / step_));
    }
    for (int k = 0; k < 8; ++k)
      visit({low[0] + (k & 1), low[1] + (k >> 1 & 1), low[2] + (k >> 2)}, from);
    while (!front.empty()) {
      const std::array<int, 3> at = front.back();
      front.pop_back();
      for (std::size_t axis = 0; axis < 3; ++axis)
        for (const int by : {-1, 1}) {
          std::array<int, 3> next = at;
          next[axis] += by;
          visit(next, middle(at));
        }
    }
    for (int z = 0; z < count_[2]; ++z)
      for (int y = 0; y < count_[1]; ++y)
        for (int x = 0; x < count_[0]; ++x) {
          const Vector3d p = middle({x, y, z});
          open += states_[place({x, y, z})] == kReached || space_.swept_box_free(p, p, half_);
        }
    return open > 0 ? static_cast<double>(reached) / static_cast<double>(open) : 0;
  }

 private:
  static constexpr char kNotTried = 0, kReached = 1;
  std::size_t place(const std::array<int, 3>& at) const {
    return (static_cast<std::size_t>(at[2]) * static_cast<std::size_t>(count_[1]) +
            static_cast<std::size_t>(at[1])) *
               static_cast<std::size_t>(count_[0]) +
           static_cast<std::size_t>(at[0]);
  }
  Vector3d middle(const std::array<int, 3>& at) const {
    return box_.min() + step_ * Vector3d(at[0], at[1], at[2]);
  }

  const FreeSpace& space_;
  Eigen::AlignedBox3d box_;
  Vector3d half_;
  double step_ = 1;
  int count_[3] = {1, 1, 1};
  std::vector<char> states_;
};

ParameterTable reach_table() {
  ParameterTable table;
  table.required_numbers("from", 3, "m", "where a flight begins, world")
      .required_numbers("lower", 3, "m", "lowest corner of the space of the flight, world")
      .required_numbers("upper", 3, "m", "its highest corner")
      .numbers("body", {1, 1, 0.5}, "m", "half edges of the vehicle's box")
      .number("step", 2, "m", "distance of the places that are tried", above(0));
  return table;
}

// rules:reach{from =, lower =, upper =, body =}: the share of the space that zones allow which can
// be flown to.
int reach(lua_State* state) {
  const auto& object = object_argument<FlightRulesObject>(state, 1, kFlightRulesType);
  const Parameters given = table_argument(state, 2, reach_table(), "reach");
  const Vector3d from = vector_of(given.numbers("from"));
  Eigen::AlignedBox3d box(vector_of(given.numbers("lower")), vector_of(given.numbers("upper")));
  box.extend(from);
  const Sandbox::ClockPause pause(Sandbox::of(state));
  const auto space = free_space_of(object.rules->zones, {}, 0);
  const double share =
      Flood(*space, box, vector_of(given.numbers("body")), given.number("step")).reached_from(from);
  lua_pushnumber(state, share);
  return 1;
}

constexpr BoundField kRulesFields[] = {{"zones", "integer", "number of zones"},
                                       {"sees", "boolean", "whether a pilot must see the flight"}};

int rules_field(lua_State* state) {
  const auto& object = object_argument<FlightRulesObject>(state, 1, kFlightRulesType);
  Value fields = Value::map();
  fields.set("zones", static_cast<std::int64_t>(object.rules->zones.obstacles.size()));
  fields.set("sees", object.rules->pilot.has_value());
  return push_field(state, "flight rules", text_argument(state, 2, "flight rules"), fields,
                    kRulesFields);
}

}  // namespace

std::shared_ptr<const FlightRules> rules_argument(lua_State* state, int table) {
  std::shared_ptr<const FlightRules> rules;
  if (lua_getfield(state, table, "rules") != LUA_TNIL)
    rules = object_argument<FlightRulesObject>(state, -1, kFlightRulesType).rules;
  lua_pop(state, 1);
  return rules ? rules : std::make_shared<const FlightRules>();
}

std::unique_ptr<FreeSpace> ruled(std::unique_ptr<FreeSpace> space, const FlightRules& rules,
                                 std::shared_ptr<const Map> map) {
  if (!rules.zones.obstacles.empty())
    space = free_in_both(free_space_of(rules.zones, {}, 0), std::move(space));  // quick first
  if (rules.pilot)
    space = free_in_both(std::move(space), in_sight_of(std::move(map), *rules.pilot));
  return space;
}

std::string forbidden_by(const FlightRules& rules, const Vector3d& p, const Vector3d& half) {
  if (rules.pilot && (p - rules.pilot->eye).norm() > rules.pilot->range - kSightRoom)
    return "it is " + plain_number((p - rules.pilot->eye).norm(), 4) +
           " m from the pilot, whose range is " + plain_number(rules.pilot->range) + " m";
  if (rules.zones.obstacles.empty() ||
      free_space_of(rules.zones, {}, 0)->swept_box_free(p, p, half))
    return "";
  std::string worst;
  double least = std::numeric_limits<double>::infinity();
  bool inside = false;
  for (std::size_t i = 0; i < rules.zones.obstacles.size(); ++i) {
    const Obstacle& zone = rules.zones.obstacles[i];
    const double sign = zone.side == Side::keep_inside ? -1 : 1;
    const double room = sign * zone.shape->distance(p, nullptr);
    if (room < least) least = room, worst = zone.label(i + 1), inside = sign < 0;
  }
  if (least < 0) return (inside ? "it lies outside of " : "it lies in ") + worst;
  return "it lies " + plain_number(least, 3) + " m from the edge of " + worst +
         ", too near for the vehicle's box and the margin";
}

std::span<const Binding> flight_rule_methods_of_run() {
  static const Binding methods[] = {
      {"flight_rules", &guarded<flight_rules_of_run>, "(rules: @): lapwing.flight_rules",
       "zones and a pilot's line of sight that a flight keeps", &rules_table, kRulesObjects}};
  return methods;
}

void open_flight_rules_type(lua_State* state) {
  static const Binding methods[] = {
      {"forbids", &guarded<forbids>, "(place: @): string?",
       "why the zones or the pilot's range forbid a place; nil if they do not", &place_table},
      {"reach", &guarded<reach>, "(space: @): number",
       "share of the space that the zones allow which can be flown to", &reach_table}};
  define_type<FlightRulesObject>(state, kFlightRulesType, {methods}, &guarded<rules_field>);
  note_fields(state, kFlightRulesType, kRulesFields);
}

}  // namespace lapwing
