// SPDX-License-Identifier: Apache-2.0
// The messages of a DataFlash log of ArduPilot, which describes its own formats.
// https://ardupilot.org/copter/docs/logmessages.html, AP_Logger/LogStructure.h
#pragma once

#include <array>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace lapwing::dataflash {

struct Column {
  std::string label;  // "Lat"
  char type = 'B';    // of FMT: 'L' is a latitude in 1e-7 degrees
  std::size_t offset = 0;
  double factor = 1;  // of the type ('c', 'L', ...) or of FMTU's multiplier
  char unit = 0;      // of FMTU: 'd' degrees; 0: not stated
};

// A kind of message, as FMT and FMTU state it.
struct Kind {
  std::string name;      // "GPS"
  std::size_t size = 0;  // bytes, with the head of three
  std::vector<Column> columns;

  // The place of a column; -1 where there is none.
  int column(std::string_view label) const;
};

// The number, scaled; not a number for a text. `body` is a message without its head.
double value_of(const Column& column, std::string_view body);
// The text of a column 'n', 'N' or 'Z' up to its first zero.
std::string text_of(const Column& column, std::string_view body);

struct Outcome {
  std::size_t read = 0;     // bytes of messages that were understood
  std::string damage;       // what is wrong; empty: nothing
  std::size_t skipped = 0;  // bytes between messages
};

// Whether the bytes begin with the description of FMT itself.
bool is_dataflash(std::string_view bytes);

// Calls `take` with the number of a kind (FMT's Type), the kind and the body of each message that
// is described, FMT, FMTU, UNIT and MULT excepted. A whole message that cannot be used is passed by
// its stated length; where a head or a length is wrong, reading goes on at the next message that
// has another one behind it. InputError for bytes that are no such log.
Outcome read_messages(
    std::string_view bytes,
    const std::function<void(int number, const Kind& kind, std::string_view body)>& take);

}  // namespace lapwing::dataflash
