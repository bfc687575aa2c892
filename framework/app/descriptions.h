// SPDX-License-Identifier: Apache-2.0
// lapwing annotations, schema, plugins show --markdown: what the program says of itself, for
// editors and for READMEs.
#pragma once

#include <filesystem>
#include <string>

#include "framework/app/command_line.h"

namespace lapwing {

struct Description {
  std::filesystem::path target;  // empty: standard output
  std::string kind;              // of a schema; empty: all missions
  bool markdown = false;
};

ExitStatus write_annotations(const Description& asked, const Invocation& invocation);
ExitStatus write_schema(const Description& asked, const Invocation& invocation);

// "| parameter | default | |", a row for each; "No parameters." without any.
std::string parameters_as_markdown(const PluginEntry& entry);

}  // namespace lapwing
