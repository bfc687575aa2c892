// SPDX-License-Identifier: Apache-2.0
// executor_pace NAME ITEMS MILLISECONDS THREADS: how long an executor takes for items that compute
// for a known time each. Alone, or as one of the processes that a launcher started. Process 0
// prints the numbers of processes and threads, the time of the whole, and what each item cost the
// processes beside its own time.
#include <ctime>

#include <chrono>
#include <cstdio>
#include <string>

#include "framework/core/error.h"
#include "framework/items/executor.h"
#include "framework/plugin/registry.h"

namespace {

double seconds_of_thread() {
  timespec time{};
  ::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

// Keeps a core busy: of the time of a processor, so that a wait for it counts as the executor's.
void compute(double seconds) {
  const double until = seconds_of_thread() + seconds;
  while (seconds_of_thread() < until) {
  }
}

int measure(const std::string& name, std::size_t count, double seconds, int threads) {
  const lapwing::Registry registry({LAPWING_BUILD_DIR "/lib/plugins"});
  const auto executor = registry.create<lapwing::Executor>(name);
  std::vector<lapwing::Item> items(count);
  std::vector<std::size_t> todo(count);
  for (std::size_t item = 0; item < count; ++item) {
    items[item].file = std::to_string(item);
    todo[item] = item;
  }
  lapwing::ItemQueue queue(items, todo, std::vector<double>(count, seconds));
  std::size_t told = 0;
  const lapwing::ItemWork work{.queue = queue,
                               .threads = threads,
                               .make =
                                   [&](std::size_t) {
                                     compute(seconds);
                                     return lapwing::ItemSeconds{seconds, 0};
                                   },
                               .prepared = [] { return std::vector<std::size_t>{}; },
                               .done = [&](std::size_t, const lapwing::ItemSeconds&) { ++told; }};
  executor->exchange("");  // all begin now
  const auto begun = std::chrono::steady_clock::now();
  executor->run(work);
  const double whole =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count();
  if (executor->rank() > 0) return 0;
  const double makers = static_cast<double>(executor->ranks()) * threads;
  const double each = whole * makers / static_cast<double>(count) - seconds;
  std::printf("%d processes by %d threads: %.3f s, %.3f ms beside each item\n", executor->ranks(),
              threads, whole, 1e3 * each);
  return told == count ? 0 : 1;
}

}  // namespace

int main(int count, char** arguments) {
  if (count != 5) return std::fprintf(stderr, "usage: NAME ITEMS MILLISECONDS THREADS\n"), 2;
  try {
    return measure(arguments[1], std::stoul(arguments[2]), 1e-3 * std::stod(arguments[3]),
                   std::stoi(arguments[4]));
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
