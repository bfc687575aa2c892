// SPDX-License-Identifier: Apache-2.0
#include "plugins/flight_logs/ulog/ulog_formats.h"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "framework/core/error.h"
#include "framework/flight_log/byte_reader.h"

namespace lapwing::ulog {
namespace {

constexpr std::size_t kLongestMessage = 65535;  // bytes
constexpr int kDeepest = 16;
constexpr std::size_t kLongestName = 255;     // of a field with all that it is in
constexpr std::size_t kMostFields = 1 << 17;  // of all formats together

struct Known {
  const char* name;
  NumberType type;
  std::size_t size;
};
constexpr Known kKnown[] = {{"int8_t", NumberType::i8, 1},    {"uint8_t", NumberType::u8, 1},
                            {"int16_t", NumberType::i16, 2},  {"uint16_t", NumberType::u16, 2},
                            {"int32_t", NumberType::i32, 4},  {"uint32_t", NumberType::u32, 4},
                            {"int64_t", NumberType::i64, 8},  {"uint64_t", NumberType::u64, 8},
                            {"float", NumberType::f32, 4},    {"double", NumberType::f64, 8},
                            {"bool", NumberType::boolean, 1}, {"char", NumberType::character, 1}};

const Known* known_named(std::string_view name) {
  const auto found = std::find_if(std::begin(kKnown), std::end(kKnown),
                                  [&](const Known& k) { return name == k.name; });
  return found == std::end(kKnown) ? nullptr : found;
}

std::size_t size_of(NumberType type) {
  return std::find_if(std::begin(kKnown), std::end(kKnown),
                      [&](const Known& k) { return k.type == type; })
      ->size;
}

[[noreturn]] void refuse(std::string_view definition) {
  throw InputError("the format '" + std::string(definition.substr(0, 60)) +
                   "' is not of the form NAME:TYPE FIELD;TYPE[N] FIELD;...");
}

template <class T>
double read(std::string_view bytes, std::size_t at) {
  const auto number = number_in<T>(bytes, at);
  return number ? static_cast<double>(*number) : NAN;
}

}  // namespace

std::optional<Number> Format::number(std::string_view name) const {
  const std::size_t open = name.ends_with(']') ? name.rfind('[') : name.npos;
  std::size_t element = 0;
  bool indexed = open != name.npos;
  if (indexed) {
    const char* last = name.data() + name.size() - 1;
    const auto [after, error] = std::from_chars(name.data() + open + 1, last, element);
    indexed = error == std::errc{} && after == last;
  }
  for (const Field& field : fields) {
    if (field.count == 0 && field.name == name) return field.first;
    if (indexed && element < field.count && field.name == name.substr(0, open))
      return Number{field.first.type, field.first.offset + element * size_of(field.first.type)};
  }
  return {};
}

double value_of(const Number& number, std::string_view bytes) {
  switch (number.type) {
    case NumberType::i8:
      return read<std::int8_t>(bytes, number.offset);
    case NumberType::u8:
    case NumberType::boolean:
    case NumberType::character:
      return read<std::uint8_t>(bytes, number.offset);
    case NumberType::i16:
      return read<std::int16_t>(bytes, number.offset);
    case NumberType::u16:
      return read<std::uint16_t>(bytes, number.offset);
    case NumberType::i32:
      return read<std::int32_t>(bytes, number.offset);
    case NumberType::u32:
      return read<std::uint32_t>(bytes, number.offset);
    case NumberType::i64:
      return read<std::int64_t>(bytes, number.offset);
    case NumberType::u64:
      return read<std::uint64_t>(bytes, number.offset);
    case NumberType::f32:
      return read<float>(bytes, number.offset);
    case NumberType::f64:
      return read<double>(bytes, number.offset);
  }
  return NAN;
}

void Formats::add(std::string_view definition) {
  const std::size_t colon = definition.find(':');
  if (colon == definition.npos || colon == 0) refuse(definition);
  std::vector<Member> members;
  std::string_view rest = definition.substr(colon + 1);
  while (!rest.empty()) {
    const std::size_t end = rest.find(';');
    const std::string_view part = rest.substr(0, end);
    rest = end == rest.npos ? std::string_view() : rest.substr(end + 1);
    if (part.empty()) continue;
    const std::size_t blank = part.find(' ');
    if (blank == part.npos || blank == 0 || blank + 1 == part.size()) refuse(definition);
    Member member{std::string(part.substr(0, blank)), std::string(part.substr(blank + 1)), 0};
    if (const std::size_t open = member.type.find('['); open != member.type.npos) {
      const char* first = member.type.data() + open + 1;
      const char* last = member.type.data() + member.type.size();
      const auto [after, error] = std::from_chars(first, last, member.count);
      if (error != std::errc{} || after == last || *after != ']' || member.count == 0 ||
          member.count > kLongestMessage)
        refuse(definition);
      member.type.resize(open);
    }
    members.push_back(std::move(member));
  }
  if (members.empty()) refuse(definition);
  const std::string name(definition.substr(0, colon));
  if (resolved_.count(name)) return;  // it is in use
  defined_[name] = std::move(members);
}

const Format& Formats::resolved(const std::string& name) {
  const auto known = resolved_.find(name);
  if (known != resolved_.end()) return known->second;
  Format format;
  append(name, "", 0, format);
  // What pads the end is not written.
  while (!format.fields.empty() && format.fields.back().name.starts_with("_padding"))
    format.fields.pop_back();
  format.size = 0;
  for (const Field& field : format.fields) {
    const std::size_t elements = std::max<std::size_t>(1, field.count);
    format.size = std::max(format.size, field.first.offset + elements * size_of(field.first.type));
  }
  return resolved_[name] = std::move(format);
}

// `into.size` is the place of the next field.
void Formats::append(const std::string& name, const std::string& prefix, int depth, Format& into) {
  const auto found = defined_.find(name);
  if (found == defined_.end())
    throw InputError("the format '" + name.substr(0, 60) + "' is not defined");
  if (depth > kDeepest) throw InputError("the format '" + name.substr(0, 60) + "' contains itself");
  for (const Member& member : found->second) {
    const Known* known = known_named(member.type);
    if (prefix.size() + member.name.size() > kLongestName)
      throw InputError("the format '" + name.substr(0, 60) + "' has a name of more than 255 bytes");
    const std::string all = prefix + member.name;
    const std::size_t count = std::max<std::size_t>(1, member.count);
    if (into.size + count * (known ? known->size : 1) > kLongestMessage)
      throw InputError("the format '" + name.substr(0, 60) +
                       "' is longer than the 65535 bytes of a message");
    // An array of formats is laid out element by element.
    const std::size_t times = known ? 1 : count;
    for (std::size_t k = 0; k < times; ++k) {
      // A file may name a format that is refused again and again: what was laid out of it counts.
      if (++fields_ > kMostFields)
        throw InputError("the formats have more than 2^17 fields together");
      if (known) {
        into.fields.push_back({all, {known->type, into.size}, member.count});
        into.size += count * known->size;
      } else {
        append(member.type, all + (member.count > 0 ? "[" + std::to_string(k) + "]." : "."),
               depth + 1, into);
      }
    }
  }
}

}  // namespace lapwing::ulog
