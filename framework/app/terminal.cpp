// SPDX-License-Identifier: Apache-2.0
#include "framework/app/terminal.h"

#include <unistd.h>

#include <cstdlib>

#include "framework/core/log.h"

namespace lapwing {

namespace {

bool g_stdout_coloured = false, g_stderr_coloured = false;

bool shows_colour(int descriptor, ColourChoice choice) {
  if (choice != ColourChoice::automatic) return choice == ColourChoice::always;
  const char* const refused = std::getenv("NO_COLOR");
  if (refused && *refused) return false;
  const char* const terminal = std::getenv("TERM");
  return terminal && *terminal && std::string_view(terminal) != "dumb" && ::isatty(descriptor);
}

std::string in_colour(bool coloured, Tone tone, std::string_view text) {
  if (!coloured) return std::string(text);
  const char* const begin = tone == Tone::good  ? "\x1b[32m"
                            : tone == Tone::bad ? "\x1b[1;31m"
                                                : "\x1b[2m";
  return begin + std::string(text) + "\x1b[0m";
}

}  // namespace

void choose_colour(ColourChoice choice) {
  g_stdout_coloured = shows_colour(STDOUT_FILENO, choice);
  g_stderr_coloured = shows_colour(STDERR_FILENO, choice);
  logging::set_console_colour(g_stderr_coloured);
}

std::string tinted(Tone tone, std::string_view text) {
  return in_colour(g_stdout_coloured, tone, text);
}

std::string tinted_error(Tone tone, std::string_view text) {
  return in_colour(g_stderr_coloured, tone, text);
}

}  // namespace lapwing
