// SPDX-License-Identifier: Apache-2.0
// Packets of ours for another implementation, and packets of another for ours:
//
//   mavlink_samples write   for each message of the table and each version of MAVLink that has it,
//                           with several drawn contents, a line: the bytes as hexadecimal digits, a
//                           tab, the fields as JSON
//   mavlink_samples read    the fields as JSON for each line of hexadecimal digits
#include <cmath>
#include <iostream>
#include <string>

#include "framework/core/json.h"
#include "framework/core/random.h"
#include "framework/mavlink/message_value.h"
#include "framework/mavlink/packet_parser.h"

namespace lapwing::mavlink {
namespace {

constexpr int kContents = 5;

std::string hexadecimal(const std::string& bytes) {
  constexpr char kDigits[] = "0123456789abcdef";
  std::string text;
  for (const char byte : bytes) {
    text += kDigits[static_cast<unsigned char>(byte) >> 4];
    text += kDigits[static_cast<unsigned char>(byte) & 15];
  }
  return text;
}

std::string bytes_from(const std::string& digits) {
  std::string bytes;
  for (std::size_t i = 0; i + 1 < digits.size(); i += 2)
    bytes += static_cast<char>(std::stoi(digits.substr(i, 2), nullptr, 16));
  return bytes;
}

// Any number that the field holds; of 64 bits those that JSON holds.
Value drawn(FieldType type, Random& random) {
  const auto bits = [&](int count, bool sign) -> Value {
    const double most = std::ldexp(1.0, sign ? count - 1 : count);
    return std::floor(sign ? random.uniform(-most, most) : random.uniform(0, most));
  };
  switch (type) {
    case FieldType::u8:
      return bits(8, false);
    case FieldType::i8:
      return bits(8, true);
    case FieldType::u16:
      return bits(16, false);
    case FieldType::i16:
      return bits(16, true);
    case FieldType::u32:
      return bits(32, false);
    case FieldType::i32:
      return bits(32, true);
    case FieldType::u64:
      return bits(53, false);
    case FieldType::i64:
      return bits(53, true);
    default:
      return static_cast<double>(static_cast<float>(random.uniform(-1e6, 1e6)));
  }
}

Value drawn_field(const FieldEntry& field, Random& random) {
  if (field.type == FieldType::text) {
    std::string text;
    for (auto left = random.integer(0, field.array); left > 0; --left)
      text += static_cast<char>(random.integer('A', 'z'));
    return text;
  }
  if (field.array == 0) return drawn(field.type, random);
  Value list = Value::list();
  for (int i = 0; i < field.array; ++i) list.push_back(drawn(field.type, random));
  return list;
}

void write_samples() {
  Random random(23);
  std::uint8_t sequence = 0;
  for (const MessageEntry& entry : kMessages)
    for (int i = 0; i < kContents; ++i) {
      Value value = Value::map();
      value.set("message", std::string(entry.name));
      value.set("system", 7);
      value.set("component", 1);
      value.set("sequence", static_cast<int>(sequence++));
      const int version = i == 0 && entry.id < 256 ? 1 : 2;
      value.set("version", version);
      Value& fields = value.set("fields", Value::map());
      // The second content is zeros alone: the shortest packet.
      for (const FieldEntry& field : entry.fields)
        if (i != 1 && !(version == 1 && field.extension))
          fields.set(field.name, drawn_field(field, random));
      Packet packet = packet_from_value(value);
      packet.version = static_cast<std::uint8_t>(version);
      std::cout << hexadecimal(bytes_of(packet)) << "\t" << to_json(value, -1) << "\n";
    }
}

bool read_samples() {
  for (std::string line; std::getline(std::cin, line);) {
    PacketParser parser;
    const auto packets = parser.read(bytes_from(line), Source::datagram);
    if (packets.size() != 1) {
      std::cerr << "no packet: " << line << "\n";
      return false;
    }
    Value value = to_value(packets[0]);
    value.set("version", static_cast<int>(packets[0].version));
    std::cout << to_json(value, -1) << "\n";
  }
  return true;
}

}  // namespace
}  // namespace lapwing::mavlink

int main(int argc, char** argv) {
  const std::string what = argc == 2 ? argv[1] : "";
  if (what == "write") {
    lapwing::mavlink::write_samples();
    return 0;
  }
  if (what == "read") return lapwing::mavlink::read_samples() ? 0 : 1;
  std::cerr << "usage: mavlink_samples write|read\n";
  return 2;
}
