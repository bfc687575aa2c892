// SPDX-License-Identifier: Apache-2.0
// Checking a map against a parameter table, and reading the checked values.

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdio>
#include <numeric>
#include <utility>

#include "framework/core/parameters.h"
#include "framework/core/units.h"

namespace lapwing {

namespace {

std::string in_quotes(std::string_view text) {
  return "'" + std::string(text) + "'";
}

std::string joined(std::span<const std::string> names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
  return text;
}

std::string with_unit(const std::string& text, const std::string& unit) {
  return unit.empty() ? text : text + " " + unit;
}

std::string in_unit(const std::string& text, const std::string& unit) {
  return unit.empty() ? text : text + " in " + unit;
}

// What was written, for messages.
std::string shown(const Value& value) {
  char buffer[32];
  switch (value.type()) {
    case Value::Type::boolean:
      return value.as_boolean() ? "true" : "false";
    case Value::Type::integer:
      return std::to_string(value.as_integer());
    case Value::Type::number:
      std::snprintf(buffer, sizeof buffer, "%.12g", value.as_number());
      return buffer;
    case Value::Type::text:
      return in_quotes(value.as_text());
    default:
      return value.describe_type();
  }
}

std::string child_path(const std::string& path, std::string_view key) {
  return path.empty() ? std::string(key) : path + "." + std::string(key);
}

std::string entry_path(const std::string& path, std::size_t index) {
  return path + "[" + std::to_string(index + 1) + "]";  // counted from 1, as Lua does
}

// An empty Lua table is neither list nor map; both are empty.
bool is_empty_list_or_map(const Value& value) {
  return (value.is_list() && value.as_list().empty()) || (value.is_map() && value.as_map().empty());
}

}  // namespace

class ParameterChecker {
 public:
  explicit ParameterChecker(Diagnostics& errors) : errors_(errors) {}

  Parameters check(const ParameterTable& table, const Value& given, const std::string& path) {
    Parameters result;
    result.origin_ = given.origin();
    result.value_.with_origin(given.origin());
    if (!given.is_null() && !given.is_map() && !is_empty_list_or_map(given)) {
      errors_.add(given.origin(), path, "expected a table, got " + shown(given));
      return result;
    }
    refuse_unknown_keys(table, given, path);
    for (const ParameterSpec& spec : table.specs()) {
      result.entries_.push_back({spec.name, false, {}, {}});
      check_entry(spec, given, child_path(path, spec.name), result);
    }
    return result;
  }

 private:
  void refuse_unknown_keys(const ParameterTable& table, const Value& given,
                           const std::string& path) {
    if (!given.is_map()) return;
    std::vector<std::string> known;
    for (const ParameterSpec& spec : table.specs()) known.push_back(spec.name);
    bool listed = false;  // once is enough
    for (const auto& [key, value] : given.as_map()) {
      if (table.find(key)) continue;
      std::string nearest = nearest_name(key, known);
      if (nearest.empty() && table.find(key + "_deg")) nearest = key + "_deg";
      std::string message = "unknown key";
      if (!nearest.empty())
        message += "; did you mean " + in_quotes(nearest) + "?";
      else if (known.empty())
        message += "; no key is accepted here";
      else if (!std::exchange(listed, true))
        message += "; known: " + joined(known);
      errors_.add(value.origin(), child_path(path, key), message);
    }
  }

  void check_entry(const ParameterSpec& spec, const Value& given, const std::string& path,
                   Parameters& result) {
    Parameters::Entry& entry = result.entries_.back();
    const Value* value = given.find(spec.name);
    if (!value && spec.required) {
      errors_.add(given.origin(), path, "missing; expected " + expected(spec));
      return;
    }
    const bool is_table = spec.type == ParameterType::table;
    Value fallback = spec.default_value;
    if (!value && is_table) fallback = Value::map();
    if (!value && spec.type == ParameterType::tables && fallback.is_null())
      fallback = Value::list();
    fallback.with_origin({"default", 0});
    if (!value) value = &fallback;
    if (value->is_null() && value == &fallback) return;  // optional and absent
    std::optional<Value> checked = check_value(spec, *value, path, entry);
    if (!checked) return;
    entry.present = true;
    result.value_.set(spec.name, std::move(*checked));
  }

  std::optional<Value> check_value(const ParameterSpec& spec, const Value& value,
                                   const std::string& path, Parameters::Entry& entry) {
    switch (spec.type) {
      case ParameterType::boolean:
        if (value.type() == Value::Type::boolean) return value;
        break;
      case ParameterType::integer:
        return check_integer(spec, value, path);
      case ParameterType::number: {
        const std::optional<double> number = check_number(spec, value, path);
        if (!number) return std::nullopt;
        return located(Value(*number), value);
      }
      case ParameterType::numbers:
        return check_numbers(spec, value, path, entry);
      case ParameterType::text:
        if (value.is_text()) return value;
        break;
      case ParameterType::choice:
        return check_choice(spec, value, path);
      case ParameterType::table:
        entry.tables.push_back(check(*spec.table, value, path));
        return entry.tables.back().value();
      case ParameterType::tables:
        return check_tables(spec, value, path, entry);
    }
    refuse(spec, value, path);
    return std::nullopt;
  }

