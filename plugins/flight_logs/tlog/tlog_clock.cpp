// SPDX-License-Identifier: Apache-2.0
#include "plugins/flight_logs/tlog/tlog_clock.h"

#include <algorithm>
#include <cmath>

namespace lapwing::tlog {
namespace {

constexpr double kJump = 10;  // s

}  // namespace

void BootClock::learn(double received, double boot) {
  const double offset = received - boot;
  if (parts_.empty() || std::abs(offset - parts_.back().offset) > kJump)
    parts_.push_back({learned_, offset});
  parts_.back().offset = std::min(parts_.back().offset, offset);
  ++learned_;
}

double BootClock::measured(double boot) {
  while (part_ + 1 < parts_.size() && parts_[part_ + 1].first <= asked_) ++part_;
  ++asked_;
  return at(boot);
}

double BootClock::at(double boot) const {
  if (part_ >= parts_.size()) return NAN;
  return std::round(1e6 * (boot + parts_[part_].offset)) / 1e6 + 0.0;  // never -0
}

}  // namespace lapwing::tlog
