// Commands about the program itself, and what is said of a line that is no command.
#pragma once

#include <string>
#include <vector>

#include "framework/app/command_options.h"

namespace lapwing {

struct HelpRequest {
  std::vector<std::string> words;  // of `help`: the command
  std::string shell;               // of `completion`
};

// version, help, completion, man. `app` is the whole program's.
void add_help_commands(CLI::App& app, HelpRequest& asked, Command& command);
// --color
void add_colour(CLI::App& app);

// Why the words of a command line cannot be parsed: the unknown command or option with the nearest
// known one, else `reason`; then what to type for help.
std::string usage_error(const CLI::App& app, const std::string& reason);

}  // namespace lapwing
