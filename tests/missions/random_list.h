// SPDX-License-Identifier: Apache-2.0
// Films of keyframes at random places, whose times are free.
#pragma once

#include <string>

#include "framework/core/random.h"

namespace lapwing {

// Places uniform in a box of 20 m above 1 m, from rest to rest.
inline std::string random_list(int count, int seed) {
  Random random(seed);
  std::string text =
      "return require 'mission.film'.shot { name = 'list', "
      "vehicle = 'vehicles/solo', timing = 'free', keyframes = {";
  for (int i = 0; i < count; ++i) {
    text += "{ position = {";
    for (const double low : {-10.0, -10.0, 1.0})
      text += std::to_string(low + 20 * random.uniform()) + ", ";
    text += "} },\n";
  }
  return text + "} }";
}

}  // namespace lapwing
