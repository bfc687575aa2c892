// SPDX-License-Identifier: Apache-2.0
// A move along a line, or a turn, from rest to rest within a largest speed and acceleration: the
// acceleration rises and falls as half a sine, is 0 for a while, and is the same against the move
// at the end. It is constant between samples, so that the samples are exact and the move ends where
// and as it should.
#pragma once

#include <cstddef>

namespace lapwing {

struct RestLimits {
  double speed = 1;         // m/s or rad/s
  double acceleration = 1;  // m/s^2 or rad/s^2
  double step = 0.05;       // s, between samples
};

class RestProfile {
 public:
  // `length` in m or rad, at least 0; a move of no length takes no step. InputError for a length
  // that is negative or not finite, and for limits that are not above 0.
  RestProfile(double length, const RestLimits& limits);

  int steps() const { return 2 * rising_ + even_; }
  double seconds() const { return steps() * step_; }
  // From sample k = 0, 1, ... to the next; 0 after the last.
  double acceleration(int k) const;

 private:
  int rising_ = 0, even_ = 0;  // steps
  double step_ = 1;            // s
  double peak_ = 0;            // acceleration
};

}  // namespace lapwing
