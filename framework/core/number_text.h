// SPDX-License-Identifier: Apache-2.0
// Numbers in messages: as short as so many significant digits allow, "0.3", "1e-09", "nan".
#pragma once

#include <cstdio>
#include <string>

namespace lapwing {

inline std::string plain_number(double value, int digits = 6) {
  char text[40];
  std::snprintf(text, sizeof text, "%.*g", digits, value);
  return text;
}

}  // namespace lapwing
