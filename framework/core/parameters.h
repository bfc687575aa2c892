// SPDX-License-Identifier: Apache-2.0
// Parameter tables: what a plugin, a vehicle file or a mission accepts, declared once.
//
// From the table come the checks of YAML and Lua input, the output of `lapwing plugins show`, and
// the defaults in `lapwing config`. Nothing that a table does not name is ever accepted.
//
//   ParameterTable{}
//       .integer("order", 4, "order of the derivative", between(1, 4))
//       .number("weight", 1.0, "", "weight of the term", at_least(0))
//       .numbers("position", 3, "m", "where to be")                       // required
#pragma once

#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "framework/core/value.h"

namespace lapwing {

struct Range {
  double minimum = -std::numeric_limits<double>::infinity();
  double maximum = std::numeric_limits<double>::infinity();
  bool minimum_excluded = false;

  bool contains(double v) const {
    return (minimum_excluded ? v > minimum : v >= minimum) && v <= maximum;
  }
  // "at least 0", "above 0", "between 1 and 4", "" when unbounded.
  std::string to_string() const;
};
inline Range at_least(double minimum) {
  return {.minimum = minimum};
}
inline Range above(double minimum) {
  return {.minimum = minimum, .minimum_excluded = true};
}
inline Range between(double minimum, double maximum) {
  return {.minimum = minimum, .maximum = maximum};
}

enum class ParameterType { boolean, integer, number, numbers, text, choice, table, tables };

class ParameterTable;

struct ParameterSpec {
  std::string name;
  ParameterType type = ParameterType::number;
  std::string unit;     // "m/s"; empty for none
  Value default_value;  // null: no default
  bool required = false;
  Range range;                                  // of a number, or of every entry of numbers
  std::vector<std::string> choices;             // of a choice
  int size = 0;                                 // of numbers; 0 accepts any count
  std::shared_ptr<const ParameterTable> table;  // of a table, or of every entry of tables
  std::string summary;                          // one line

  std::string type_name() const;  // "number", "3 numbers", "list of tables", ...
};

class ParameterTable {
 public:
  // Here and in the source: a declaration is cheap to compile.
  ParameterTable();
  ParameterTable(const ParameterTable& other);
  ParameterTable(ParameterTable&& other) noexcept;
  ParameterTable& operator=(const ParameterTable& other);
  ParameterTable& operator=(ParameterTable&& other) noexcept;
  ~ParameterTable();

  ParameterTable& boolean(std::string_view name, bool default_value, std::string_view summary);
  ParameterTable& integer(std::string_view name, std::int64_t default_value,
                          std::string_view summary, Range range = {});
  ParameterTable& number(std::string_view name, double default_value, std::string_view unit,
                         std::string_view summary, Range range = {});
  // No default: the user must give it.
  ParameterTable& required_number(std::string_view name, std::string_view unit,
                                  std::string_view summary, Range range = {});
  // No default and not required: Parameters::has tells.
  ParameterTable& optional_number(std::string_view name, std::string_view unit,
                                  std::string_view summary, Range range = {});
  ParameterTable& numbers(std::string_view name, std::vector<double> default_value,
                          std::string_view unit, std::string_view summary, Range range = {});
  ParameterTable& required_numbers(std::string_view name, int size, std::string_view unit,
                                   std::string_view summary, Range range = {});
  ParameterTable& optional_numbers(std::string_view name, int size, std::string_view unit,
                                   std::string_view summary, Range range = {});
  ParameterTable& text(std::string_view name, std::string_view default_value,
                       std::string_view summary);
  ParameterTable& required_text(std::string_view name, std::string_view summary);
  ParameterTable& optional_text(std::string_view name, std::string_view summary);
  ParameterTable& choice(std::string_view name, std::string_view default_value,
                         std::vector<std::string> choices, std::string_view summary);
  // A nested table; its own defaults apply when it is absent.
  ParameterTable& table(std::string_view name, ParameterTable table, std::string_view summary);
  // A list of nested tables; empty when absent, unless `required`.
  ParameterTable& tables(std::string_view name, ParameterTable table, std::string_view summary,
                         bool required = false);

  const std::vector<ParameterSpec>& specs() const { return specs_; }
  const ParameterSpec* find(std::string_view name) const;
  // As data, for sidecars and `plugins show --json`; `from_value` reads it back.
  Value to_value() const;
  static ParameterTable from_value(const Value& value);

 private:
  ParameterTable& add(ParameterSpec spec);
  std::vector<ParameterSpec> specs_;
};

// Checked values of a table. Copyable; reading a name that the table lacks is a defect (Error).
class Parameters {
 public:
  Parameters();
  Parameters(const Parameters& other);
  Parameters(Parameters&& other) noexcept;
  Parameters& operator=(const Parameters& other);
  Parameters& operator=(Parameters&& other) noexcept;
  ~Parameters();

  bool has(std::string_view name) const;
  bool boolean(std::string_view name) const;
  std::int64_t integer(std::string_view name) const;
  double number(std::string_view name) const;
  // Valid as long as this object lives unchanged.
  std::span<const double> numbers(std::string_view name) const;
  const std::string& text(std::string_view name) const;  // also of a choice
  const Parameters& table(std::string_view name) const;
  const std::vector<Parameters>& tables(std::string_view name) const;
  // Where the value of `name` was written; "default" when it was not.
  Origin origin(std::string_view name) const;
  // Where the table itself was written.
  const Origin& origin() const { return origin_; }
  // Every value, defaults included, with origins.
  const Value& value() const { return value_; }

 private:
  friend class ParameterChecker;
  struct Entry {
    std::string name;
    bool present = false;
    std::vector<double> numbers;
    std::vector<Parameters> tables;
  };
  const Entry& entry(std::string_view name) const;
  Value value_ = Value::map();
  std::vector<Entry> entries_;
  Origin origin_;
};

// Checks a map against a table and fills in defaults. Every unknown key (with the nearest known
// one), wrong type, wrong unit, value out of range, missing required key and non-finite number goes
// to `errors`; the result is meaningful only if none was added. Where a unit is declared, a text
// such as "36 km/h" is converted to it, and another dimension is an error. `key_path` is prefixed
// to keys in messages; list entries count from 1. Null is taken as an empty map; a number without a
// fraction is an integer; an empty list and an empty map are one thing, as an empty Lua table is.
Parameters check(const ParameterTable& table, const Value& given, const std::string& key_path,
                 Diagnostics& errors);

// As above; throws InputError with all errors.
Parameters check(const ParameterTable& table, const Value& given, const std::string& key_path = "");

// The candidate with the smallest edit distance, or "" when none is near.
std::string nearest_name(std::string_view name, std::span<const std::string> candidates);

}  // namespace lapwing
