// SPDX-License-Identifier: Apache-2.0
// The blocks that a function reads, by name. Handles are bound once, in `declare`; reading through
// one is a load at an offset known by then.
#pragma once

#include <string_view>
#include <vector>

#include "framework/problem/block.h"

namespace lapwing {

// Where the numbers of a block stand among those that a function gets of a stage. A handle of size
// 1 reads a number, any other a vector; Eigen::Dynamic: as many numbers as the block has.
template <int Size>
class BlockHandle {
 public:
  int offset() const { return offset_; }
  int size() const { return Size == Eigen::Dynamic ? size_ : Size; }

 private:
  friend class BlocksRead;
  int offset_ = 0, size_ = 0;
};
using NumberHandle = BlockHandle<1>;
using VectorHandle = BlockHandle<3>;
using AnyHandle = BlockHandle<Eigen::Dynamic>;

// Fills the list of blocks of a shape:
//
//   BlocksRead reads(setting.layout, shape.blocks);
//   in_ = {reads.add<3>("position"), reads.add("yaw")};
//
// Both arguments outlive it.
class BlocksRead {
 public:
  BlocksRead(const StageLayout& layout, std::vector<int>& blocks)
      : layout_(layout), blocks_(blocks) {}

  // InputError naming the known blocks and the nearest one where there is none of that name; Error
  // where the block has another size than `Size`. A block that is read already is not added again.
  template <int Size = 1>
  BlockHandle<Size> add(std::string_view name) {
    BlockHandle<Size> handle;
    append(name, Size, handle.offset_, handle.size_);
    return handle;
  }
  bool has(std::string_view name) const { return layout_.find(name) >= 0; }

 private:
  void append(std::string_view name, int expected, int& offset, int& size);

  const StageLayout& layout_;
  std::vector<int>& blocks_;
};

}  // namespace lapwing
