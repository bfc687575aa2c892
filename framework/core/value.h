// SPDX-License-Identifier: Apache-2.0
// The neutral tree that YAML, Lua tables, JSON and --set become before they are checked.
//
// Every node remembers where it was written, so that an error found late still names file and line.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "framework/core/error.h"

namespace lapwing {

class Value {
 public:
  enum class Type { null, boolean, integer, number, text, list, map };
  using List = std::vector<Value>;
  using Map = std::vector<std::pair<std::string, Value>>;  // in the order written, keys unique

  // All in the source: nearly every other one copies and drops values.
  Value();
  Value(bool v);
  Value(int v);
  Value(std::int64_t v);
  Value(double v);
  Value(const char* v);
  Value(std::string v);
  Value(List v);
  Value(Map v);
  Value(const Value& other);
  Value(Value&& other) noexcept;
  Value& operator=(const Value& other);
  Value& operator=(Value&& other) noexcept;
  ~Value();
  static Value list();
  static Value map();

  Type type() const { return static_cast<Type>(data_.index()); }
  bool is_null() const { return type() == Type::null; }
  bool is_number() const { return type() == Type::integer || type() == Type::number; }
  bool is_text() const { return type() == Type::text; }
  bool is_list() const { return type() == Type::list; }
  bool is_map() const { return type() == Type::map; }
  // "an integer", "a list", ... for messages.
  std::string describe_type() const;

  // Each throws InputError naming the origin when the type differs. An integer reads as a number.
  bool as_boolean() const;
  std::int64_t as_integer() const;
  double as_number() const;
  const std::string& as_text() const;
  const List& as_list() const;
  List& as_list();
  const Map& as_map() const;
  Map& as_map();

  // Map access. `find` returns null when absent (or when this is no map); `at` throws InputError.
  const Value* find(std::string_view key) const;
  Value* find(std::string_view key);
  const Value& at(std::string_view key) const;
  // Inserts or replaces; a null value becomes a map first.
  Value& set(std::string_view key, Value value);
  void push_back(Value value);

  const Origin& origin() const { return origin_; }
  Value& with_origin(Origin origin);
  // Compares contents, not origins.
  bool operator==(const Value& other) const;

 private:
  std::variant<std::monostate, bool, std::int64_t, double, std::string, List, Map> data_;
  Origin origin_;
};

// Lays `over` on `base`: maps are merged key by key, everything else is replaced. A map that names
// another `type` than the one below it replaces it whole: parameters of one plugin mean nothing to
// another. A text is short for a map with that `type` alone: laid over a map of another type it
// replaces it, over one of its own type it changes nothing; a map without a `type`, laid over a
// text, keeps that text as its `type`.
void merge(Value& base, const Value& over);

}  // namespace lapwing
