// SPDX-License-Identifier: Apache-2.0
// Little-endian numbers at places of a file, for readers of binary logs.
#pragma once

#include <bit>
#include <cstdint>
#include <cstring>
#include <optional>
#include <string_view>

namespace lapwing {

static_assert(std::endian::native == std::endian::little);

// Nothing beyond the end. T is a number without padding.
template <class T>
std::optional<T> number_in(std::string_view bytes, std::size_t at) {
  if (at > bytes.size() || bytes.size() - at < sizeof(T)) return std::nullopt;
  T value;
  std::memcpy(&value, bytes.data() + at, sizeof value);
  return value;
}

}  // namespace lapwing
