// SPDX-License-Identifier: Apache-2.0
// Packets: known bytes, round trips, and streams with garbage.
#include <gtest/gtest.h>

#include <cmath>

#include "framework/core/random.h"
#include "framework/mavlink/message.h"
#include "framework/mavlink/message_value.h"
#include "framework/mavlink/packet_parser.h"

namespace lapwing::mavlink {
namespace {

std::string bytes(std::initializer_list<int> list) {
  std::string text;
  for (const int byte : list) text += static_cast<char>(byte);
  return text;
}

// A heartbeat of PX4's simulator, as pymavlink's documentation shows the fields.
Packet heartbeat(std::uint8_t sequence = 7) {
  Packet packet = Message<kHeartbeat>()
                      .set<"type">(2)
                      .set<"autopilot">(12)
                      .set<"base_mode">(81)
                      .set<"custom_mode">(196608)
                      .set<"system_status">(3)
                      .set<"mavlink_version">(3)
                      .packet();
  packet.system = 1, packet.component = 1, packet.sequence = sequence;
  return packet;
}

TEST(Packets, HaveTheBytesOfTheSerializationGuide) {
  const std::string text = bytes_of(heartbeat());
  ASSERT_EQ(text.size(), 21u);
  EXPECT_EQ(text.substr(0, 19), bytes({0xfd, 9, 0, 0, 7, 1, 1, 0, 0, 0,  // header
                                       0, 0, 3, 0, 2, 12, 81, 3, 3}));
  // CRC-16/MCRF4XX of "123456789", from the catalogue of CRCs.
  std::uint16_t crc = kCrcStart;
  for (const char c : std::string("123456789")) crc = crc_add(crc, static_cast<std::uint8_t>(c));
  EXPECT_EQ(crc, 0x6f91);
}

TEST(Packets, LeaveOutZerosAtTheEndAndReadThemAgain) {
  Packet packet = Message<kCommandAck>().set<"command">(400).packet();
  const std::string text = bytes_of(packet);
  EXPECT_EQ(text.size(), 12u + 2u) << "10 bytes are 2";
  PacketParser parser;
  const auto read = parser.read(text);
  ASSERT_EQ(read.size(), 1u);
  EXPECT_EQ(Message<kCommandAck>(read[0]).get<"command">(), 400);
  EXPECT_EQ(Message<kCommandAck>(read[0]).get<"target_component">(), 0);
  // A payload of zeros alone keeps one byte.
  EXPECT_EQ(bytes_of(Message<kExtendedSysState>().packet()).size(), 12u + 1u);
}

TEST(Packets, OfTheFirstVersionHaveTheFullPayload) {
  Packet packet = heartbeat();
  packet.version = 1;
  const std::string text = bytes_of(packet);
  ASSERT_EQ(text.size(), 17u);
  EXPECT_EQ(text.substr(0, 6), bytes({0xfe, 9, 7, 1, 1, 0}));
  PacketParser parser;
  const auto read = parser.read(text);
  ASSERT_EQ(read.size(), 1u);
  EXPECT_EQ(read[0].version, 1);
  EXPECT_EQ(Message<kHeartbeat>(read[0]).get<"custom_mode">(), 196608u);
  packet.message = kGimbalManagerSetAttitude;
  EXPECT_THROW(bytes_of(packet), Error);
}

TEST(Packets, WhatCannotBeWrittenIsAnError) {
  Packet packet;
  packet.message = 9999;
  EXPECT_THROW(bytes_of(packet), Error);
  packet = heartbeat();
  packet.length = 10;
  EXPECT_THROW(bytes_of(packet), Error);
}

// Every message with random fields, through bytes and through values.
TEST(Packets, ComeBackFromBytesAndFromValues) {
  Random random(3);
  for (const MessageEntry& entry : kMessages) {
    Packet packet;
    packet.message = entry.id;
    packet.length = entry.length;
    packet.system = 3, packet.component = 5;
    for (std::size_t i = 0; i < entry.length; ++i)
      packet.payload[i] = static_cast<std::uint8_t>(random.integer(0, 100));
    PacketParser parser;
    const auto read = parser.read(bytes_of(packet));
    ASSERT_EQ(read.size(), 1u) << entry.name;
    EXPECT_EQ(read[0].payload, packet.payload) << entry.name;
    const Value value = to_value(read[0]);
    if (value.at("fields").find("text")) continue;  // ends at its first zero
    const Packet again = packet_from_value(value);
    // Numbers of 64 bits have 53 bits as values.
    bool wide = false;
    for (const FieldEntry& field : entry.fields) wide = wide || size_of(field.type) == 8;
    if (wide) continue;
    EXPECT_EQ(again.payload, packet.payload) << entry.name;
  }
}

TEST(Packets, ValuesThatDoNotFitAreRefused) {
  const auto refused = [](const char* message, const char* key, Value content) {
    Value value = Value::map();
    value.set("message", message);
    value.set("fields", Value::map()).set(key, std::move(content));
    EXPECT_THROW(packet_from_value(value), InputError) << key;
  };
  refused("HEARTBEAT", "type", 256);
  refused("HEARTBEAT", "type", -1);
  refused("HEARTBEAT", "type", 1.5);
  refused("HEARTBEAT", "type", "many");
  refused("HEARTBEAT", "kind", 1);
  refused("HEARTBEATS", "type", 1);
  refused("TIMESYNC", "tc1", 9.3e18);
  refused("STATUSTEXT", "text", std::string(51, 'a'));
  refused("HOME_POSITION", "q", Value::list());
  Value value = Value::map();
  value.set("message", "ATTITUDE");
  value.set("fields", Value::map()).set("roll", "nan");
  EXPECT_TRUE(std::isnan(Message<kAttitude>(packet_from_value(value)).get<"roll">()));
}

TEST(PacketParser, FindsPacketsBetweenGarbage) {
  Random random(11);
  std::string stream;
  constexpr int kPackets = 200;
  for (int i = 0; i < kPackets; ++i) {
    const auto garbage = random.integer(0, 12);
    // No byte of the garbage begins a packet.
    for (int k = 0; k < garbage; ++k) stream += static_cast<char>(random.integer(0, 250));
    stream += bytes_of(heartbeat(static_cast<std::uint8_t>(i)));
  }
  // In pieces of any length.
  PacketParser parser;
  std::vector<Packet> read;
  for (std::size_t at = 0; at < stream.size();) {
    const auto length = static_cast<std::size_t>(random.integer(1, 40));
    for (const Packet& packet : parser.read(std::string_view(stream).substr(at, length)))
      read.push_back(packet);
    at += length;
  }
  ASSERT_EQ(read.size(), static_cast<std::size_t>(kPackets));
  for (int i = 0; i < kPackets; ++i) EXPECT_EQ(read[static_cast<std::size_t>(i)].sequence, i % 256);
  EXPECT_EQ(parser.counts().lost, 0u);
}

TEST(PacketParser, FindsAPacketInsideOneThatOnlySeemedToBegin) {
  // A stray first byte, whose "header" would swallow what follows.
  std::string stream = bytes({0xfd, 20, 0, 0});
  for (int i = 0; i < 3; ++i) stream += bytes_of(heartbeat(static_cast<std::uint8_t>(i)));
  PacketParser parser;
  EXPECT_EQ(parser.read(stream).size(), 3u);
  EXPECT_EQ(parser.counts().garbage, 4u);
}

TEST(PacketParser, DropsDamagedPacketsAndCountsTheLost) {
  PacketParser parser;
  std::string damaged = bytes_of(heartbeat(1));
  damaged[12] ^= 1;
  EXPECT_EQ(parser.read(bytes_of(heartbeat(0)) + damaged + bytes_of(heartbeat(2))).size(), 2u);
  EXPECT_EQ(parser.counts().bad_checksums, 1u);
  EXPECT_EQ(parser.counts().lost, 1u);
  EXPECT_EQ(parser.read(bytes_of(heartbeat(12))).size(), 1u);
  EXPECT_EQ(parser.counts().lost, 10u);
  // Over the end of the numbers, and a sender that begins anew.
  parser.read(bytes_of(heartbeat(13)));
  parser.read(bytes_of(heartbeat(0)));
  EXPECT_EQ(parser.counts().lost, 10u);
  Packet other = heartbeat(77);
  other.component = 9;
  parser.read(bytes_of(other));
  EXPECT_EQ(parser.counts().lost, 10u) << "each sender counts for itself";
}

TEST(PacketParser, ReadsSignedPacketsAndSaysSo) {
  std::string text = bytes_of(heartbeat());
  // The flag is part of the checksum: write it anew.
  text[2] = kSignedFlag;
  std::uint16_t crc = kCrcStart;
  for (std::size_t i = 1; i < text.size() - 2; ++i)
    crc = crc_add(crc, static_cast<std::uint8_t>(text[i]));
  crc = crc_add(crc, 50);
  text[text.size() - 2] = static_cast<char>(crc & 0xff);
  text[text.size() - 1] = static_cast<char>(crc >> 8);
  text += std::string(kSignatureLength, 'x');
  PacketParser parser;
  const auto read = parser.read(text + bytes_of(heartbeat(8)));
  ASSERT_EQ(read.size(), 2u);
  EXPECT_TRUE(read[0].has_signature);
  EXPECT_FALSE(read[1].has_signature);
  EXPECT_EQ(parser.counts().with_signature, 1u);
  // Another flag of incompatibility is refused.
  text[2] = 2;
  EXPECT_TRUE(parser.read(text).empty());
  EXPECT_EQ(parser.counts().incompatible, 1u);
}

TEST(PacketParser, PassesOverMessagesThatItDoesNotKnow) {
  std::string unknown = bytes({0xfd, 5, 0, 0, 8, 1, 1, 0xe8, 3, 0, 1, 2, 3, 4, 5, 9, 9});
  PacketParser parser;
  const auto read = parser.read(bytes_of(heartbeat(7)) + unknown + bytes_of(heartbeat(9)));
  EXPECT_EQ(read.size(), 2u);
  EXPECT_EQ(parser.counts().unknown, 1u);
  EXPECT_EQ(parser.counts().garbage, 0u);
  EXPECT_EQ(parser.counts().lost, 0u);
}

TEST(PacketParser, ADatagramHoldsWholePackets) {
  PacketParser parser;
  const std::string text = bytes_of(heartbeat());
  EXPECT_TRUE(parser.read(text.substr(0, 12), Source::datagram).empty());
  EXPECT_EQ(parser.read(text, Source::datagram).size(), 1u);
  EXPECT_EQ(parser.counts().garbage, 12u);
}

TEST(PacketParser, CutsAPayloadOfANewerDialect) {
  // A heartbeat with three bytes more, as an extension would bring.
  std::string text =
      bytes({0xfd, 12, 0, 0, 7, 1, 1, 0, 0, 0, 0, 0, 3, 0, 2, 12, 81, 3, 3, 1, 2, 3});
  std::uint16_t crc = kCrcStart;
  for (std::size_t i = 1; i < text.size(); ++i)
    crc = crc_add(crc, static_cast<std::uint8_t>(text[i]));
  crc = crc_add(crc, 50);
  text += static_cast<char>(crc & 0xff);
  text += static_cast<char>(crc >> 8);
  PacketParser parser;
  const auto read = parser.read(text);
  ASSERT_EQ(read.size(), 1u);
  EXPECT_EQ(read[0], heartbeat());
}

}  // namespace
}  // namespace lapwing::mavlink
