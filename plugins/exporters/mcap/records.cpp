// SPDX-License-Identifier: Apache-2.0
// Source: https://mcap.dev/spec
#include "plugins/exporters/mcap/records.h"

#include <algorithm>

#include "framework/core/error.h"

namespace lapwing::mcap_file {
namespace {

const std::string kMagic("\x89MCAP0\r\n", 8);
constexpr std::uint8_t kHeader = 1, kFooter = 2, kSchema = 3, kChannel = 4, kMessage = 5;
constexpr std::uint8_t kStatistics = 11, kMetadata = 12, kDataEnd = 15;

template <class T>
void put(std::string& out, T number) {
  for (std::size_t i = 0; i < sizeof(T); ++i)
    out += static_cast<char>((static_cast<std::uint64_t>(number) >> (8 * i)) & 0xff);
}

void put_text(std::string& out, const std::string& text) {
  put(out, static_cast<std::uint32_t>(text.size()));
  out += text;
}

std::string map_bytes(const std::map<std::string, std::string>& values) {
  std::string entries, out;
  for (const auto& [key, value] : values) {
    put_text(entries, key);
    put_text(entries, value);
  }
  put_text(out, entries);
  return out;
}

std::string record(std::uint8_t kind, const std::string& content) {
  std::string out(1, static_cast<char>(kind));
  put(out, static_cast<std::uint64_t>(content.size()));
  return out + content;
}

std::uint32_t checksum(const std::string& bytes) {
  std::uint32_t crc = 0xffffffff;
  for (const char c : bytes) {
    crc ^= static_cast<unsigned char>(c);
    for (int i = 0; i < 8; ++i) crc = (crc >> 1) ^ ((crc & 1) ? 0xedb88320u : 0u);
  }
  return ~crc;
}

std::uint64_t number_at(const std::string& bytes, std::size_t at, std::size_t count) {
  if (at + count > bytes.size()) throw InputError("mcap: the file is cut short");
  std::uint64_t number = 0;
  for (std::size_t i = count; i-- > 0;)
    number = 256 * number + static_cast<unsigned char>(bytes[at + i]);
  return number;
}

std::string text_at(const std::string& bytes, std::size_t& at) {
  const auto size = static_cast<std::size_t>(number_at(bytes, at, 4));
  if (at + 4 + size > bytes.size()) throw InputError("mcap: the file is cut short");
  at += 4 + size;
  return bytes.substr(at - size, size);
}

}  // namespace

Writer::Writer(const std::string& library) : data_(kMagic) {
  std::string header;
  put_text(header, "");
  put_text(header, library);
  data_ += record(kHeader, header);
}

std::string Writer::schema_record(std::uint16_t number) const {
  const Channel& channel = channels_[number - 1u];
  std::string content;
  put(content, number);
  put_text(content, channel.schema_name);
  put_text(content, "jsonschema");
  put_text(content, channel.schema);
  return record(kSchema, content);
}

std::string Writer::channel_record(std::uint16_t number) const {
  std::string content;
  put(content, number);
  put(content, number);  // of its schema
  put_text(content, channels_[number - 1u].topic);
  put_text(content, "json");
  return record(kChannel, content + map_bytes({}));
}

std::uint16_t Writer::add_channel(const std::string& topic, const std::string& schema_name,
                                  const std::string& schema) {
  channels_.push_back({topic, schema_name, schema});
  const auto number = static_cast<std::uint16_t>(channels_.size());
  data_ += schema_record(number) + channel_record(number);
  return number;
}

void Writer::add_message(std::uint16_t channel, std::uint64_t time, const std::string& json) {
  Channel& of = channels_[channel - 1u];
  const bool first = std::all_of(channels_.begin(), channels_.end(),
                                 [](const Channel& c) { return c.messages == 0; });
  first_ = first ? time : std::min(first_, time);
  last_ = std::max(last_, time);
  std::string content;
  put(content, channel);
  put(content, of.sequence++);
  put(content, time);
  put(content, time);
  data_ += record(kMessage, content + json);
  ++of.messages;
}

void Writer::add_metadata(const std::string& name,
                          const std::map<std::string, std::string>& values) {
  std::string content;
  put_text(content, name);
  data_ += record(kMetadata, content + map_bytes(values));
  ++metadata_;
}

std::string Writer::finish() {
  std::string end;
  put(end, checksum(data_));
  data_ += record(kDataEnd, end);
  const auto place = static_cast<std::uint64_t>(data_.size());
  std::string summary, counts;
  std::uint64_t messages = 0;
  for (std::size_t i = 0; i < channels_.size(); ++i) {
    const auto number = static_cast<std::uint16_t>(i + 1);
    summary += schema_record(number) + channel_record(number);
    put(counts, number);
    put(counts, channels_[i].messages);
    messages += channels_[i].messages;
  }
  std::string statistics;
  put(statistics, messages);
  put(statistics, static_cast<std::uint16_t>(channels_.size()));
  put(statistics, static_cast<std::uint32_t>(channels_.size()));
  put(statistics, std::uint32_t{0});  // attachments
  put(statistics, metadata_);
  put(statistics, std::uint32_t{0});  // chunks
  put(statistics, first_);
  put(statistics, last_);
  put_text(statistics, counts);
  summary += record(kStatistics, statistics);
  std::string footer;
  put(footer, place);
  put(footer, std::uint64_t{0});  // no offsets of groups
  // The checksum covers the summary and the footer up to here.
  std::string begun(1, static_cast<char>(kFooter));
  put(begun, std::uint64_t{20});
  put(footer, checksum(summary + begun + footer));
  return data_ + summary + record(kFooter, footer) + kMagic;
}

std::vector<Message> messages_of(const std::string& file, const std::string& topic) {
  if (file.compare(0, kMagic.size(), kMagic) != 0) throw InputError("mcap: no MCAP file");
  std::vector<Message> found;
  std::uint64_t channel = 0;
  for (std::size_t at = kMagic.size(); at + 9 <= file.size();) {
    const auto kind = static_cast<std::uint8_t>(file[at]);
    const auto size = static_cast<std::size_t>(number_at(file, at + 1, 8));
    const std::size_t content = at + 9;
    if (size > file.size() - content) throw InputError("mcap: the file is cut short");
    if (kind == kChannel) {
      std::size_t name = content + 4;
      if (text_at(file, name) == topic) channel = number_at(file, content, 2);
    }
    if (kind == kMessage && channel > 0 && number_at(file, content, 2) == channel)
      found.push_back({number_at(file, content + 6, 8), file.substr(content + 22, size - 22)});
    if (kind == kDataEnd) return found;
    at = content + size;
  }
  throw InputError("mcap: the data has no end");
}

}  // namespace lapwing::mcap_file
