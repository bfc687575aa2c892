// SPDX-License-Identifier: Apache-2.0
// Races that the controller cannot follow.
#pragma once

#include <gmock/gmock.h>

#include "tests/missions/race_fixture.h"

namespace lapwing {

class RaceAdvice : public Race {
 protected:
  // Stands between two gates that ask the whole quadrotor for more than its controller can follow.
  static std::string turns(const std::string& more) {
    return "model = 'quadrotor_full', thrust = 1, refinements = 1, start = {0, 0, 2}, finish = "
           "{12, 4, 2}, gates = { { shape = 'ball', position = {6, 0, 2}, radius = 0.3 }, { shape "
           "= 'ball', position = {6, 6, 3}, radius = 0.3 } }, " +
           more;
  }
  static std::vector<std::string> notes(const Flown& flown) {
    std::vector<std::string> list;
    if (const Value* notes = flown.result.find("notes"))
      for (const Value& note : notes->as_list()) list.push_back(note.as_text());
    return list;
  }
  // "--set thrust=0.5 --set rate_share=0.3" at the end of a note.
  static std::string settings(const std::string& note) { return note.substr(note.find("--set ")); }
};

}  // namespace lapwing
