// SPDX-License-Identifier: Apache-2.0
// The items of a command in the threads of one process.
#include "framework/items/executor.h"
#include "framework/items/item_threads.h"
#include "framework/plugin/plugin.h"

namespace lapwing {
namespace {

class Threads final : public Executor {
 public:
  static constexpr PluginText kText{"threads", "1.0.0", "the threads of one process", "own"};
  static ParameterTable parameters() { return {}; }
  explicit Threads(const Parameters&) {}

  int rank() const override { return 0; }
  int ranks() const override { return 1; }
  int default_threads() const override { return 0; }
  std::vector<std::string> exchange(const std::string& text) override { return {text}; }

  void run(const ItemWork& work) override {
    std::mutex reporting;
    const ItemThreads threads(work,
                              {[&] { return work.queue.take(0, work.prepared()); },
                               [&](std::size_t item, const ItemSeconds& seconds) {
                                 const std::lock_guard lock(reporting);
                                 work.done(item, seconds);
                               }},
                              false);
    if (threads.failure()) std::rethrow_exception(threads.failure());
    if (work.cancellation && work.cancellation->cancelled() && work.queue.left() > 0)
      throw Cancelled();
  }
};

}  // namespace
}  // namespace lapwing

LAPWING_PLUGINS(lapwing::Threads)
