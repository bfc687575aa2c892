// SPDX-License-Identifier: Apache-2.0
#include "framework/study/study_settings.h"

#include <cctype>

#include "framework/core/json.h"
#include "framework/items/statement.h"

namespace lapwing {

std::string file_text(std::string name) {
  for (char& c : name)
    if (!std::isalnum(static_cast<unsigned char>(c)) && c != '-' && c != '.') c = '_';
  return name;
}

namespace {

// The moves of a world of this evaluation; null where it has none of that name.
const Value* moves_of(const Value& settings, const std::string& world) {
  const Value* files = settings.find("files");
  if (!files || !files->find(world)) return nullptr;
  const Value* own = settings.find("world_moves");
  if (const Value* moves = own ? own->find(world) : nullptr) return moves;
  return settings.find("moves");
}

}  // namespace

std::string settings_text(const Value& settings) {
  std::string text;
  for (const auto& [name, value] : settings.as_map())
    text += (text.empty() ? "" : ", ") + name + " " + to_json(value, -1);
  return text;
}

std::string settings_difference(const Value& there, const Value& here) {
  if (!there.is_map()) return "its settings are not stated";
  for (const Value* one : {&here, &there})
    for (const auto& [key, ignored] : one->as_map()) {
      if (key == "files" || key == "world_moves") continue;
      const Value *a = there.find(key), *b = here.find(key);
      if (key == kMachineEntry && !(a && b && *a == *b)) return statement_difference(there, here);
      if (!a || !b || !(*a == *b))
        return key + " is " + (a ? to_json(*a, -1) : "not said") + " there, " +
               (b ? to_json(*b, -1) : "not said") + " here";
    }
  for (const Value* one : {&here, &there})
    if (const Value* own = one->find("world_moves"))
      for (const auto& [world, ignored] : own->as_map()) {
        const Value *a = moves_of(there, world), *b = moves_of(here, world);
        if (a && b && !(*a == *b))
          return "the moves in " + world + " are " + settings_text(*a) + " there, " +
                 settings_text(*b) + " here";
      }
  const Value* files = there.find("files");
  for (const auto& [name, sum] : here.at("files").as_map())
    if (const Value* before = files ? files->find(name) : nullptr; before && !(*before == sum))
      return "the file of " + name + " is another one";
  return "";
}

}  // namespace lapwing
