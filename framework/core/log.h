// SPDX-License-Identifier: Apache-2.0
// The log: to stderr for the user, and to a run's own file. Thread-safe. Control characters of a
// message are shown as text (visible_text.h).
#pragma once

#include <filesystem>
#include <string>

namespace lapwing::logging {

enum class Level { debug, info, warning, error, off };

void set_console_level(Level level);     // default: warning
void set_console_colour(bool coloured);  // default: where stderr is a terminal
void debug(const std::string& message);
void info(const std::string& message);
void warning(const std::string& message);
void error(const std::string& message);

// While alive, every message of level debug and above is kept as a line; `text` returns them all.
// Lines bear no wall-clock time, so equal runs give equal logs.
class Capture {
 public:
  Capture();
  ~Capture();
  Capture(const Capture&) = delete;
  Capture& operator=(const Capture&) = delete;
  std::string text() const;

 private:
  struct Impl;
  Impl* impl_;
};

}  // namespace lapwing::logging
