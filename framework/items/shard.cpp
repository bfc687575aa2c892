// SPDX-License-Identifier: Apache-2.0
#include "framework/items/shard.h"

#include <charconv>

#include "framework/core/error.h"

namespace lapwing {

namespace {

constexpr std::size_t kMostShards = 1'000'000;

bool read_whole(const std::string& text, std::size_t& number) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  return !text.empty() && error == std::errc{} && end == text.data() + text.size();
}

}  // namespace

std::string Shard::text() const {
  return std::to_string(number) + "/" + std::to_string(count);
}

Shard read_shard(const std::string& text) {
  const std::size_t slash = text.find('/');
  Shard shard;
  const bool read = slash != text.npos && read_whole(text.substr(0, slash), shard.number) &&
                    read_whole(text.substr(slash + 1), shard.count);
  if (!read || shard.count < 1 || shard.count > kMostShards)
    throw InputError("--shard: expected K/N, as 3/10, with N from 1 to " +
                     std::to_string(kMostShards) + ", not '" + text + "'");
  if (shard.number > shard.count)
    throw InputError("--shard: expected K/N with K from 1 to N (0 stands for N), not '" + text +
                     "'");
  if (shard.number == 0) shard.number = shard.count;
  return shard;
}

}  // namespace lapwing
