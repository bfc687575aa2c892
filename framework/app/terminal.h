// SPDX-License-Identifier: Apache-2.0
// What standard output and standard error may show: colour, and texts from outside.
#pragma once

#include <string>
#include <string_view>

namespace lapwing {

// auto: on a terminal that can (TERM neither empty nor "dumb"), unless NO_COLOR is set.
enum class ColourChoice { automatic, always, never };

// For all that is written from now on. Before, nothing is coloured.
void choose_colour(ColourChoice choice);

enum class Tone { good, bad, faint };

// `text` in the colour of `tone` where standard output shows colours; else as it is.
std::string tinted(Tone tone, std::string_view text);
// The same for standard error.
std::string tinted_error(Tone tone, std::string_view text);

}  // namespace lapwing
