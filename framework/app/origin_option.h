// SPDX-License-Identifier: Apache-2.0
// --origin of commands that need the place of a plan on the earth.
#pragma once

#include <string>

#include "framework/trajectory/plan.h"

namespace lapwing {

// Gives a plan the origin of `text`, the value of --origin: "46.5191,6.5668,395,sea"; "" leaves the
// plan as it is. InputError for another form, for numbers that are no place on the earth, and for a
// plan that has an origin already.
void give_origin(Plan& plan, const std::string& text);

}  // namespace lapwing
