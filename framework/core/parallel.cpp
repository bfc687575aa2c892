// SPDX-License-Identifier: Apache-2.0
#include "framework/core/parallel.h"

#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>

#include "framework/core/active_call.h"

namespace lapwing {

int available_threads() {
  return std::max(1, tbb::info::default_concurrency());
}

void parallel_for(std::size_t count, int threads, const std::function<void(std::size_t)>& body) {
  const int most = threads > 0 ? std::min(threads, available_threads()) : available_threads();
  if (most == 1 || count < 2) {
    for (std::size_t i = 0; i < count; ++i) body(i);
    return;
  }
  tbb::task_arena arena(most);
  const ActiveCallName caller = active_call();
  if (!caller.name) {
    arena.execute([&] { tbb::parallel_for(std::size_t{0}, count, body); });
    return;
  }
  // The other threads are in the caller's plugin as well.
  const auto marked = [&](std::size_t i) {
    const ActiveCall mark(caller.name, caller.call, caller.length);
    body(i);
  };
  arena.execute([&] { tbb::parallel_for(std::size_t{0}, count, marked); });
}

void on_this_thread(const std::function<void()>& body) {
  tbb::task_arena arena(1);
  arena.execute(body);
}

}  // namespace lapwing
