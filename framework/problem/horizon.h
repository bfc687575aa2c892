// SPDX-License-Identifier: Apache-2.0
// Stages in time: one step for all of them, or legs with a step each.
#pragma once

#include <limits>
#include <vector>

namespace lapwing {

// Neighbouring intervals of one length. Where that is free, every leg has its own: `step` is then
// the first guess.
struct Leg {
  int intervals = 1;
  double step = 0;  // s
  bool free = true;
  // Bounds on the duration of a free leg, s.
  double shortest = 0;
  double longest = std::numeric_limits<double>::infinity();
};

// A free step is a variable, equal for all stages of a leg. A leg ends where the next one begins:
// on a stage, which is where keyframes of free time stand.
struct Horizon {
  int stages = 0;              // at least 2
  double step = 0;             // s; with legs their mean
  double begin = 0;            // s, time of the first stage: a part of a longer flight begins later
  bool step_free = false;      // some step is a variable
  std::vector<Leg> legs = {};  // empty: one leg of `stages` and `step`
  // The last stage closes onto the first: every state is the same, but yaw, which may have made
  // whole turns (counter-clockwise).
  bool periodic = false;
  int turns = 0;

  // InputError when there is no leg, or one without intervals, with a step that is not positive or
  // with bounds between which nothing lies.
  static Horizon of_legs(std::vector<Leg> legs);

  bool uniform() const { return legs.size() < 2; }
  double duration() const { return end() - begin; }
  double end() const { return time(stages - 1); }  // s, time of the last stage
  // Of a stage, s: nominal where steps are free.
  double time(int stage) const;
  // From a stage to the next, s; of the last stage, as before it.
  double step_after(int stage) const;
  // The last stage at or before `time`, one interval's end excepted.
  int stage_at(double time) const;
  // The leg that the interval after a stage belongs to.
  int leg_of(int stage) const;
  // Where the first `leg` legs end: 0 for the start. InputError when there are not so many.
  int end_of_leg(int leg) const;
  int leg_count() const { return legs.empty() ? 1 : static_cast<int>(legs.size()); }
  // Whether the step of `stage` equals that of the next by a row of its own.
  bool chained(int stage) const;
};

}  // namespace lapwing
