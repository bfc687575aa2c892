// SPDX-License-Identifier: Apache-2.0
// Commands about the program itself, and what is said of a line that is no command.
#pragma once

#include <string>
#include <vector>

#include "framework/app/command_options.h"

namespace CLI {
class ParseError;
}

namespace lapwing {

struct HelpRequest {
  std::vector<std::string> words;  // of `help`: the command
  std::string shell;               // of `completion`
  std::string names;               // of `complete`: the list
  std::string script, typed;       // of its list of settings: the mission, what stands there
};

// version, help, completion, man, and complete, which no help shows. `app` is the whole program's.
void add_help_commands(CLI::App& app, const Invocation& invocation, HelpRequest& asked,
                       Command& command);
// --color
void add_colour(CLI::App& app);

// Why the words of a command line cannot be parsed: the unknown command or option with the nearest
// known one, what is missing, or what `error` says; then what to type for help.
std::string usage_error(const CLI::App& app, const CLI::ParseError& error);

// Whether help was asked for behind a word that is no command: "lapwing map inof --help".
bool help_of_unknown(const CLI::App& app);

}  // namespace lapwing
