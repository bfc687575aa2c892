// SPDX-License-Identifier: Apache-2.0
#include "framework/mavlink/packet.h"

#include "framework/core/error.h"

namespace lapwing::mavlink {

namespace {

// Zeros at the end are left out, but the first byte stays (MAVLink 2).
std::size_t shortened(const Packet& packet, std::size_t length) {
  while (length > 1 && packet.payload[length - 1] == 0) --length;
  return length;
}

}  // namespace

std::string bytes_of(const Packet& packet) {
  const MessageEntry* entry = find_message(packet.message);
  if (!entry)
    throw Error("MAVLink message " + std::to_string(packet.message) + " is not in the table");
  if (packet.length > entry->length)
    throw Error("a payload of " + std::to_string(packet.length) + " bytes is longer than " +
                std::string(entry->name));
  const bool first = packet.version == 1;
  if (first && packet.message > 255)
    throw Error(std::string(entry->name) + " is a message of MAVLink 2");
  const std::size_t length = first ? entry->base_length : shortened(packet, entry->length);
  std::string bytes;
  const auto put = [&bytes](std::size_t byte) { bytes += static_cast<char>(byte & 0xff); };
  put(first ? kMagic1 : kMagic2);
  put(length);
  if (!first) put(0), put(0);
  put(packet.sequence), put(packet.system), put(packet.component);
  put(packet.message);
  if (!first) put(packet.message >> 8), put(packet.message >> 16);
  for (std::size_t i = 0; i < length; ++i) put(packet.payload[i]);
  std::uint16_t crc = kCrcStart;
  for (std::size_t i = 1; i < bytes.size(); ++i)
    crc = crc_add(crc, static_cast<std::uint8_t>(bytes[i]));
  crc = crc_add(crc, entry->crc_extra);
  put(crc), put(crc >> 8);
  return bytes;
}

}  // namespace lapwing::mavlink
