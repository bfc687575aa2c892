// SPDX-License-Identifier: Apache-2.0
#include "framework/verify/certificate.h"

#include <cstdio>

#include "framework/core/fields.h"
#include "framework/core/units.h"

namespace lapwing {
namespace {

const std::vector<std::string> kGroups{"safety", "task"};
const std::vector<std::string> kSenses{"at_most", "at_least"};

bool failed(const Check& check) {
  return check.required && check.skipped.empty() && !check.pass;
}

Value check_to_value(const Check& check) {
  Value value = Value::map();
  value.set("name", check.name);
  value.set("group", kGroups[static_cast<std::size_t>(check.group)]);
  value.set("required", check.required);
  if (!check.skipped.empty()) {
    value.set("skipped", check.skipped);
    return value;
  }
  value.set("worst", check.worst ? Value(*check.worst) : Value());
  value.set("limit", check.limit);
  value.set("sense", kSenses[check.at_least ? 1 : 0]);
  value.set("tolerance", check.tolerance);
  value.set("unit", check.unit);
  value.set("at", check.at);
  value.set("pass", check.pass);
  if (!check.detail.empty()) value.set("detail", check.detail);
  return value;
}

Check check_from(Fields fields) {
  Check check;
  check.name = fields.text("name");
  check.group = static_cast<CheckGroup>(fields.choice("group", kGroups));
  check.required = fields.boolean("required");
  if (fields.has("skipped")) {
    check.skipped = fields.text("skipped");
    if (check.skipped.empty()) fields.add_error("skipped", "expected a reason");
    fields.finish();
    return check;
  }
  if (!fields.opaque("worst").is_null()) check.worst = fields.number("worst");
  check.limit = fields.number("limit");
  check.at_least = fields.choice("sense", kSenses) == 1;
  check.tolerance = fields.number("tolerance");
  check.unit = fields.text("unit");
  check.at = fields.number("at");
  check.pass = fields.boolean("pass");
  check.detail = fields.optional_text("detail");
  fields.finish();
  return check;
}

// Four significant digits; radians as degrees, since people read this.
std::string quantity(double value, const std::string& unit) {
  const bool angle = unit.rfind("rad", 0) == 0;
  const std::string shown = angle ? "deg" + unit.substr(3) : unit;
  char number[40];
  std::snprintf(number, sizeof number, "%.4g", angle ? degrees(value) : value);
  return number + (shown.empty() ? std::string() : " " + shown);
}

}  // namespace

bool Certificate::feasible() const {
  const auto made = [](const Check& check) { return check.skipped.empty(); };
  return std::any_of(checks.begin(), checks.end(), made) &&
         std::none_of(checks.begin(), checks.end(), failed);
}

const Check* Certificate::find(std::string_view name) const {
  for (const Check& check : checks) {
    if (check.name == name) return &check;
  }
  return nullptr;
}

std::vector<Check> Certificate::failures() const {
  std::vector<Check> result;
  std::copy_if(checks.begin(), checks.end(), std::back_inserter(result), failed);
  return result;
}

Value Certificate::to_value() const {
  Value list = Value::list(), value = Value::map();
  for (const Check& check : checks) list.push_back(check_to_value(check));
  value.set("feasible", feasible());
  value.set("checks", std::move(list));
  return value;
}

Certificate Certificate::from_value(const Value& value) {
  Diagnostics errors;
  Certificate certificate;
  Fields fields(value, "certificate", errors);
  const bool stated = fields.boolean("feasible");
  for (const Fields& entry : fields.tables("checks")) {
    certificate.checks.push_back(check_from(entry));
  }
  fields.finish();
  errors.throw_if_any();
  if (stated != certificate.feasible()) {
    fields.add_error("feasible", "does not follow from the checks");
  }
  errors.throw_if_any();
  return certificate;
}

std::string result_of(const Check& check) {
  if (!check.skipped.empty()) return check.skipped;
  if (check.name == "document" && check.detail.empty()) return "holds together";
  const bool in_words =
      (check.name == "document" || check.name == "provenance") && !check.detail.empty();
  if (!check.worst || in_words) return check.detail;
  const std::string worst = quantity(*check.worst, check.unit);
  const std::string limit = quantity(check.limit, check.unit);
  const std::string at = " at " + quantity(check.at, "s");
  std::string text = check.pass
                         ? worst + at + (check.at_least ? ", at least " : ", at most ") + limit
                         : worst + (check.at_least ? " falls below " : " exceeds ") + limit + at;
  if (!check.detail.empty()) text += " (" + check.detail + ")";
  return text;
}

std::string to_line(const Check& check) {
  if (!check.skipped.empty()) return check.name + " skipped: " + check.skipped;
  const bool in_words = check.name == "document" || check.name == "provenance" || !check.worst;
  return check.name + (in_words ? ": " : " ") + result_of(check);
}

}  // namespace lapwing
