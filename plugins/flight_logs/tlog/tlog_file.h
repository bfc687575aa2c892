// SPDX-License-Identifier: Apache-2.0
// The packets of a telemetry log, in the order of the file. A record is a time, 8 bytes, the most
// significant first, in microseconds since 1970, and one packet of MAVLink 1 or 2.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>

#include "framework/mavlink/packet.h"

namespace lapwing::tlog {

struct Outcome {
  std::size_t read = 0;     // bytes of whole records
  std::size_t skipped = 0;  // bytes in the middle that are no record
  std::string damage;       // what is wrong with the rest; empty: nothing
};

// What is told of a record. `known`: the table has the message and the checksum is right. Of
// another message only its number, sender and sequence are there; nobody can check it.
struct Listener {
  std::function<void(std::uint64_t microseconds, const mavlink::Packet&, bool known)> packet;
};

// Whether the first bytes are a record. Of a message that is not in the table: whether a second
// record or the end follows.
bool is_tlog(std::string_view bytes);

// Reads all that can be read. InputError for bytes without a record, and for more than 1 GiB.
Outcome read_records(std::string_view bytes, const Listener& listener);

}  // namespace lapwing::tlog
