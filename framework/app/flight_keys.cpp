// SPDX-License-Identifier: Apache-2.0
#include "framework/app/flight_keys.h"

#include <poll.h>
#include <unistd.h>

#include <charconv>
#include <sstream>

#include "framework/core/error.h"

namespace lapwing {

FlightKeys::FlightKeys() {
  if (!::isatty(STDIN_FILENO) || ::tcgetattr(STDIN_FILENO, &before_) != 0) return;
  termios single = before_;
  single.c_lflag &= static_cast<tcflag_t>(~(ICANON | ECHO));
  there_ = ::tcsetattr(STDIN_FILENO, TCSANOW, &single) == 0;
}

FlightKeys::~FlightKeys() {
  if (there_) ::tcsetattr(STDIN_FILENO, TCSANOW, &before_);
}

std::optional<FlightKey> FlightKeys::pressed() {
  pollfd waiting{STDIN_FILENO, POLLIN, 0};
  while (there_ && ::poll(&waiting, 1, 0) > 0) {
    char key = 0;
    if (::read(STDIN_FILENO, &key, 1) != 1) return std::nullopt;
    if (key == ' ') return FlightKey::pause;
    if (key == 'r') return FlightKey::resume;
    if (key == 'a' || key == 'q') return FlightKey::abort;
  }
  return std::nullopt;
}

std::vector<PlannedKey> planned_keys_from(const std::string& text) {
  std::vector<PlannedKey> keys;
  std::istringstream parts(text);
  for (std::string part; std::getline(parts, part, ',');) {
    const std::size_t at = part.find('@');
    const std::string name = part.substr(0, at);
    PlannedKey key;
    bool good = at != std::string::npos;
    if (name == "resume")
      key.key = FlightKey::resume;
    else if (name == "abort")
      key.key = FlightKey::abort;
    else
      good = good && name == "pause";
    if (good) {
      const char* end = part.data() + part.size();
      const auto [next, error] = std::from_chars(part.data() + at + 1, end, key.at);
      good = error == std::errc{} && next == end && key.at >= 0;
    }
    if (!good)
      throw InputError("--press '" + text +
                       "': expected pause, resume or abort with seconds, as in pause@3,resume@5");
    keys.push_back(key);
  }
  return keys;
}

}  // namespace lapwing
