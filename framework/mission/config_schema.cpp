// SPDX-License-Identifier: Apache-2.0
// A JSON schema (draft 7, which editors of YAML read) from the declarations of mission kinds.
#include <algorithm>
#include <cmath>

#include "framework/mission/declared_entry.h"
#include "framework/mission/script_interface.h"
#include "framework/vehicle/vehicle.h"

namespace lapwing {

namespace {

Value typed(const char* type) {
  Value schema = Value::map();
  schema.set("type", type);
  return schema;
}

Value any_of(Value::List schemas) {
  if (schemas.size() == 1) return schemas[0];
  Value schema = Value::map();
  schema.set("anyOf", Value(std::move(schemas)));
  return schema;
}

Value list_of_texts(const Value& texts) {
  Value schema = Value::map();
  schema.set("enum", texts);
  return schema;
}

// Nothing but these keys; `required` where a whole table is written, not a part of one that is laid
// over another.
Value object_of(Value properties, const Value& required = Value::list()) {
  Value schema = typed("object");
  schema.set("properties", std::move(properties));
  schema.set("additionalProperties", false);
  if (!required.as_list().empty()) schema.set("required", required);
  return schema;
}

class SchemaWriter {
 public:
  explicit SchemaWriter(const Registry& registry) : registry_(registry) {}

  Value properties_of(const Value& entries, Value* required = nullptr) {
    Value properties = Value::map();
    for (const Value& entry : entries.as_list()) {
      properties.set(declared_text(entry, "name"), schema_of(entry));
      if (required && declared_required(entry)) required->push_back(declared_text(entry, "name"));
    }
    return properties;
  }

  const Value& definitions() const { return definitions_; }

 private:
  Value number_of(const Value& entry, const char* type) {
    Value schema = typed(type);
    for (const auto& [key, name] : {std::pair{"minimum", "minimum"}, {"maximum", "maximum"}})
      if (const Value* bound = entry.find(key)) schema.set(name, *bound);
    if (const Value* bound = entry.find("above")) schema.set("exclusiveMinimum", *bound);
    Value::List ways{std::move(schema)};
    if (!declared_text(entry, "unit").empty()) {
      Value with_unit = typed("string");
      with_unit.set("pattern", "^[-+]?[0-9.]+([eE][-+]?[0-9]+)? *[A-Za-z%]");
      ways.push_back(std::move(with_unit));
    }
    if (const Value* words = entry.find("words")) ways.push_back(list_of_texts(*words));
    return any_of(std::move(ways));
  }

  Value bare_schema_of(const Value& entry) {
    const std::string type = declared_text(entry, "type");
    if (type == "boolean") return typed("boolean");
    if (type == "number" || type == "integer") return number_of(entry, type.c_str());
    if (type == "text") return typed("string");
    if (type == "choice") return list_of_texts(entry.at("choices"));
    if (type == "plugin") return plugin_schema_of(entry);
    if (type == "plugins") return plugins_schema_of(entry);
    if (type == "numbers") {
      Value schema = typed("array");
      schema.set("items", number_of(entry, "number"));
      if (const Value* size = entry.find("size"); size && size->as_integer() > 0) {
        schema.set("minItems", *size);
        schema.set("maxItems", *size);
      }
      return schema;
    }
    if (type == "vehicle") {
      if (!definitions_.find("vehicle"))
        definitions_.set("vehicle", object_of(properties_of(vehicle_table().to_value())));
      return any_of({typed("string"), reference("vehicle")});
    }
    if (type == "tables") {
      Value required = Value::list(), schema = typed("array");
      Value properties = properties_of(entry.at("table"), &required);
      schema.set("items", object_of(std::move(properties), required));
      return schema;
    }
    return object_of(properties_of(entry.at("table")));
  }

  Value schema_of(const Value& entry) {
    Value schema = bare_schema_of(entry);
    std::string summary = declared_text(entry, "summary");
    if (const std::string unit = declared_text(entry, "unit"); !unit.empty())
      summary += (summary.empty() ? "" : ", ") + unit;
    if (!summary.empty()) schema.set("description", summary);
    if (const Value* fallback = entry.find("default"); fallback && !fallback->is_null())
      schema.set("default", *fallback);
    return schema;
  }

  static Value reference(const std::string& name) {
    Value schema = Value::map();
    schema.set("$ref", "#/definitions/" + name);
    return schema;
  }

