// SPDX-License-Identifier: Apache-2.0
// As much of JSON schema as the schemas of configurations use, to hold documents against them.
#pragma once

#include <regex>
#include <string>

#include "framework/core/value.h"

namespace lapwing {

// "" where `given` is as the schema says, else what is wrong, with its place. `root` holds the
// definitions.
std::string schema_error(const Value& schema, const Value& given, const Value& root,
                         const std::string& at);
inline std::string schema_error(const Value& schema, const Value& given) {
  return schema_error(schema, given, schema, "");
}

inline bool has_schema_type(const std::string& type, const Value& given) {
  if (type == "object") return given.is_map();
  if (type == "array") return given.is_list();
  if (type == "string") return given.is_text();
  if (type == "boolean") return given.type() == Value::Type::boolean;
  if (type == "integer") return given.type() == Value::Type::integer;
  if (type == "number") return given.is_number();
  throw Error("a schema has the unknown type " + type);
}

inline std::string schema_object_error(const Value& schema, const Value& given, const Value& root,
                                       const std::string& at) {
  const Value* properties = schema.find("properties");
  for (const auto& [key, value] : given.as_map()) {
    const Value* property = properties ? properties->find(key) : nullptr;
    if (property) {
      const std::string error = schema_error(*property, value, root, at + "." + key);
      if (!error.empty()) return error;
      continue;
    }
    const Value* more = schema.find("additionalProperties");
    if (more && !more->as_boolean()) {
      return at + "." + key + " is not known";
    }
  }
  if (const Value* required = schema.find("required"))
    for (const Value& key : required->as_list())
      if (!given.find(key.as_text())) return at + " lacks " + key.as_text();
  return "";
}

inline std::string schema_error(const Value& schema, const Value& given, const Value& root,
                                const std::string& at) {
  if (const Value* reference = schema.find("$ref")) {
    const std::string name = reference->as_text().substr(std::string("#/definitions/").size());
    return schema_error(root.at("definitions").at(name), given, root, at);
  }
  if (const Value* ways = schema.find("anyOf")) {
    std::string errors;
    for (const Value& way : ways->as_list()) {
      const std::string error = schema_error(way, given, root, at);
      if (error.empty()) return "";
      errors += (errors.empty() ? "" : "; or ") + error;
    }
    return errors;
  }
  if (const Value* type = schema.find("type"); type && !has_schema_type(type->as_text(), given))
    return at + " is no " + type->as_text();
  if (const Value* one = schema.find("const"); one && !(*one == given)) return at + " is another";
  if (const Value* known = schema.find("enum")) {
    bool found = false;
    for (const Value& choice : known->as_list()) found = found || choice == given;
    if (!found) return at + " is none of the choices";
  }
  if (const Value* pattern = schema.find("pattern"))
    if (!std::regex_search(given.as_text(), std::regex(pattern->as_text())))
      return at + " is written otherwise";
  if (given.is_number()) {
    const double x = given.as_number();
    const Value *low = schema.find("minimum"), *high = schema.find("maximum"),
                *above = schema.find("exclusiveMinimum");
    if ((low && x < low->as_number()) || (high && x > high->as_number()) ||
        (above && x <= above->as_number()))
      return at + " is out of range";
  }
  if (given.is_list()) {
    const auto size = static_cast<std::int64_t>(given.as_list().size());
    const Value *least = schema.find("minItems"), *most = schema.find("maxItems");
    if ((least && size < least->as_integer()) || (most && size > most->as_integer()))
      return at + " has another size";
    if (const Value* items = schema.find("items"))
      for (const Value& entry : given.as_list()) {
        const std::string error = schema_error(*items, entry, root, at + "[]");
        if (!error.empty()) return error;
      }
  }
  if (given.is_map()) {
    const std::string error = schema_object_error(schema, given, root, at);
    if (!error.empty()) return error;
  }
  if (const Value* all = schema.find("allOf"))
    for (const Value& one : all->as_list()) {
      const std::string error = schema_error(one, given, root, at);
      if (!error.empty()) return error;
    }
  if (const Value* condition = schema.find("if"))
    if (schema_error(*condition, given, root, at).empty())
      return schema_error(schema.at("then"), given, root, at);
  return "";
}

}  // namespace lapwing
