// SPDX-License-Identifier: Apache-2.0
// Keys of a live flight: space pauses, r resumes, a and q abort.
#pragma once

#include <termios.h>

#include <optional>
#include <string>
#include <vector>

#include "framework/fly/flight_session.h"

namespace lapwing {

// Takes single keys of the terminal at standard input while it lives; the terminal is then as it
// was. Without a terminal there are no keys.
class FlightKeys {
 public:
  FlightKeys();
  ~FlightKeys();
  FlightKeys(const FlightKeys&) = delete;
  FlightKeys& operator=(const FlightKeys&) = delete;

  bool there() const { return there_; }
  // The next key that means something; waits for none.
  std::optional<FlightKey> pressed();

 private:
  bool there_ = false;
  termios before_{};
};

// A key that is pressed by itself, in rehearsals.
struct PlannedKey {
  FlightKey key = FlightKey::pause;
  double at = 0;  // s after the plan's start
};

// "pause@3,resume@5.5,abort@9". Throws InputError for another text.
std::vector<PlannedKey> planned_keys_from(const std::string& text);

}  // namespace lapwing
