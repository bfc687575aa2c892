// SPDX-License-Identifier: Apache-2.0
// Names that a shell completes and that only the installed files and plugins tell.
#pragma once

#include <string>
#include <vector>

#include "framework/app/command_line.h"

namespace lapwing {

// What is typed at one place of the command line.
struct NamedValue {
  const char* command;  // "lapwing plugins show"; "": every command that has the option
  const char* option;   // "--config", or the name of a positional
  const char* names;    // one of name_lists()
  bool files;           // files may stand there too
};

const std::vector<NamedValue>& named_values();
// "config", "vehicle", "plugin", ...
std::vector<std::string> name_lists();

// The names of a list, sorted. Left out are names with characters that a shell would read as more
// than a name. InputError for an unknown list.
std::vector<std::string> names_in_list(const std::string& list, const Invocation& invocation);

// "'chruch' is not a scene of scripts/scene (did you mean 'church'? There are arcade, ...)"
std::string no_scene(const std::string& name);

// The list of what --set takes: it depends on the mission, and on what is typed already.
inline constexpr const char* kSettings = "setting";

// For the beginning `typed` of KEY=VALUE: keys of the mission's options, "weights.yaw="; behind a
// '=' the values that the option may have. InputError where the mission cannot be read.
std::vector<std::string> settings_of(const std::string& script, const std::string& typed,
                                     const Invocation& invocation);

// Prints them, one a line.
ExitStatus print_names(const std::string& list, const Invocation& invocation);
ExitStatus print_settings(const std::string& script, const std::string& typed,
                          const Invocation& invocation);

}  // namespace lapwing
