// SPDX-License-Identifier: Apache-2.0
// The memory of one Lua state: capped, and with a number for every object.
//
// Lua names an object by its address (in `tostring`, in the order of `next`), and addresses differ
// from run to run. Here every table, function, userdata and thread gets a number when it is made,
// counted per kind: the same in every run of the same script. When garbage is collected depends on
// what the script made, not on addresses, so that weak tables lose entries at the same places too.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

struct lua_State;

namespace lapwing {

class SandboxHeap {
 public:
  explicit SandboxHeap(double megabytes);

  // As a lua_Alloc. Null where the cap, once it is on, would be exceeded.
  void* resize(void* block, std::size_t old_size, std::size_t new_size);

  void set_capped(bool capped) { capped_ = capped; }
  // Whether `bytes` more would fit under the cap.
  bool fits(std::size_t bytes) const;
  bool exceeded() const { return exceeded_; }
  void set_exceeded(bool exceeded) { exceeded_ = exceeded; }

  // Learns where in a block Lua puts an object. Once, with the libraries not yet open.
  void learn_layout(lua_State* state);
  // The number of the table, function, userdata or thread at `index`, from 1 in the order of their
  // making; 0 of what has none (a function of C without upvalues, any other type).
  std::uint64_t number_of(lua_State* state, int index) const;

  // Whether as much was made since the last collection as had survived it.
  bool collection_due() const;
  void note_collection();

 private:
  static constexpr int kKinds = 16;  // more than Lua has types

  std::size_t limit_;     // bytes
  std::size_t used_ = 0;  // bytes, ours included
  bool capped_ = false;   // off while the libraries are set up
  bool exceeded_ = false;
  std::size_t live_ = 0;                       // bytes of objects, texts included
  std::size_t made_ = 0;                       // bytes of objects since the last collection
  std::size_t live_then_ = 0, used_then_ = 0;  // after it
  std::array<std::uint64_t, kKinds> counts_{};
  std::array<const void*, kKinds> last_{};        // block of each kind
  std::array<std::ptrdiff_t, kKinds> offsets_{};  // of an object in its block
};

}  // namespace lapwing
