// SPDX-License-Identifier: Apache-2.0
// The threads of one process that make items, for executors.
#pragma once

#include <exception>
#include <functional>
#include <mutex>
#include <optional>
#include <thread>

#include "framework/items/executor.h"

namespace lapwing {

// Threads that take items, make them and report them, until none is left or one fails. They are
// threads of their own, not tasks: an item may wait for another one, and then must not begin a
// third one.
class ItemThreads {
 public:
  // `take` waits for an item and returns none at the end; `done` is told of each item that was
  // made; `failed` of the first exception, after which this process begins no more items. All are
  // called by several threads and must outlive the object.
  struct Calls {
    std::function<std::optional<std::size_t>()> take;
    std::function<void(std::size_t item, const ItemSeconds& seconds)> done;
    std::function<void()> failed = [] {};
  };
  // `alongside`: the caller has other work, and all threads are new ones; else the caller is one
  // of them, and the constructor returns when all have ended. Error if the system refuses threads.
  ItemThreads(const ItemWork& work, Calls calls, bool alongside);
  ~ItemThreads();
  ItemThreads(const ItemThreads&) = delete;
  ItemThreads& operator=(const ItemThreads&) = delete;

  bool ended() const;                  // all threads
  void join();                         // waits for their end
  std::exception_ptr failure() const;  // the first; null for none

 private:
  void loop();

  const ItemWork& work_;
  Calls calls_;
  mutable std::mutex mutex_;
  std::exception_ptr failure_;
  int running_ = 0;
  std::vector<std::thread> threads_;
};

}  // namespace lapwing
