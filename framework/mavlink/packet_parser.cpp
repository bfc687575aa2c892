// SPDX-License-Identifier: Apache-2.0
#include "framework/mavlink/packet_parser.h"

#include <algorithm>

namespace lapwing::mavlink {

namespace {

constexpr std::size_t kHeader1 = 6, kHeader2 = 10, kChecksum = 2;
// A gap in a sequence above this is a sender that began anew.
constexpr int kMostLost = 128;

std::uint8_t byte_at(std::string_view text, std::size_t i) {
  return static_cast<std::uint8_t>(text[i]);
}

bool checksum_holds(std::string_view packet, std::size_t end, std::uint8_t crc_extra) {
  std::uint16_t crc = kCrcStart;
  for (std::size_t i = 1; i < end; ++i) crc = crc_add(crc, byte_at(packet, i));
  crc = crc_add(crc, crc_extra);
  return byte_at(packet, end) == (crc & 0xff) && byte_at(packet, end + 1) == crc >> 8;
}

}  // namespace

// What begins at the first byte of `rest`.
PacketParser::Found PacketParser::look(std::string_view rest, Packet& packet) {
  const bool second = byte_at(rest, 0) == kMagic2;
  if (!second && byte_at(rest, 0) != kMagic1) return {Look::nothing};
  const std::size_t header = second ? kHeader2 : kHeader1;
  if (rest.size() < header) return {Look::more};
  const std::size_t length = byte_at(rest, 1);
  const std::uint8_t incompatible = second ? byte_at(rest, 2) : 0;
  if (incompatible & ~kSignedFlag) {
    ++counts_.incompatible;
    return {Look::nothing};
  }
  const bool has_signature = incompatible & kSignedFlag;
  const std::size_t end = header + length;
  const std::size_t whole = end + kChecksum + (has_signature ? kSignatureLength : 0);
  const std::size_t at = second ? 4 : 2;
  packet = {};
  packet.version = second ? 2 : 1;
  packet.sequence = byte_at(rest, at);
  packet.system = byte_at(rest, at + 1);
  packet.component = byte_at(rest, at + 2);
  packet.message = byte_at(rest, at + 3);
  if (second) packet.message |= byte_at(rest, 8) << 8 | byte_at(rest, 9) << 16;
  if (rest.size() < whole) return {Look::more};
  const MessageEntry* entry = find_message(packet.message);
  // Its checksum cannot be checked: a packet behind it makes it likely.
  if (!entry) {
    const bool likely =
        rest.size() == whole || byte_at(rest, whole) == kMagic1 || byte_at(rest, whole) == kMagic2;
    return likely ? Found{Look::skip, whole} : Found{};
  }
  if (!checksum_holds(rest, end, entry->crc_extra)) {
    ++counts_.bad_checksums;
    return {Look::nothing};
  }
  packet.has_signature = has_signature;
  const std::size_t known = second ? entry->length : entry->base_length;
  packet.length = static_cast<std::uint8_t>(std::min(length, known));
  std::copy_n(rest.begin() + static_cast<std::ptrdiff_t>(header), packet.length,
              packet.payload.begin());
  return {Look::packet, whole};
}

void PacketParser::follow(const Packet& packet) {
  const auto sender = static_cast<std::uint16_t>(packet.system << 8 | packet.component);
  const auto known = next_.find(sender);
  if (known != next_.end()) {
    const int gap = static_cast<std::uint8_t>(packet.sequence - known->second);
    if (gap < kMostLost) counts_.lost += static_cast<std::uint64_t>(gap);
  }
  next_[sender] = static_cast<std::uint8_t>(packet.sequence + 1);
}

std::vector<Packet> PacketParser::read(std::string_view bytes, Source source) {
  std::vector<Packet> packets;
  waiting_ += bytes;
  std::size_t at = 0;
  Packet packet;
  while (at < waiting_.size()) {
    const Found found = look(std::string_view(waiting_).substr(at), packet);
    if (found.look == Look::more && source == Source::stream) break;
    if (found.look == Look::nothing || found.look == Look::more) {
      ++counts_.garbage, ++at;
      continue;
    }
    at += found.length;
    if (found.look == Look::skip) {
      ++counts_.unknown;
    } else {
      ++counts_.packets;
      if (packet.has_signature) ++counts_.with_signature;
      packets.push_back(packet);
    }
    follow(packet);
  }
  waiting_.erase(0, at);
  return packets;
}

}  // namespace lapwing::mavlink
