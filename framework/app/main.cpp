// SPDX-License-Identifier: Apache-2.0
#include <fcntl.h>

#include <csignal>

#include "framework/app/allocation_counter.h"
#include "framework/app/command_line.h"
#include "framework/app/plugin_check.h"

namespace {

// A closed descriptor would be the next file's: what is printed would go into it. In its place
// comes one that cannot be written to, or read from.
void open_standard_streams() {
  for (const int descriptor : {0, 1, 2})
    if (::fcntl(descriptor, F_GETFD) < 0)
      ::open("/dev/null", descriptor == 0 ? O_WRONLY : O_RDONLY);
}

}  // namespace

int main(int argc, char** argv) {
  open_standard_streams();
  // Who closes a pipe is told of by the status, and what is being written to files is not ended.
  std::signal(SIGPIPE, SIG_IGN);
  // So that `plugins check` can say which calls allocate.
  lapwing::count_allocations_by(lapwing::allocation_counter());
  return lapwing::finish_output(lapwing::run_command_line(argc, argv));
}
