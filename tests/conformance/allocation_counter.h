// Counts every heap allocation of the test program, those of the libraries that it loads included.
#pragma once

#include <cstdint>
#include <functional>

namespace lapwing {

// Allocations of the calling thread so far; empty where a sanitizer owns the heap.
std::function<std::int64_t()> allocation_counter();

}  // namespace lapwing
