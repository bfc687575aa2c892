// SPDX-License-Identifier: Apache-2.0
#include "framework/problem/blocks_read.h"

#include "framework/core/error.h"

namespace lapwing {

void BlocksRead::append(std::string_view name, int expected, int& offset, int& size) {
  const int index = layout_.index(name);
  size = layout_.block(index).size;
  if (expected != Eigen::Dynamic && expected != size)
    throw Error("block '" + std::string(name) + "' is read as " + std::to_string(expected) +
                " numbers and has " + std::to_string(size));
  offset = 0;
  for (const int block : blocks_) {
    if (block == index) return;
    offset += layout_.block(block).size;
  }
  blocks_.push_back(index);
}

}  // namespace lapwing
