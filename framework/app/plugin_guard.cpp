#include "framework/app/plugin_guard.h"

#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <map>
#include <string>
#include <thread>

#include "framework/core/active_call.h"
#include "framework/core/error.h"

namespace lapwing {

namespace {

constexpr int kDefect = 3;  // exit status

// Of what a signal handler may call.
void write_text(const char* text) {
  const ssize_t ignored = ::write(STDERR_FILENO, text, std::strlen(text));
  static_cast<void>(ignored);
}

void on_crash(int signal) {
  const ActiveCallName call = active_call();
  if (!call.name) {  // not in a plugin: as if there were no handler
    std::signal(signal, SIG_DFL);
    std::raise(signal);
    return;
  }
  write_text("lapwing: plugin '");
  write_text(call.name);
  write_text("' crashed in ");
  write_text(call.call);
  write_text(signal == SIGSEGV   ? " (segmentation fault)"
             : signal == SIGABRT ? " (aborted)"
             : signal == SIGFPE  ? " (arithmetic)"
                                 : "");
  write_text("; try it alone: lapwing plugins check NAME\n");
  ::_exit(kDefect);
}

void handle_crashes() {
  constexpr std::size_t kStack = 64 * 1024;  // of its own: the other may be what overflowed
  stack_t stack{};
  stack.ss_sp = std::malloc(kStack);
  stack.ss_size = kStack;
  const bool own_stack = stack.ss_sp && ::sigaltstack(&stack, nullptr) == 0;
  struct sigaction action {};
  action.sa_handler = on_crash;
  action.sa_flags = (own_stack ? SA_ONSTACK : 0) | SA_NODEFER;
  for (const int signal : {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT})
    ::sigaction(signal, &action, nullptr);
}

[[noreturn]] void watch_calls(double seconds) {
  using Clock = std::chrono::steady_clock;
  const auto pause = std::chrono::duration<double>(std::clamp(seconds / 4, 0.05, 5.0));
  std::map<std::uint64_t, Clock::time_point> seen;  // by the number of a call, since when
  for (;;) {
    std::this_thread::sleep_for(pause);
    std::map<std::uint64_t, Clock::time_point> still;
    for (const RunningCall& call : running_brief_calls()) {
      const auto before = seen.find(call.serial);
      const auto since = before == seen.end() ? Clock::now() : before->second;
      still[call.serial] = since;
      if (std::chrono::duration<double>(Clock::now() - since).count() < seconds) continue;
      const std::string text = "lapwing: plugin '" + call.name + "' does not return from " +
                               call.call + "; try it alone: lapwing plugins check NAME\n";
      write_text(text.c_str());
      ::_exit(kDefect);
    }
    seen = std::move(still);
  }
}

}  // namespace

void guard_plugin_calls(double seconds) {
  handle_crashes();
  std::thread(watch_calls, seconds).detach();
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
