// SPDX-License-Identifier: Apache-2.0
// lapwing new: files to begin from, made of the templates in scripts/templates.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "framework/app/command_line.h"

namespace lapwing {

struct NewFiles {
  std::string kind;              // of plugin or mission
  std::string name;              // of the plugin; of a mission, the file
  std::filesystem::path folder;  // where a plugin's folder is made; "": here
};

// A folder NAME with source, CMake list and README: builds against an installed Lapwing, and in the
// folder of its kind in this tree. InputError for an unknown kind, a name that is taken or no name.
ExitStatus new_plugin(const NewFiles& wanted, const Invocation& invocation);
// The kinds of missions that there are templates for, in order; none where the shipped files are
// not found.
std::vector<std::string> mission_kinds();
// One script. InputError for an unknown kind or a file that exists.
ExitStatus new_mission(const NewFiles& wanted, const Invocation& invocation);

}  // namespace lapwing
