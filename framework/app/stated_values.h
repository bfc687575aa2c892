// SPDX-License-Identifier: Apache-2.0
// What a plan's configuration states, read without trust: whatever has another form is not stated.
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "framework/core/value.h"

namespace lapwing {

// Equal to twelve digits; infinite ones exactly.
inline bool same_number(double a, double b) {
  if (!std::isfinite(a) || !std::isfinite(b)) return a == b;
  return std::abs(a - b) <= 1e-12 * std::max({1.0, std::abs(a), std::abs(b)});
}

inline std::optional<double> stated_number(const Value& table, const char* key) {
  const Value* value = table.find(key);
  return value && value->is_number() ? std::optional(value->as_number()) : std::nullopt;
}

inline std::string stated_text(const Value& table, const char* key) {
  const Value* value = table.find(key);
  return value && value->is_text() ? value->as_text() : "";
}

inline bool stated_flag(const Value& table, const char* key) {
  const Value* value = table.find(key);
  return value && value->type() == Value::Type::boolean && value->as_boolean();
}

// A list whose entries are all tables; empty where it is anything else.
inline const Value::List& stated_tables(const Value& table, const char* key) {
  static const Value::List none;
  const Value* list = table.find(key);
  if (!list || !list->is_list()) return none;
  for (const Value& entry : list->as_list())
    if (!entry.is_map()) return none;
  return list->as_list();
}

// Nothing where it is not a list of numbers.
inline std::optional<std::vector<double>> stated_numbers(const Value& table, const char* key) {
  const Value* list = table.find(key);
  if (!list || !list->is_list()) return std::nullopt;
  std::vector<double> numbers;
  for (const Value& entry : list->as_list()) {
    if (!entry.is_number()) return std::nullopt;
    numbers.push_back(entry.as_number());
  }
  return numbers;
}

template <class Vector>
bool same_vector(const std::vector<double>& given, const Vector& v) {
  if (given.size() != static_cast<std::size_t>(v.size())) return false;
  for (std::size_t i = 0; i < given.size(); ++i)
    if (!same_number(given[i], v[static_cast<Eigen::Index>(i)])) return false;
  return true;
}

}  // namespace lapwing
