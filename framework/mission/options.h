// The options of a mission: what its script declares, and the values that they come to have.
//
// A declaration is an entry of a parameter table as data (core/parameters.h: name, type, summary,
// unit, default, required, minimum, above, maximum, choices, size, table), with three more forms:
//   type = "plugin", kind = "trajectory_solver", default = "iqp"
//       a plugin's name, or a table with `type` and the plugin's own parameters
//       settled = { name = "why" }: parameters that the mission itself settles; who sets one is
//       told why not
//       under = "solver": the key that names the plugin, in place of `type`
//       table = {...}: entries of the mission's own beside the plugin's parameters
//   type = "vehicle"               a vehicle file's name, or a table as in such a file
//   words = {"auto"}               on a number: these texts are allowed as well
#pragma once

#include <string>
#include <vector>

#include "framework/core/parameters.h"
#include "framework/plugin/registry.h"

namespace lapwing {

class OptionDeclarations {
 public:
  // From what a script gave to lapwing.options. InputError naming what is malformed.
  static OptionDeclarations from_value(const Value& list);
  // A script that declares nothing: its own options with their types, as defaults.
  static OptionDeclarations from_options(const Value& options);

  // Checks given values (script and overrides, merged) and fills in every default, those of the
  // plugins chosen included; no code is loaded. InputError with all errors.
  Value check(const Value& given, const Registry& registry) const;

 private:
  struct Option {
    std::string name;
    Value declaration;           // an entry of a parameter table as data
    std::string plugin_kind;     // not empty: a plugin's name or table
    Value settled;               // of a plugin: parameters that cannot be set, and why
    std::string under = "type";  // of a plugin: the key that names it
    Value own;                   // of a plugin: entries of the mission's own; null or a list
    bool vehicle = false;
    std::vector<std::string> words;
  };
  // Each gives the entry of a parameter table that fits `given`.
  static Value plugin_entry(const Option& option, Value& given, const Registry& registry);
  static Value plain_entry(const Option& option, const Value* value);
  ParameterTable table_for(Value& given, const Registry& registry) const;
  std::vector<Option> options_;
};

// What lapwing.options returns to a script.
struct MissionOptions {
  OptionDeclarations declarations;
  Value given;
};

}  // namespace lapwing
