// SPDX-License-Identifier: Apache-2.0
// JSON text to and from Value.
#pragma once

#include <functional>
#include <string>
#include <string_view>

#include "framework/core/value.h"

namespace lapwing {

// `indent` < 0 writes one line. Numbers are written shortest round-trip, so equal values give equal
// bytes. Throws Error on NaN and infinity, naming the key path: JSON cannot hold them.
std::string to_json(const Value& value, int indent = 2);

// The first byte of a text that is no UTF-8, or npos.
std::size_t first_invalid_utf8(std::string_view text);
// Whether JSON can hold a text, and the same with every byte that it cannot as U+FFFD.
bool is_utf8(std::string_view text);
std::string as_utf8(std::string_view text);

// Throws InputError naming `source`, line and column on malformed or truncated text, and on
// repeated keys. `hold` is told every megabyte how many bytes the values take so far, about; what
// it throws ends the reading.
using HoldValues = std::function<void(std::size_t)>;
Value from_json(std::string_view text, const std::string& source, const HoldValues& hold = {});

}  // namespace lapwing
