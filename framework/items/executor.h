// SPDX-License-Identifier: Apache-2.0
// Who makes the items of a command: the plugin kind `executor`.
//
// An executor connects the processes that run the same command. Every process creates one, makes
// the same calls in the same order, and knows the same items. Process 0 decides which items are
// made, reads and writes everything but items, and speaks for all.
#pragma once

#include <functional>

#include "framework/core/plugin_object.h"
#include "framework/core/progress.h"
#include "framework/items/item_queue.h"

namespace lapwing {

struct ItemWork {
  ItemQueue& queue;  // items are taken from that of process 0; others are not used
  int threads = 1;   // of this process, at least 1: items that it makes at the same time
  // Makes one item; called by several threads. After an exception, no item is begun any more.
  std::function<ItemSeconds(std::size_t item)> make;
  // The groups that this process has prepared, for ItemQueue::take. Thread-safe.
  std::function<std::vector<std::size_t>()> prepared;
  // Called in process 0 for every item that was made anywhere, by one thread at a time.
  std::function<void(std::size_t item, const ItemSeconds& seconds)> done;
  const CancellationToken* cancellation = nullptr;  // after which no item is begun; may be null
};

class Executor : public PluginObject {
 public:
  using Interface = Executor;
  static constexpr const char* kKind = "executor";

  virtual ~Executor() = default;

  // The place of this process among all, from 0, and how many there are.
  virtual int rank() const = 0;
  virtual int ranks() const = 0;
  // Threads of one process, unless the user states a number; 0: one per core.
  virtual int default_threads() const = 0;

  // The texts of all processes in their order, in every process. All processes call it together.
  virtual std::vector<std::string> exchange(const std::string& text) = 0;

  // Makes the items of the queue. All processes call it together; each calls `make` in its own
  // threads only. Every item is made once, by one process. Returns when all items are made.
  //
  // After a failure of `make` in any process, items in flight are ended, and process 0 throws: its
  // own exception as it is, one of another process as InputError, Cancelled or Error with the name
  // of the process. Other processes return. Throws Cancelled if the token was cancelled before all
  // items were begun.
  virtual void run(const ItemWork& work) = 0;
};

}  // namespace lapwing
