// SPDX-License-Identifier: Apache-2.0
#include "framework/core/fields.h"

#include "framework/core/parameters.h"

namespace lapwing {
namespace {

const Value& empty_map() {
  static const Value value = Value::map();
  return value;
}

// Fills `numbers` from a list of just as many finite numbers; false for anything else.
bool read_numbers(const Value& value, std::vector<double>& numbers) {
  if (!value.is_list() || value.as_list().size() != numbers.size()) return false;
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    const Value& entry = value.as_list()[i];
    if (!entry.is_number() || !std::isfinite(entry.as_number())) return false;
    numbers[i] = entry.as_number();
  }
  return true;
}

}  // namespace

Fields::Fields(const Value& value, std::string key_path, Diagnostics& errors)
    : value_(&value), key_path_(std::move(key_path)), errors_(&errors) {
  if (value.is_map()) return;
  errors.add(value.origin(), key_path_, "expected a map, got " + value.describe_type());
  value_ = &empty_map();
  silent_ = true;
}

std::string Fields::path_of(std::string_view name) const {
  if (name.empty()) return key_path_;
  return key_path_.empty() ? std::string(name) : key_path_ + "." + std::string(name);
}

void Fields::add_error(std::string_view name, const std::string& message) {
  if (silent_) return;
  const Value* field = name.empty() ? nullptr : value_->find(name);
  errors_->add((field ? field : value_)->origin(), path_of(name), message);
}

const Value* Fields::read(std::string_view name, bool required) {
  known_.emplace_back(name);
  const Value* field = value_->find(name);
  if (!field && required) add_error(name, "missing");
  return field;
}

double Fields::number(std::string_view name) {
  const Value* field = read(name, true);
  if (!field) return 0.0;
  if (!field->is_number()) {
    add_error(name, "expected a number, got " + field->describe_type());
    return 0.0;
  }
  const double number = field->as_number();
  if (std::isfinite(number)) return number;
  add_error(name, "expected a finite number");
  return 0.0;
}

std::optional<double> Fields::optional_number(std::string_view name) {
  if (!has(name)) {
    known_.emplace_back(name);
    return std::nullopt;
  }
  return number(name);
}

std::vector<double> Fields::numbers(std::string_view name, int size) {
  std::vector<double> numbers(static_cast<std::size_t>(size), 0.0);
  const Value* field = read(name, true);
  if (field && !read_numbers(*field, numbers)) {
    add_error(name, "expected a list of " + std::to_string(size) + " finite numbers");
  }
  return numbers;
}

std::vector<double> Fields::numbers(std::string_view name) {
  std::vector<double> numbers;
  const Value* field = read(name, true);
  if (!field) return numbers;
  if (field->is_list()) numbers.resize(field->as_list().size());
  if (!read_numbers(*field, numbers)) add_error(name, "expected a list of finite numbers");
  return numbers;
}

std::vector<std::vector<double>> Fields::rows(std::string_view name, int size) {
  std::vector<std::vector<double>> rows;
  const Value* field = read(name, true);
  if (!field) return rows;
  if (field->is_list()) {
    rows.resize(field->as_list().size(), std::vector<double>(static_cast<std::size_t>(size)));
  }
  bool sound = field->is_list();
  for (std::size_t i = 0; i < rows.size() && sound; ++i) {
    sound = read_numbers(field->as_list()[i], rows[i]);
  }
  if (!sound) {
    add_error(name, "expected a list of lists of " + std::to_string(size) + " finite numbers");
  }
  return rows;
}

Eigen::Vector3d Fields::vector3(std::string_view name) {
  const std::vector<double> v = numbers(name, 3);
  return {v[0], v[1], v[2]};
}

std::int64_t Fields::integer(std::string_view name) {
  const Value* field = read(name, true);
  if (!field) return 0;
  if (field->type() == Value::Type::integer) return field->as_integer();
  add_error(name, "expected an integer, got " + field->describe_type());
  return 0;
}

int Fields::integer(std::string_view name, int least, int most) {
  const Value* field = read(name, true);
  if (!field) return least;
  if (field->type() == Value::Type::integer && field->as_integer() >= least &&
      field->as_integer() <= most)
    return static_cast<int>(field->as_integer());
  add_error(name, "expected an integer from " + std::to_string(least) + " to " +
                      std::to_string(most) + ", got " +
                      (field->type() == Value::Type::integer ? std::to_string(field->as_integer())
                                                             : field->describe_type()));
  return least;
}

bool Fields::boolean(std::string_view name) {
  const Value* field = read(name, true);
  if (!field) return false;
  if (field->type() == Value::Type::boolean) return field->as_boolean();
  add_error(name, "expected true or false, got " + field->describe_type());
  return false;
}

std::string Fields::text(std::string_view name) {
  const Value* field = read(name, true);
  if (!field) return {};
  if (field->is_text()) return field->as_text();
  add_error(name, "expected a text, got " + field->describe_type());
  return {};
}

std::string Fields::optional_text(std::string_view name) {
  if (has(name)) return text(name);
  known_.emplace_back(name);
  return {};
}

int Fields::choice(std::string_view name, const std::vector<std::string>& choices) {
  const Value* field = read(name, true);
  if (!field) return 0;
  std::string listed;
  for (std::size_t i = 0; i < choices.size(); ++i) {
    if (field->is_text() && field->as_text() == choices[i]) return static_cast<int>(i);
    listed += (i ? ", " : "") + choices[i];
  }
  add_error(name, "expected one of: " + listed);
  return 0;
}

Fields Fields::table(std::string_view name) {
  const Value* field = read(name, true);
  if (field) return Fields(*field, path_of(name), *errors_);
  Fields absent(empty_map(), path_of(name), *errors_);
  absent.silent_ = true;
  return absent;
}

std::vector<Fields> Fields::tables(std::string_view name) {
  std::vector<Fields> tables;
  const Value* field = read(name, true);
  if (!field) return tables;
  if (!field->is_list()) {
    add_error(name, "expected a list, got " + field->describe_type());
    return tables;
  }
  const auto& list = field->as_list();
  tables.reserve(list.size());
  for (std::size_t i = 0; i < list.size(); ++i) {
    tables.emplace_back(list[i], path_of(name) + "[" + std::to_string(i + 1) + "]", *errors_);
  }
  return tables;
}

std::vector<Fields> Fields::optional_tables(std::string_view name) {
  if (has(name)) return tables(name);
  known_.emplace_back(name);
  return {};
}

Value Fields::opaque(std::string_view name) {
  const Value* field = read(name, false);
  return field ? *field : Value();
}

void Fields::finish() {
  if (silent_) return;
  for (const auto& [key, field] : value_->as_map()) {
    if (std::find(known_.begin(), known_.end(), key) != known_.end()) continue;
    const std::string near = nearest_name(key, known_);
    add_error(key, "unknown" + (near.empty() ? std::string() : "; did you mean '" + near + "'?"));
  }
}

}  // namespace lapwing
