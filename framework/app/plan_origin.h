// SPDX-License-Identifier: Apache-2.0
// The origin that a command line gives to a plan without one.
#pragma once

#include <string>

#include "framework/trajectory/plan.h"

namespace lapwing {

// `text` of --origin, "46.5191,6.5668,395,sea"; "" leaves the plan as it is. InputError for another
// form, for figures that are none, and for a plan that has an origin of its own.
void give_origin(Plan& plan, const std::string& text);

}  // namespace lapwing
