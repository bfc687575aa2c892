// SPDX-License-Identifier: Apache-2.0
// The constraints of a script in plan.json.
#include <array>

#include "framework/trajectory/plan_sections.h"

namespace lapwing {
namespace {

// In the order of ConstraintOp. `number`: the key of an operation's own number.
struct OperationForm {
  const char* name;
  int operands;
  const char* number;
};
constexpr std::array<OperationForm, kConstraintOps> kForms{{{"constant", 0, "number"},
                                                            {"input", 0, ""},
                                                            {"add", 2, ""},
                                                            {"subtract", 2, ""},
                                                            {"multiply", 2, ""},
                                                            {"divide", 2, ""},
                                                            {"negate", 1, ""},
                                                            {"sin", 1, ""},
                                                            {"cos", 1, ""},
                                                            {"tan", 1, ""},
                                                            {"exp", 1, ""},
                                                            {"log", 1, ""},
                                                            {"sqrt", 1, ""},
                                                            {"power", 1, "exponent"},
                                                            {"atan2", 2, ""},
                                                            {"absolute", 1, "width"},
                                                            {"norm", 1, "width"},
                                                            {"maximum", 2, "width"},
                                                            {"select", 3, ""},
                                                            {"subject", 1, ""},
                                                            {"distance", 3, "reach"}}};

const OperationForm& form_of(ConstraintOp op) {
  return kForms[static_cast<std::size_t>(op)];
}

const std::vector<std::string>& operation_names() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> all;
    for (const OperationForm& form : kForms) all.emplace_back(form.name);
    return all;
  }();
  return names;
}

Value to_value(const ConstraintStep& step) {
  const OperationForm& form = form_of(step.op);
  Value value = Value::map();
  value.set("op", form.name);
  if (form.operands > 0) {
    Value& operands = value.set("of", Value::list());
    for (int k = 0; k < form.operands; ++k) operands.push_back(step.operands[k]);
  }
  if (*form.number) value.set(form.number, step.number);
  if (step.op == ConstraintOp::input) {
    value.set("block", step.name);
    value.set("component", step.component);
    value.set("later", step.later);
  } else if (step.op == ConstraintOp::subject) {
    value.set("subject", step.name);
    value.set("component", step.component);
  } else if (step.op == ConstraintOp::distance) {
    value.set("obstacle", step.component);
  }
  return value;
}

// A whole number of a list of numbers; `field` is named where it is none.
int whole(double number, Fields& fields, std::string_view field) {
  const bool fits = number >= 0 && number < StatedConstraint::kMostOperations;
  const int result = fits ? static_cast<int>(number) : -1;
  if (result != number) fields.add_error(field, "expected places of earlier operations, from 0");
  return result;
}

ConstraintStep step_from(Fields& fields, int format) {
  ConstraintStep step;
  step.op = static_cast<ConstraintOp>(fields.choice("op", operation_names()));
  const OperationForm& form = form_of(step.op);
  if (form.operands > 0) {
    const std::vector<double> operands = fields.numbers("of", form.operands);
    for (std::size_t k = 0; k < operands.size() && k < 3; ++k)
      step.operands[k] = whole(operands[k], fields, "of");
  }
  if (*form.number) step.number = fields.number(form.number);
  constexpr int kMost = 1'000'000;
  if (step.op == ConstraintOp::input) {
    step.name = fields.text("block");
    step.component = fields.integer("component", 0, kMost);
    step.later = fields.integer("later", 0, StatedConstraint::kMostLater);
  } else if (step.op == ConstraintOp::subject) {
    step.name = fields.text("subject");
    step.component = fields.integer("component", 0, 2);
  } else if (step.op == ConstraintOp::distance) {
    if (format == 1) step.name = fields.text("obstacle");
    step.component = fields.integer(format == 1 ? "index" : "obstacle", 0, kMost);
  }
  return step;
}

Value to_value(const ConstraintResult& result) {
  Value value = Value::map();
  value.set("of", result.operation);
  if (result.lower) value.set("lower", *result.lower);
  if (result.upper) value.set("upper", *result.upper);
  return value;
}

Value to_value(const StatedConstraint& constraint) {
  Value value = Value::map();
  value.set("name", constraint.name);
  value.set("required", constraint.required);
  if (!constraint.unjudged.empty()) {
    value.set("unjudged", constraint.unjudged);
    return value;
  }
  value.set("operations", operations_to_value(constraint.operations));
  Value& results = value.set("results", Value::list());
  for (const ConstraintResult& result : constraint.results) results.push_back(to_value(result));
  if (!constraint.times.empty())
    value.set("times", Value(Value::List(constraint.times.begin(), constraint.times.end())));
  if (!constraint.spans.empty()) value.set("spans", spans_to_value(constraint.spans));
  if (!constraint.except.empty()) value.set("except", spans_to_value(constraint.except));
  return value;
}

StatedConstraint constraint_from(Fields& fields, int format) {
  StatedConstraint constraint;
  constraint.name = fields.text("name");
  constraint.required = fields.boolean("required");
  if (fields.has("unjudged")) {
    constraint.unjudged = fields.text("unjudged");
    if (constraint.unjudged.empty()) fields.add_error("unjudged", "expected a reason");
    return constraint;
  }
  constraint.operations = operations_from(fields.tables("operations"), format);
  for (Fields& entry : fields.tables("results")) {
    ConstraintResult result;
    result.operation = entry.integer("of", 0, StatedConstraint::kMostOperations);
    result.lower = entry.optional_number("lower");
    result.upper = entry.optional_number("upper");
    constraint.results.push_back(result);
    entry.finish();
  }
  if (fields.has("times")) constraint.times = fields.numbers("times");
  constraint.spans = spans_from(fields.optional_tables("spans"));
  constraint.except = spans_from(fields.optional_tables("except"));
  return constraint;
}

}  // namespace

const char* name_of(ConstraintOp op) {
  return form_of(op).name;
}

int operand_count(ConstraintOp op) {
  return form_of(op).operands;
}

Value operations_to_value(const std::vector<ConstraintStep>& operations) {
  Value list = Value::list();
  for (const ConstraintStep& step : operations) list.push_back(to_value(step));
  return list;
}

std::vector<ConstraintStep> operations_from(std::vector<Fields> entries, int format) {
  std::vector<ConstraintStep> operations;
  for (Fields& entry : entries) {
    operations.push_back(step_from(entry, format));
    entry.finish();
  }
  return operations;
}

Value constraints_to_value(const std::vector<StatedConstraint>& constraints) {
  Value list = Value::list();
  for (const StatedConstraint& constraint : constraints) list.push_back(to_value(constraint));
  return list;
}

std::vector<StatedConstraint> constraints_from(std::vector<Fields> entries, int format) {
  std::vector<StatedConstraint> constraints;
  for (Fields& entry : entries) {
    constraints.push_back(constraint_from(entry, format));
    entry.finish();
  }
  return constraints;
}

}  // namespace lapwing
