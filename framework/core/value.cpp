// SPDX-License-Identifier: Apache-2.0
#include "framework/core/value.h"

#include <algorithm>

namespace lapwing {

namespace {

[[noreturn]] void wrong_type(const Value& value, const char* expected) {
  throw InputError(value.origin(),
                   std::string("expected ") + expected + ", got " + value.describe_type());
}

}  // namespace

Value::Value() = default;
Value::Value(bool v) : data_(v) {}
Value::Value(int v) : data_(static_cast<std::int64_t>(v)) {}
Value::Value(std::int64_t v) : data_(v) {}
Value::Value(double v) : data_(v) {}
Value::Value(const char* v) : data_(std::string(v)) {}
Value::Value(std::string v) : data_(std::move(v)) {}
Value::Value(List v) : data_(std::move(v)) {}
Value::Value(Map v) : data_(std::move(v)) {}
Value::Value(const Value& other) = default;
Value::Value(Value&& other) noexcept = default;
Value& Value::operator=(const Value& other) = default;
Value& Value::operator=(Value&& other) noexcept = default;
Value::~Value() = default;
Value Value::list() {
  return Value(List{});
}
Value Value::map() {
  return Value(Map{});
}

Value& Value::with_origin(Origin origin) {
  origin_ = std::move(origin);
  return *this;
}

bool Value::operator==(const Value& other) const {
  return data_ == other.data_;
}

std::string Value::describe_type() const {
  switch (type()) {
    case Type::null:
      return "nothing";
    case Type::boolean:
      return "a boolean";
    case Type::integer:
      return "an integer";
    case Type::number:
      return "a number";
    case Type::text:
      return "a text";
    case Type::list:
      return "a list";
    case Type::map:
      return "a map";
  }
  return "nothing";
}

bool Value::as_boolean() const {
  if (type() != Type::boolean) wrong_type(*this, "a boolean");
  return std::get<bool>(data_);
}

std::int64_t Value::as_integer() const {
  if (type() != Type::integer) wrong_type(*this, "an integer");
  return std::get<std::int64_t>(data_);
}

double Value::as_number() const {
  if (!is_number()) wrong_type(*this, "a number");
  if (type() == Type::integer) return static_cast<double>(std::get<std::int64_t>(data_));
  return std::get<double>(data_);
}

const std::string& Value::as_text() const {
  if (!is_text()) wrong_type(*this, "a text");
  return std::get<std::string>(data_);
}

const Value::List& Value::as_list() const {
  if (!is_list()) wrong_type(*this, "a list");
  return std::get<List>(data_);
}

Value::List& Value::as_list() {
  if (!is_list()) wrong_type(*this, "a list");
  return std::get<List>(data_);
}

const Value::Map& Value::as_map() const {
  if (!is_map()) wrong_type(*this, "a map");
  return std::get<Map>(data_);
}

Value::Map& Value::as_map() {
  if (!is_map()) wrong_type(*this, "a map");
  return std::get<Map>(data_);
}

const Value* Value::find(std::string_view key) const {
  if (!is_map()) return nullptr;
  for (const auto& [name, value] : std::get<Map>(data_)) {
    if (name == key) return &value;
  }
  return nullptr;
}

Value* Value::find(std::string_view key) {
  return const_cast<Value*>(static_cast<const Value*>(this)->find(key));
}

const Value& Value::at(std::string_view key) const {
  if (!is_map()) wrong_type(*this, "a map");
  const Value* found = find(key);
  if (!found) throw InputError(origin_, "missing key '" + std::string(key) + "'");
  return *found;
}

Value& Value::set(std::string_view key, Value value) {
  if (is_null()) data_ = Map{};
  if (Value* found = find(key)) {
    *found = std::move(value);
    return *found;
  }
  Map& map = as_map();
  map.emplace_back(std::string(key), std::move(value));
  return map.back().second;
}

void Value::push_back(Value value) {
  if (is_null()) data_ = List{};
  as_list().push_back(std::move(value));
}

namespace {

const std::string* type_of(const Value& value) {
  const Value* type = value.find("type");
  return type && type->is_text() ? &type->as_text() : nullptr;
}

// `solver: iqp` is short for `solver: {type: iqp}`.
Value expanded(const Value& name) {
  Value map = Value::map();
  map.with_origin(name.origin());
  map.set("type", name);
  return map;
}

}  // namespace

void merge(Value& base, const Value& over) {
  const std::string* below = type_of(base);
  if (over.is_text() && below && *below == over.as_text()) {
    base.set("type", over);
    return;
  }
  if (!over.is_map()) {
    base = over;
    return;
  }
  const std::string* above = type_of(over);
  if (base.is_text() && (!above || *above == base.as_text())) {
    base = expanded(base);
    below = type_of(base);
  }
  if (!base.is_map() || (above && below && *above != *below)) {
    base = over;
    return;
  }
  for (const auto& [key, value] : over.as_map()) {
    if (Value* existing = base.find(key))
      merge(*existing, value);
    else
      base.set(key, value);
  }
}

}  // namespace lapwing
