#include "framework/app/plugin_guard.h"

#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <cstring>
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

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point then) {
  return std::chrono::duration<double>(Clock::now() - then).count();
}

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
  const auto pause = std::chrono::duration<double>(std::clamp(seconds / 4, 0.05, 5.0));
  std::map<std::uint64_t, Clock::time_point> seen;  // by the number of a call, since when
  std::uint64_t activity = activity_of_calls();
  Clock::time_point active = Clock::now();
  for (;;) {
    std::this_thread::sleep_for(pause);
    const std::uint64_t now = activity_of_calls();
    if (now != activity) active = Clock::now();
    activity = now;
    std::map<std::uint64_t, Clock::time_point> still;
    for (const RunningCall& call : running_calls()) {
      if (call.length == CallLength::lengthy) {
        if (seconds_since(active) >= kPatience * seconds)
          end_for(call, ": it neither evaluates nor asks whether it was cancelled");
        continue;
      }
      const auto before = seen.find(call.serial);
      const auto since = before == seen.end() ? Clock::now() : before->second;
      still[call.serial] = since;
      if (seconds_since(since) >= seconds) end_for(call, "");
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
