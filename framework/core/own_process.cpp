// SPDX-License-Identifier: Apache-2.0
#include "framework/core/own_process.h"

#include <poll.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <new>
#include <string_view>

#include "framework/core/error.h"

namespace lapwing {
namespace {

constexpr char kResult = 'r', kInputError = 'i', kOtherError = 'o';

double now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

// Bytes of address space that this process has.
double address_space() {
  double pages = 0;
  std::ifstream("/proc/self/statm") >> pages;
  return pages * static_cast<double>(::sysconf(_SC_PAGESIZE));
}

void limit_memory(double bytes) {
  const auto most = static_cast<rlim_t>(address_space() + bytes);
  rlimit limit{};
  if (::getrlimit(RLIMIT_AS, &limit) == 0 && most < limit.rlim_cur) {
    limit.rlim_cur = most;
    ::setrlimit(RLIMIT_AS, &limit);
  }
  // A crash is expected here and leaves no core file.
  limit = {};
  ::setrlimit(RLIMIT_CORE, &limit);
}

bool write_all(int pipe, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(pipe, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) return false;
    bytes.remove_prefix(static_cast<std::size_t>(written));
  }
  return true;
}

// Never returns: the copy must not run what the original does when it ends.
[[noreturn]] void run_copy(int pipe, const ProcessLimits& limits,
                           const std::function<std::string()>& work) {
  for (const int signal : {SIGSEGV, SIGABRT, SIGBUS, SIGFPE, SIGILL, SIGPIPE}) {
    std::signal(signal, SIG_DFL);
  }
  limit_memory(limits.memory);
  std::string answer;
  try {
    answer = kResult + work();
  } catch (const InputError& error) {
    answer = kInputError + std::string(error.what());
  } catch (const std::bad_alloc&) {
    answer = kOtherError + std::string("it takes too much memory");
  } catch (const std::exception& error) {
    answer = kOtherError + std::string(error.what());
  }
  ::_exit(write_all(pipe, answer) ? 0 : 1);
}

class Pipe {
 public:
  Pipe() {
    if (::pipe(ends_) != 0) throw Error(std::string("no pipe: ") + std::strerror(errno));
  }
  ~Pipe() {
    close(0);
    close(1);
  }
  Pipe(const Pipe&) = delete;
  Pipe& operator=(const Pipe&) = delete;
  int end(int which) const { return ends_[which]; }
  void close(int which) {
    if (ends_[which] >= 0) ::close(ends_[which]);
    ends_[which] = -1;
  }

 private:
  int ends_[2] = {-1, -1};
};

// Whether the copy closed its end before the deadline; fills `answer`.
bool read_until(int pipe, double deadline, std::string& answer) {
  char buffer[1 << 16];
  for (;;) {
    const double left = deadline - now();
    if (left <= 0) return false;
    pollfd waiting{pipe, POLLIN, 0};
    const int ready = ::poll(&waiting, 1, static_cast<int>(left * 1000) + 1);
    if (ready < 0 && errno != EINTR) return false;
    if (ready <= 0) continue;
    const ssize_t count = ::read(pipe, buffer, sizeof buffer);
    if (count == 0) return true;
    if (count > 0) answer.append(buffer, static_cast<std::size_t>(count));
    if (count < 0 && errno != EINTR) return false;
  }
}

}  // namespace

ProcessResult run_in_own_process(const ProcessLimits& limits,
                                 const std::function<std::string()>& work) {
  Pipe pipe;
  const pid_t copy = ::fork();
  if (copy < 0) throw Error(std::string("no separate process: ") + std::strerror(errno));
  if (copy == 0) {
    pipe.close(0);
    run_copy(pipe.end(1), limits, work);
  }
  pipe.close(1);
  std::string answer;
  const bool whole = read_until(pipe.end(0), now() + limits.seconds, answer);
  if (!whole) ::kill(copy, SIGKILL);
  int status = 0;
  while (::waitpid(copy, &status, 0) < 0 && errno == EINTR) {
  }
  if (!whole) {
    char text[32];
    std::snprintf(text, sizeof text, "%g", limits.seconds);
    return {ProcessEnd::overtime, std::string("it takes longer than ") + text + " s"};
  }
  if (WIFSIGNALED(status)) return {ProcessEnd::crashed, ::strsignal(WTERMSIG(status))};
  if (answer.empty()) return {ProcessEnd::crashed, "it ended without an answer"};
  const ProcessEnd end = answer[0] == kResult       ? ProcessEnd::answered
                         : answer[0] == kInputError ? ProcessEnd::refused
                                                    : ProcessEnd::failed;
  return {end, answer.substr(1)};
}

std::string in_own_process(const std::string& what, const ProcessLimits& limits,
                           const std::function<std::string()>& work) {
  const ProcessResult result = run_in_own_process(limits, work);
  switch (result.end) {
    case ProcessEnd::answered:
      return result.text;
    case ProcessEnd::refused:
      throw InputError(result.text);
    case ProcessEnd::crashed:
      throw InputError(what + ": reading it crashed (" + result.text + ")");
    default:
      throw InputError(what + ": " + result.text);
  }
}

}  // namespace lapwing
