// SPDX-License-Identifier: Apache-2.0
// --origin of commands that need a plan's place on the earth.
#pragma once

#include <string>

#include "framework/trajectory/plan.h"

namespace lapwing {

// Of "LAT,LON,HEIGHT,OF"; "" changes nothing. A plan keeps the origin that it has: InputError then,
// and for another text.
void give_origin(Plan& plan, const std::string& text);

}  // namespace lapwing
