// SPDX-License-Identifier: Apache-2.0
#include "framework/mission/place_library.h"

#include <lua.hpp>

#include "framework/core/number_text.h"
#include "framework/mission/guard.h"
#include "framework/mission/run.h"
#include "framework/mission/value_path.h"

namespace lapwing {
namespace {

// An option's entry; null where nobody stated it.
const Value* stated_entry(const Value* option, const char* key) {
  const Value* value = option ? option->find(key) : nullptr;
  return value && !value->is_null() ? value : nullptr;
}

// run:take_origin("origin"): the option of that name is the origin of the world frame, of all plans
// that the mission makes.
int take_origin(lua_State* state) {
  const std::string path = text_argument(state, 2, "take_origin");
  MissionRun& run = run_of(state);
  const Value* given = at_path(run.configuration, path);
  std::string missing;
  double figures[3] = {};
  for (int i = 0; const char* key : {"latitude_deg", "longitude_deg", "height"}) {
    if (const Value* value = stated_entry(given, key))
      figures[i] = value->as_number();
    else
      missing += std::string(missing.empty() ? "" : ", ") + key;
    ++i;
  }
  const Value* word = stated_entry(given, "height_of");
  if (!word && missing == "latitude_deg, longitude_deg, height") return 0;
  if (!word)
    throw InputError(place_of_option(state, path),
                     path + ".height_of: expected ellipsoid, sea or ground: heights of the three " +
                         "differ by up to 100 m and more");
  if (!missing.empty())
    throw InputError(place_of_option(state, path), path + ": " + missing + " missing");
  try {
    run.origin =
        stated_origin(figures[0], figures[1], figures[2], *height_of_named(word->as_text()), path);
  } catch (const InputError& error) {  // it begins with the key
    const std::string message = error.what();
    throw InputError(place_of_option(state, message.substr(0, message.find(':'))), message);
  }
  return 0;
}

Eigen::Vector3d place_from(const Value& numbers) {
  const auto& entries = numbers.as_list();
  return {entries.at(0).as_number(), entries.at(1).as_number(), entries.at(2).as_number()};
}

// Keyframes beyond the limits, as far as options state them in the world: no flight to them could
// be certified. A keyframe may be missed by its tolerance.
void require_keyframes_within(lua_State* state, const MissionRun& run, const Home& home) {
  constexpr double kTolerance = 0.5;  // m
  const Value* keyframes = at_path(run.configuration, "keyframes");
  if (!keyframes || !keyframes->is_list()) return;
  for (std::size_t i = 0; i < keyframes->as_list().size(); ++i) {
    const Value& keyframe = keyframes->as_list()[i];
    if (!keyframe.is_map() || stated_entry(&keyframe, "beside")) continue;
    const Value* position = stated_entry(&keyframe, "position");
    if (!position || !position->is_list() || position->as_list().size() != 3) continue;
    const Eigen::Vector3d off = place_from(*position) - home.position;
    const std::string path = "keyframes[" + std::to_string(i + 1) + "].position";
    const auto refuse = [&](double off_home, const char* way, double limit, const char* option) {
      throw InputError(place_of_option(state, path), path + ": " + plain_number(off_home) + " m " +
                                                         way + " home, beyond home." + option +
                                                         " = " + plain_number(limit) + " m");
    };
    if (home.max_height && off.z() > *home.max_height + kTolerance)
      refuse(off.z(), "above", *home.max_height, "max_height");
    if (home.max_distance && off.head<2>().norm() > *home.max_distance + kTolerance)
      refuse(off.head<2>().norm(), "from", *home.max_distance, "max_distance");
  }
}

// run:take_home("home"): the option of that name is the take-off place of all plans that the
// mission makes.
int take_home(lua_State* state) {
  const std::string path = text_argument(state, 2, "take_home");
  MissionRun& run = run_of(state);
  const Value* given = at_path(run.configuration, path);
  const Value* position = stated_entry(given, "position");
  const Value* height = stated_entry(given, "max_height");
  const Value* distance = stated_entry(given, "max_distance");
  const Value* points = stated_entry(given, "rally_points");
  if (!position) {
    if (!height && !distance && (!points || points->as_list().empty())) return 0;
    throw InputError(place_of_option(state, path),
                     path +
                         ".position: missing; expected the take-off place, {x, y, z} in metres, "
                         "from which the others count");
  }
  Home home;
  home.position = place_from(*position);
  if (height) home.max_height = height->as_number();
  if (distance) home.max_distance = distance->as_number();
  if (points)
    for (const Value& point : points->as_list())
      home.rally_points.push_back(place_from(point.at("position")));
  require_keyframes_within(state, run, home);
  run.home = std::move(home);
  return 0;
}

}  // namespace

std::span<const Binding> place_methods_of_run() {
  static const Binding methods[] = {
      {"take_origin", &guarded<take_origin>, "(option: string)",
       "sets the geodetic origin of all plans of the mission from the option: {latitude_deg, "
       "longitude_deg, height, height_of}"},
      {"take_home", &guarded<take_home>, "(option: string)",
       "sets the take-off place of all plans of the mission from the option: {position, "
       "max_height, max_distance, rally_points}"}};
  return methods;
}

}  // namespace lapwing
