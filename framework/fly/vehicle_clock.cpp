// SPDX-License-Identifier: Apache-2.0
#include "framework/fly/vehicle_clock.h"

#include <algorithm>
#include <cmath>

namespace lapwing {
namespace {

constexpr double kJump = 0.25;     // s
constexpr double kLongestWay = 1;  // s; telemetry that is older than this may be a jump back
constexpr int kOldInTurn = 5;      // messages that are so old: a jump back
constexpr double kSlowDown = 1e-3, kSpeedUp = 5e-5;  // s per s
constexpr double kSlowTrip = 0.01;                   // s, above 1.5 times the quickest: not used
constexpr double kAnswersStop = 5;                   // s without an answer: telemetry tells again

}  // namespace

void VehicleClock::measured(double offset) {
  measured_ = offset;
  if (!known_) {
    offset_ = offset, known_ = true;
  } else if (!flying_) {
    if (std::abs(offset - offset_) > kJump) last_jump_ = offset - offset_, ++jumps_;
    offset_ = offset;
  } else if (std::abs(offset - offset_) > kJump) {
    last_jump_ = offset - offset_;
    offset_ = offset;
    ++jumps_;
  }
}

void VehicleClock::answered(double sent, double received, double vehicle) {
  const double trip = received - sent;
  if (!(trip >= 0) || trip > 2 * kLongestWay) return;
  // The first one is better than telemetry, and no jump of the clock.
  if (!quickest_ && known_ && !flying_) offset_ = vehicle - 0.5 * (sent + received);
  quickest_ = quickest_ ? std::min(*quickest_, trip) : trip;
  last_answer_ = received;
  if (trip <= 1.5 * *quickest_ + kSlowTrip) measured(vehicle - 0.5 * (sent + received));
}

void VehicleClock::telemetry(double now, double vehicle) {
  const double offset = vehicle - now;
  if (!known_) return measured(offset);
  const double late = measured_ - offset;  // s, on its way
  if (late < -kJump) return measured(offset);
  early_ = late > kLongestWay ? early_ + 1 : 0;
  if (early_ >= kOldInTurn) {
    early_ = 0;
    return measured(offset);
  }
  if (now - last_answer_ > kAnswersStop && late < 0) measured(offset);
}

double VehicleClock::advance(double step) {
  if (!known_) return step;
  const double change = std::clamp(measured_ - offset_, -kSlowDown * step, kSpeedUp * step);
  offset_ += change;
  return step + change;
}

}  // namespace lapwing
