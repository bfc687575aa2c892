// SPDX-License-Identifier: Apache-2.0
// What scripts may call, as LuaLS reads it and as a table of a README.
#include <algorithm>

#include "framework/core/json.h"
#include "framework/mission/declared_entry.h"
#include "framework/mission/script_interface.h"
#include "framework/vehicle/vehicle.h"

namespace lapwing {

namespace {

struct Argument {
  std::string name;  // with a question mark where it may be left out
  std::string type;
};

struct Signature {
  std::vector<Argument> arguments;
  std::string results;
};

// "(a: x, b?: y): z"; types hold no ", " outside of brackets.
Signature parsed_signature(const std::string& text) {
  Signature signature;
  std::size_t at = 1;
  int depth = 0;
  std::string part;
  const auto finish = [&] {
    if (part.empty()) return;
    const std::size_t colon = part.find(": ");
    signature.arguments.push_back({part.substr(0, colon), part.substr(colon + 2)});
    part.clear();
  };
  for (; at < text.size(); ++at) {
    const char c = text[at];
    if (depth == 0 && c == ')') break;
    depth += c == '(' || c == '<' || c == '{';
    depth -= c == ')' || c == '>' || c == '}';
    if (depth == 0 && c == ',') {
      finish();
      ++at;
    } else {
      part += c;
    }
  }
  finish();
  if (at + 3 < text.size()) signature.results = text.substr(at + 3);
  return signature;
}

// The class of a binding's own table.
std::string table_class(const std::string& owner, const char* binding) {
  return (owner == "lapwing" ? "lapwing.functions" : owner) + "." + binding;
}

std::string class_name(const std::string& type) {
  std::string name = type == "lapwing"                ? type
                     : type.rfind("lapwing.", 0) == 0 ? type
                                                      : "lapwing." + type;
  std::replace(name.begin(), name.end(), ' ', '_');
  return name;
}

// The alias of what may choose a plugin of a kind.
std::string choice_alias(const std::string& kind) {
  return "lapwing." + (kind == "map" ? "map_choice" : kind);
}

std::string quoted_alternatives(const Value& list) {
  std::string text;
  for (const Value& choice : list.as_list())
    text += (text.empty() ? "\"" : "|\"") + choice.as_text() + "\"";
  return text;
}

// "above 0, m, default 2" after a summary.
std::string details_of(const Value& entry) {
  std::string text;
  const auto add = [&](const std::string& part) { text += (text.empty() ? "" : ", ") + part; };
  if (const std::string unit = declared_text(entry, "unit"); !unit.empty()) add(unit);
  if (const std::string in_words = declared_range(entry).to_string(); !in_words.empty())
    add(in_words);
  if (const Value* fallback = entry.find("default");
      fallback && !fallback->is_null() && fallback->type() != Value::Type::map)
    add("default " + to_json(*fallback, -1));
  return text;
}

class AnnotationWriter {
 public:
  AnnotationWriter(const ScriptInterface& interface, const Registry& registry)
      : interface_(interface), registry_(registry) {}

  std::string write() {
    text_ =
        "---@meta\n"
        "-- What mission scripts may call and users may set; written by `lapwing annotations`.\n\n"
        "---@alias lapwing.value number|lapwing.scalar\n"
        "---@alias lapwing.vector number[]|lapwing.symbolic_vector\n\n";
    for (const BoundType& type : interface_.types) write_type(type);
    write_plugins();
    for (const MissionFunction& mission : interface_.missions) {
      begin_class("lapwing." + mission.kind + "." + mission.name);
      text_ += "---@field name? string the mission's, and that of the folder of its results\n";
      write_entries(mission.declarations, "lapwing." + mission.kind + "." + mission.name, {});
      finish_class();
    }
    write_described();
    write_class("lapwing.vehicle_file", vehicle_table().to_value());
    return text_;
  }

 private:
  void write_field(const std::string& name, const std::string& type, const std::string& summary) {
    if (name.rfind("operator ", 0) == 0)
      text_ += "---@" + name + ": " + type + "\n";
    else
      text_ += "---@field " + name + " " + type + " " + summary + "\n";
  }

