// SPDX-License-Identifier: Apache-2.0
// What every executor must pass, with the processes that the check was started with: one, unless a
// launcher started more.
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <thread>

#include "framework/conformance/every_case.h"
#include "framework/items/executor.h"

namespace lapwing {
namespace {

using std::chrono::steady_clock;

constexpr double kPatience = 5;     // s for threads that must be at work together
constexpr double kDispatch = 2e-3;  // s of an executor's own work for an item
// What an item takes that begins after another one has failed: a busy machine may give the thread
// of the failed one no time for as long.
constexpr std::chrono::milliseconds kAfterFailure{50};

double seconds_since(steady_clock::time_point begun) {
  return std::chrono::duration<double>(steady_clock::now() - begun).count();
}

// Items without files, of several groups, and what an executor did with them in this process.
class Workbench {
 public:
  Workbench(std::size_t count, std::size_t groups) {
    std::vector<std::size_t> all;
    for (std::size_t i = 0; i < count; ++i) {
      items_.push_back({"item_" + std::to_string(i), i % groups, {}});
      seconds_.push_back(1 + static_cast<double>((i * 7919) % 101));
      all.push_back(i);
    }
    queue_.emplace(items_, all, seconds_);
    made.assign(count, 0);
    told.assign(count, 0);
  }

  // `make` is called for each item beside the notes that are taken of it.
  ItemWork work(
      int threads, std::function<void(std::size_t)> make = [](std::size_t) {}) {
    return {.queue = *queue_,
            .threads = threads,
            .make =
                [this, make = std::move(make)](std::size_t item) {
                  begin(item);
                  try {
                    make(item);
                  } catch (...) {
                    --at_once_;
                    throw;
                  }
                  --at_once_;
                  return ItemSeconds{static_cast<double>(item) + 0.25, 0.5};
                },
            .prepared = [] { return std::vector<std::size_t>{}; },
            .done =
                [this](std::size_t item, const ItemSeconds& seconds) {
                  ++told.at(item);
                  times_right &= seconds.item == static_cast<double>(item) + 0.25 &&
                                 seconds.preparation == 0.5;
                }};
  }

  const std::vector<double>& seconds() const { return seconds_; }

  std::vector<int> made, told;     // by item: how often
  std::vector<std::size_t> order;  // of their beginnings
  bool times_right = true;
  int most_at_once = 0;

 private:
  void begin(std::size_t item) {
    const std::lock_guard lock(mutex_);
    ++made.at(item);
    order.push_back(item);
    most_at_once = std::max(most_at_once, ++at_once_);
  }

