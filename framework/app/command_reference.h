// SPDX-License-Identifier: Apache-2.0
// What the command line understands, as data: help, completion and the manual are made of it.
#pragma once

#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace lapwing {

struct OptionEntry {
  std::vector<std::string> names;  // "-o", "--out"; of a positional its one name
  std::string value;               // "DIR", "auto|always|never"; empty: a flag
  std::string help;
  std::string names_list;  // of app/completion_names.h; empty: none
  bool or_files = false;   // beside these names
  bool positional = false;
  bool required = false;
  bool repeatable = false;
};

struct CommandEntry {
  std::string path;     // "lapwing map info"
  std::string name;     // "info"
  std::string summary;  // one line
  std::string footer;   // examples and exit statuses, as the help prints them
  std::vector<OptionEntry> options;
  std::vector<CommandEntry> commands;
};

// All that the program declares, commands in their order. Options that every command takes are
// those of the first entry.
CommandEntry command_tree();  // defined beside the parsing (command_line.cpp)
CommandEntry entry_of(const CLI::App& app, const std::string& path);
// The commands below, without those of no group, which are not for people.
std::vector<const CLI::App*> shown_commands(const CLI::App& app);

// Every command of the tree, the tree itself first.
std::vector<const CommandEntry*> every_command(const CommandEntry& tree);

// What to offer where a value is typed.
enum class ValueKind { none, files, folders, words };
ValueKind kind_of_value(const std::string& value);
// "auto|always|never": its three words.
std::vector<std::string> words_of_value(const std::string& value);

// Gives every command the examples and exit statuses of command_examples.cpp.
void add_footers(CLI::App& app);

// A script for "bash", "zsh" or "fish".
std::string completion_script(const CommandEntry& tree, const std::string& shell);
// The manual page in roff's man macros. `version`: "0.1.0".
std::string manual_page(const CommandEntry& tree, const std::string& version);

}  // namespace lapwing
