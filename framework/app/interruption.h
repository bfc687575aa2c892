// SPDX-License-Identifier: Apache-2.0
// Ctrl-C: the first asks the work to end with the best so far, the second ends the program, unless
// the work wants to be told of each.
#pragma once

#include "framework/core/progress.h"

namespace lapwing {

// While alive, SIGINT and SIGTERM cancel the token; a second one ends the process at once with exit
// status 130. One at a time.
class Interruption {
 public:
  Interruption();
  ~Interruption();
  Interruption(const Interruption&) = delete;
  Interruption& operator=(const Interruption&) = delete;

  const CancellationToken& token() const;
  // From now on, while this lives, no signal ends the process: whoever works counts them.
  void only_count() const;
  int count() const;
};

}  // namespace lapwing
