// SPDX-License-Identifier: Apache-2.0
// Strict reading of a map that this project wrote itself: plan, vehicle in a plan, certificate.
//
//   Fields fields(value, "plan", errors);
//   plan.budget = fields.optional_number("budget");
//   fields.finish();               // every key that nobody asked for is an error
//   errors.throw_if_any();
//
// Errors are collected, so that one reading reports all of them. A read that fails returns zero or
// an empty value; results are meaningful only if no error was added.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "framework/core/value.h"

namespace lapwing {

class Fields {
 public:
  // Holds references: `value` and `errors` must outlive this object. `key_path` prefixes the keys
  // in messages.
  Fields(const Value& value, std::string key_path, Diagnostics& errors);

  bool has(std::string_view name) const { return value_->find(name) != nullptr; }
  // A look at a field before reading it; null when absent.
  const Value* find(std::string_view name) const { return value_->find(name); }

  // Finite numbers only.
  double number(std::string_view name);
  std::optional<double> optional_number(std::string_view name);
  std::vector<double> numbers(std::string_view name, int size);
  // As many as there are.
  std::vector<double> numbers(std::string_view name);
  // Lists of `size` numbers, as many as there are.
  std::vector<std::vector<double>> rows(std::string_view name, int size);
  Eigen::Vector3d vector3(std::string_view name);
  std::int64_t integer(std::string_view name);
  // From `least` to `most`, both included.
  int integer(std::string_view name, int least, int most);
  bool boolean(std::string_view name);
  std::string text(std::string_view name);
  std::string optional_text(std::string_view name);
  // The position of the text among `choices`; 0 on an error.
  int choice(std::string_view name, const std::vector<std::string>& choices);

  // A map within the map. Where it is missing, that alone is reported and its own reads are silent.
  Fields table(std::string_view name);
  std::vector<Fields> tables(std::string_view name);
  // None when absent.
  std::vector<Fields> optional_tables(std::string_view name);
  // Anything at all, null when absent.
  Value opaque(std::string_view name);

  // An error about one field, or about the map itself when `name` is empty.
  void add_error(std::string_view name, const std::string& message);

  // Reports every key that was never asked for, with the nearest one that was.
  void finish();

 private:
  const Value* read(std::string_view name, bool required);
  std::string path_of(std::string_view name) const;

  const Value* value_;
  std::string key_path_;
  Diagnostics* errors_;
  bool silent_ = false;
  std::vector<std::string> known_;
};

}  // namespace lapwing
