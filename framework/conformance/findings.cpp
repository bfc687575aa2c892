// SPDX-License-Identifier: Apache-2.0
#include "framework/conformance/findings.h"

#include <algorithm>

namespace lapwing {

CheckResult& Findings::result(const std::string& check) {
  for (CheckResult& known : results_)
    if (known.name == check) return known;
  results_.push_back({check, Outcome::passed, ""});
  return results_.back();
}

bool Findings::noted(const std::string& check) const {
  return only_.empty() || check == "creation" || check == "exceptions" || check == "shape" ||
         std::find(only_.begin(), only_.end(), check) != only_.end();
}

void Findings::expect(const std::string& check, bool ok,
                      const std::function<std::string()>& message) {
  if (!noted(check)) return;
  CheckResult& entry = result(check);
  if (entry.outcome == Outcome::skipped) entry = {check, Outcome::passed, ""};
  if (ok || entry.outcome == Outcome::failed) return;
  entry.outcome = Outcome::failed;
  entry.message = case_.empty() ? message() : message() + " (" + case_ + ")";
}

void Findings::fail(const std::string& check, const std::string& message) {
  expect(check, false, [&] { return message; });
}

void Findings::skip(const std::string& check, const std::string& reason) {
  if (!noted(check)) return;
  for (const CheckResult& known : results_)
    if (known.name == check) return;
  results_.push_back({check, Outcome::skipped, reason});
}

void Findings::warn(const std::string& check, const std::string& message) {
  if (!noted(check)) return;
  CheckResult& entry = result(check);
  if (entry.outcome == Outcome::failed || entry.outcome == Outcome::warned) return;
  entry.outcome = Outcome::warned;
  entry.message = case_.empty() ? message : message + " (" + case_ + ")";
}

bool Findings::failed(const std::string& check) const {
  for (const CheckResult& known : results_)
    if (known.name == check) return known.outcome == Outcome::failed;
  return false;
}

bool Findings::settled() const {
  return !only_.empty() && std::all_of(only_.begin(), only_.end(),
                                       [&](const std::string& check) { return failed(check); });
}

bool Findings::survives(const std::string& check, const std::string& where,
                        const std::function<void()>& call) {
  try {
    call();
    expect(check, true, {});
    return true;
  } catch (const std::exception& error) {
    fail(check, where + " throws: " + error.what());
  } catch (...) {
    fail(check, where + " throws something that is not an exception");
  }
  return false;
}

}  // namespace lapwing
