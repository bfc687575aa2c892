// SPDX-License-Identifier: Apache-2.0
// Parameters to try a plugin with, made from its table alone. Internal to the room.
#pragma once

#include <string>
#include <vector>

#include "framework/conformance/standard_setting.h"
#include "framework/core/parameters.h"

namespace lapwing {

struct ParameterCase {
  std::string description;  // "defaults", "order = 4"
  Value parameters;
  // Whether the plugin must accept it: defaults and the ends of every range it declares. Other
  // cases may contradict each other; a plugin may refuse those with an InputError.
  bool must_work = true;
};

// Defaults first (with made-up values for what is required), then every range's ends, every choice,
// every flag, every optional value. Lists of tables get three entries at times inside the horizon,
// of which one number may contradict another; numbers of any count get as many as the block that
// the table's `block` names by default. `points` are a path with a corner. Where there is a
// parameter `subject` every case is tried again with a subject of the setting.
std::vector<ParameterCase> parameter_cases(const ParameterTable& table,
                                           const StandardSetting& standard);

}  // namespace lapwing
