// Checks common to cost terms and constraints. Internal to the room.
#pragma once

#include "framework/conformance/findings.h"
#include "framework/conformance/standard_setting.h"

namespace lapwing {

// Creates and binds the subject in every parameter case, with a fixed and with a free step, and
// checks each. `also` adds the checks of the kind.
struct BoundSubject {
  StageFunction& function;
  const FunctionShape& shape;
  const StandardSetting& standard;
  int count;  // instances
};
void check_stage_function(const ParameterTable& parameters,
                          const std::function<std::unique_ptr<StageFunction>(const Value&)>& create,
                          const CheckOptions& options, Findings& findings,
                          const std::function<void(const BoundSubject&)>& also);

}  // namespace lapwing
