// SPDX-License-Identifier: Apache-2.0
// A name with parameters on one line, as command lines and vehicle files give plugins.
#pragma once

#include <optional>
#include <string>

#include "framework/core/value.h"

namespace lapwing {

struct NamedParameters {
  std::string name;
  Value parameters;  // a map of numbers, booleans and texts; null without a colon
};

// "mpc:command_delay=0.01,rates=3", or the name alone. Nothing where what follows the colon is not
// KEY=VALUE,... with each key once.
std::optional<NamedParameters> named_parameters_from(const std::string& text);

}  // namespace lapwing
