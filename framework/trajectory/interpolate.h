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

// Replaces held inputs of a sample by a continuous curve: each input belongs to the middle of its
// step, and between middles inputs are linear. `time`, seconds, is the middle of the step that the
// sample shall hold its inputs for. For a start on another grid, where steps of held inputs would
// be jumps. Inputs that are linear stay as they are.
void smooth_held_inputs(const Trajectory& trajectory, double time, Sample& sample);

}  // namespace lapwing
