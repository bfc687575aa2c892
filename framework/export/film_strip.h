// SPDX-License-Identifier: Apache-2.0
// What the planned camera would film: rendered frames, and where the subjects are in the image.
#pragma once

#include <vector>

#include "framework/export/report.h"
#include "framework/trajectory/plan.h"
#include "framework/vehicle/vehicle.h"

namespace lapwing {

// Moments for a strip of at most `count` frames: evenly spaced from start to end, each moved to a
// keyframe's time where one is near, none inside a cut.
std::vector<double> strip_times(const Plan& plan, int count = 12);

// The frames at these times, which must lie within the flight. Subjects, spheres and boxes stand on
// a checkered ground under the sun; an obstacle that contains a subject is see-through. Zones are
// not things and are not drawn. Bodies beyond 1e5 m are left out.
FilmStrip film_strip(const Plan& plan, const Vehicle& vehicle, const std::vector<double>& times);

// One such frame as a PNG file, the camera's view in as many pixels as fit. InputError for a time
// outside of the flight.
std::string film_frame(const Plan& plan, const Vehicle& vehicle, double time, int most_across,
                       int most_down);

}  // namespace lapwing
