// SPDX-License-Identifier: Apache-2.0
// The problem that terms are bound to when they are checked. Internal to the room.
#pragma once

#include "framework/core/random.h"
#include "framework/problem/stage_function.h"

namespace lapwing {

// A 1.5 kg camera drone, as configs/vehicles/solo.yaml states it.
Vehicle standard_vehicle();

// Obstacles, zones and subjects around the origin, some with a name and some without: it is the
// centre of a sphere, inside a box, and the corner of a zone that is not convex. No track turns on
// a stage.
Environment standard_environment();

struct StandardSetting {
  StageLayout layout;  // blocks of the shipped vehicle models, `target`, `time`, `step`
  Horizon horizon;
  Vehicle vehicle;
  Environment environment;

  explicit StandardSetting(bool step_free);
  // The same over ten minutes, with a fixed step.
  static StandardSetting long_flight();
  ProblemSetting setting() const { return {layout, horizon, vehicle, environment}; }
};

// The instances of a shape, each with its first stage or its time.
struct Instances {
  std::vector<double> times;  // s
  int count() const { return static_cast<int>(times.size()); }
};
Instances instances_of(const FunctionShape& shape, const Horizon& horizon);

// How numbers of an instance are laid out.
struct InputPlace {
  int stage = 0;  // in the window
  int block = 0;  // layout index
  int component = 0;
};
std::vector<InputPlace> input_places(const FunctionShape& shape, const StageLayout& layout);

enum class InputKind { random, far, zero, coincident };

// Inputs of instances at `times`, [count][n]: plausible numbers for known blocks, unit quaternions,
// true times; `far` has places up to some hundred metres away and faster motion, `zero` has zeros
// but for the clock and orientations, `coincident` equal stages. The clock is the setting's, but a
// free step, and with it the time, varies when random or far.
std::vector<double> make_inputs(const StandardSetting& standard, const FunctionShape& shape,
                                const std::vector<double>& times, InputKind kind, Random& random);

}  // namespace lapwing
