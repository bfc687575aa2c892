// SPDX-License-Identifier: Apache-2.0
// What a studio and its working processes send each other over pipes: a header and parts of bytes.
//
// On the pipe: the lengths of header and parts as 32-bit numbers of this machine (count of parts,
// header, each part), then the bytes. Both ends are the same program.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "framework/core/value.h"

namespace lapwing {

struct Frame {
  Value header = Value::map();
  std::vector<std::string> parts = {};
};

inline constexpr std::size_t kLargestFrame = std::size_t{1} << 30;  // bytes
inline constexpr std::uint32_t kMostParts = 4096;

// Blocks. False, or nothing, where the other end is gone; Error for what is no frame.
bool write_frame(int descriptor, const Frame& frame);
std::optional<Frame> read_frame(int descriptor);

}  // namespace lapwing
