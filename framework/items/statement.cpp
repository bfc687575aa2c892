// SPDX-License-Identifier: Apache-2.0
#include "framework/items/statement.h"

#include "framework/core/checksum.h"
#include "framework/core/error.h"
#include "framework/core/files.h"
#include "framework/core/json.h"
#include "framework/core/portable.h"

namespace lapwing {

namespace {

constexpr const char* kProgram = "program";
constexpr const char* kInputs = "inputs";

std::string text_of_entry(const Value* value) {
  return !value ? "not stated" : value->is_text() ? value->as_text() : to_json(*value, -1);
}

}  // namespace

std::string statement_difference(const Value& there, const Value& here) {
  if (!there.is_map()) return "it is not a statement";
  const Value *their_machine = there.find(kMachineEntry), *own_machine = here.find(kMachineEntry);
  if (own_machine && !(their_machine && *their_machine == *own_machine))
    return "it is of another machine (" + text_of_entry(their_machine) + "; this one is " +
           text_of_entry(own_machine) +
           "), whose results differ in their last digits; use --portable on all machines";
  std::string names;
  for (const Value* one : {&here, &there})
    for (const auto& [name, ignored] : one->as_map()) {
      const Value *a = there.find(name), *b = here.find(name);
      if (a && b && *a == *b) continue;
      if (one == &here || !b) names += (names.empty() ? "" : ", ") + name;
    }
  return names.empty() ? "" : "it has other inputs: " + names;
}

Value made_by(const std::string& program, const Value& statement) {
  Value mark = Value::map();
  mark.set(kProgram, program);
  mark.set(kMachineEntry, machine_of_numbers());
  mark.set(kInputs, sha256(to_json(statement, -1)).substr(0, 16));
  return mark;
}

void require_made_by(const std::filesystem::path& file, const Value& item, const Value& mark) {
  const Value* there = item.is_map() ? item.find(kMadeByEntry) : nullptr;
  const auto refuse = [&](const std::string& why) {
    throw InputError("'" + file.string() + "' " + why + "; delete it, or choose another folder");
  };
  if (!there || !there->is_map()) refuse("does not state what it was made from");
  for (const char* name : {kProgram, kMachineEntry, kInputs}) {
    const Value *theirs = there->find(name), &own = mark.at(name);
    if (theirs && *theirs == own) continue;
    if (name == kInputs) refuse("was made from other inputs");
    if (name == kProgram)
      refuse("was made by " + text_of_entry(theirs) + ", and this is " + own.as_text());
    refuse("was made on another machine (" + text_of_entry(theirs) + "; this one is " +
           own.as_text() +
           "), whose results differ in their last digits; use --portable on all machines");
  }
}

bool has_item(const std::filesystem::path& file, const Value& mark) {
  std::error_code code;
  if (!std::filesystem::exists(file, code)) return false;
  Value item;
  try {
    item = from_json(read_file(file), file.string());
  } catch (const InputError& error) {
    throw InputError(std::string(error.what()) + "; delete it");
  }
  require_made_by(file, item, mark);
  return true;
}

void open_statement(const std::filesystem::path& file, const Value& statement,
                    const ItemOptions& options, const std::string& what) {
  const std::string folder = "'" + file.parent_path().string() + "'";
  std::error_code code;
  if (!std::filesystem::exists(file, code)) {
    if (options.gather || options.schedule)
      throw InputError(options.name() + ": there is no " + what + " in " + folder);
    if (create_file_atomically(file, to_json(statement) + "\n")) return;
    // Another shard was faster.
  }
  if (!options.continues())
    throw InputError(folder + " contains a " + what +
                     ": continue it with --resume, or choose another folder with --out");
  const Value there = from_json(read_file(file), file.string());
  if (const std::string difference = statement_difference(there, statement); !difference.empty())
    throw InputError("'" + file.string() + "' states another " + what + ": " + difference + "; " +
                     options.name() + " continues the same one only");
}

}  // namespace lapwing
