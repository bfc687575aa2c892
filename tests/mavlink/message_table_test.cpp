// SPDX-License-Identifier: Apache-2.0
// The table of messages: known layouts, and the published definitions where they are there.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <map>
#include <regex>

#include "framework/core/files.h"
#include "framework/mavlink/message.h"

namespace lapwing::mavlink {
namespace {

constexpr const MessageEntry& entry_of(std::string_view name) {
  return *find_message(name);
}

// Figures that MAVLink's generators publish (MAVLINK_MSG_ID_*_CRC, *_LEN, *_MIN_LEN).
static_assert(entry_of("HEARTBEAT").crc_extra == 50);
static_assert(entry_of("HEARTBEAT").length == 9);
static_assert(entry_of("HEARTBEAT").offsets[3] == 0, "custom_mode is the widest");
static_assert(entry_of("SYS_STATUS").crc_extra == 124);
static_assert(entry_of("SYS_STATUS").base_length == 31);
static_assert(entry_of("SYS_STATUS").length == 43);
static_assert(entry_of("ATTITUDE").crc_extra == 39);
static_assert(entry_of("GLOBAL_POSITION_INT").crc_extra == 104);
static_assert(entry_of("COMMAND_LONG").crc_extra == 152);
static_assert(entry_of("COMMAND_ACK").crc_extra == 143);
static_assert(entry_of("SET_POSITION_TARGET_LOCAL_NED").crc_extra == 143);
static_assert(entry_of("SET_POSITION_TARGET_LOCAL_NED").length == 53);
static_assert(entry_of("TIMESYNC").crc_extra == 34);
static_assert(entry_of("STATUSTEXT").crc_extra == 83);
static_assert(find_message(kHeartbeat) == &entry_of("HEARTBEAT"));
static_assert(find_message(4u) == nullptr);

TEST(MessageTable, NamesAndNumbersAreUnique) {
  std::map<std::uint32_t, int> ids;
  std::map<std::string_view, int> names;
  for (const MessageEntry& entry : kMessages) {
    EXPECT_EQ(++ids[entry.id], 1) << entry.name;
    EXPECT_EQ(++names[entry.name], 1) << entry.name;
  }
}

// The messages of the published definitions, as text between <message> and </message>.
struct Definitions {
  std::map<std::string, std::pair<std::uint32_t, std::string>> messages;
};

Definitions read_definitions(const std::filesystem::path& folder) {
  Definitions all;
  static const std::regex kHead("<message ([^>]*)>"), kId("id=\"([0-9]+)\""),
      kName("name=\"([A-Z0-9_]+)\"");
  for (const char* file : {"minimal.xml", "standard.xml", "common.xml"}) {
    std::string text = read_file(folder / file);
    for (std::size_t at = 0; (at = text.find("<!--", at)) != text.npos;)
      text.erase(at, text.find("-->", at) - at);
    for (std::sregex_iterator it(text.begin(), text.end(), kHead), end; it != end; ++it) {
      const std::string head = (*it)[1];
      std::smatch id, name;
      if (!std::regex_search(head, id, kId) || !std::regex_search(head, name, kName)) continue;
      const auto begin = static_cast<std::size_t>(it->position() + it->length());
      all.messages[name[1]] = {static_cast<std::uint32_t>(std::stoul(id[1])),
                               text.substr(begin, text.find("</message>", begin) - begin)};
    }
  }
  return all;
}

struct DefinedField {
  std::string name, type, unit;
  int array = 0;
  bool extension = false;
};

std::vector<DefinedField> defined_fields(const std::string& body) {
  static const std::regex kTag("<(field|extensions)([^>]*)>"),
      kType("type=\"(\\w+)(\\[(\\d+)\\])?\""), kName(" name=\"(\\w+)\""),
      kUnit("units=\"([^\"]*)\"");
  std::vector<DefinedField> fields;
  bool extension = false;
  for (std::sregex_iterator it(body.begin(), body.end(), kTag), end; it != end; ++it) {
    if ((*it)[1] == "extensions") {
      extension = true;
      continue;
    }
    const std::string attributes = (*it)[2];
    std::smatch match;
    DefinedField field;
    field.extension = extension;
    if (std::regex_search(attributes, match, kType)) {
      field.type = match[1] == "uint8_t_mavlink_version" ? "uint8_t" : match[1].str();
      if (match[3].matched) field.array = std::stoi(match[3]);
    }
    if (std::regex_search(attributes, match, kName)) field.name = match[1];
    if (std::regex_search(attributes, match, kUnit)) field.unit = match[1];
    fields.push_back(field);
  }
  return fields;
}

// CRC_EXTRA and the order of the wire anew, from the text of the definition, with a bitwise CRC.
struct Derived {
  int crc_extra = 0;
  std::vector<std::string> order;
};

Derived derived(const std::string& name, std::vector<DefinedField> fields) {
  unsigned crc = 0xffff;
  const auto byte = [&crc](unsigned value) {
    crc ^= value;
    for (int bit = 0; bit < 8; ++bit) crc = crc & 1 ? crc >> 1 ^ 0x8408 : crc >> 1;
  };
  const auto word = [&byte](const std::string& text) {
    for (const char c : text + " ") byte(static_cast<unsigned char>(c));
  };
  static const std::map<std::string, int> kSizes{{"uint8_t", 1},  {"int8_t", 1},  {"char", 1},
                                                 {"uint16_t", 2}, {"int16_t", 2}, {"uint32_t", 4},
                                                 {"int32_t", 4},  {"float", 4},   {"uint64_t", 8},
                                                 {"int64_t", 8},  {"double", 8}};
  std::stable_sort(fields.begin(), fields.end(), [](const auto& a, const auto& b) {
    if (a.extension || b.extension) return !a.extension && b.extension;
    return kSizes.at(a.type) > kSizes.at(b.type);
  });
  Derived result;
  word(name);
  for (const DefinedField& field : fields) {
    result.order.push_back(field.name);
    if (field.extension) continue;
    word(field.type);
    word(field.name);
    if (field.array > 0) byte(static_cast<unsigned>(field.array));
  }
  result.crc_extra = static_cast<int>((crc & 0xff) ^ (crc >> 8));
  return result;
}

TEST(MessageTable, IsThatOfThePublishedDefinitions) {
  const char* data = std::getenv("LAPWING_DATA");
  const std::filesystem::path folder = std::filesystem::path(data ? data : "") / "mavlink";
  if (!data || !std::filesystem::exists(folder / "common.xml"))
    GTEST_SKIP() << "no real inputs: set LAPWING_DATA";
  const Definitions all = read_definitions(folder);
  ASSERT_GT(all.messages.size(), 150u);
  for (const MessageEntry& entry : kMessages) {
    SCOPED_TRACE(entry.name);
    const auto found = all.messages.find(std::string(entry.name));
    ASSERT_NE(found, all.messages.end());
    EXPECT_EQ(found->second.first, entry.id);
    const std::vector<DefinedField> fields = defined_fields(found->second.second);
    ASSERT_EQ(fields.size(), entry.fields.size());
    for (std::size_t i = 0; i < fields.size(); ++i) {
      EXPECT_EQ(fields[i].name, entry.fields[i].name);
      EXPECT_EQ(fields[i].type, name_of(entry.fields[i].type)) << fields[i].name;
      EXPECT_EQ(fields[i].array, entry.fields[i].array) << fields[i].name;
      EXPECT_EQ(fields[i].unit, entry.fields[i].unit) << fields[i].name;
      EXPECT_EQ(fields[i].extension, entry.fields[i].extension) << fields[i].name;
    }
    const Derived expected = derived(std::string(entry.name), fields);
    EXPECT_EQ(expected.crc_extra, entry.crc_extra);
    std::vector<std::string> order;
    in_wire_order(entry.fields, [&](std::size_t i) { order.emplace_back(entry.fields[i].name); });
    EXPECT_EQ(expected.order, order);
    for (std::size_t i = 1; i < order.size(); ++i)
      EXPECT_LT(entry.offsets[entry.field(order[i - 1])], entry.offsets[entry.field(order[i])]);
  }
}

}  // namespace
}  // namespace lapwing::mavlink
