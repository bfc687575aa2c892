// SPDX-License-Identifier: Apache-2.0
// What is in the shot when, for subtitles and edit lists.
#pragma once

#include <string>
#include <vector>

#include "framework/trajectory/plan.h"

namespace lapwing {

// A span of the flight in which the same things hold.
struct Shot {
  TimeSpan span;                      // s
  bool cut = false;                   // its footage is discarded
  bool lit = false;                   // the light is on
  std::vector<std::string> subjects;  // whose middle is in the image, in the plan's order
};

// The whole flight, without gaps, looked at 20 times a second; each end is exact to 0.05 s, those
// of cuts and lights to the rounding. What stands between camera and subject is not considered.
// Without a gimbal nothing is in the image. Throws InputError beginning with `format` for a flight
// of no length.
std::vector<Shot> shot_list(const Plan& plan, const std::string& format);

// What happens at one moment: "image 3" of a scan, "gate 2: north" where the flight passes it after
// the gate before, at most 0.1 m outside of it.
struct Moment {
  double time = 0;  // s
  std::string what;
};
std::vector<Moment> moments_of(const Plan& plan);

}  // namespace lapwing
