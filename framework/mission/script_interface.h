// SPDX-License-Identifier: Apache-2.0
// All that a script may call and a user may set, as data: what the bindings and the mission kinds
// say of themselves. Annotations for editors, the schema of configurations and tables in READMEs
// are written from it.
#pragma once

#include <string>
#include <vector>

#include "framework/mission/binding.h"
#include "framework/mission/run.h"

namespace lapwing {

// A function of a mission kind that makes a mission: film.shot.
struct MissionFunction {
  std::string kind;    // of mission, and its module below scripts/mission
  std::string name;    // of the function
  Value declarations;  // of its options, as lapwing.options takes them
};

// A function that a kind's module describes in a table of its own: film.shots.orbit.
struct DescribedFunction {
  std::string owner;  // "film.shots"
  std::string name, summary;
  std::string gives;   // a type as LuaLS writes it
  Value declarations;  // of its arguments, as lapwing.arguments takes them
};

struct ScriptInterface {
  std::vector<BoundType> types;
  std::vector<MissionFunction> missions;     // by kind, then by name
  std::vector<DescribedFunction> described;  // by owner, then in the module's order
};

// Opens a sandbox, binds everything, and asks every kind in `settings.scripts` what it declares.
// InputError where a kind's own script does not load.
ScriptInterface read_script_interface(const MissionSettings& settings);

// As a file for LuaLS (`---@meta`): every binding, and a class for the options of every mission and
// the parameters of every plugin.
std::string annotations_of(const ScriptInterface& interface, const Registry& registry);

// The rows of the README's tables: "| call | gives |" of all functions, or of one type.
std::string call_table_of(const ScriptInterface& interface);

// "| argument | default | |" of the functions that `owner` describes.
std::string argument_table_of(const ScriptInterface& interface, const std::string& owner);

// "| option | default | |" of every option of the missions of a kind, those within tables by dotted
// names; with a column "of" where the kind's functions have different options.
std::string option_table_of(const ScriptInterface& interface, const std::string& kind);

// A JSON schema for configurations: of missions of one kind, of all ("" for `kind`), or of vehicle
// files ("vehicle"). InputError naming the kinds there are.
Value config_schema(const ScriptInterface& interface, const Registry& registry,
                    const std::string& kind);

}  // namespace lapwing
