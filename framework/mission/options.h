// SPDX-License-Identifier: Apache-2.0
// The options of a mission: what its script declares, and the values that they come to have.
//
// A declaration is an entry of a parameter table as data (core/parameters.h: name, type, summary,
// unit, default, required, minimum, above, maximum, choices, size, table), with four more forms:
//   type = "plugin", kind = "trajectory_solver", default = "iqp"
//       a plugin's name, or a table with `type` and the plugin's own parameters
//       settled = { name = "why" }: parameters that the mission itself settles; who sets one is
//       told why not
//       under = "solver": the key that names the plugin, in place of `type`
//       table = {...}: entries of the mission's own beside the plugin's parameters
//   type = "plugins", kind = "cost_term", table = {...}
//       a list of tables, each with a plugin's `type`, its parameters and the mission's own
//       entries; one without `type`, a function of the script, has the mission's own entries and
//       functions = {...}: entries of functions alone
//   type = "vehicle"               a vehicle file's name, or a table as in such a file
//   replaced_by = "input"          left out of what the options come to where `input` is set
//   words = {"auto"}               on a number: these texts are allowed as well
//   refused = "why"                nobody may set it, and who does is told why; on a choice, the
//                                  reason why it has no others
//   also = "string"                a short form that the kind itself writes out, for annotations
#pragma once

#include <string>
#include <vector>

#include "framework/core/parameters.h"
#include "framework/mission/binding.h"
#include "framework/plugin/registry.h"

namespace lapwing {

// The keys of a declaration.
inline constexpr BoundField kDeclarationKeys[] = {
    {"name", "string", "name of the option"},
    {"type", "string",
     "boolean, integer, number, numbers, text, choice, table, tables, plugin, plugins, vehicle"},
    {"summary?", "string", "one line"},
    {"unit?", "string", "unit of a number or of numbers: m, s, m/s, deg, ..."},
    {"default?", "any", "value if it is not set"},
    {"required?", "boolean", "whether it must be set"},
    {"minimum?", "number", "smallest value of a number, or of each of numbers"},
    {"above?", "number", "exclusive lower bound"},
    {"maximum?", "number", "largest value of a number, or of each of numbers"},
    {"choices?", "string[]", "values of a choice"},
    {"size?", "integer", "length of the list of numbers"},
    {"table?", "lapwing.option[]", "entries of a table, or of each of tables"},
    {"kind?", "string", "kind of a plugin: trajectory_solver, ..."},
    {"words?", "string[]", "texts that are allowed in place of a number"},
    {"settled?", "table<string, string>", "parameters of a plugin that cannot be set, and why"},
    {"under?", "string", "the key that names a plugin, in place of `type`"},
    {"functions?", "lapwing.option[]", "entries of plugins that are functions of the script"},
    {"replaced_by?", "string", "option that replaces this one if it is set"},
    {"refused?", "string", "reason why it cannot be set, or why a choice has no others"},
    {"also?", "string", "another form that a script may give, as a type of LuaLS"}};

// What may be written behind --set: "weights.yaw", and the words that its value may be.
struct SettableOption {
  std::string key;
  std::vector<std::string> values;
  bool vehicle = false;  // a vehicle file's name
};

class OptionDeclarations {
 public:
  // From what a script gave to lapwing.options. InputError naming what is malformed.
  static OptionDeclarations from_value(const Value& list);
  // The list again: what `from_value` takes.
  Value to_value() const;
  // A script that declares nothing: its own options with their types, as defaults.
  static OptionDeclarations from_options(const Value& options);

  // Checks given values (script and overrides, merged) and fills in every default, those of the
  // plugins chosen included; no code is loaded. InputError with all errors, whose keys begin with
  // `what`.
  Value check(const Value& given, const Registry& registry, const std::string& what = "") const;

  // Every option with a single value, nested ones with their path, those of the plugins that
  // `given` chooses included. Entries of lists are left out. InputError where a plugin is not
  // known.
  std::vector<SettableOption> settable(const Value& given, const Registry& registry) const;

  // A plugin's name alone, where the mission has entries of its own beside the plugin's, becomes a
  // table with that name, so that it takes nothing else away: "tour=greedy" is
  // "tour.solver=greedy".
  Value spelled_out(Value layer) const;
  std::string spelled_out(const std::string& override_text) const;

 private:
  struct Option {
    std::string name;
    Value declaration;           // an entry of a parameter table as data
    std::string plugin_kind;     // not empty: a plugin's name or table
    Value settled;               // of a plugin: parameters that cannot be set, and why
    std::string under = "type";  // of a plugin: the key that names it
    Value own;                   // of a plugin: entries of the mission's own; null or a list
    Value functions;             // of plugins: entries of functions alone; null or a list
    std::string replaced_by;     // another option, or ""
    std::string refused;         // of a choice: why it has no others, or ""
    std::string also;            // a short form, for annotations
    bool vehicle = false;
    bool plugins = false;  // a list of them
    std::vector<std::string> words;
  };
  // Each gives the entry of a parameter table that fits `given`.
  static Value plugin_entry(const Option& option, Value& given, const Registry& registry);
  static Value plain_entry(const Option& option, const Value* value);
  static Value checked_plugins(const Option& option, const Value* given, const Registry& registry,
                               Diagnostics& errors);
  // Without lists of plugins, whose entries differ.
  ParameterTable table_for(Value& given, const Registry& registry) const;
  // Adds an error where a value is given that nothing of this kind can take.
  void refuse(Value& given, const std::string& what, Diagnostics& errors) const;
  std::vector<Option> options_;
  std::vector<std::pair<std::string, std::string>> refused_;  // names that nobody may set, and why
};

// What lapwing.options returns to a script.
struct MissionOptions {
  OptionDeclarations declarations;
  Value given;
};

}  // namespace lapwing
