// SPDX-License-Identifier: Apache-2.0
// The order in which items are handed out: longest first, but a process keeps to the group that it
// has prepared.
#pragma once

#include <mutex>
#include <optional>
#include <set>

#include "framework/items/item.h"

namespace lapwing {

// Thread-safe.
class ItemQueue {
 public:
  // `todo` are places in `items`; `expected` are the times of all items in s.
  ItemQueue(const std::vector<Item>& items, const std::vector<std::size_t>& todo,
            const std::vector<double>& expected);

  // The next item for process `asker`, which has prepared the groups `prepared`; none if nothing is
  // left. The longest item is handed out, with one exception: among items that take at least half
  // as long, one of a prepared group goes first, then one of a group that no other process has.
  // Equal times: in the order of groups and items.
  std::optional<std::size_t> take(int asker, const std::vector<std::size_t>& prepared);

  // From now on nothing is handed out.
  void close();
  std::size_t left() const;

 private:
  struct Entry {
    double seconds;
    std::size_t item;
  };
  bool of_another(int asker, std::size_t group) const;

  mutable std::mutex mutex_;
  std::vector<std::vector<Entry>> groups_;  // each with its longest item last
  std::vector<std::set<std::size_t>>
      prepared_;  // by process: groups that it was last known to have
  std::size_t left_ = 0;
};

}  // namespace lapwing
