// SPDX-License-Identifier: Apache-2.0
// Counts every heap allocation of a program that is linked with it, those of the libraries that it
// loads included. For programs alone: in a library it would replace its users' allocator.
#pragma once

#include <cstdint>
#include <functional>

namespace lapwing {

// Allocations of the calling thread so far; empty where a sanitizer owns the heap.
std::function<std::int64_t()> allocation_counter();

}  // namespace lapwing
