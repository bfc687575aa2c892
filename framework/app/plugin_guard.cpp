// SPDX-License-Identifier: Apache-2.0
#include "framework/app/plugin_guard.h"

#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <map>
#include <mutex>
#include <string>
#include <thread>

#include "framework/core/active_call.h"
#include "framework/core/error.h"
#include "framework/plugin/library.h"

namespace lapwing {

namespace {

constexpr int kDefect = 3;  // exit status

// Of what a signal handler may call.
void write_text(const char* text) {
  const ssize_t ignored = ::write(STDERR_FILENO, text, std::strlen(text));
  static_cast<void>(ignored);
}

// " crashed in evaluate", and what to do, of whose code the thread is in; false: of nobody's.
bool write_whose(const char* what, const char* detail) {
  const ActiveCallName call = active_call();
  const char* const name = call.name ? call.name : library_in_stack();
  if (!name) return false;
  write_text("lapwing: plugin '");
  write_text(name);
  write_text("' ");
  write_text(what);
  if (call.name) {
    write_text(" in ");
    write_text(call.call);
  }
  write_text(detail);
  write_text("; try it alone: lapwing plugins check ");
  write_text(name);
  write_text("\n");
  return true;
}

void on_crash(int signal) {
  const bool known = write_whose("crashed", signal == SIGSEGV   ? " (segmentation fault)"
                                            : signal == SIGBUS  ? " (bus error)"
                                            : signal == SIGABRT ? " (aborted)"
                                            : signal == SIGFPE  ? " (arithmetic)"
                                                                : "");
  if (known) ::_exit(kDefect);
  std::signal(signal, SIG_DFL);  // not in a plugin: as if there were no handler
  std::raise(signal);
}

// A plugin that ends the program would make a run look finished.
void on_exit() {
  if (write_whose("ended the program", "")) ::_exit(kDefect);
}

void handle_crashes() {
  // A stack of its own: the other may be what overflowed.
  alignas(16) static std::byte own[64 * 1024];
  stack_t stack{};
  stack.ss_sp = own;
  stack.ss_size = sizeof own;
  const bool own_stack = ::sigaltstack(&stack, nullptr) == 0;
  struct sigaction action {};
  action.sa_handler = on_crash;
  action.sa_flags = (own_stack ? SA_ONSTACK : 0) | SA_NODEFER;
  for (const int signal : {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT})
    ::sigaction(signal, &action, nullptr);
}

// Seconds that the process could have worked in: where the machine gives it little of its time, or
// stops it, calls take longer through no fault of the plugin's. What the process used of its
// processors counts, at least a third of what passed (a plugin may wait in vain), and of a time in
// which even this thread did not run a few pauses.
class WorkingClock {
 public:
  explicit WorkingClock(double longest_step) : longest_step_(longest_step) {}
  // Since it was made; asked often.
  double seconds() {
    const double wall = wall_seconds(), used = used_seconds();
    const double passed = wall - wall_;
    counted_ += std::min({passed, std::max(used - used_, passed / 3), longest_step_});
    wall_ = wall;
    used_ = used;
    return counted_;
  }

 private:
  static double wall_seconds() {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch())
        .count();
  }
  static double used_seconds() {
    timespec used{};
    ::clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &used);
    return static_cast<double>(used.tv_sec) + 1e-9 * static_cast<double>(used.tv_nsec);
  }

  double longest_step_;  // s
  double wall_ = wall_seconds(), used_ = used_seconds(), counted_ = 0;
};

[[noreturn]] void end_for(const RunningCall& call, const char* silent) {
  const std::string text = "lapwing: plugin '" + call.name + "' does not return from " + call.call +
                           silent + cure_of_plugin(call.name) + "\n";
  write_text(text.c_str());
  ::_exit(kDefect);
}

// A brief call is watched by how long it takes; a lengthy one by how long nothing was evaluated or
// asked by anyone, with more patience: a library's one step may be long.
[[noreturn]] void watch_calls(double seconds) {
  constexpr double kPatience = 5;
  const double pause = std::clamp(seconds / 4, 0.05, 5.0);
  WorkingClock clock(4 * pause);
  std::map<std::uint64_t, double> seen;  // by the number of a call, since when
  std::uint64_t activity = activity_of_calls();
  double active = 0;
  for (;;) {
    std::this_thread::sleep_for(std::chrono::duration<double>(pause));
    const double time = clock.seconds();
    const std::uint64_t now = activity_of_calls();
    if (now != activity) active = time;
    activity = now;
    std::map<std::uint64_t, double> still;
    for (const RunningCall& call : running_calls()) {
      if (call.length == CallLength::lengthy) {
        if (time - active >= kPatience * seconds)
          end_for(call, ": it neither evaluates nor asks whether it was cancelled");
        continue;
      }
      const auto before = seen.find(call.serial);
      const double since = before == seen.end() ? time : before->second;
      still[call.serial] = since;
      if (time - since >= seconds) end_for(call, "");
    }
    seen = std::move(still);
  }
}

}  // namespace

void guard_plugin_calls(double seconds) {
  static std::once_flag once;
  std::call_once(once, [seconds] {
    library_in_stack();
    handle_crashes();
    std::atexit(on_exit);
    std::at_quick_exit(on_exit);
    std::thread(watch_calls, seconds).detach();
  });
}

double call_limit_from_environment() {
  constexpr double kUsual = 60;
  const char* given = std::getenv("LAPWING_CALL_LIMIT");
  if (!given || !*given) return kUsual;
  char* end = nullptr;
  const double seconds = std::strtod(given, &end);
  if (*end != '\0' || !(seconds > 0))
    throw InputError(
        std::string("LAPWING_CALL_LIMIT: expected a number of seconds above 0, got '") + given +
        "'");
  return seconds;
}

}  // namespace lapwing
