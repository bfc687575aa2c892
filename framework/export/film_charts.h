// SPDX-License-Identifier: Apache-2.0
// The camera of a flight: its film strip, its gimbal, and how it sees its subjects.
#pragma once

#include "framework/export/report.h"
#include "framework/trajectory/plan.h"
#include "framework/vehicle/vehicle.h"

namespace lapwing {

// Of a trajectory with a gimbal. Charts of subjects have gaps in cuts, and where a subject is not
// asked for or, in the image, not wholly in front of the camera; without subjects there are none.
// Angles in degrees.
Section camera_section(const Plan& plan, const Vehicle& vehicle);

}  // namespace lapwing
