// SPDX-License-Identifier: Apache-2.0
#include "framework/vehicle/live_race.h"

#include <algorithm>
#include <cmath>

#include "framework/core/error.h"

namespace lapwing {

LiveRace::LiveRace(const Trajectory& course, const std::vector<GateTask>& gates,
                   const Vehicle& vehicle, std::vector<RacePlayer> players, const RaceRules& rules)
    : course_(course), gates_(gates), rules_(rules) {
  if (std::none_of(players.begin(), players.end(), [](const RacePlayer& p) { return p.by_hand; }))
    throw InputError("a game needs a player who flies by hand");
  const RaceFlightLimits limits = race_limits(course_, gates_);
  for (RacePlayer& player : players) {
    RaceInProgress race(course_, vehicle, player.pilot, limits);
    players_.push_back({std::move(player), std::move(race), {StickSample{}}});
  }
}

void LiveRace::advance(double time, const std::vector<Eigen::Vector2d>& sticks) {
  if (!std::isfinite(time) || time <= time_) throw InputError("time: it must rise");
  if (time - time_ > StickLog::kLongestGap)
    throw InputError("time: a stick must be told at least every 0.5 s");
  const auto flown = std::count_if(players_.begin(), players_.end(),
                                   [](const Player& p) { return p.player.by_hand; });
  if (sticks.size() != static_cast<std::size_t>(flown))
    throw InputError("sticks: expected " + std::to_string(flown) + ", one for each player");
  for (const Eigen::Vector2d& stick : sticks)
    if (!stick.allFinite() || stick.cwiseAbs().maxCoeff() > 1)
      throw InputError("sticks: each moves from -1 to 1");
  auto stick = sticks.begin();
  for (Player& player : players_) {
    const StickSample from = player.sticks.back();
    const StickSample to{time, player.player.by_hand ? *stick++ : Eigen::Vector2d::Zero()};
    const auto moving = [&](double at, const BodyState&, double) {
      return StickLog::between(from, to, at);
    };
    while (!player.race.ended() && player.race.time() < time) player.race.step(moving);
    player.sticks.push_back(to);
  }
  time_ = time;
}

bool LiveRace::over() const {
  return std::all_of(players_.begin(), players_.end(),
                     [](const Player& p) { return !p.player.by_hand || p.race.ended(); });
}

double LiveRace::score(std::size_t k) const {
  const RaceFlight& flight = players_[k].race.flight();
  if (flight.samples.empty()) return players_[k].player.pilot.handicap;
  return score_over_time(flight, course_, gates_, players_[k].player.pilot.handicap, rules_,
                         !players_[k].race.ended())
      .back();
}

std::vector<RacedPilot> LiveRace::finish() {
  std::vector<RacedPilot> all;
  for (Player& player : players_) {
    RacedPilot raced{player.player.pilot, {}, {}};
    raced.pilot.log = StickLog(player.sticks, raced.pilot.name);
    const auto logged = [&](double time, const BodyState&, double) {
      return raced.pilot.log.at(time);
    };
    while (!player.race.ended()) player.race.step(logged);
    raced.flight = player.race.flight();
    raced.score = score_of(raced.flight, course_, gates_, raced.pilot.handicap, rules_);
    all.push_back(std::move(raced));
  }
  return all;
}

}  // namespace lapwing