  std::optional<Value> check_integer(const ParameterSpec& spec, const Value& value,
                                     const std::string& path) {
    std::int64_t integer = 0;
    if (value.type() == Value::Type::integer) {
      integer = value.as_integer();
    } else if (value.type() == Value::Type::number && std::abs(value.as_number()) < 0x1p53 &&
               value.as_number() == std::floor(value.as_number())) {
      integer = static_cast<std::int64_t>(value.as_number());  // Lua computes 6 / 2 = 3.0
    } else {
      refuse(spec, value, path);
      return std::nullopt;
    }
    if (!spec.range.contains(static_cast<double>(integer))) {
      refuse_range(spec, shown(value), value, path);
      return std::nullopt;
    }
    return located(Value(integer), value);
  }

  std::optional<double> check_number(const ParameterSpec& spec, const Value& value,
                                     const std::string& path) {
    double number = 0.0;
    if (value.is_text() && !spec.unit.empty()) {
      const std::optional<double> converted = parse_quantity(value.as_text(), spec.unit);
      if (!converted) {
        errors_.add(value.origin(), path,
                    shown(value) + " is not a quantity in " + spec.unit +
                        "; expected a number in " + spec.unit +
                        ", or a text with a unit of that kind");
        return std::nullopt;
      }
      number = *converted;
    } else if (value.is_number()) {
      number = value.as_number();
    } else {
      const bool one_of_many = spec.type == ParameterType::numbers;
      errors_.add(value.origin(), path,
                  "expected " +
                      std::string(one_of_many ? in_unit("a number", spec.unit) : expected(spec)) +
                      ", got " + shown(value));
      return std::nullopt;
    }
    if (!std::isfinite(number)) {
      errors_.add(value.origin(), path, "expected a finite number, got " + shown(value));
      return std::nullopt;
    }
    if (!spec.range.contains(number)) {
      refuse_range(spec, shown(value), value, path);
      return std::nullopt;
    }
    return number;
  }

  std::optional<Value> check_numbers(const ParameterSpec& spec, const Value& value,
                                     const std::string& path, Parameters::Entry& entry) {
    if (!value.is_list() && !is_empty_list_or_map(value)) {
      refuse(spec, value, path);
      return std::nullopt;
    }
    static const Value::List kEmpty;
    const Value::List& list = value.is_list() ? value.as_list() : kEmpty;
    if (spec.size > 0 && list.size() != static_cast<std::size_t>(spec.size)) {
      errors_.add(value.origin(), path,
                  "expected " + expected(spec) + ", got " + std::to_string(list.size()));
      return std::nullopt;
    }
    Value checked = Value::list();
    bool good = true;
    for (std::size_t i = 0; i < list.size(); ++i) {
      const std::optional<double> number = check_number(spec, list[i], entry_path(path, i));
      good = good && number;
      if (!number) continue;
      entry.numbers.push_back(*number);
      checked.push_back(located(Value(*number), list[i]));
    }
    if (!good) return std::nullopt;
    return located(std::move(checked), value);
  }

  std::optional<Value> check_choice(const ParameterSpec& spec, const Value& value,
                                    const std::string& path) {
    if (!value.is_text()) {
      refuse(spec, value, path);
      return std::nullopt;
    }
    for (const std::string& choice : spec.choices) {
      if (choice == value.as_text()) return value;
    }
    const std::string nearest = nearest_name(value.as_text(), spec.choices);
    errors_.add(value.origin(), path,
                "expected " + expected(spec) + ", got " + shown(value) +
                    (nearest.empty() ? "" : "; did you mean " + in_quotes(nearest) + "?"));
    return std::nullopt;
  }

  std::optional<Value> check_tables(const ParameterSpec& spec, const Value& value,
                                    const std::string& path, Parameters::Entry& entry) {
    if (!value.is_list() && !is_empty_list_or_map(value)) {
      refuse(spec, value, path);
      return std::nullopt;
    }
    Value checked = Value::list();
    if (value.is_list()) {
      const Value::List& list = value.as_list();
      for (std::size_t i = 0; i < list.size(); ++i) {
        entry.tables.push_back(check(*spec.table, list[i], entry_path(path, i)));
        checked.push_back(entry.tables.back().value());
      }
    }
    return located(std::move(checked), value);
  }

  static Value located(Value value, const Value& where) {
    value.with_origin(where.origin());
    return value;
  }

  static std::string expected(const ParameterSpec& spec) {
    switch (spec.type) {
      case ParameterType::boolean:
        return "true or false";
      case ParameterType::integer:
        return "an integer";
      case ParameterType::number:
        return in_unit("a number", spec.unit);
      case ParameterType::numbers:
        return in_unit(spec.size > 0 ? "a list of " + spec.type_name() : "a list of numbers",
                       spec.unit);
      case ParameterType::text:
        return "a text";
      case ParameterType::choice:
        return "one of " + joined(spec.choices);
      case ParameterType::table:
        return "a table";
      case ParameterType::tables:
        return "a list of tables";
    }
    return "";
  }

