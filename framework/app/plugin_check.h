// SPDX-License-Identifier: Apache-2.0
// lapwing plugins check: what every plugin of a kind must pass, each test in a process of its own.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "framework/app/command_line.h"

namespace lapwing {

struct PluginCheck {
  std::string target;             // a library's file, NAME or KIND/NAME
  std::vector<std::string> only;  // tests; none: all
  double limit = 60;              // s that one test may take
};

// Exit status 0 where every test of every plugin named passes, 1 where one does not.
ExitStatus check_plugins(const PluginCheck& asked, const Invocation& invocation);

// Number of heap allocations of the calling thread so far, where the program counts them: set
// before the command line runs.
void count_allocations_by(std::function<std::int64_t()> count);

}  // namespace lapwing
