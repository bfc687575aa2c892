// SPDX-License-Identifier: Apache-2.0
// Streams of MAVLink in pieces: every packet that is read can be written, and reads the same again.
#include <cstdint>
#include <cstdlib>

#include "framework/mavlink/message_value.h"
#include "framework/mavlink/packet_parser.h"

using namespace lapwing::mavlink;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view all(reinterpret_cast<const char*>(data), size);
  if (all.empty()) return 0;
  const Source source = all[0] & 1 ? Source::stream : Source::datagram;
  const std::size_t piece = static_cast<std::uint8_t>(all[0]) / 2 + 1;
  PacketParser parser;
  for (std::size_t at = 1; at < all.size(); at += piece)
    for (const Packet& packet : parser.read(all.substr(at, piece), source)) {
      (void)to_value(packet);
      PacketParser again;
      const auto read = again.read(bytes_of(packet), Source::datagram);
      if (read.size() != 1 || read[0].payload != packet.payload ||
          read[0].message != packet.message || read[0].system != packet.system)
        std::abort();
    }
  if (parser.counts().garbage > size) std::abort();
  return 0;
}
