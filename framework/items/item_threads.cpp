// SPDX-License-Identifier: Apache-2.0
#include "framework/items/item_threads.h"

namespace lapwing {

ItemThreads::ItemThreads(const ItemWork& work, Calls calls, bool alongside)
    : work_(work), calls_(std::move(calls)), running_(work.threads) {
  const int others = alongside ? work.threads : work.threads - 1;
  for (int k = 0; k < others; ++k) {
    try {
      threads_.emplace_back([this] { loop(); });
    } catch (...) {  // as std::system_error; what has begun comes to its end
      const std::lock_guard lock(mutex_);
      if (!failure_) failure_ = std::current_exception();
      running_ -= others - k;
      calls_.failed();
      break;
    }
  }
  if (alongside) return;
  loop();
  join();
}

ItemThreads::~ItemThreads() {
  join();
}

void ItemThreads::loop() {
  const auto stopped = [&] {
    const std::lock_guard lock(mutex_);
    return failure_ != nullptr;
  };
  try {
    while (!stopped()) {
      if (work_.cancellation && work_.cancellation->cancelled()) break;
      const std::optional<std::size_t> item = calls_.take();
      if (!item) break;
      calls_.done(*item, work_.make(*item));
    }
  } catch (...) {
    bool first = false;
    {
      const std::lock_guard lock(mutex_);
      first = !failure_;
      if (first) failure_ = std::current_exception();
    }
    if (first) calls_.failed();
  }
  const std::lock_guard lock(mutex_);
  --running_;
}

bool ItemThreads::ended() const {
  const std::lock_guard lock(mutex_);
  return running_ <= 0;
}

void ItemThreads::join() {
  for (std::thread& thread : threads_)
    if (thread.joinable()) thread.join();
}

std::exception_ptr ItemThreads::failure() const {
  const std::lock_guard lock(mutex_);
  return failure_;
}

}  // namespace lapwing
