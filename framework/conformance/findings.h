// SPDX-License-Identifier: Apache-2.0
// Collects the outcome of named checks, the first failure of each. Internal to the room.
#pragma once

#include "framework/conformance/check.h"

namespace lapwing {

class Findings {
 public:
  Findings() = default;
  // Notes nothing but what `options` wants, and what stands in the way of every check: creation
  // and exceptions.
  explicit Findings(const CheckOptions& options) : only_(options.only) {}

  // Notes that `check` was made; `ok` false makes it fail with the first such message.
  void expect(const std::string& check, bool ok, const std::function<std::string()>& message);
  void fail(const std::string& check, const std::string& message);
  void skip(const std::string& check, const std::string& reason);
  // Something that is likely a slip: said where nothing worse is known of the check.
  void warn(const std::string& check, const std::string& message);
  bool failed(const std::string& check) const;
  // Whether every check that was asked for by name has failed: there is nothing left to find.
  bool settled() const;

  // Runs `call`; anything it throws fails `check`. Whether it came to its end.
  bool survives(const std::string& check, const std::string& where,
                const std::function<void()>& call);

  // Prefixed to messages: which parameters are under test.
  void set_case(std::string description) { case_ = std::move(description); }

  std::vector<CheckResult> results() && { return std::move(results_); }

 private:
  CheckResult& result(const std::string& check);
  bool noted(const std::string& check) const;
  std::vector<std::string> only_;  // none: all
  std::vector<CheckResult> results_;
  std::string case_;
};

}  // namespace lapwing
