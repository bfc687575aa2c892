// SPDX-License-Identifier: Apache-2.0
#include "framework/verify/provenance.h"

#include "framework/core/number_text.h"
#include "framework/verify/checks.h"

namespace lapwing {
namespace {

constexpr const char* kProvenance = "provenance";
constexpr std::size_t kFaultsListed = 6;

bool alike(double a, double b) {
  return std::abs(a - b) <= 1e-9 * std::max({1.0, std::abs(a), std::abs(b)});
}

std::string outcome_of(const Check& check) {
  return !check.skipped.empty() ? "skipped" : check.pass ? "passed" : "failed";
}

}  // namespace

void state_provenance(const Provenance& provenance, Certificate& certificate) {
  for (Check& check : certificate.checks) {
    if (check.name != kProvenance) continue;
    const Check* document = certificate.find("document");
    if (!document || !document->pass) return;
    const std::vector<std::string>& faults = provenance.faults;
    check = judged(make_check(kProvenance), static_cast<double>(faults.size()), 0, 0, 0);
    check.detail = faults.empty() ? provenance.summary : "";
    for (std::size_t i = 0; i < std::min(faults.size(), kFaultsListed); ++i)
      check.detail += (i ? "; " : "") + faults[i];
    if (faults.size() > kFaultsListed)
      check.detail += "; and " + std::to_string(faults.size() - kFaultsListed) + " more";
    return;
  }
  throw Error("a certificate without a check of provenance");
}

std::vector<std::string> changes_since(const Value& stored, const Certificate& now) {
  std::vector<std::string> changes;
  Certificate before;
  try {
    before = Certificate::from_value(stored);
  } catch (const InputError&) {
    return changes;
  }
  for (const Check& check : now.checks) {
    const Check* old = before.find(check.name);
    if (!old || check.name == kProvenance) continue;
    if (outcome_of(*old) != outcome_of(check)) {
      changes.push_back(check.name + " " + outcome_of(*old) + " at planning, and is now " +
                        outcome_of(check));
    } else if (old->skipped.empty() &&
               !(alike(old->limit, check.limit) && alike(old->tolerance, check.tolerance))) {
      changes.push_back(check.name + " was judged by a limit of " + plain_number(old->limit) +
                        " at planning, and is now by " + plain_number(check.limit) +
                        (check.unit.empty() ? "" : " " + check.unit));
    }
  }
  return changes;
}

}  // namespace lapwing
