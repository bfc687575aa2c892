// SPDX-License-Identifier: Apache-2.0
#include "framework/mavlink/message_value.h"

#include <cmath>
#include <cstring>
#include <limits>

namespace lapwing::mavlink {

namespace {

// Calls `take` with an element of the C++ type of the field.
template <class Take>
auto with_element(FieldType type, Take take) {
  switch (type) {
    case FieldType::u8:
      return take(std::uint8_t{});
    case FieldType::i8:
      return take(std::int8_t{});
    case FieldType::u16:
      return take(std::uint16_t{});
    case FieldType::i16:
      return take(std::int16_t{});
    case FieldType::u32:
      return take(std::uint32_t{});
    case FieldType::i32:
      return take(std::int32_t{});
    case FieldType::u64:
      return take(std::uint64_t{});
    case FieldType::i64:
      return take(std::int64_t{});
    case FieldType::f32:
      return take(float{});
    case FieldType::f64:
      return take(double{});
    default:
      return take(char{});
  }
}

Value number_value(double number) {
  if (std::isnan(number)) return "nan";
  if (std::isinf(number)) return number > 0 ? "inf" : "-inf";
  return number;
}

double number_of(const Value& value) {
  if (!value.is_text()) return value.as_number();
  const std::string& text = value.as_text();
  if (text == "nan") return std::numeric_limits<double>::quiet_NaN();
  if (text == "inf") return std::numeric_limits<double>::infinity();
  if (text == "-inf") return -std::numeric_limits<double>::infinity();
  throw InputError(value.origin(), "expected a number, \"nan\", \"inf\" or \"-inf\"");
}

Value element_value(FieldType type, const std::uint8_t* place) {
  return with_element(type, [place](auto element) -> Value {
    std::memcpy(&element, place, sizeof element);
    if constexpr (std::is_floating_point_v<decltype(element)>) {
      return number_value(element);
    } else if constexpr (sizeof element == 8) {
      // A number of JSON holds 53 bits.
      return static_cast<double>(element);
    } else {
      return static_cast<std::int64_t>(element);
    }
  });
}

void set_element(const FieldEntry& field, const Value& value, std::uint8_t* place) {
  with_element(field.type, [&](auto element) {
    using Element = decltype(element);
    const double number = number_of(value);
    if constexpr (std::is_floating_point_v<Element>) {
      element = static_cast<Element>(number);
    } else {
      const auto least = static_cast<double>(std::numeric_limits<Element>::min());
      const auto most = static_cast<double>(std::numeric_limits<Element>::max());
      const bool below = sizeof element == 8 ? number < most : number <= most;
      if (!(number >= least && below) || number != std::trunc(number))
        throw InputError(value.origin(),
                         std::string(field.name) + ": no " + std::string(name_of(field.type)));
      element = static_cast<Element>(number);
    }
    std::memcpy(place, &element, sizeof element);
  });
}

void set_field(const MessageEntry& entry, std::size_t i, const Value& value, Packet& packet) {
  const FieldEntry& field = entry.fields[i];
  std::uint8_t* place = packet.payload.data() + entry.offsets[i];
  if (field.type == FieldType::text) {
    const std::string& text = value.as_text();
    if (text.size() > field.elements())
      throw InputError(value.origin(), std::string(field.name) + ": longer than its field");
    std::memcpy(place, text.data(), text.size());
    return;
  }
  if (field.array == 0) return set_element(field, value, place);
  const Value::List& list = value.as_list();
  if (list.size() != field.array)
    throw InputError(value.origin(), std::string(field.name) + ": expected " +
                                         std::to_string(field.array) + " numbers");
  for (std::size_t k = 0; k < list.size(); ++k)
    set_element(field, list[k], place + k * size_of(field.type));
}

Value field_value(const MessageEntry& entry, std::size_t i, const Packet& packet) {
  const FieldEntry& field = entry.fields[i];
  const std::uint8_t* place = packet.payload.data() + entry.offsets[i];
  if (field.type == FieldType::text) {
    const char* begin = reinterpret_cast<const char*>(place);
    return std::string(begin, strnlen(begin, field.elements()));
  }
  if (field.array == 0) return element_value(field.type, place);
  Value list = Value::list();
  for (std::size_t k = 0; k < field.array; ++k)
    list.push_back(element_value(field.type, place + k * size_of(field.type)));
  return list;
}

}  // namespace

Value to_value(const Packet& packet) {
  const MessageEntry* entry = find_message(packet.message);
  if (!entry)
    throw Error("MAVLink message " + std::to_string(packet.message) + " is not in the table");
  Value value = Value::map();
  value.set("message", std::string(entry->name));
  value.set("system", static_cast<int>(packet.system));
  value.set("component", static_cast<int>(packet.component));
  value.set("sequence", static_cast<int>(packet.sequence));
  Value& fields = value.set("fields", Value::map());
  for (std::size_t i = 0; i < entry->fields.size(); ++i)
    fields.set(entry->fields[i].name, field_value(*entry, i, packet));
  return value;
}

Packet packet_from_value(const Value& value) {
  const std::string& name = value.at("message").as_text();
  const MessageEntry* entry = find_message(std::string_view(name));
  if (!entry) throw InputError(value.origin(), "'" + name + "' is not in the table of messages");
  Packet packet;
  packet.message = entry->id;
  packet.length = entry->length;
  const auto byte = [&](const char* key) {
    const Value* found = value.find(key);
    const std::int64_t number = found ? found->as_integer() : 0;
    if (number < 0 || number > 255)
      throw InputError(value.origin(), std::string(key) + ": expected 0 to 255");
    return static_cast<std::uint8_t>(number);
  };
  packet.system = byte("system");
  packet.component = byte("component");
  packet.sequence = byte("sequence");
  if (const Value* fields = value.find("fields")) {
    for (const auto& [key, content] : fields->as_map()) {
      const std::size_t i = entry->field(key);
      if (i == entry->fields.size())
        throw InputError(content.origin(), name + " has no field '" + key + "'");
      set_field(*entry, i, content, packet);
    }
  }
  return packet;
}

}  // namespace lapwing::mavlink
