// SPDX-License-Identifier: Apache-2.0
#include "framework/mission/sandbox_heap.h"

#include <algorithm>
#include <cstdlib>
#include <lua.hpp>
#include <new>

#include "framework/core/error.h"

namespace lapwing {

namespace {

constexpr double kMegabyte = 1024.0 * 1024.0;
constexpr std::size_t kLeastMade = 4u << 20;   // bytes between two collections
constexpr std::size_t kLeastUsed = 64u << 20;  // bytes, before the arrays of tables are looked at

// Before every block. Its size keeps blocks aligned as malloc aligns them.
struct alignas(std::max_align_t) Header {
  std::uint64_t number = 0;
  std::size_t counted = 0;  // bytes, where the block is an object
};

Header* header_of(void* block) {
  return static_cast<Header*>(block) - 1;
}

int do_nothing(lua_State*) {
  return 0;
}

}  // namespace

SandboxHeap::SandboxHeap(double megabytes)
    : limit_(static_cast<std::size_t>(megabytes * kMegabyte)) {}

bool SandboxHeap::fits(std::size_t bytes) const {
  return !capped_ || (used_ <= limit_ && bytes <= limit_ - used_);
}

void* SandboxHeap::resize(void* block, std::size_t old_size, std::size_t new_size) {
  // Of a new block `old_size` says which kind of object it is for, 0 for none.
  const std::size_t kind = block ? 0 : old_size;
  const std::size_t old_bytes = block ? old_size + sizeof(Header) : 0;
  if (new_size == 0) {
    if (!block) return nullptr;
    Header* const header = header_of(block);
    live_ -= header->counted;
    used_ -= old_bytes;
    std::free(header);
    return nullptr;
  }
  const std::size_t new_bytes = new_size + sizeof(Header);
  if (new_bytes > old_bytes && !fits(new_bytes - old_bytes)) {
    exceeded_ = true;
    return nullptr;
  }
  void* const moved = std::realloc(block ? header_of(block) : nullptr, new_bytes);
  if (!moved) return nullptr;
  used_ += new_bytes - old_bytes;
  Header* const header = static_cast<Header*>(moved);
  if (!block) {
    new (header) Header;
    if (kind > 0 && kind < kKinds) {
      header->number = ++counts_[kind];
      header->counted = new_bytes;
      last_[kind] = header + 1;
      live_ += new_bytes;
      made_ += new_bytes;
    }
  }
  return header + 1;
}

void SandboxHeap::learn_layout(lua_State* state) {
  lua_newtable(state);
  lua_pushnil(state);
  lua_pushcclosure(state, &do_nothing, 1);
  lua_newuserdatauv(state, 1, 0);
  lua_newthread(state);
  for (int index = -4; index < 0; ++index) {
    const int kind = lua_type(state, index);
    const auto* object = static_cast<const char*>(lua_topointer(state, index));
    offsets_[kind] = object - static_cast<const char*>(last_[kind]);
    if (!last_[kind] || offsets_[kind] < 0 || offsets_[kind] > 256)
      throw Error("this build of Lua does not say which objects it makes");
  }
  lua_pop(state, 4);
}

std::uint64_t SandboxHeap::number_of(lua_State* state, int index) const {
  const int kind = lua_type(state, index);
  if (kind != LUA_TTABLE && kind != LUA_TFUNCTION && kind != LUA_TUSERDATA && kind != LUA_TTHREAD)
    return 0;
  if (lua_iscfunction(state, index)) {
    if (!lua_getupvalue(state, index, 1)) return 0;  // no object: its address in the program
    lua_pop(state, 1);
  }
  const char* const object = static_cast<const char*>(lua_topointer(state, index));
  return reinterpret_cast<const Header*>(object - offsets_[kind])[-1].number;
}

bool SandboxHeap::collection_due() const {
  if (made_ > std::max(kLeastMade, live_then_)) return true;
  return used_ > std::max(kLeastUsed, 2 * used_then_);
}

void SandboxHeap::note_collection() {
  made_ = 0;
  live_then_ = live_;
  used_then_ = used_;
}

}  // namespace lapwing
