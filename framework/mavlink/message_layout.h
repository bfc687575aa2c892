// SPDX-License-Identifier: Apache-2.0
// How a message of MAVLink is described, and what follows from that at compile time: the order of
// its fields on the wire, their places, its length, and the byte CRC_EXTRA.
//
// Source: the serialization guide of MAVLink (mavlink.io/en/guide/serialization.html). Fields are
// sorted by the size of one element, the largest first; equal ones keep their order; extensions
// follow in the order of their definition. CRC_EXTRA does not depend on extensions.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

namespace lapwing::mavlink {

enum class FieldType : std::uint8_t { u8, i8, u16, i16, u32, i32, u64, i64, f32, f64, text };

constexpr std::size_t size_of(FieldType type) {
  switch (type) {
    case FieldType::u8:
    case FieldType::i8:
    case FieldType::text:
      return 1;
    case FieldType::u16:
    case FieldType::i16:
      return 2;
    case FieldType::u32:
    case FieldType::i32:
    case FieldType::f32:
      return 4;
    default:
      return 8;
  }
}

// As the definitions and CRC_EXTRA write a type.
constexpr std::string_view name_of(FieldType type) {
  constexpr std::array<std::string_view, 11> kNames = {"uint8_t",  "int8_t",  "uint16_t", "int16_t",
                                                       "uint32_t", "int32_t", "uint64_t", "int64_t",
                                                       "float",    "double",  "char"};
  return kNames[static_cast<std::size_t>(type)];
}

// One field, in the order of the definition.
struct FieldEntry {
  std::string_view name;
  FieldType type;
  std::uint8_t array = 0;      // elements; 0: not an array
  std::string_view unit = {};  // as the definitions write it: "degE7", "cm/s"; "" for none
  bool extension = false;      // of MAVLink 2 alone

  constexpr std::size_t elements() const { return array == 0 ? 1 : array; }
  constexpr std::size_t size() const { return size_of(type) * elements(); }
};

// X.25 as MAVLink uses it: CRC-16/MCRF4XX.
constexpr std::uint16_t crc_add(std::uint16_t crc, std::uint8_t byte) {
  auto t = static_cast<std::uint8_t>(byte ^ (crc & 0xff));
  t = static_cast<std::uint8_t>(t ^ (t << 4));
  return static_cast<std::uint16_t>((crc >> 8) ^ (t << 8) ^ (t << 3) ^ (t >> 4));
}
inline constexpr std::uint16_t kCrcStart = 0xffff;

inline constexpr std::size_t kMostFields = 20;
inline constexpr std::size_t kMostPayload = 255;  // bytes

struct MessageEntry {
  std::uint32_t id = 0;
  std::string_view name = {};
  std::span<const FieldEntry> fields = {};
  std::array<std::uint8_t, kMostFields> offsets{};  // bytes in the payload, by field
  std::uint8_t base_length = 0;                     // bytes, without extensions: that of MAVLink 1
  std::uint8_t length = 0;                          // bytes, with them
  std::uint8_t crc_extra = 0;

  // The place of a field in `fields`; the number of fields for a name that is not there.
  constexpr std::size_t field(std::string_view wanted) const {
    std::size_t i = 0;
    while (i < fields.size() && fields[i].name != wanted) ++i;
    return i;
  }
};

// Calls `take(i)` for every field in the order of the wire.
template <class Take>
constexpr void in_wire_order(std::span<const FieldEntry> fields, Take take) {
  for (std::size_t size = 8; size > 0; size /= 2)
    for (std::size_t i = 0; i < fields.size(); ++i)
      if (!fields[i].extension && size_of(fields[i].type) == size) take(i);
  for (std::size_t i = 0; i < fields.size(); ++i)
    if (fields[i].extension) take(i);
}

// The layout of a message. A message with too many fields, or one that does not fit into a packet,
// does not compile.
consteval MessageEntry message(std::uint32_t id, std::string_view name,
                               std::span<const FieldEntry> fields) {
  if (fields.size() > kMostFields) throw "too many fields";
  MessageEntry entry{id, name, fields};
  std::uint16_t crc = kCrcStart;
  const auto add = [&crc](std::string_view text) {
    for (const char c : text) crc = crc_add(crc, static_cast<std::uint8_t>(c));
    crc = crc_add(crc, ' ');
  };
  add(name);
  std::size_t length = 0;
  in_wire_order(fields, [&](std::size_t i) {
    const FieldEntry& field = fields[i];
    entry.offsets[i] = static_cast<std::uint8_t>(length);
    length += field.size();
    if (length > kMostPayload) throw "longer than a packet";
    if (field.extension) return;
    entry.base_length = static_cast<std::uint8_t>(length);
    add(name_of(field.type));
    add(field.name);
    if (field.array > 0) crc = crc_add(crc, field.array);
  });
  entry.length = static_cast<std::uint8_t>(length);
  entry.crc_extra = static_cast<std::uint8_t>((crc & 0xff) ^ (crc >> 8));
  return entry;
}

}  // namespace lapwing::mavlink
