// SPDX-License-Identifier: Apache-2.0
// lapwing reproduce: a table or figure of the thesis, made again by one command.
#pragma once

#include <string>

#include "framework/app/command_line.h"

namespace lapwing {

struct ReproduceRequest {
  std::string table;   // "4.3", "list"
  bool quick = false;  // what `quick` of its file says: within five minutes
  bool resume = false;
};

// Runs the studies that configs/reproduce/TABLE.yaml states, each by its command in a process of
// its own, and writes table.txt, table.csv and report.html into OUT/TABLE. Every study has a folder
// there, or with `from` in that of the other table; its answer is a file beside it. All of it is of
// one version of the program and its plugins, of the studies, and of the scripts, configurations
// and data that they read, which reproduction.json states.
//
// InputError for an unknown table, for data that are not there (all named before anything runs),
// for a folder of an earlier reproduction without `resume`, and for one of another version.
ExitStatus reproduce_table(const ReproduceRequest& asked, const Invocation& invocation);

// Prints what there is.
ExitStatus list_reproductions(const Invocation& invocation);

}  // namespace lapwing
