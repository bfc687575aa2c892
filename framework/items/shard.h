// SPDX-License-Identifier: Apache-2.0
// A part of the items of a command, for batch systems that start one process per part.
#pragma once

#include <cstddef>
#include <string>

namespace lapwing {

// Part `number` of `count`. The parts share no item, are together all items, and do not depend on
// which items exist already. Part 0 is part `count`, so that arrays may count from 0 or from 1.
struct Shard {
  std::size_t number = 1, count = 1;

  bool has(std::size_t item) const { return item % count == number % count; }
  std::string text() const;  // "3/10"
};

// "3/10". InputError that names --shard.
Shard read_shard(const std::string& text);

}  // namespace lapwing
