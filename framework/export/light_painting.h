// SPDX-License-Identifier: Apache-2.0
// A light painting as it comes out: the flight in simulation, photographed with an open shutter.
#pragma once

#include "framework/picture/render.h"
#include "framework/trajectory/plan.h"
#include "framework/vehicle/closed_loop.h"

namespace lapwing {

// Distances of the flown path from the strokes while the light is on, over time.
struct DrawingError {
  double mean = 0, worst = 0;  // m
};
DrawingError drawing_error(const Plan& plan, const FlownPath& flown);

// What a camera far away sees along `task.drawing_view`, `width` pixels across, its shutter open
// for the whole flight: light adds up, so that slow strokes are brighter. Black without strokes.
Picture long_exposure(const Plan& plan, const FlownPath& flown, int width);

}  // namespace lapwing
