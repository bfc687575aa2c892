#include "framework/app/command_line.h"
#include "framework/app/plugin_check.h"

// The program counts its heap allocations, so that `plugins check` can say which calls make some.
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)

#include <cerrno>
#include <cstdlib>

// The C library's own allocators, under the names that stay when the usual ones are replaced.
extern "C" {
void* __libc_malloc(std::size_t size);
void* __libc_calloc(std::size_t count, std::size_t size);
void* __libc_realloc(void* block, std::size_t size);
void* __libc_memalign(std::size_t alignment, std::size_t size);
}

namespace {
thread_local std::int64_t allocations = 0;
}

extern "C" {
void* malloc(std::size_t size) {
  ++allocations;
  return __libc_malloc(size);
}
void* calloc(std::size_t count, std::size_t size) {
  ++allocations;
  return __libc_calloc(count, size);
}
void* realloc(void* block, std::size_t size) {
  ++allocations;
  return __libc_realloc(block, size);
}
void* aligned_alloc(std::size_t alignment, std::size_t size) {
  ++allocations;
  return __libc_memalign(alignment, size);
}
int posix_memalign(void** block, std::size_t alignment, std::size_t size) {
  ++allocations;
  *block = __libc_memalign(alignment, size);
  return *block ? 0 : ENOMEM;
}
}

#define LAPWING_COUNTS_ALLOCATIONS
#endif

int main(int argc, char** argv) {
#ifdef LAPWING_COUNTS_ALLOCATIONS
  lapwing::count_allocations_by([] { return allocations; });
#endif
  return lapwing::run_command_line(argc, argv);
}
