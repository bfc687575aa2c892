// SPDX-License-Identifier: Apache-2.0
// Packets out of a stream of bytes, such as a serial line or datagrams give.
//
// Garbage is passed over: after a byte that begins no packet, or a packet whose checksum is wrong,
// the search goes on with the byte after the one where that packet seemed to begin, so that a
// packet inside the garbage is found.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "framework/mavlink/packet.h"

namespace lapwing::mavlink {

struct ParserCounts {
  std::uint64_t packets = 0;         // given to the caller
  std::uint64_t garbage = 0;         // bytes that belong to no packet
  std::uint64_t bad_checksums = 0;   // of messages in the table
  std::uint64_t unknown = 0;         // whole packets of messages that are not in the table: without
                                     // their CRC_EXTRA their checksums cannot be checked
  std::uint64_t incompatible = 0;    // that demand what this parser does not know
  std::uint64_t with_signature = 0;  // among `packets`: read, but their signatures are not checked
  std::uint64_t lost = 0;            // gaps in the sequences of all senders
};

// A stream may bring the rest of a packet later; a datagram holds whole packets.
enum class Source { stream, datagram };

class PacketParser {
 public:
  // The packets that are whole now. A payload that is longer than its message, as a newer dialect
  // may send, is cut to what the table knows.
  std::vector<Packet> read(std::string_view bytes, Source source = Source::stream);

  const ParserCounts& counts() const { return counts_; }

 private:
  enum class Look { packet, more, nothing, skip };
  struct Found {
    Look look = Look::nothing;
    std::size_t length = 0;  // bytes of the packet
  };
  Found look(std::string_view rest, Packet& packet);
  void follow(const Packet& packet);

  std::string waiting_;  // the beginning of a packet
  ParserCounts counts_;
  std::map<std::uint16_t, std::uint8_t> next_;  // sequence, by system and component
};

}  // namespace lapwing::mavlink
