// SPDX-License-Identifier: Apache-2.0
#include "framework/problem/horizon.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "framework/core/error.h"

namespace lapwing {

Horizon Horizon::of_legs(std::vector<Leg> legs) {
  if (legs.empty()) throw InputError("a horizon of legs needs at least one");
  Horizon horizon;
  horizon.stages = 1;
  double duration = 0;
  for (std::size_t k = 0; k < legs.size(); ++k) {
    const Leg& leg = legs[k];
    const std::string name = "leg " + std::to_string(k + 1);
    if (leg.intervals < 1 || !(leg.step > 0) || !std::isfinite(leg.step))
      throw InputError(name + " needs at least one interval and a positive step");
    if (leg.free && !(leg.shortest >= 0 && leg.shortest <= leg.longest && leg.longest > 0))
      throw InputError(name + ": nothing lies between the shortest duration and the longest");
    horizon.stages += leg.intervals;
    horizon.step_free |= leg.free;
    duration += leg.intervals * leg.step;
  }
  horizon.step = duration / (horizon.stages - 1);
  horizon.legs = std::move(legs);
  return horizon;
}

double Horizon::time(int stage) const {
  if (legs.empty()) return begin + stage * step;
  double time = begin;
  for (const Leg& leg : legs) {
    if (stage <= leg.intervals) return time + stage * leg.step;
    time += leg.intervals * leg.step;
    stage -= leg.intervals;
  }
  return time;
}

int Horizon::leg_of(int stage) const {
  for (int k = 0; k < static_cast<int>(legs.size()); ++k) {
    if (stage < legs[k].intervals) return k;
    stage -= legs[k].intervals;
  }
  return leg_count() - 1;
}

double Horizon::step_after(int stage) const {
  return legs.empty() ? step : legs[leg_of(stage)].step;
}

int Horizon::stage_at(double time) const {
  if (legs.empty()) return std::clamp(static_cast<int>((time - begin) / step), 0, stages - 1);
  int first = 0;
  double leg_begin = begin;
  for (const Leg& leg : legs) {
    const double length = leg.intervals * leg.step;
    if (time < leg_begin + length)
      return first +
             std::clamp(static_cast<int>((time - leg_begin) / leg.step), 0, leg.intervals - 1);
    leg_begin += length;
    first += leg.intervals;
  }
  return stages - 1;
}

int Horizon::end_of_leg(int leg) const {
  if (leg < 0 || leg > leg_count())
    throw InputError("leg " + std::to_string(leg) + " of " + std::to_string(leg_count()));
  if (legs.empty()) return leg == 0 ? 0 : stages - 1;
  int stage = 0;
  for (int k = 0; k < leg; ++k) stage += legs[k].intervals;
  return stage;
}

bool Horizon::chained(int stage) const {
  if (!step_free || stage < 0 || stage + 1 >= stages) return false;
  if (legs.empty()) return true;
  const int leg = leg_of(stage);
  return legs[leg].free && leg == leg_of(stage + 1);
}

}  // namespace lapwing
