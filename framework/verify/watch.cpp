// SPDX-License-Identifier: Apache-2.0
#include "framework/verify/watch.h"

#include <algorithm>
#include <utility>

#include "framework/core/error.h"

namespace lapwing {

void Watch::expect(std::vector<VerifierPart> parts) {
  parts_ = std::move(parts);
  next_ = 0;
  all_ = before_ = 0;
  for (const VerifierPart& part : parts_) all_ += part.weight;
}

void Watch::begin() {
  obey();
  if (next_ > 0) before_ += parts_[next_ - 1].weight;
  ++next_;
  done(0);
}

void Watch::done(double share) {
  obey();
  if (!progress_ || next_ == 0 || !(all_ > 0)) return;
  const VerifierPart& part = parts_[next_ - 1];
  report((before_ + std::clamp(share, 0.0, 1.0) * part.weight) / all_, part.name);
}

void Watch::end() {
  if (progress_ && next_ > 0) report(1, parts_[next_ - 1].name);
}

void Watch::obey() const {
  if (cancellation_ && cancellation_->cancelled()) throw Cancelled();
}

void Watch::report(double whole, const std::string& name) {
  const std::lock_guard lock(reporting_);
  reported_ = std::max(reported_, std::min(whole, 1.0));
  progress_->report(reported_, name);
}

}  // namespace lapwing