  // A plugin's name, or a table: which keys it may have depends on the plugin that it names.
  Value plugin_schema_of(const Value& entry) {
    const std::string kind = declared_text(entry, "kind");
    Value names = Value::list(), branches = Value::list(), all = Value::map();
    const Value* settled = entry.find("settled");
    const bool own = entry.find("table") || settled;
    for (const PluginEntry& plugin : registry_.entries()) {
      if (plugin.kind != kind) continue;
      names.push_back(plugin.name);
      if (own) {
        const Value parameters = plugin.parameters.to_value();
        for (const Value& parameter : parameters.as_list())
          if (const std::string name = declared_text(parameter, "name");
              !all.find(name) && !(settled && settled->find(name)))
            all.set(name, schema_of(parameter));
      } else {
        branches.push_back(branch_of(plugin));
      }
    }
    const std::string under =
        declared_text(entry, "under").empty() ? "type" : declared_text(entry, "under");
    Value table = typed("object");
    if (own) {
      if (const Value* more = entry.find("table")) {
        const Value properties = properties_of(*more);
        for (const auto& [name, schema] : properties.as_map()) all.set(name, schema);
      }
      all.set(under, list_of_texts(names));
      table = object_of(std::move(all));
    } else {
      Value type = Value::map();
      type.set("type", list_of_texts(names));
      table.set("properties", std::move(type));
      table.set("allOf", std::move(branches));
    }
    return any_of({list_of_texts(names), std::move(table)});
  }

  // A list of tables: by its `type` of one plugin, or without one the mission's own entries.
  Value plugins_schema_of(const Value& entry) {
    const std::string kind = declared_text(entry, "kind");
    Value function = entry.at("table");
    if (const Value* more = entry.find("functions"))
      for (const Value& one : more->as_list()) function.push_back(one);
    Value::List forms{object_of(properties_of(function))};
    for (const PluginEntry& plugin : registry_.entries()) {
      if (plugin.kind != kind) continue;
      Value properties = properties_of(plugin.parameters.to_value()), constant = Value::map();
      const Value own = properties_of(entry.at("table"));
      for (const auto& [name, schema] : own.as_map()) properties.set(name, schema);
      constant.set("const", plugin.name);
      properties.set("type", std::move(constant));
      Value form = object_of(std::move(properties), Value(Value::List{"type"}));
      form.set("description", plugin.summary);
      forms.push_back(std::move(form));
    }
    Value schema = typed("array");
    schema.set("items", any_of(std::move(forms)));
    return schema;
  }

  Value branch_of(const PluginEntry& plugin) {
    const std::string name = plugin.kind + "." + plugin.name;
    if (!definitions_.find(name)) {
      Value properties = properties_of(plugin.parameters.to_value());
      properties.set("type", typed("string"));
      Value schema = object_of(std::move(properties));
      schema.set("description", plugin.summary);
      definitions_.set(name, std::move(schema));
    }
    Value constant = Value::map(), type = Value::map(), condition = Value::map(),
          branch = Value::map();
    constant.set("const", plugin.name);
    type.set("type", std::move(constant));
    condition.set("properties", std::move(type));
    condition.set("required", Value(Value::List{"type"}));
    branch.set("if", std::move(condition));
    branch.set("then", reference(name));
    return branch;
  }

  const Registry& registry_;
  Value definitions_ = Value::map();
};

}  // namespace

Value config_schema(const ScriptInterface& interface, const Registry& registry,
                    const std::string& kind) {
  SchemaWriter writer(registry);
  Value properties = Value::map(), required = Value::list();
  std::vector<std::string> known{"vehicle"};
  if (kind == "vehicle") {
    properties = writer.properties_of(vehicle_table().to_value(), &required);
    // A file of its own, by name.
    Value camera = Value::map();
    camera.set("anyOf", Value(Value::List{typed("string"), properties.at("camera")}));
    properties.set("camera", std::move(camera));
  } else {
    std::vector<std::pair<std::string, Value::List>> forms;  // what the kinds say of an option
    for (const MissionFunction& mission : interface.missions) {
      if (std::find(known.begin(), known.end(), mission.kind) == known.end())
        known.push_back(mission.kind);
      if (!kind.empty() && mission.kind != kind) continue;
      const Value options = writer.properties_of(mission.declarations);
      for (const auto& [name, schema] : options.as_map()) {
        auto form = std::find_if(forms.begin(), forms.end(),
                                 [&, &key = name](const auto& one) { return one.first == key; });
        if (form == forms.end()) form = forms.insert(forms.end(), {name, {}});
        if (std::find(form->second.begin(), form->second.end(), schema) == form->second.end())
          form->second.push_back(schema);
      }
    }
    if (forms.empty()) {
      std::string all;
      for (const std::string& one : known) all += (all.empty() ? "" : ", ") + one;
      const std::string nearest = nearest_name(kind, known);
      throw InputError("there is no kind of configuration '" + kind + "'" +
                       (nearest.empty() ? "." : "; did you mean '" + nearest + "'?") +
                       " There are: " + all);
    }
    for (auto& [name, schemas] : forms) properties.set(name, any_of(std::move(schemas)));
    properties.set("sandbox", object_of(writer.properties_of(sandbox_table().to_value())));
  }
  Value schema = Value::map();
  schema.set("$schema", "http://json-schema.org/draft-07/schema#");
  schema.set("title", kind.empty()        ? "Lapwing: options of missions"
                      : kind == "vehicle" ? "Lapwing: a vehicle"
                                          : "Lapwing: options of missions of kind " + kind);
  const Value object = object_of(std::move(properties), required);
  for (const auto& [key, value] : object.as_map()) schema.set(key, value);
  if (!writer.definitions().as_map().empty()) schema.set("definitions", writer.definitions());
  return schema;
}

}  // namespace lapwing
