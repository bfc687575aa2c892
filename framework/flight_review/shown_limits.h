// SPDX-License-Identifier: Apache-2.0
// What a log shows of its vehicle: limits that it reached, and what fits tell of its drag, its
// thrust and its rotors.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "framework/flight_log/flight_log.h"
#include "framework/vehicle/vehicle.h"

namespace lapwing {

// A number for a vehicle file, in the unit of its key.
struct ShownFigure {
  std::string key;  // "limits.speed_across"
  double value = 0;
  // Of a fit: the interval that holds 95 % of the fits to blocks of 5 s drawn with replacement.
  std::optional<double> low, high;
  std::string evidence;  // how much data stands behind it, as a comment
};

struct ShownLimits {
  std::vector<ShownFigure> figures;
  std::vector<std::string>
      remarks;          // sentences: what was seen that no key holds, what was not seen
  double airborne = 0;  // s
  std::string source;   // of the positions

  const ShownFigure* find(std::string_view key) const;
};

// Values that were held for 0.5 s at least. `base` gives the mass, on which drag and thrust depend,
// and what counts as exercised: a limit of which less than a fifth was shown is left out, and said.
// InputError as of shown_motion.
ShownLimits shown_limits(const FlightLog& log, const Vehicle& base);

}  // namespace lapwing
