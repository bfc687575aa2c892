// SPDX-License-Identifier: Apache-2.0
// The certificate: what was checked, how it came out, and whether the plan may fly.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "framework/core/value.h"

namespace lapwing {

// safety: the vehicle can fly it and hits nothing; task: it does what the mission asked.
enum class CheckGroup { safety, task };

struct Check {
  std::string name = {};  // snake_case
  CheckGroup group = CheckGroup::safety;
  bool required = true;
  std::string skipped = {};          // why the check does not apply; empty: it was made
  bool at_least = false;             // the limit is a lower one
  std::optional<double> worst = {};  // absent: nothing finite to report, see detail
  double limit = 0;
  double tolerance = 0;   // how far beyond the limit still passes
  std::string unit = {};  // SI, "rad" for angles; "" for a count
  double at = 0;          // s, when `worst` occurs
  bool pass = false;
  std::string detail = {};  // what a number cannot say: the keyframe, the obstacle
};

struct Certificate {
  std::vector<Check> checks;

  // All required checks that were made pass, and at least one was made.
  bool feasible() const;
  // Null when there is none; valid as long as this object lives unchanged.
  const Check* find(std::string_view name) const;
  // Every required check that was made and failed.
  std::vector<Check> failures() const;

  // {"feasible": ..., "checks": [...]}. A skipped check has "skipped" in place of its result.
  Value to_value() const;
  // Throws InputError listing everything malformed, and a "feasible" that the checks deny.
  static Certificate from_value(const Value& value);
};

// "speed_across 10.8 m/s exceeds 10 m/s at 3.4 s", "thrust_min 5 N at 2 s, at least 4 N"; angles in
// degrees.
std::string to_line(const Check& check);
// The same without the check's name; of one that was skipped, the reason.
std::string result_of(const Check& check);

}  // namespace lapwing
