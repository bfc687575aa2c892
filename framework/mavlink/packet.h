// SPDX-License-Identifier: Apache-2.0
// Packets of MAVLink as bytes. Source: mavlink.io/en/guide/serialization.html.
//
//   MAVLink 2:  FD length incompat compat seq system component id0 id1 id2 payload crc0 crc1
//               [signature: 13 bytes, where incompat has bit 0]
//   MAVLink 1:  FE length seq system component id payload crc0 crc1
//
// We write MAVLink 2, without signatures and without the zeros at the end of a payload.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>

#include "framework/mavlink/message_table.h"

namespace lapwing::mavlink {

inline constexpr std::uint8_t kMagic1 = 0xfe, kMagic2 = 0xfd;
inline constexpr std::uint8_t kSignedFlag = 1;
inline constexpr std::size_t kSignatureLength = 13;

struct Packet {
  std::uint8_t version = 2;  // 1 or 2
  std::uint8_t sequence = 0;
  std::uint8_t system = 0, component = 0;  // of the sender
  std::uint32_t message = 0;
  bool has_signature = false;  // it had one when it was read; nobody has checked it
  std::uint8_t length = 0;     // bytes of the payload on the wire; what follows is zero
  std::array<std::uint8_t, kMostPayload> payload{};

  bool operator==(const Packet&) const = default;
};

// The bytes of a packet. Throws Error for a message that is not in the table, for a payload that is
// longer than its message, and for a message of MAVLink 2 in version 1.
std::string bytes_of(const Packet& packet);

}  // namespace lapwing::mavlink
