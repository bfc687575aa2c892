// SPDX-License-Identifier: Apache-2.0
// A reader of recorded flights: the plugin kind `flight_log`.
#pragma once

#include <string>
#include <string_view>

#include "framework/core/error.h"
#include "framework/core/plugin_object.h"
#include "framework/flight_log/flight_log.h"

namespace lapwing {

class FlightLogReader : public PluginObject {
 public:
  using Interface = FlightLogReader;
  static constexpr const char* kKind = "flight_log";

  virtual ~FlightLogReader() = default;

  // Whether these bytes are a log of this format, by their content alone. Quick, and for any bytes:
  // it looks at the beginning, and throws nothing.
  virtual bool recognizes(std::string_view bytes) const = 0;

  // What the bytes hold. A file that is cut short or damaged gives what can be read of it, and says
  // so in `damage`; a log without a damage is read whole. InputError where nothing can be read: it
  // says what is wrong, where in the file (byte or line), and what would be right; the caller adds
  // the name of the file. Equal bytes give equal logs. Thread-safe.
  virtual FlightLog read(std::string_view bytes) const = 0;

  // A small log of this format, whole, of a second or more with at least `position` or `place`:
  // checks cut it at every byte.
  virtual std::string example() const = 0;
};

}  // namespace lapwing
