// SPDX-License-Identifier: Apache-2.0
// Standard output: whether what was written to it arrived.
#include <poll.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <iostream>

#include "framework/app/command_line.h"

namespace lapwing {

int finish_output(int status) {
  errno = 0;
  std::cout.flush();
  bool lost = std::fflush(stdout) != 0;
  int reason = lost ? errno : 0;
  lost = lost || std::ferror(stdout) || !std::cout;
  // Some file systems tell of a full disk only when a file is closed; a copy is, since others may
  // still print. Where it was closed from the start, nothing was lost if nothing was printed.
  const int copy = ::dup(STDOUT_FILENO);
  if (copy >= 0 && ::close(copy) != 0 && errno != EBADF) {
    lost = true;
    reason = errno;
  }
  if (!lost) return status;
  // The first failure was met by whoever printed, who kept no reason; a closed pipe still shows.
  pollfd state{STDOUT_FILENO, POLLOUT, 0};
  if (reason == 0 && ::poll(&state, 1, 0) > 0 && (state.revents & POLLERR) != 0) reason = EPIPE;
  // Whoever read has seen enough, as `head` has: no fault to tell of. The status says all the same
  // that not all arrived, and says it as shells do of other tools that a closed pipe ends.
  if (reason == EPIPE) return status != 0 ? status : static_cast<int>(ExitStatus::reader_gone);
  std::fprintf(stderr, "lapwing: cannot write to standard output%s%s\n", reason ? ": " : "",
               reason ? std::strerror(reason) : "; is the disk full?");
  return static_cast<int>(ExitStatus::defect);
}

}  // namespace lapwing
