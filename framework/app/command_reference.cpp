// SPDX-License-Identifier: Apache-2.0
#include "framework/app/command_reference.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <sstream>

#include "framework/app/completion_names.h"

namespace lapwing {

namespace {

// Which names are completed where this value is typed.
void find_names(const std::string& command, OptionEntry& entry) {
  if (entry.value.empty()) return;
  for (const NamedValue& value : named_values()) {
    const bool here = *value.command == '\0' || command == value.command;
    if (!here || std::count(entry.names.begin(), entry.names.end(), value.option) == 0) continue;
    entry.names_list = value.names;
    entry.or_files = value.files;
    return;
  }
}

OptionEntry entry_of_option(const CLI::Option& option, const std::string& command) {
  OptionEntry entry;
  entry.positional = option.get_positional();
  if (entry.positional) {
    entry.names = {option.get_name(true)};
  } else {
    for (const std::string& name : option.get_snames()) entry.names.push_back("-" + name);
    for (const std::string& name : option.get_lnames()) entry.names.push_back("--" + name);
  }
  if (option.get_type_size() != 0) entry.value = option.get_type_name();
  entry.help = option.get_description();
  entry.required = option.get_required();
  entry.repeatable =
      option.get_multi_option_policy() == CLI::MultiOptionPolicy::TakeAll && !entry.value.empty();
  find_names(command, entry);
  return entry;
}

}  // namespace

std::vector<const CLI::App*> shown_commands(const CLI::App& app) {
  return app.get_subcommands([](const CLI::App* command) { return !command->get_group().empty(); });
}

CommandEntry entry_of(const CLI::App& app, const std::string& path) {
  CommandEntry entry;
  entry.path = path;
  entry.name = app.get_name();
  entry.summary = app.get_description();
  entry.footer = app.get_footer();
  for (const CLI::Option* option : app.get_options())
    entry.options.push_back(entry_of_option(*option, path));
  for (const CLI::App* command : shown_commands(app))
    entry.commands.push_back(entry_of(*command, path + " " + command->get_name()));
  return entry;
}

std::vector<const CommandEntry*> every_command(const CommandEntry& tree) {
  std::vector<const CommandEntry*> all{&tree};
  for (const CommandEntry& command : tree.commands)
    for (const CommandEntry* below : every_command(command)) all.push_back(below);
  return all;
}

std::vector<std::string> words_of_value(const std::string& value) {
  std::vector<std::string> words;
  std::istringstream rest(value);
  for (std::string word; std::getline(rest, word, '|');) words.push_back(word);
  return words;
}

ValueKind kind_of_value(const std::string& value) {
  if (value.find('|') != value.npos &&
      value.find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789_|") == value.npos)
    return ValueKind::words;
  for (const char* part :
       {"FILE", "PATH", "PAGE", ".json", ".lua", "MAP", "SCENE", "LOG", "PLAN", "MODEL"})
    if (value.find(part) != value.npos) return ValueKind::files;
  return value.find("DIR") != value.npos ? ValueKind::folders : ValueKind::none;
}

}  // namespace lapwing
