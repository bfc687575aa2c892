// SPDX-License-Identifier: Apache-2.0
// Commands that are lists of items (framework/items): their options, and their processes.
#pragma once

#include <functional>

#include "framework/app/command_line.h"
#include "framework/core/file_set.h"
#include "framework/items/item_run.h"

namespace CLI {
class App;
}  // namespace CLI

namespace lapwing {

// --resume, --shard, --gather, --schedule, --executor, --portable. `resume_help` says what
// --resume keeps.
void add_items(CLI::App& command, ItemOptions& options, const std::string& resume_help);

// The number of this process among those that mpirun started, and how many there are; 0 and 1 where
// it started none.
int launched_rank();
int launched_processes();

// Runs a command: chooses the executor, calls `body`, and sees to it that no process waits for one
// that failed. Process 0 throws what is to be said; other processes return without a word.
ExitStatus run_items(const ItemOptions& options, const Invocation& invocation,
                     const Registry& registry,
                     const std::function<ExitStatus(ItemRun&, const CancellationToken&)>& body);

// Prints what a run came to whose results are not to be read (ItemRun::make returned false).
ExitStatus print_answer(const ItemRun& run, const Invocation& invocation);

// How the folder of the items is claimed: shards share it.
ClaimKind claim_for(const ItemOptions& options);

}  // namespace lapwing
