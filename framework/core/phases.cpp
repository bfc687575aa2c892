// SPDX-License-Identifier: Apache-2.0
#include "framework/core/phases.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace lapwing {
namespace {

constexpr double kLeastFraction = 0.05;  // before, a share tells too little of the phase
constexpr double kLeastSeconds = 1;      // likewise
constexpr double kMostGuessed = 0.2;     // of the whole, by weights alone
constexpr double kFalls = 0.02;          // a share that falls by more has begun again

}  // namespace

void expect_phases(Progress* progress, std::vector<Phase> phases) {
  if (auto* phased = dynamic_cast<PhasedProgress*>(progress)) phased->expect(std::move(phases));
}

void begin_phase(Progress* progress, const std::string& phase) {
  if (auto* phased = dynamic_cast<PhasedProgress*>(progress)) phased->begin(phase);
}

void PhaseTimes::expect(std::vector<Phase> phases) {
  phases_ = std::move(phases);
  next_ = 0;
  now_.reset();
}

std::optional<std::pair<std::string, double>> PhaseTimes::begin(const std::string& phase,
                                                                double now) {
  if (begun_ && phase == name_) return std::nullopt;
  std::optional<std::pair<std::string, double>> ended;
  ended_ = begun_;
  if (begun_) {
    ended.emplace(name_, now - began_);
    if (now_) {
      measured_.weight += weight_of(*now_);
      measured_.seconds += now - began_;
    }
  }
  begun_ = true;
  name_ = phase;
  began_ = now;
  fraction_.reset();
  fell_ = false;
  now_.reset();
  for (std::size_t k = next_; k < phases_.size(); ++k)
    if (phases_[k].name == phase) {
      now_ = k;
      next_ = k + 1;
      break;
    }
  return ended;
}

void PhaseTimes::report(double fraction, double) {
  if (!(fraction >= 0 && fraction <= 1)) return;
  if (fraction_ && fraction < *fraction_ - kFalls) fell_ = true;
  fraction_ = std::max(fraction, fraction_.value_or(0));
}

std::optional<double> PhaseTimes::own_total(double now) const {
  const double seconds = now - began_;
  if (!fraction_ || fell_ || *fraction_ < kLeastFraction || seconds < kLeastSeconds)
    return std::nullopt;
  return seconds / *fraction_;
}

PhaseTimes::Standing PhaseTimes::standing(double now) {
  Standing standing;
  standing.phase = name_;
  if (!fell_) standing.fraction = fraction_;
  if (now_) standing.number = static_cast<int>(*now_) + 1;
  standing.count = static_cast<int>(phases_.size());
  const std::optional<double> own = own_total(now);
  // Work without phases: its share is all there is to know. Of several that nobody expected, the
  // share of one tells nothing of all.
  if (phases_.empty()) {
    if (ended_ && whole_ > 0) standing.whole = whole_;
    if (ended_ || fell_ || !fraction_) return standing;
    whole_ = std::max(whole_, *fraction_);
    standing.whole = whole_;
    if (own && *fraction_ < 1) standing.left = *own - (now - began_);
    return standing;
  }
  if (!now_) {
    if (whole_ > 0) standing.whole = whole_;
    return standing;
  }
  double later = 0;
  bool said = true;
  for (std::size_t k = *now_ + 1; k < phases_.size(); ++k) {
    later += weight_of(k);
    said = said && weight_of(k) > 0;
  }
  const double weight = weight_of(*now_);
  Measured known = measured_;
  if (own) known.weight += weight, known.seconds += *own;
  if (!said || !(weight > 0) || !(known.weight > 0)) {
    if (whole_ > 0) standing.whole = whole_;
    return standing;
  }
  const double a_weight = known.seconds / known.weight;
  const double spent = now - began_;
  const double current = std::max(spent, own.value_or(a_weight * weight));
  const double guessed = a_weight * later + (own ? 0 : current - spent);
  const double done = measured_.seconds + spent;
  const double all = measured_.seconds + current + a_weight * later;
  if (all > 0) whole_ = std::max(whole_, std::min(1.0, done / all));
  standing.whole = whole_;
  if (guessed <= kMostGuessed * all && all > done) standing.left = all - done;
  return standing;
}

}  // namespace lapwing
