// SPDX-License-Identifier: Apache-2.0
// Races that are flown by hand in a page: the working process flies them, stick by stick. Internal
// to this room.
#pragma once

#include <deque>
#include <filesystem>
#include <optional>
#include <string>

#include "framework/studio/frames.h"
#include "framework/trajectory/plan.h"
#include "framework/vehicle/live_race.h"

namespace lapwing {

class WorkerGames {
 public:
  // A new game on the plan. InputError for a plan that is no race, and for players that cannot be.
  Frame begin(const Frame& asked, Plan plan);
  // Flies on to a time. The last of it writes the game's folder, out/NAME-game-NNN: the plan, a log
  // for each player and the page that `lapwing race` makes of them.
  Frame stick(const Frame& asked);

 private:
  struct Game {
    std::string id;
    Plan plan;
    LiveRace race;
    std::optional<Frame> last = {};  // once it is over and written; told again to who asks again
  };
  void finish(Game& game, Frame& frame);

  std::deque<Game> games_;  // the newest last
};

}  // namespace lapwing