  // Classes of nested tables are written when the class that they are in is finished.
  void begin_class(const std::string& name, const std::string& parent = "") {
    text_ += "---@class " + name + (parent.empty() ? "" : ": " + parent) + "\n";
  }
  void finish_class() {
    text_ += "\n";
    std::vector<std::pair<std::string, Value>> pending = std::move(pending_);
    pending_.clear();
    for (const auto& [name, entries] : pending) write_class(name, entries);
  }
  void write_class(const std::string& name, const Value& entries,
                   std::span<const BoundField> objects = {}) {
    begin_class(name);
    for (const BoundField& object : objects) write_field(object.name, object.type, object.summary);
    write_entries(entries, name, {});
    finish_class();
  }

  std::string type_of(const Value& entry, const std::string& owner) {
    const std::string type = declared_text(entry, "type");
    const std::string words =
        entry.find("words") ? "|" + quoted_alternatives(entry.at("words")) : "";
    const std::string nested = owner + "." + declared_text(entry, "name");
    const bool has_unit = !declared_text(entry, "unit").empty();
    if (type == "number") return (has_unit ? "number|string" : "number") + words;
    if (type == "integer") return "integer" + words;
    if (type == "numbers") return has_unit ? "(number|string)[]" : "number[]";
    if (type == "text") return "string";
    if (type == "choice") return quoted_alternatives(entry.at("choices"));
    if (type == "vehicle") return "string|lapwing.vehicle_file";
    if (type == "plugin") return plugin_type(entry, nested);
    if (type == "plugins") return choice_alias(declared_text(entry, "kind")) + "[]";
    if (type == "table" || type == "tables") {
      pending_.emplace_back(nested, entry.at("table"));
      return type == "table" ? nested : nested + "[]";
    }
    return type;
  }

  std::string plugin_type(const Value& entry, const std::string& nested) {
    const std::string alias = choice_alias(declared_text(entry, "kind"));
    const Value* own = entry.find("table");
    if (!own) return alias;
    Value all = *own;
    Value chosen = Value::map();
    chosen.set("name", declared_text(entry, "under"));
    chosen.set("type", "text");
    chosen.set("summary", "name of the plugin; its parameters may follow in this table");
    all.push_back(std::move(chosen));
    pending_.emplace_back(nested, std::move(all));
    return nested + "|" + alias;
  }

  void write_entries(const Value& entries, const std::string& owner,
                     const std::vector<std::string>& left_out) {
    for (const Value& entry : entries.as_list()) {
      const std::string name = declared_text(entry, "name");
      if (std::find(left_out.begin(), left_out.end(), name) != left_out.end()) continue;
      const std::string details = details_of(entry);
      const std::string also = declared_text(entry, "also");
      write_field(name + (declared_required(entry) ? "" : "?"),
                  type_of(entry, owner) + (also.empty() ? "" : "|" + also),
                  declared_text(entry, "summary") + (details.empty() ? "" : " (" + details + ")"));
    }
  }

  void write_type(const BoundType& type) {
    const std::string name = class_name(type.name);
    const std::string variable = type.name == "lapwing" ? "lapwing" : "it";
    begin_class(name);
    for (const BoundField& field : type.fields) write_field(field.name, field.type, field.summary);
    if (!type.functions.empty())
      text_ += (type.name == "lapwing" ? "" : "local ") + variable + " = {}\n";
    for (const Binding& binding : type.functions) write_function(type, binding, name, variable);
    finish_class();
    for (const Binding& binding : type.functions)
      if (binding.table || !binding.objects.empty())
        write_class(table_class(name, binding.name),
                    binding.table ? binding.table().to_value() : Value::list(), binding.objects);
    for (const BoundTable& table : type.tables)
      write_class("lapwing." + std::string(table.name), table.table().to_value(), table.objects);
  }

  void write_function(const BoundType& type, const Binding& binding, const std::string& owner,
                      const std::string& variable) {
    const Signature signature = parsed_signature(binding.signature);
    text_ += "\n--- " + std::string(binding.summary) + "\n";
    std::string names;
    for (const Argument& argument : signature.arguments) {
      const std::string is =
          argument.type == "@" ? table_class(owner, binding.name) : argument.type;
      text_ += "---@param " + argument.name + " " + is + "\n";
      std::string plain = argument.name;
      if (plain.back() == '?') plain.pop_back();
      names += (names.empty() ? "" : ", ") + plain;
    }
    if (!signature.results.empty()) text_ += "---@return " + signature.results + "\n";
    text_ += "function " + variable + (type.name == "lapwing" ? "." : ":") + binding.name + "(" +
             names + ") end\n";
  }

