// SPDX-License-Identifier: Apache-2.0
// A command of this program in a process of its own.
#pragma once

#include <string>
#include <vector>

#include "framework/core/progress.h"

namespace lapwing {

struct ChildAnswer {
  int status = 0;      // exit status
  std::string output;  // standard output
};

// Runs this program with `words`; its standard error is this one's. It ends when this process does,
// and is asked to (SIGTERM) once the token is cancelled. Error where there can be no process or it
// ends by a signal; Cancelled once it has ended after the token was cancelled.
ChildAnswer run_child(const std::vector<std::string>& words, const CancellationToken& token);

}  // namespace lapwing
