// SPDX-License-Identifier: Apache-2.0
// Reading a trajectory between its samples, for reports, views and exporters.
//
// The verifier does not use this: it integrates the motion model itself.
#pragma once

#include "framework/trajectory/trajectory.h"

namespace lapwing {

// The state at `time`, seconds. For the models `force` and `rotors` position and yaw are the cubic
// through both samples' values and rates, which for `force` is the exact motion, inputs held or
// linear; orientation is the shortest turn between samples. For `path` they are straight lines.
// Inputs are held or linear as the trajectory says. Throws Error when the trajectory has no sample
// or `time` lies outside its samples by more than a microsecond; within that it reads the end.
Sample sample_at(const Trajectory& trajectory, double time);

}  // namespace lapwing
