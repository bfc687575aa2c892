// SPDX-License-Identifier: Apache-2.0
#include "framework/studio/worker_games.h"

#include <algorithm>

#include "framework/core/folders.h"
#include "framework/core/json.h"
#include "framework/core/number_text.h"
#include "framework/core/parameters.h"
#include "framework/export/race_report.h"
#include "framework/export/run_folder.h"
#include "framework/mission/players.h"

namespace lapwing {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMostGames = 4;
constexpr std::size_t kLongestName = 100;  // bytes
constexpr int kMostFolders = 999;

ParameterTable game_table() {
  ParameterTable player;
  player.required_text("name", "name")
      .boolean("by_hand", true, "false: the stick stays in the middle");
  add_player_numbers(player);
  ParameterTable table;
  table.tables("players", player, "who races", true);
  return table;
}

std::vector<RacePlayer> players_in(const Value& given) {
  const Parameters game = check(game_table(), given);
  std::vector<RacePlayer> players;
  for (const Parameters& one : game.tables("players")) {
    Pilot pilot{.name = one.text("name"), .log = StickLog({StickSample{}}, one.text("name"))};
    read_player_numbers(one, pilot);
    if (pilot.name.empty() || pilot.name.size() > kLongestName)
      throw InputError("players: a name has 1 to " + std::to_string(kLongestName) + " bytes");
    const bool twice = std::any_of(players.begin(), players.end(),
                                   [&](const RacePlayer& p) { return p.pilot.name == pilot.name; });
    if (twice) throw InputError("players: two have the name '" + pilot.name + "'");
    players.push_back({std::move(pilot), one.boolean("by_hand")});
  }
  return players;
}

// Where everyone is.
std::string state_text(const LiveRace& race, const std::string& result) {
  Value state = Value::map();
  state.set("time", race.time());
  state.set("over", race.over());
  Value& list = state.set("players", Value::list());
  for (std::size_t k = 0; k < race.players(); ++k) {
    const RaceInProgress& flown = race.race(k);
    const BodyState& body = flown.state();
    Value one = Value::map();
    one.set("name", as_utf8(race.player(k).pilot.name));
    one.set("by_hand", race.player(k).by_hand);
    one.set("position",
            Value(Value::List{body.position.x(), body.position.y(), body.position.z()}));
    one.set("orientation", Value(Value::List{body.orientation.w(), body.orientation.x(),
                                             body.orientation.y(), body.orientation.z()}));
    one.set("speed", body.velocity.norm());
    one.set("progress", flown.progress());
    one.set("deviation", flown.deviation());
    one.set("score", race.score(k));
    if (flown.ended()) one.set("end", std::string(to_string(flown.flight().end)));
    list.push_back(std::move(one));
  }
  if (!result.empty()) state.set("result", result);
  return to_json(state, -1);
}

// A number that replays the same game, in an argument of `lapwing race`.
std::string stated(double number) {
  return plain_number(number, 17);
}

std::string words_of(const RacePlayer& player, const std::string& log) {
  const Pilot& pilot = player.pilot;
  // What an argument of a shell, or of --pilot, would take for something else.
  const bool plain = std::none_of(pilot.name.begin(), pilot.name.end(), [](char c) {
    return std::string_view("',:=").find(c) != std::string_view::npos || (c >= 0 && c < ' ') ||
           c == 127;
  });
  return " --pilot '" + log + ":weight=" + stated(pilot.weight) +
         ",strength=" + stated(pilot.strength) + ",reach=" + stated(pilot.reach) +
         ",speed=" + stated(pilot.speed) + ",handicap=" + stated(pilot.handicap) +
         (plain ? ",name=" + pilot.name : "") + "'";
}

// That is not there yet.
fs::path game_folder(const std::string& mission) {
  for (int k = 1; k <= kMostFolders; ++k) {
    char number[16];
    std::snprintf(number, sizeof number, "-game-%03d", k);
    const fs::path folder = fs::absolute(run_folder(mission)).string() + number;
    if (!fs::exists(folder)) return folder;
  }
  throw InputError("there are 999 folders of games already: delete some");
}

}  // namespace

Frame WorkerGames::begin(const Frame& asked, Plan plan) {
  if (plan.task.gates.empty()) throw InputError("the plan has no gates: it is no race");
  const Vehicle vehicle = vehicle_from_value(plan.vehicle);
  Value given = Value::map();
  given.set("players", asked.header.at("players"));
  LiveRace race(plan.trajectory, plan.task.gates, vehicle, players_in(given));
  games_.push_back({asked.header.at("id").as_text(), std::move(plan), std::move(race)});
  if (games_.size() > kMostGames) {  // one that is over, if there is one
    auto oldest = std::find_if(games_.begin(), games_.end(),
                               [](const Game& game) { return game.last.has_value(); });
    games_.erase(oldest == games_.end() ? games_.begin() : oldest);
  }
  Frame frame;
  frame.header.set("said", "done");
  frame.parts.push_back(state_text(games_.back().race, ""));
  return frame;
}

Frame WorkerGames::stick(const Frame& asked) {
  const std::string& id = asked.header.at("id").as_text();
  const auto found =
      std::find_if(games_.begin(), games_.end(), [&](const Game& game) { return game.id == id; });
  if (found == games_.end())
    throw InputError(
        "this game is gone: the process that flew it ended, or too many others began; race again");
  if (found->last) return *found->last;
  std::vector<Eigen::Vector2d> sticks;
  for (const Value& stick : asked.header.at("sticks").as_list())
    sticks.emplace_back(stick.as_list().at(0).as_number(), stick.as_list().at(1).as_number());
  if (!found->race.over()) found->race.advance(asked.header.at("time").as_number(), sticks);
  Frame frame;
  frame.header.set("said", "done");
  if (found->race.over())
    finish(*found, frame);
  else
    frame.parts.push_back(state_text(found->race, ""));
  return frame;
}

void WorkerGames::finish(Game& game, Frame& frame) {
  const std::vector<RacedPilot> raced = game.race.finish();
  const fs::path folder = game_folder(game.plan.mission);
  NamedContents contents{{"plan.json", plan_text(game.plan)},
                         {"race.html", render_html(race_report(game.plan, raced))}};
  std::string again = "lapwing race plan.json";
  for (std::size_t k = 0; k < raced.size(); ++k) {
    const std::string log =
        std::to_string(k + 1) + "_" + run_folder_name(raced[k].pilot.name) + ".csv";
    contents.emplace_back(log, stick_log_text(raced[k].pilot.log));
    again += words_of(game.race.player(k), log);
  }
  contents.emplace_back("again.sh", "#!/bin/sh\n# Flies the same game again, in this folder.\n" +
                                        again + " \"$@\"\n");
  write_folder_atomically(folder, contents);
  Value& files = frame.header.set("files", Value::list());
  for (const auto& [file, bytes] : contents) files.push_back((folder / file).string());
  frame.parts.push_back(state_text(game.race, race_result(raced)));
  game.last = frame;
}

}  // namespace lapwing
