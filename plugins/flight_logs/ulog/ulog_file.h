// SPDX-License-Identifier: Apache-2.0
// The records of a ULog file, in the order of the file.
#pragma once

#include <functional>
#include <map>
#include <string>
#include <string_view>

#include "plugins/flight_logs/ulog/ulog_formats.h"

namespace lapwing::ulog {

// A topic that the file logs; several instances of one have numbers.
struct Topic {
  std::string name;
  int instance = 0;
  const Format* format = nullptr;  // as long as the Records live
};

// What is told of the file while it is read. `bytes` of a message holds no id.
struct Listener {
  std::function<void(const Topic&, std::string_view bytes)> data;
  std::function<void(double time, std::string_view text)> message;                // s
  std::function<void(double time, double duration)> dropout;                      // s
  std::function<void(std::string_view key, std::string_view value)> information;  // "char[3] a"
};

struct Outcome {
  std::size_t read = 0;     // bytes of the head and of records that were understood
  std::string damage;       // what is wrong with the rest; empty: nothing
  std::size_t skipped = 0;  // bytes in the middle that hold no record
};

bool is_ulog(std::string_view bytes);

// Reads all that can be read. A whole record that cannot be used is passed by its stated length;
// where a length or a head is wrong, and where a record that lost bytes reaches into others,
// reading goes on at the next place where a record begins beyond doubt. Takes O(n log n) for n
// bytes, besides the listener. InputError for bytes that are no ULog, and for a file that needs
// what this version does not know (incompatible flags).
Outcome read_records(std::string_view bytes, Formats& formats, const Listener& listener);

}  // namespace lapwing::ulog
