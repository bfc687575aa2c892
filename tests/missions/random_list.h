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

// A keyframe every 6 s along a walk in random directions, with a subject that walks along.
inline std::string long_walk(int count, int seed) {
  Random random(seed);
  std::string keyframes, track;
  double x = 0, y = 0;
  for (int i = 0; i < count; ++i) {
    const std::string time = std::to_string(6 * i);
    keyframes += "{ time = " + time + ", position = {" + std::to_string(x) + "," +
                 std::to_string(y) + "," + std::to_string(random.uniform(2, 6)) + "} },";
    track += "{ time = " + time + ", position = {" + std::to_string(x + 3) + "," +
             std::to_string(y + random.uniform(6, 8)) + ", 1} },";
    x += random.uniform(2, 12);
    y += random.uniform(-6, 6);
  }
  return "return require 'mission.film'.shot { name = 'walk', subject = { height = 1.8, track = {" +
         track + "} }, keyframes = {" + keyframes + "} }";
}

}  // namespace lapwing
