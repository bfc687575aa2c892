// SPDX-License-Identifier: Apache-2.0
// LZF, the compression of .pcd files: Lempel-Ziv with byte-aligned codes (Lehmann, LibLZF).
#pragma once

#include <string_view>
#include <vector>

namespace lapwing {

// No input of n bytes stands for more than this many times n: three bytes for 7 + 255 + 2.
inline constexpr std::size_t kMostOfLzf = 88;

// The `size` bytes that `packed` stands for; false where it stands for fewer or more, or refers to
// bytes before the first one.
bool unpack_lzf(std::string_view packed, std::size_t size, std::vector<char>& unpacked);

}  // namespace lapwing
