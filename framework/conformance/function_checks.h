// SPDX-License-Identifier: Apache-2.0
// Checks common to cost terms and constraints. Internal to the room.
#pragma once

#include <map>

#include "framework/conformance/findings.h"
#include "framework/conformance/standard_setting.h"

namespace lapwing {

// A function bound to the standard problem in one case of its parameters.
struct BoundSubject {
  StageFunction& function;
  const FunctionShape& shape;
  const StandardSetting& standard;
  std::vector<double> times;  // s, of the instances
  bool constraint = false;

  int count() const { return static_cast<int>(times.size()); }
};

// Of what a subject reads ("position[0]"), whether a result was ever seen to depend on it.
using Dependence = std::map<std::string, bool>;

// Creates and binds the subject in every parameter case, with a fixed and with a free step, and
// over a long flight, and checks each. `also` adds the checks of the kind.
struct FunctionSubject {
  const ParameterTable& parameters;
  std::function<std::unique_ptr<StageFunction>(const Value&)> create;
  const std::vector<std::string>& declares;
  bool constraint = false;
};
void check_stage_function(const FunctionSubject& subject, const CheckOptions& options,
                          Findings& findings, const std::function<void(const BoundSubject&)>& also);

// Whether a bound function stays the same under what it declares (problem/invariance.h): costs by
// the length of their residuals, constraints by how far they are from what they allow.
void check_invariance(const BoundSubject& subject, const std::vector<std::string>& declares,
                      std::uint64_t seed, Findings& findings);

}  // namespace lapwing
