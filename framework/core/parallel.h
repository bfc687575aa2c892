// SPDX-License-Identifier: Apache-2.0
// Loops over several threads. What a loop computes must not depend on how many there are: each
// index writes to its own place, and whatever is summed up is summed in order afterwards.
#pragma once

#include <cstddef>
#include <functional>

namespace lapwing {

// As many as the machine runs at once; at least 1.
int available_threads();

// Calls `body` once for every index below `count`, on at most `threads` threads, this one included,
// and on no more than the machine runs at once; 0 or fewer asks for all of those, 1 runs in order
// on this thread. Returns when all calls have. An exception of `body` ends the loop and is thrown
// here; other indices may have run.
void parallel_for(std::size_t count, int threads, const std::function<void(std::size_t)>& body);

// Runs `body` on this thread; what a library starts in it through oneTBB stays on this thread too.
void on_this_thread(const std::function<void()>& body);

}  // namespace lapwing
