// SPDX-License-Identifier: Apache-2.0
// A hash table of places of a grid, by open addressing. Internal to the room.
#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

namespace lapwing {

// Three coordinates of 21 bits each, from -2^20 to 2^20 - 1.
using GridKey = std::uint64_t;
inline constexpr GridKey kNoPlace = ~GridKey{0};

inline GridKey grid_key(std::int64_t x, std::int64_t y, std::int64_t z) {
  constexpr std::int64_t kMiddle = 1 << 20;
  return static_cast<GridKey>(x + kMiddle) << 42 | static_cast<GridKey>(y + kMiddle) << 21 |
         static_cast<GridKey>(z + kMiddle);
}

// Of the place so many places away. Keys ascend along z, then y, then x.
inline GridKey grid_key_beside(GridKey key, std::int64_t x, std::int64_t y, std::int64_t z) {
  return key + (static_cast<GridKey>(x) << 42) + (static_cast<GridKey>(y) << 21) +
         static_cast<GridKey>(z);
}

// Bits well mixed (splitmix64's last step).
inline std::uint64_t mixed(GridKey key) {
  key = (key ^ key >> 30) * 0xbf58476d1ce4e5b9ull;
  key = (key ^ key >> 27) * 0x94d049bb133111ebull;
  return key ^ key >> 31;
}

template <class Entry>
class GridTable {
 public:
  struct Slot {
    GridKey key = kNoPlace;
    Entry entry;
  };

  Entry& operator[](GridKey key) {
    if (2 * (size_ + 1) > slots_.size()) grow();
    Slot& slot = slots_[place_of(key)];
    if (slot.key == kNoPlace) {
      slot.key = key;
      ++size_;
    }
    return slot.entry;
  }
  const Entry* find(GridKey key) const {
    if (slots_.empty()) return nullptr;
    const Slot& slot = slots_[place_of(key)];
    return slot.key == kNoPlace ? nullptr : &slot.entry;
  }
  std::size_t size() const { return size_; }
  // Those with kNoPlace are empty.
  const std::vector<Slot>& slots() const { return slots_; }

 private:
  std::size_t place_of(GridKey key) const {
    const std::size_t mask = slots_.size() - 1;
    std::size_t at = mixed(key) & mask;
    while (slots_[at].key != kNoPlace && slots_[at].key != key) at = (at + 1) & mask;
    return at;
  }
  void grow() {
    std::vector<Slot> old(slots_.empty() ? 1024 : 2 * slots_.size());
    old.swap(slots_);
    for (const Slot& slot : old) {
      if (slot.key != kNoPlace) slots_[place_of(slot.key)] = slot;
    }
  }

  std::vector<Slot> slots_;
  std::size_t size_ = 0;
};

}  // namespace lapwing
