// SPDX-License-Identifier: Apache-2.0
#include "framework/verify/checks.h"

namespace lapwing {

Check make_check(std::string_view name) {
  std::vector<CheckKind> kinds(kCheckKinds.begin(), kCheckKinds.end());
  kinds.insert(kinds.end(), kMotionCheckKinds.begin(), kMotionCheckKinds.end());
  kinds.insert(kinds.end(), kPilotCheckKinds.begin(), kPilotCheckKinds.end());
  kinds.insert(kinds.end(), kHomeCheckKinds.begin(), kHomeCheckKinds.end());
  for (const CheckKind& kind : kinds) {
    if (name != kind.name) continue;
    Check check;
    check.name = kind.name;
    check.group = kind.group;
    check.required = kind.required;
    check.unit = kind.unit;
    return check;
  }
  throw Error("verify: no check is named " + std::string(name));
}

Check skipped_check(std::string_view name, std::string reason) {
  Check check = make_check(name);
  check.skipped = std::move(reason);
  return check;
}

double tolerance_of(double limit) {
  return std::max(tolerances::kLimitShare * std::abs(limit), tolerances::kLimitFloor);
}

Check judged(Check check, double worst, double limit, double tolerance, double at, bool at_least) {
  check.limit = limit;
  check.tolerance = tolerance;
  check.at = at;
  check.at_least = at_least;
  if (!std::isfinite(worst)) {
    check.detail = "not a finite number";
    return check;
  }
  check.worst = worst;
  check.pass = at_least ? worst >= limit - tolerance : worst <= limit + tolerance;
  return check;
}

Worst::Worst(std::string_view name, double limit, double tolerance, bool at_least)
    : name_(name), limit_(limit), tolerance_(tolerance), at_least_(at_least) {}

bool Worst::see(double value, double time) {
  if (seen_ && std::isnan(value_)) return false;
  // Written so that a NaN counts as worse.
  if (seen_ && (at_least_ ? value >= value_ : value <= value_)) return false;
  seen_ = true;
  value_ = value;
  at_ = time;
  return true;
}

double Worst::excess() const {
  return at_least_ ? limit_ - value_ : value_ - limit_;
}

Check Worst::check() const {
  const double worst = seen_ ? value_ : std::numeric_limits<double>::quiet_NaN();
  return judged(make_check(name_), worst, limit_, tolerance_, at_, at_least_);
}

}  // namespace lapwing
