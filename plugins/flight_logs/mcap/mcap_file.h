// SPDX-License-Identifier: Apache-2.0
// The messages of an MCAP file, in the order of the file, chunks opened. https://mcap.dev/spec
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>

namespace lapwing::mcap_log {

struct Channel {
  std::string topic, encoding, schema;  // "/tf", "json", "foxglove.FrameTransform"
  std::size_t messages = 0;
};

struct Message {
  const Channel* channel = nullptr;
  std::uint64_t time = 0;  // ns, when it was logged
  std::string_view data;
};

struct Outcome {
  std::size_t read = 0;  // bytes up to the last record that is whole
  std::string damage;    // what is wrong with the rest; empty: nothing
  std::string library;   // of the header
};

bool is_mcap(std::string_view bytes);

// Calls `take` with each message; `channels` gets each channel when the file is read, with the
// number of its messages. InputError for bytes that are no MCAP, for a compression other than
// none, lz4 and zstd, and for chunks that are larger than they say or than 1 GiB.
Outcome read_messages(std::string_view bytes, const std::function<void(const Message&)>& take,
                      const std::function<void(const Channel&)>& channels);

}  // namespace lapwing::mcap_log
