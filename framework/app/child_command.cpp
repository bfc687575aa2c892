// SPDX-License-Identifier: Apache-2.0
#include "framework/app/child_command.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstring>

#include "framework/app/command_line.h"
#include "framework/core/error.h"

namespace lapwing {
namespace {

constexpr int kGlanceMilliseconds = 50;  // between looks at the token

[[noreturn]] void become(const std::vector<std::string>& words, int output, pid_t parent) {
  std::vector<char*> arguments;
  for (const std::string& word : words) arguments.push_back(const_cast<char*>(word.c_str()));
  arguments.push_back(nullptr);
  // Ctrl-C at a terminal reaches the parent alone, which asks this process once.
  ::setpgid(0, 0);
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (::getppid() != parent || ::dup2(output, STDOUT_FILENO) < 0)
    ::_exit(static_cast<int>(ExitStatus::interrupted));
  ::execv("/proc/self/exe", arguments.data());
  ::_exit(static_cast<int>(ExitStatus::defect));
}

}  // namespace

ChildAnswer run_child(const std::vector<std::string>& words, const CancellationToken& token) {
  int ends[2];
  if (::pipe2(ends, O_CLOEXEC) != 0) throw Error(std::string("no pipe: ") + std::strerror(errno));
  const pid_t parent = ::getpid(), child = ::fork();
  if (child == 0) become(words, ends[1], parent);
  ::close(ends[1]);
  if (child < 0) {
    ::close(ends[0]);
    throw Error(std::string("no process for a study: ") + std::strerror(errno));
  }
  ChildAnswer answer;
  bool asked = false;
  for (char buffer[1 << 14];;) {
    if (token.cancelled() && !asked) {
      asked = true;
      ::kill(child, SIGTERM);
    }
    pollfd waiting{ends[0], POLLIN, 0};
    if (::poll(&waiting, 1, kGlanceMilliseconds) <= 0) continue;
    const ssize_t count = ::read(ends[0], buffer, sizeof buffer);
    if (count > 0) answer.output.append(buffer, static_cast<std::size_t>(count));
    if (count == 0 || (count < 0 && errno != EINTR)) break;
  }
  ::close(ends[0]);
  int status = 0;
  while (::waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  if (token.cancelled()) throw Cancelled();
  if (!WIFEXITED(status))
    throw Error("'" + words.at(1) + "' was ended by signal " + std::to_string(WTERMSIG(status)));
  answer.status = WEXITSTATUS(status);
  return answer;
}

}  // namespace lapwing
