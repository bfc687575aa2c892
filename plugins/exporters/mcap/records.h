// SPDX-License-Identifier: Apache-2.0
// Records of MCAP 0, without chunks and compression: what an exporter writes, and what it reads
// back.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace lapwing::mcap_file {

class Writer {
 public:
  explicit Writer(const std::string& library);

  // A topic of JSON messages with its schema (JSON Schema). Its number.
  std::uint16_t add_channel(const std::string& topic, const std::string& schema_name,
                            const std::string& schema);
  // `time`: ns. Messages of a channel come in the order of their times.
  void add_message(std::uint16_t channel, std::uint64_t time, const std::string& json);
  void add_metadata(const std::string& name, const std::map<std::string, std::string>& values);
  // The whole file, with its summary and checksums.
  std::string finish();

 private:
  struct Channel {
    std::string topic, schema_name, schema;
    std::uint64_t messages = 0;
    std::uint32_t sequence = 0;
  };
  std::string schema_record(std::uint16_t number) const;
  std::string channel_record(std::uint16_t number) const;

  std::string data_;
  std::vector<Channel> channels_;
  std::uint64_t first_ = 0, last_ = 0;
  std::uint32_t metadata_ = 0;
};

struct Message {
  std::uint64_t time = 0;  // ns
  std::string json;
};
// The messages of a topic, in their order. InputError for bytes that are no such file.
std::vector<Message> messages_of(const std::string& file, const std::string& topic);

}  // namespace lapwing::mcap_file
