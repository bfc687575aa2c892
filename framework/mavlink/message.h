// SPDX-License-Identifier: Apache-2.0
// Fields of messages by name, checked at compile time: a name or a type that is not in the table
// does not compile.
//
//   Message<kHeartbeat> heartbeat;
//   heartbeat.set<"type">(kGroundStation).set<"custom_mode">(4);
//   const float roll = Message<kAttitude>(packet).get<"roll">();
#pragma once

#include <algorithm>
#include <bit>
#include <cstring>
#include <string>
#include <string_view>
#include <type_traits>

#include "framework/mavlink/packet.h"

namespace lapwing::mavlink {

// A field's name as a template argument.
template <std::size_t N>
struct FieldName {
  char text[N]{};
  consteval FieldName(const char (&name)[N]) { std::copy_n(name, N, text); }
  constexpr std::string_view view() const { return {text, N - 1}; }
};

template <FieldType Type>
constexpr auto element_of() {
  if constexpr (Type == FieldType::u8) return std::uint8_t{};
  if constexpr (Type == FieldType::i8) return std::int8_t{};
  if constexpr (Type == FieldType::u16) return std::uint16_t{};
  if constexpr (Type == FieldType::i16) return std::int16_t{};
  if constexpr (Type == FieldType::u32) return std::uint32_t{};
  if constexpr (Type == FieldType::i32) return std::int32_t{};
  if constexpr (Type == FieldType::u64) return std::uint64_t{};
  if constexpr (Type == FieldType::i64) return std::int64_t{};
  if constexpr (Type == FieldType::f32) return float{};
  if constexpr (Type == FieldType::f64) return double{};
  if constexpr (Type == FieldType::text) return char{};
}

// Numbers of the wire are little-endian; so is every machine that this is built for.
static_assert(std::endian::native == std::endian::little);

template <std::uint32_t Id>
class Message {
  static constexpr const MessageEntry& kEntry = *find_message(Id);
  template <FieldName Name>
  static constexpr std::size_t kField = [] {
    constexpr std::size_t found = kEntry.field(Name.view());
    static_assert(found < kEntry.fields.size(), "the message has no field of this name");
    return found;
  }();
  template <FieldName Name>
  using Element = decltype(element_of<kEntry.fields[kField<Name>].type>());

 public:
  Message() = default;
  // Reads a packet of this message; what it does not bring is zero.
  explicit Message(const Packet& packet) : payload_(packet.payload) {}

  // Element `index` of the field.
  template <FieldName Name>
  Element<Name> get(std::size_t index = 0) const {
    Element<Name> value;
    std::memcpy(&value, payload_.data() + place<Name>(index), sizeof value);
    return value;
  }
  template <FieldName Name>
  Message& set(std::type_identity_t<Element<Name>> value, std::size_t index = 0) {
    std::memcpy(payload_.data() + place<Name>(index), &value, sizeof value);
    return *this;
  }
  // A field of characters, to its first zero. What does not fit is left out.
  template <FieldName Name>
  std::string text() const {
    const char* begin = reinterpret_cast<const char*>(payload_.data()) + place<Name>(0);
    return {begin, strnlen(begin, kEntry.fields[kField<Name>].elements())};
  }
  template <FieldName Name>
  Message& set_text(std::string_view text) {
    const std::size_t most = kEntry.fields[kField<Name>].elements();
    std::fill_n(payload_.begin() + place<Name>(0), most, std::uint8_t{0});
    std::copy_n(text.begin(), std::min(text.size(), most), payload_.begin() + place<Name>(0));
    return *this;
  }

  // To be sent; whoever sends it fills in system, component and sequence.
  Packet packet() const {
    Packet packet;
    packet.message = Id;
    packet.length = kEntry.length;
    packet.payload = payload_;
    return packet;
  }

 private:
  template <FieldName Name>
  static std::ptrdiff_t place(std::size_t index) {
    constexpr const FieldEntry& field = kEntry.fields[kField<Name>];
    return static_cast<std::ptrdiff_t>(kEntry.offsets[kField<Name>] +
                                       size_of(field.type) *
                                           std::min<std::size_t>(index, field.elements() - 1));
  }
  std::array<std::uint8_t, kMostPayload> payload_{};
};

}  // namespace lapwing::mavlink
