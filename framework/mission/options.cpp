// SPDX-License-Identifier: Apache-2.0
#include "framework/mission/options.h"

#include <algorithm>

#include "framework/config/overrides.h"
#include "framework/vehicle/vehicle.h"

namespace lapwing {

namespace {

const std::vector<std::string>& known_declaration_keys() {
  static const std::vector<std::string> keys = [] {
    std::vector<std::string> names;
    for (const BoundField& key : kDeclarationKeys) {
      names.emplace_back(key.name);
      if (names.back().ends_with('?')) names.back().pop_back();
    }
    return names;
  }();
  return keys;
}

void check_declaration_keys(const Value& declaration) {
  for (const auto& [key, value] : declaration.as_map()) {
    const auto& known = known_declaration_keys();
    if (std::find(known.begin(), known.end(), key) != known.end()) continue;
    const std::string nearest = nearest_name(key, known);
    throw InputError(value.origin(),
                     "an option is declared with the unknown key '" + key + "'" +
                         (nearest.empty() ? "" : "; did you mean '" + nearest + "'?"));
  }
}

Value without(const Value& map, std::initializer_list<std::string_view> keys) {
  Value rest = Value::map();
  rest.with_origin(map.origin());
  for (const auto& [key, value] : map.as_map()) {
    if (std::find(keys.begin(), keys.end(), key) == keys.end()) rest.set(key, value);
  }
  return rest;
}

Value inferred(const std::string& name, const Value& value) {
  Value declaration = Value::map();
  declaration.set("name", name);
  declaration.set("summary", "");
  Value fallback = value;
  switch (value.type()) {
    case Value::Type::boolean:
      declaration.set("type", "boolean");
      break;
    case Value::Type::integer:
    case Value::Type::number:
      declaration.set("type", "number");
      break;
    case Value::Type::text:
      declaration.set("type", "text");
      break;
    case Value::Type::list: {
      const auto& list = value.as_list();
      const bool numbers =
          std::all_of(list.begin(), list.end(), [](const Value& v) { return v.is_number(); });
      if (!numbers) {
        throw InputError(value.origin(), name +
                                             ": only numbers can be listed here; declare the "
                                             "option with lapwing.options");
      }
      declaration.set("type", "numbers");
      break;
    }
    case Value::Type::map: {
      Value inner = Value::list();
      for (const auto& [key, entry] : value.as_map()) inner.push_back(inferred(key, entry));
      declaration.set("type", "table");
      declaration.set("table", inner);
      return declaration;
    }
    case Value::Type::null:
      break;
  }
  declaration.set("default", fallback);
  return declaration;
}

}  // namespace

OptionDeclarations OptionDeclarations::from_value(const Value& list) {
  OptionDeclarations declarations;
  Value plain = Value::list();
  for (Value declaration : list.as_list()) {
    check_declaration_keys(declaration);
    Option option;
    option.name = declaration.at("name").as_text();
    if (const Value* why = declaration.find("refused")) {
      option.refused = why->as_text();
      declaration = without(declaration, {"refused"});
      if (!declaration.find("choices")) {
        declarations.refused_.emplace_back(option.name, option.refused);
        continue;
      }
    }
    const std::string type = declaration.at("type").as_text();
    option.plugins = type == "plugins";
    if (type == "plugin" || option.plugins) option.plugin_kind = declaration.at("kind").as_text();
    option.vehicle = type == "vehicle";
    if (type == "plugin" || type == "vehicle" || option.plugins) declaration.set("type", "text");
    if (const Value* words = declaration.find("words")) {
      for (const Value& word : words->as_list()) option.words.push_back(word.as_text());
    }
    if (!declaration.find("summary")) declaration.set("summary", "");
    if (const Value* settled = declaration.find("settled")) option.settled = *settled;
    if (const Value* under = declaration.find("under")) option.under = under->as_text();
    if (const Value* functions = declaration.find("functions")) option.functions = *functions;
    if (!option.plugin_kind.empty()) {
      if (const Value* own = declaration.find("table")) option.own = *own;
      declaration = without(declaration, {"table"});
    }
    if (const Value* also = declaration.find("also")) option.also = also->as_text();
    if (const Value* other = declaration.find("replaced_by")) option.replaced_by = other->as_text();
    option.declaration = without(
        declaration, {"kind", "words", "settled", "under", "also", "functions", "replaced_by"});
    plain.push_back(option.declaration);
    declarations.options_.push_back(std::move(option));
  }
  ParameterTable::from_value(plain);  // refuses what is malformed or declared twice
  return declarations;
}

Value OptionDeclarations::to_value() const {
  Value list = Value::list();
  for (const Option& option : options_) {
    Value entry = option.declaration;
    if (!option.plugin_kind.empty()) {
      entry.set("type", option.plugins ? "plugins" : "plugin");
      entry.set("kind", option.plugin_kind);
      if (!option.plugins) entry.set("under", option.under);
      if (option.settled.is_map()) entry.set("settled", option.settled);
      if (option.own.is_list()) entry.set("table", option.own);
      if (option.functions.is_list()) entry.set("functions", option.functions);
    }
    if (option.vehicle) entry.set("type", "vehicle");
    if (!option.also.empty()) entry.set("also", option.also);
    if (!option.replaced_by.empty()) entry.set("replaced_by", option.replaced_by);
    if (!option.words.empty()) {
      Value& words = entry.set("words", Value::list());
      for (const std::string& word : option.words) words.push_back(word);
    }
    list.push_back(std::move(entry));
  }
  return list;
}

OptionDeclarations OptionDeclarations::from_options(const Value& options) {
  Value list = Value::list();
  if (options.is_map()) {
    for (const auto& [key, value] : options.as_map()) list.push_back(inferred(key, value));
  }
  return from_value(list);
}

Value OptionDeclarations::plugin_entry(const Option& option, Value& given,
                                       const Registry& registry) {
  const Value* value = given.find(option.name);
  const Value* chosen = value && value->is_map() ? value->find(option.under) : value;
  if (!chosen) chosen = option.declaration.find("default");
  if (!chosen || !chosen->is_text()) {
    throw InputError(chosen ? chosen->origin() : given.origin(),
                     option.name + ": expected the name of a plugin (" + option.plugin_kind + ")");
  }
  Value type = *chosen;
  if (!value) type.with_origin({"default", 0});
  const PluginEntry& plugin = registry.find(option.plugin_kind, type.as_text(), type.origin());
  Value expanded = value && value->is_map() ? *value : Value::map();
  expanded.with_origin(value ? value->origin() : type.origin());
  expanded.set(option.under, type);
  given.set(option.name, std::move(expanded));

  Value table =
      ParameterTable{}.text(option.under, type.as_text(), "name of the plugin").to_value();
  if (option.own.is_list())
    for (const Value& entry : option.own.as_list()) table.push_back(entry);
  const Value own = plugin.parameters.to_value();
  for (const Value& parameter : own.as_list()) {
    const std::string& name = parameter.at("name").as_text();
    const Value* why = option.settled.is_map() ? option.settled.find(name) : nullptr;
    if (!why) {
      table.push_back(parameter);
      continue;
    }
    const Value* set = value && value->is_map() ? value->find(name) : nullptr;
    if (set) throw InputError(set->origin(), option.name + "." + name + ": " + why->as_text());
  }
  Value entry = without(option.declaration, {"default"});
  entry.set("type", "table");
  entry.set("table", std::move(table));
  return entry;
}

Value OptionDeclarations::plain_entry(const Option& option, const Value* value) {
  const Value* fallback = option.declaration.find("default");
  if (option.vehicle && value && value->is_map()) {
    Value entry = without(option.declaration, {"default"});
    entry.set("type", "table");
    entry.set("table", vehicle_table().to_value());
    return entry;
  }
  const Value* effective = value ? value : fallback;
  const auto is_word = [&](const Value& v) {
    return v.is_text() &&
           std::find(option.words.begin(), option.words.end(), v.as_text()) != option.words.end();
  };
  if (effective && is_word(*effective)) {
    Value entry = without(option.declaration, {"unit", "minimum", "above", "maximum", "default"});
    entry.set("type", "choice");
    Value& choices = entry.set("choices", Value::list());
    for (const std::string& word : option.words) choices.push_back(word);
    if (!value) entry.set("default", *fallback);
    return entry;
  }
  if (fallback && is_word(*fallback)) return without(option.declaration, {"default"});
  return option.declaration;
}

Value OptionDeclarations::spelled_out(Value layer) const {
  for (const Option& option : options_) {
    if (!option.own.is_list() || option.plugins) continue;
    const Value* given = layer.find(option.name);
    if (!given || !given->is_text()) continue;
    Value chosen = Value::map();
    chosen.with_origin(given->origin());
    chosen.set(option.under, *given);
    layer.set(option.name, std::move(chosen));
  }
  return layer;
}

std::string OptionDeclarations::spelled_out(const std::string& override_text) const {
  for (const Option& option : options_) {
    if (!option.own.is_list() || option.plugins || !override_text.starts_with(option.name + "="))
      continue;
    Value given = Value::map();
    apply_override(given, override_text);
    if (given.at(option.name).is_text())
      return option.name + "." + option.under + override_text.substr(option.name.size());
  }
  return override_text;
}

namespace {

void add_settable(const ParameterTable& table, const std::string& before,
                  std::vector<SettableOption>& all) {
  for (const ParameterSpec& spec : table.specs()) {
    if (spec.type == ParameterType::tables) continue;
    if (spec.type == ParameterType::table) {
      add_settable(*spec.table, before + spec.name + ".", all);
      continue;
    }
    SettableOption option{before + spec.name, spec.choices};
    if (spec.type == ParameterType::boolean) option.values = {"false", "true"};
    all.push_back(std::move(option));
  }
}

}  // namespace

std::vector<SettableOption> OptionDeclarations::settable(const Value& given,
                                                         const Registry& registry) const {
  Value values = given.is_map() ? given : Value::map();
  std::vector<SettableOption> all;
  add_settable(table_for(values, registry), "", all);
  for (const Option& option : options_) {
    if (option.plugins) continue;
    std::vector<std::string> plugins;
    for (const PluginEntry& entry : registry.entries())
      if (entry.kind == option.plugin_kind) plugins.push_back(entry.name);
    for (SettableOption& one : all) {
      if (one.key == option.name) {
        one.vehicle = option.vehicle;
        one.values.insert(one.values.end(), option.words.begin(), option.words.end());
      }
      if (!plugins.empty() && one.key == option.name + "." + option.under) one.values = plugins;
    }
    if (!plugins.empty()) all.push_back({option.name, plugins});
  }
  return all;
}

// Each entry against the table of the plugin that it names.
Value OptionDeclarations::checked_plugins(const Option& option, const Value* given,
                                          const Registry& registry, Diagnostics& errors) {
  Value all = Value::list();
  all.with_origin(given ? given->origin() : Origin{"default", 0});
  if (!given || given->is_null() || *given == Value::map()) return all;
  if (!given->is_list()) {
    errors.add(given->origin(), option.name,
               "expected a list of tables, got " + given->describe_type());
    return all;
  }
  for (const Value& entry : given->as_list()) {
    const std::string what = option.name + "[" + std::to_string(all.as_list().size() + 1) + "]";
    Value table = option.own;
    const Value* type = entry.find("type");
    if (type) {
      const PluginEntry& plugin =
          registry.find(option.plugin_kind, type->as_text(), type->origin());
      ParameterTable own = ParameterTable::from_value(option.own);
      Value parameters = ParameterTable{}
                             .required_text("type", "which plugin (" + option.plugin_kind + ")")
                             .to_value();
      for (const Value& one : option.own.as_list()) parameters.push_back(one);
      const Value of_plugin = plugin.parameters.to_value();
      for (const Value& one : of_plugin.as_list())
        if (!own.find(one.at("name").as_text())) parameters.push_back(one);
      table = std::move(parameters);
    } else if (option.functions.is_list()) {
      for (const Value& one : option.functions.as_list()) table.push_back(one);
    } else if (option.also.empty()) {  // else the kind says what may be without a type
      errors.add(entry.origin(), what,
                 "expected `type`, the name of a plugin (" + option.plugin_kind + ")");
      continue;
    }
    all.push_back(lapwing::check(ParameterTable::from_value(table), entry, what, errors).value());
  }
  return all;
}

namespace {

// A vehicle's table on another layer than a vehicle's name replaces it: what `merge` kept as its
// `type` is that name.
void forget_replaced_vehicle(Value* given) {
  if (!given || !given->is_map()) return;
  const Value *type = given->find("type"), *mass = given->find("mass");
  if (!type || !mass || type->origin() == mass->origin()) return;
  std::erase_if(given->as_map(), [](const auto& entry) { return entry.first == "type"; });
}

}  // namespace

// The table depends on the values: on the plugins chosen, and on the forms used.
ParameterTable OptionDeclarations::table_for(Value& given, const Registry& registry) const {
  Value list = Value::list();
  for (const Option& option : options_) {
    if (option.plugins) continue;
    if (option.vehicle) forget_replaced_vehicle(given.find(option.name));
    list.push_back(option.plugin_kind.empty() ? plain_entry(option, given.find(option.name))
                                              : plugin_entry(option, given, registry));
  }
  return ParameterTable::from_value(list);
}

void OptionDeclarations::refuse(Value& given, const std::string& what, Diagnostics& errors) const {
  const auto named = [&](const std::string& name) {
    return what.empty() ? name : what + "." + name;
  };
  for (const auto& [name, why] : refused_) {
    const Value* value = given.find(name);
    if (!value) continue;
    errors.add(value->origin(), named(name), why);
    given = without(given, {name});
  }
  for (const Option& option : options_) {
    const Value* value = option.refused.empty() ? nullptr : given.find(option.name);
    if (!value || !value->is_text()) continue;
    const Value::List& choices = option.declaration.at("choices").as_list();
    if (std::find(choices.begin(), choices.end(), Value(value->as_text())) != choices.end())
      continue;
    std::string known;
    for (const Value& choice : choices) known += (known.empty() ? "" : ", ") + choice.as_text();
    errors.add(value->origin(), named(option.name),
               "expected one of " + known + ", got '" + value->as_text() + "': " + option.refused);
    given = without(given, {option.name});
  }
}

Value OptionDeclarations::check(const Value& given, const Registry& registry,
                                const std::string& what) const {
  Value values = given.is_map() ? given : Value::map();
  values.with_origin(given.origin());
  Value plain = Value::map(), lists = Value::map(), result = Value::map();
  plain.with_origin(values.origin());
  Diagnostics errors;
  for (const auto& [key, value] : values.as_map()) {
    const auto of_plugins = [&, &key = key](const Option& option) {
      return option.plugins && option.name == key;
    };
    (std::any_of(options_.begin(), options_.end(), of_plugins) ? lists : plain).set(key, value);
  }
  refuse(plain, what, errors);
  const ParameterTable table = table_for(plain, registry);
  const Parameters checked = lapwing::check(table, plain, what, errors);
  result.with_origin(checked.value().origin());
  const auto replaced = [&](const Option& option) {
    const Value* other =
        option.replaced_by.empty() ? nullptr : checked.value().find(option.replaced_by);
    return other && !other->is_null();
  };
  for (const Option& option : options_) {
    if (replaced(option)) continue;
    if (option.plugins)
      result.set(option.name, checked_plugins(option, lists.find(option.name), registry, errors));
    else if (const Value* value = checked.value().find(option.name))
      result.set(option.name, *value);
  }
  errors.throw_if_any();
  return result;
}

}  // namespace lapwing
