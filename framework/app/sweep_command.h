// SPDX-License-Identifier: Apache-2.0
// lapwing sweep: one mission with several values of its options, several runs at once, one table.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "framework/app/item_command.h"

namespace lapwing {

struct Sweep {
  std::filesystem::path script;
  std::vector<std::string> varied;  // "key=value,value,..."; all combinations are run
  int jobs = 0;                     // runs at once in one process; 0: 2, one with mpi
  ItemOptions items;                // an item is a run
};

// Each run is `lapwing run` in a process of its own, into a folder of its own below --out. Exit
// status 0 where every one is certified, 1 where one is not, 2 where one's input is bad.
ExitStatus sweep_missions(const Sweep& asked, const Invocation& invocation);

}  // namespace lapwing
