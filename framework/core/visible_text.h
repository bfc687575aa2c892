// SPDX-License-Identifier: Apache-2.0
// Text from outside (names, messages, a script's prints) as a terminal may show it.
#pragma once

#include <string>
#include <string_view>

namespace lapwing {

// `text` with everything that a terminal would obey shown as text: control characters and bytes
// that are no UTF-8 as \x1b, characters that turn the direction of writing as \u202e. Line breaks
// and tabs stay. What is shown without a change comes back without a change.
std::string visible_text(std::string_view text);

// The same on one line: line breaks and tabs become \n and \t. For names and for lines of a table.
std::string visible_line(std::string_view text);

}  // namespace lapwing
