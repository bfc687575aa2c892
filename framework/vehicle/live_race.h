// SPDX-License-Identifier: Apache-2.0
// A race that is flown now: the sticks come piece by piece, and `lapwing race` makes the same
// flights and scores of the logs that are left of them.
#pragma once

#include <vector>

#include "framework/vehicle/race_score.h"

namespace lapwing {

struct RacePlayer {
  Pilot pilot;          // its log is not looked at
  bool by_hand = true;  // false: the stick stays in the middle
};

class LiveRace {
 public:
  // Everyone at the start, sticks in the middle. Throws InputError as fly_race does, and where
  // nobody flies by hand.
  LiveRace(const Trajectory& course, const std::vector<GateTask>& gates, const Vehicle& vehicle,
           std::vector<RacePlayer> players, const RaceRules& rules = {});

  // Flies everyone to `time`, s from the start, the sticks moving evenly to where they are then.
  // `sticks`: forward and left, -1 to 1, of each player who flies by hand. Throws InputError, and
  // flies nothing, for a time that does not rise, a gap above StickLog::kLongestGap, another number
  // of sticks, a stick beyond 1.
  void advance(double time, const std::vector<Eigen::Vector2d>& sticks);

  double time() const { return time_; }
  bool over() const;  // whether all who fly by hand have ended
  std::size_t players() const { return players_.size(); }
  const RacePlayer& player(std::size_t k) const { return players_[k].player; }
  const RaceInProgress& race(std::size_t k) const { return players_[k].race; }
  // The score as it stands, s; a gate is missed once the next one is passed. Of who has ended, that
  // of `score_of`.
  double score(std::size_t k) const;

  // Everyone's flight to its end, their sticks in the middle from now on, with logs and scores.
  std::vector<RacedPilot> finish();

 private:
  struct Player {
    RacePlayer player;
    RaceInProgress race;
    std::vector<StickSample> sticks;
  };

  Trajectory course_;
  std::vector<GateTask> gates_;
  RaceRules rules_;
  std::vector<Player> players_;
  double time_ = 0;
};

}  // namespace lapwing
