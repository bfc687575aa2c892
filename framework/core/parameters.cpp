// SPDX-License-Identifier: Apache-2.0
#include "framework/core/parameters.h"

#include <cmath>
#include <cstdio>
#include <utility>

namespace lapwing {

namespace {

// "4" and "0.25", not "4.000000".
std::string shortest(double number) {
  char buffer[32];
  std::snprintf(buffer, sizeof buffer, "%.12g", number);
  return buffer;
}

struct TypeName {
  ParameterType type;
  const char* name;
};
constexpr TypeName kTypeNames[] = {
    {ParameterType::boolean, "boolean"}, {ParameterType::integer, "integer"},
    {ParameterType::number, "number"},   {ParameterType::numbers, "numbers"},
    {ParameterType::text, "text"},       {ParameterType::choice, "choice"},
    {ParameterType::table, "table"},     {ParameterType::tables, "tables"},
};

ParameterType type_from_name(const Value& value) {
  for (const TypeName& known : kTypeNames) {
    if (value.as_text() == known.name) return known.type;
  }
  throw InputError(value.origin(), "unknown parameter type '" + value.as_text() + "'");
}

Value spec_to_value(const ParameterSpec& spec) {
  Value map = Value::map();
  map.set("name", spec.name);
  for (const TypeName& known : kTypeNames) {
    if (known.type == spec.type) map.set("type", known.name);
  }
  map.set("summary", spec.summary);
  if (!spec.unit.empty()) map.set("unit", spec.unit);
  if (!spec.default_value.is_null()) map.set("default", spec.default_value);
  if (spec.required) map.set("required", true);
  if (std::isfinite(spec.range.minimum)) {
    map.set(spec.range.minimum_excluded ? "above" : "minimum", spec.range.minimum);
  }
  if (std::isfinite(spec.range.maximum)) map.set("maximum", spec.range.maximum);
  if (spec.size > 0) map.set("size", spec.size);
  if (!spec.choices.empty()) {
    Value& choices = map.set("choices", Value::list());
    for (const std::string& choice : spec.choices) choices.push_back(choice);
  }
  if (spec.table) map.set("table", spec.table->to_value());
  return map;
}

ParameterSpec spec_from_value(const Value& value) {
  ParameterSpec spec;
  spec.name = value.at("name").as_text();
  spec.type = type_from_name(value.at("type"));
  spec.summary = value.at("summary").as_text();
  if (const Value* unit = value.find("unit")) spec.unit = unit->as_text();
  if (const Value* given = value.find("default")) {
    spec.default_value = *given;
    spec.default_value.with_origin({"default", 0});
  }
  if (const Value* required = value.find("required")) spec.required = required->as_boolean();
  if (const Value* minimum = value.find("minimum")) spec.range.minimum = minimum->as_number();
  if (const Value* bound = value.find("above")) {
    spec.range.minimum = bound->as_number();
    spec.range.minimum_excluded = true;
  }
  if (const Value* maximum = value.find("maximum")) spec.range.maximum = maximum->as_number();
  if (const Value* size = value.find("size")) spec.size = static_cast<int>(size->as_integer());
  if (const Value* choices = value.find("choices")) {
    for (const Value& choice : choices->as_list()) spec.choices.push_back(choice.as_text());
  }
  if (const Value* table = value.find("table")) {
    spec.table = std::make_shared<const ParameterTable>(ParameterTable::from_value(*table));
  }
  return spec;
}

ParameterSpec make_spec(std::string_view name, ParameterType type, std::string_view summary) {
  ParameterSpec spec;
  spec.name = name;
  spec.type = type;
  spec.summary = summary;
  return spec;
}

}  // namespace

std::string Range::to_string() const {
  const bool low = std::isfinite(minimum);
  const bool high = std::isfinite(maximum);
  if (low && high && !minimum_excluded) {
    return "between " + shortest(minimum) + " and " + shortest(maximum);
  }
  std::string text;
  if (low) text = (minimum_excluded ? "above " : "at least ") + shortest(minimum);
  if (high) text += (low ? " and at most " : "at most ") + shortest(maximum);
  return text;
}

std::string ParameterSpec::type_name() const {
  switch (type) {
    case ParameterType::boolean:
      return "boolean";
    case ParameterType::integer:
      return "integer";
    case ParameterType::number:
      return "number";
    case ParameterType::numbers:
      return size > 0 ? std::to_string(size) + (size == 1 ? " number" : " numbers")
                      : "list of numbers";
    case ParameterType::text:
      return "text";
    case ParameterType::choice:
      return "choice";
    case ParameterType::table:
      return "table";
    case ParameterType::tables:
      return "list of tables";
  }
  return "";
}

ParameterTable::ParameterTable() = default;
ParameterTable::ParameterTable(const ParameterTable& other) = default;
ParameterTable::ParameterTable(ParameterTable&& other) noexcept = default;
ParameterTable& ParameterTable::operator=(const ParameterTable& other) = default;
ParameterTable& ParameterTable::operator=(ParameterTable&& other) noexcept = default;
ParameterTable::~ParameterTable() = default;

ParameterTable& ParameterTable::add(ParameterSpec spec) {
  if (find(spec.name)) throw Error("parameter '" + spec.name + "' is declared twice");
  spec.default_value.with_origin({"default", 0});
  specs_.push_back(std::move(spec));
  return *this;
}

ParameterTable& ParameterTable::boolean(std::string_view name, bool default_value,
                                        std::string_view summary) {
  ParameterSpec spec = make_spec(name, ParameterType::boolean, summary);
  spec.default_value = default_value;
  return add(std::move(spec));
}

ParameterTable& ParameterTable::integer(std::string_view name, std::int64_t default_value,
                                        std::string_view summary, Range range) {
  ParameterSpec spec = make_spec(name, ParameterType::integer, summary);
  spec.default_value = default_value;
  spec.range = range;
  return add(std::move(spec));
}

ParameterTable& ParameterTable::number(std::string_view name, double default_value,
                                       std::string_view unit, std::string_view summary,
                                       Range range) {
  ParameterSpec spec = make_spec(name, ParameterType::number, summary);
  spec.default_value = default_value;
  spec.unit = unit;
  spec.range = range;
  return add(std::move(spec));
}

ParameterTable& ParameterTable::required_number(std::string_view name, std::string_view unit,
                                                std::string_view summary, Range range) {
  optional_number(name, unit, summary, range);
  specs_.back().required = true;
  return *this;
}

ParameterTable& ParameterTable::optional_number(std::string_view name, std::string_view unit,
                                                std::string_view summary, Range range) {
  ParameterSpec spec = make_spec(name, ParameterType::number, summary);
  spec.unit = unit;
  spec.range = range;
  return add(std::move(spec));
}

ParameterTable& ParameterTable::numbers(std::string_view name, std::vector<double> default_value,
                                        std::string_view unit, std::string_view summary,
                                        Range range) {
  ParameterSpec spec = make_spec(name, ParameterType::numbers, summary);
  spec.default_value = Value::list();
  for (const double number : default_value) spec.default_value.push_back(number);
  spec.size = static_cast<int>(default_value.size());
  spec.unit = unit;
  spec.range = range;
  return add(std::move(spec));
}

ParameterTable& ParameterTable::required_numbers(std::string_view name, int size,
                                                 std::string_view unit, std::string_view summary,
                                                 Range range) {
  optional_numbers(name, size, unit, summary, range);
  specs_.back().required = true;
  return *this;
}

ParameterTable& ParameterTable::optional_numbers(std::string_view name, int size,
                                                 std::string_view unit, std::string_view summary,
                                                 Range range) {
  ParameterSpec spec = make_spec(name, ParameterType::numbers, summary);
  spec.size = size;
  spec.unit = unit;
  spec.range = range;
  return add(std::move(spec));
}

ParameterTable& ParameterTable::text(std::string_view name, std::string_view default_value,
                                     std::string_view summary) {
  ParameterSpec spec = make_spec(name, ParameterType::text, summary);
  spec.default_value = std::string(default_value);
  return add(std::move(spec));
}

ParameterTable& ParameterTable::required_text(std::string_view name, std::string_view summary) {
  optional_text(name, summary);
  specs_.back().required = true;
  return *this;
}

ParameterTable& ParameterTable::optional_text(std::string_view name, std::string_view summary) {
  return add(make_spec(name, ParameterType::text, summary));
}

ParameterTable& ParameterTable::choice(std::string_view name, std::string_view default_value,
                                       std::vector<std::string> choices, std::string_view summary) {
  ParameterSpec spec = make_spec(name, ParameterType::choice, summary);
  spec.default_value = std::string(default_value);
  spec.choices = std::move(choices);
  return add(std::move(spec));
}

ParameterTable& ParameterTable::table(std::string_view name, ParameterTable table,
                                      std::string_view summary) {
  ParameterSpec spec = make_spec(name, ParameterType::table, summary);
  spec.table = std::make_shared<const ParameterTable>(std::move(table));
  return add(std::move(spec));
}

ParameterTable& ParameterTable::tables(std::string_view name, ParameterTable table,
                                       std::string_view summary, bool required) {
  ParameterSpec spec = make_spec(name, ParameterType::tables, summary);
  spec.table = std::make_shared<const ParameterTable>(std::move(table));
  spec.required = required;
  return add(std::move(spec));
}

const ParameterSpec* ParameterTable::find(std::string_view name) const {
  for (const ParameterSpec& spec : specs_) {
    if (spec.name == name) return &spec;
  }
  return nullptr;
}

Value ParameterTable::to_value() const {
  Value list = Value::list();
  for (const ParameterSpec& spec : specs_) list.push_back(spec_to_value(spec));
  return list;
}

ParameterTable ParameterTable::from_value(const Value& value) {
  ParameterTable table;
  for (const Value& entry : value.as_list()) {
    ParameterSpec spec = spec_from_value(entry);
    if (table.find(spec.name)) {
      throw InputError(entry.origin(), "parameter '" + spec.name + "' is declared twice");
    }
    table.add(std::move(spec));
  }
  return table;
}

}  // namespace lapwing
