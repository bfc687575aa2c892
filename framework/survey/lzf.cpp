// SPDX-License-Identifier: Apache-2.0
#include "framework/survey/lzf.h"

namespace lapwing {

// A byte below 32 announces that many bytes and one as they are. Any other one holds a length in
// its upper three bits (7: another byte is added to it) and the upper five bits of an offset, whose
// lower eight follow: length + 2 bytes are copied from offset + 1 bytes before, and may overlap.
bool unpack_lzf(std::string_view packed, std::size_t size, std::vector<char>& unpacked) {
  unpacked.clear();
  unpacked.reserve(size);
  std::size_t at = 0;
  const auto next = [&] { return static_cast<unsigned char>(packed[at++]); };
  while (at < packed.size()) {
    const unsigned code = next();
    if (code < 32) {
      const std::size_t count = code + 1;
      if (count > packed.size() - at || count > size - unpacked.size()) return false;
      unpacked.insert(unpacked.end(), packed.begin() + static_cast<std::ptrdiff_t>(at),
                      packed.begin() + static_cast<std::ptrdiff_t>(at + count));
      at += count;
      continue;
    }
    std::size_t count = code >> 5;
    if (count == 7) {
      if (at == packed.size()) return false;
      count += next();
    }
    if (at == packed.size()) return false;
    const std::size_t back = ((code & 31u) << 8 | next()) + 1;
    count += 2;
    if (back > unpacked.size() || count > size - unpacked.size()) return false;
    for (std::size_t from = unpacked.size() - back; count > 0; --count)
      unpacked.push_back(unpacked[from++]);
  }
  return unpacked.size() == size;
}

}  // namespace lapwing