  void write_described() {
    std::string owner;
    for (const DescribedFunction& function : interface_.described) {
      const std::string name = "lapwing." + function.owner;
      if (function.owner != owner) begin_class(name);
      owner = function.owner;
      write_field(function.name,
                  "fun(given: " + name + "." + function.name + "): " + function.gives,
                  function.summary);
    }
    if (!owner.empty()) finish_class();
    for (const DescribedFunction& function : interface_.described)
      write_class("lapwing." + function.owner + "." + function.name, function.declarations);
  }

  void write_plugins() {
    std::string kind, alternatives;
    const auto finish = [&] {
      if (!kind.empty()) text_ += "---@alias " + choice_alias(kind) + " " + alternatives + "\n\n";
      alternatives.clear();
    };
    for (const PluginEntry& entry : registry_.entries()) {
      if (entry.kind != kind) finish();
      kind = entry.kind;
      const bool term = kind == "cost_term" || kind == "constraint" || kind == "vehicle_model";
      const std::string name = "lapwing." + kind + "." + entry.name;
      text_ += "--- " + entry.summary + "\n";
      begin_class(name, kind == "cost_term"    ? "lapwing.cost_frame"
                        : kind == "constraint" ? "lapwing.constraint_frame"
                        : term                 ? "lapwing.plugin_frame"
                                               : "");
      text_ += "---@field type \"" + entry.name + "\"\n";
      write_entries(entry.parameters.to_value(), name, {"type"});
      finish_class();
      if (!alternatives.empty()) alternatives += "|";
      if (!term) alternatives += "\"" + entry.name + "\"|";
      alternatives += name;
    }
    finish();
  }

  const ScriptInterface& interface_;
  const Registry& registry_;
  std::vector<std::pair<std::string, Value>> pending_;
  std::string text_;
};

// "{ vehicle =, duration =, ... }": the keys of a binding's own table.
std::string keys_of(const Binding& binding) {
  std::string text;
  const auto add = [&](std::string name) {
    if (name.back() == '?') name.pop_back();
    text += (text.empty() ? " { " : ", ") + name + " =";
  };
  for (const BoundField& object : binding.objects) add(object.name);
  if (binding.table) {
    const ParameterTable table = binding.table();
    for (const ParameterSpec& spec : table.specs()) add(spec.name);
  }
  return text + " }";
}

std::string call_of(const Binding& binding) {
  const Signature signature = parsed_signature(binding.signature);
  if (signature.arguments.size() == 1 && signature.arguments[0].type == "@")
    return keys_of(binding);
  std::string text, closing;
  for (const Argument& argument : signature.arguments) {
    const bool optional = argument.name.back() == '?';
    std::string name = optional ? argument.name.substr(0, argument.name.size() - 1) : argument.name;
    if (argument.type == "@") name = keys_of(binding).substr(1);
    text += optional ? (text.empty() ? "[" : " [, ") : (text.empty() ? "" : ", ");
    text += name;
    if (optional) closing += "]";
  }
  return "(" + text + closing + ")";
}

}  // namespace

std::string annotations_of(const ScriptInterface& interface, const Registry& registry) {
  return AnnotationWriter(interface, registry).write();
}

std::string call_table_of(const ScriptInterface& interface) {
  std::string text = "| call | gives |\n|---|---|\n";
  for (const BoundType& type : interface.types) {
    std::string owner = type.name;
    std::replace(owner.begin(), owner.end(), ' ', '_');
    for (const Binding& binding : type.functions)
      text += "| `" + owner + (type.name == "lapwing" ? "." : ":") + binding.name +
              call_of(binding) + "` | " + binding.summary + " |\n";
    std::string fields;
    for (const BoundField& field : type.fields)
      if (std::string_view(field.name).find_first_of("[ ") == std::string_view::npos)
        fields += (fields.empty() ? "`" : "; `") + std::string(field.name) + "` " + field.summary;
    // Tables of the script's own, and the values of terms, have their place in the text.
    const bool elsewhere =
        type.name == "option" || type.name == "mission" || type.name == "symbolic vector";
    if (fields.empty() || elsewhere) continue;
    const bool vowel = std::string("aeiou").find(type.name.front()) != std::string::npos;
    text +=
        "| fields of " + std::string(vowel ? "an " : "a ") + type.name + " | " + fields + " |\n";
  }
  return text;
}

}  // namespace lapwing