  std::vector<Item> items_;
  std::vector<double> seconds_;
  std::optional<ItemQueue> queue_;
  std::mutex mutex_;
  std::atomic<int> at_once_{0};
};

bool alone(const Executor& executor) {
  return executor.ranks() == 1;
}

void check_exchange(Executor& executor, Findings& findings) {
  const int rank = executor.rank(), ranks = executor.ranks();
  findings.expect("exchange", ranks >= 1 && rank >= 0 && rank < ranks, [&] {
    return "it is process " + std::to_string(rank) + " of " + std::to_string(ranks);
  });
  findings.expect("exchange", executor.default_threads() >= 0,
                  [] { return "its default number of threads is below 0"; });
  for (const std::size_t size : {0u, 1u, 70'000u}) {
    std::string text(size, static_cast<char>('a' + rank % 20));
    if (size > 1) text[1] = '\0';
    const std::vector<std::string> all = executor.exchange(text);
    findings.expect("exchange", static_cast<int>(all.size()) == ranks, [&] {
      return "it returns " + std::to_string(all.size()) + " texts of " + std::to_string(ranks) +
             " processes";
    });
    findings.expect(
        "exchange",
        static_cast<int>(all.size()) > rank && all[static_cast<std::size_t>(rank)] == text,
        [] { return "the text of this process comes back as another one"; });
  }
}

void check_items(Executor& executor, Findings& findings) {
  for (const std::size_t count : {std::size_t{0}, std::size_t{1}, std::size_t{57}})
    for (const int threads : {1, 3}) {
      Workbench bench(count, 4);
      executor.run(bench.work(threads, [threads](std::size_t) {  // so long that threads overlap
        if (threads > 1) std::this_thread::sleep_for(std::chrono::milliseconds(1));
      }));
      if (!alone(executor)) return;  // the items are distributed
      const std::string of = " (of " + std::to_string(count) + ", " + std::to_string(threads) +
                             (threads == 1 ? " thread)" : " threads)");
      for (std::size_t i = 0; i < count; ++i) {
        findings.expect("items", bench.made[i] == 1, [&] {
          return "item " + std::to_string(i) + " is made " + std::to_string(bench.made[i]) +
                 " times" + of;
        });
        findings.expect("items", bench.told[i] == 1, [&] {
          return "item " + std::to_string(i) + " is reported " + std::to_string(bench.told[i]) +
                 " times" + of;
        });
      }
      findings.expect("items", bench.times_right,
                      [] { return "it reports other times than `make` returned"; });
      findings.expect("threads", bench.most_at_once <= threads, [&] {
        return "it makes " + std::to_string(bench.most_at_once) + " items at once" + of;
      });
      if (threads > 1) continue;
      for (std::size_t i = 1; i < bench.order.size(); ++i)
        findings.expect(
            "order",
            bench.seconds()[bench.order[i - 1]] + 1e-9 >= 0.5 * bench.seconds()[bench.order[i]],
            [] { return "it does not take items in the order of the queue"; });
    }
}

// Three items of which each waits until all have begun.
void check_threads(Executor& executor, Findings& findings) {
  if (!alone(executor)) return;
  constexpr int kThreads = 3;
  std::mutex mutex;
  std::condition_variable changed;
  int begun = 0;
  bool together = true;
  Workbench bench(kThreads, 1);
  executor.run(bench.work(kThreads, [&](std::size_t) {
    std::unique_lock lock(mutex);
    ++begun;
    changed.notify_all();
    together = together && changed.wait_for(lock, std::chrono::duration<double>(kPatience),
                                            [&] { return begun == kThreads; });
  }));
  findings.expect("threads", together,
                  [] { return "with 3 threads it does not make 3 items at the same time"; });
}

void check_failure(Executor& executor, Findings& findings) {
  if (!alone(executor)) return;
  constexpr std::size_t kFails = 5;  // the place in the order of the item that fails
  for (const int threads : {1, 3}) {
    Workbench bench(40, 1);
    std::atomic<std::size_t> begun{0};
    std::string thrown;
    try {
      executor.run(bench.work(threads, [&](std::size_t) {
        const std::size_t place = ++begun;
        if (place == kFails) throw InputError("the disk is full");
        if (place > kFails) std::this_thread::sleep_for(kAfterFailure);
      }));
    } catch (const InputError& error) {
      thrown = error.what();
    }
    findings.expect("failure", thrown == "the disk is full",
                    [] { return "it does not throw the exception of an item"; });
    findings.expect(
        "failure",
        begun <= kFails + 3 * static_cast<std::size_t>(threads) && (threads > 1 || begun == kFails),
        [] { return "it begins items after one has failed"; });
  }
  Workbench again(3, 1);
  executor.run(again.work(1));
  findings.expect("failure", again.made == std::vector<int>(3, 1),
                  [] { return "it cannot be used again after an item has failed"; });
}

void check_cancellation(Executor& executor, Findings& findings) {
  if (!alone(executor)) return;
  Workbench bench(40, 1);
  CancellationToken token;
  std::atomic<int> begun{0};
  ItemWork work = bench.work(1, [&](std::size_t) {
    if (++begun == 4) token.cancel();
  });
  work.cancellation = &token;
  bool thrown = false;
  try {
    executor.run(work);
  } catch (const Cancelled&) {
    thrown = true;
  }
  findings.expect("cancellation", thrown, [] { return "it does not throw Cancelled"; });
  findings.expect("cancellation", begun == 4,
                  [] { return "it begins items after it was cancelled"; });
}

void check_dispatch(Executor& executor, Findings& findings) {
  constexpr std::size_t kCount = 200;
  Workbench bench(kCount, 1);
  const auto begun = steady_clock::now();
  executor.run(bench.work(1));
  const double each = seconds_since(begun) / kCount;
  // A busy machine is no mistake of the plugin.
  if (each <= kDispatch)
    findings.expect("dispatch", true, {});
  else
    findings.warn("dispatch", "it takes " + std::to_string(1e3 * each) +
                                  " ms for an item, beside "
                                  "what the item takes; 2 ms are allowed");
}

}  // namespace

std::vector<CheckResult> check_executor(const Specimen<Executor>& subject,
                                        const CheckOptions& options) {
  return check_every_case(subject, options, "making items",
                          [&](Executor& executor, Findings& findings, bool first) {
                            if (options.wants("exchange")) check_exchange(executor, findings);
                            if (options.wants_any({"items", "order", "threads"}))
                              check_items(executor, findings);
                            if (options.wants("threads")) check_threads(executor, findings);
                            if (!first) return;
                            if (options.wants("failure")) check_failure(executor, findings);
                            if (options.wants("cancellation"))
                              check_cancellation(executor, findings);
                            if (options.wants("dispatch")) check_dispatch(executor, findings);
                          });
}

}  // namespace lapwing