  void refuse(const ParameterSpec& spec, const Value& value, const std::string& path) {
    errors_.add(value.origin(), path, "expected " + expected(spec) + ", got " + shown(value));
  }

  void refuse_range(const ParameterSpec& spec, const std::string& got, const Value& value,
                    const std::string& path) {
    errors_.add(value.origin(), path,
                "expected " + with_unit(spec.range.to_string(), spec.unit) + ", got " + got);
  }

  Diagnostics& errors_;
};

Parameters check(const ParameterTable& table, const Value& given, const std::string& key_path,
                 Diagnostics& errors) {
  return ParameterChecker(errors).check(table, given, key_path);
}

Parameters check(const ParameterTable& table, const Value& given, const std::string& key_path) {
  Diagnostics errors;
  Parameters result = check(table, given, key_path, errors);
  errors.throw_if_any();
  return result;
}

const Parameters::Entry& Parameters::entry(std::string_view name) const {
  for (const Entry& entry : entries_) {
    if (entry.name != name) continue;
    if (!entry.present) throw Error("parameter '" + std::string(name) + "' was read but not given");
    return entry;
  }
  throw Error("parameter '" + std::string(name) + "' was read but never declared");
}

Parameters::Parameters() = default;
Parameters::Parameters(const Parameters& other) = default;
Parameters::Parameters(Parameters&& other) noexcept = default;
Parameters& Parameters::operator=(const Parameters& other) = default;
Parameters& Parameters::operator=(Parameters&& other) noexcept = default;
Parameters::~Parameters() = default;

bool Parameters::has(std::string_view name) const {
  for (const Entry& entry : entries_) {
    if (entry.name == name) return entry.present;
  }
  throw Error("parameter '" + std::string(name) + "' was requested but never declared");
}

bool Parameters::boolean(std::string_view name) const {
  entry(name);
  return value_.at(name).as_boolean();
}

std::int64_t Parameters::integer(std::string_view name) const {
  entry(name);
  return value_.at(name).as_integer();
}

double Parameters::number(std::string_view name) const {
  entry(name);
  return value_.at(name).as_number();
}

std::span<const double> Parameters::numbers(std::string_view name) const {
  const Entry& found = entry(name);
  if (!value_.at(name).is_list())
    throw Error("parameter '" + std::string(name) + "' is not a list");
  return found.numbers;
}

const std::string& Parameters::text(std::string_view name) const {
  entry(name);
  return value_.at(name).as_text();
}

const Parameters& Parameters::table(std::string_view name) const {
  const Entry& found = entry(name);
  if (!value_.at(name).is_map())
    throw Error("parameter '" + std::string(name) + "' is not a table");
  return found.tables.front();
}

const std::vector<Parameters>& Parameters::tables(std::string_view name) const {
  const Entry& found = entry(name);
  if (!value_.at(name).is_list()) {
    throw Error("parameter '" + std::string(name) + "' is not a list of tables");
  }
  return found.tables;
}

Origin Parameters::origin(std::string_view name) const {
  const Value* value = value_.find(name);
  return value ? value->origin() : Origin{"default", 0};
}

std::string nearest_name(std::string_view name, std::span<const std::string> candidates) {
  // Further away than a third of its letters, a name is another word, not a slip of the hand.
  std::size_t best_distance = std::max<std::size_t>(1, (name.size() + 1) / 3) + 1;
  std::string best;
  for (const std::string& candidate : candidates) {
    // Levenshtein's distance, a row at a time; two swapped neighbours count as one slip.
    std::vector<std::size_t> before(candidate.size() + 1);
    std::vector<std::size_t> row(candidate.size() + 1);
    std::vector<std::size_t> next(candidate.size() + 1);
    std::iota(row.begin(), row.end(), std::size_t{0});
    for (std::size_t i = 1; i <= name.size(); ++i) {
      next[0] = i;
      for (std::size_t j = 1; j <= candidate.size(); ++j) {
        const auto same = [](char a, char b) {  // a capital is no slip
          return std::tolower(static_cast<unsigned char>(a)) ==
                 std::tolower(static_cast<unsigned char>(b));
        };
        const std::size_t cost = same(name[i - 1], candidate[j - 1]) ? 0 : 1;
        next[j] = std::min({row[j] + 1, next[j - 1] + 1, row[j - 1] + cost});
        if (i > 1 && j > 1 && name[i - 1] == candidate[j - 2] && name[i - 2] == candidate[j - 1]) {
          next[j] = std::min(next[j], before[j - 2] + 1);
        }
      }
      std::swap(before, row);
      std::swap(row, next);
    }
    if (row.back() < best_distance) {
      best_distance = row.back();
      best = candidate;
    }
  }
  return best;
}

}  // namespace lapwing
