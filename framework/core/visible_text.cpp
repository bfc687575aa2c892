// SPDX-License-Identifier: Apache-2.0
#include "framework/core/visible_text.h"

#include <cstdint>
#include <cstdio>

namespace lapwing {

namespace {

struct DecodedCharacter {
  std::uint32_t code = 0;
  std::size_t bytes = 0;  // 0: no UTF-8
};

DecodedCharacter decoded_character(std::string_view text) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const unsigned char first = byte(0);
  if (first < 0x80) return {first, 1};
  const std::size_t bytes = first >= 0xf0 ? 4 : first >= 0xe0 ? 3 : 2;
  if (first < 0xc2 || first > 0xf4 || text.size() < bytes) return {};
  std::uint32_t code = first & (0x7fu >> bytes);
  for (std::size_t i = 1; i < bytes; ++i) {
    if ((byte(i) & 0xc0) != 0x80) return {};
    code = code << 6 | (byte(i) & 0x3f);
  }
  const bool overlong = (bytes == 3 && code < 0x800) || (bytes == 4 && code < 0x10000);
  const bool surrogate = code >= 0xd800 && code <= 0xdfff;
  return overlong || surrogate || code > 0x10ffff ? DecodedCharacter{}
                                                  : DecodedCharacter{code, bytes};
}

bool is_control(std::uint32_t code) {
  return code < 0x20 || (code >= 0x7f && code < 0xa0);
}

// Marks that let text appear in another order than it has, and separators of lines.
bool turns_direction(std::uint32_t code) {
  return code == 0x61c || code == 0x200e || code == 0x200f || (code >= 0x2028 && code <= 0x202e) ||
         (code >= 0x2066 && code <= 0x2069);
}

std::string escaped(const char* format, unsigned code) {
  char text[16];
  std::snprintf(text, sizeof text, format, code);
  return text;
}

std::string visible(std::string_view text, bool one_line) {
  std::string out;
  out.reserve(text.size());
  while (!text.empty()) {
    const DecodedCharacter next = decoded_character(text);
    const std::size_t bytes = next.bytes > 0 ? next.bytes : 1;
    if (next.bytes == 0)
      out += escaped("\\x%02x", static_cast<unsigned char>(text[0]));
    else if (next.code == '\n' || next.code == '\t')
      out += one_line ? (next.code == '\n' ? "\\n" : "\\t") : std::string(1, text[0]);
    else if (is_control(next.code))
      out += escaped("\\x%02x", next.code);
    else if (turns_direction(next.code))
      out += escaped("\\u%04x", next.code);
    else
      out += text.substr(0, bytes);
    text.remove_prefix(bytes);
  }
  return out;
}

}  // namespace

std::string visible_text(std::string_view text) {
  return visible(text, false);
}

std::string visible_line(std::string_view text) {
  return visible(text, true);
}

}  // namespace lapwing
