// SPDX-License-Identifier: Apache-2.0
// What the planned camera looks at, for strips and charts.
#pragma once

#include <vector>

#include "framework/geometry/camera_view.h"
#include "framework/trajectory/plan.h"

namespace lapwing {

// The camera of a vehicle with a gimbal in this state.
CameraView view_of(const Sample& sample, const Pinhole& pinhole);

bool in_cut(const Plan& plan, double time);

// Places in the environment's list of the subjects that the task asks for at this time, in
// increasing order; of a task that asks for none at any time, all of them.
std::vector<std::size_t> subjects_at(const Plan& plan, double time);

}  // namespace lapwing
