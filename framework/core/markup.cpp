// SPDX-License-Identifier: Apache-2.0
#include "framework/core/markup.h"

#include "framework/core/json.h"

namespace lapwing {
namespace {

constexpr std::string_view kReplacement = "\xef\xbf\xbd";

std::string_view reference_of(char c) {
  switch (c) {
    case '&':
      return "&amp;";
    case '<':
      return "&lt;";
    case '>':
      return "&gt;";
    case '"':
      return "&quot;";
    case '\'':
      return "&#39;";
    default:
      return {};
  }
}

// Bytes of what markup may not hold, where `text`, of UTF-8, begins with it; else 0.
std::size_t forbidden(std::string_view text) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const unsigned char first = byte(0);
  if (first < 0x20) return first == '\n' || first == '\t' ? 0 : 1;
  if (first == 0x7f) return 1;
  if (first == 0xc2 && text.size() > 1 && byte(1) < 0xa0) return 2;
  const bool last_of_plane = text.starts_with("\xef\xbf\xbe") || text.starts_with("\xef\xbf\xbf");
  return last_of_plane ? 3 : 0;
}

}  // namespace

std::string markup_text(std::string_view text) {
  const std::string sound = as_utf8(text);
  std::string out;
  out.reserve(sound.size());
  for (std::string_view rest = sound; !rest.empty();) {
    if (const std::size_t bytes = forbidden(rest)) {
      out += kReplacement;
      rest.remove_prefix(bytes);
      continue;
    }
    const std::string_view reference = reference_of(rest[0]);
    if (reference.empty())
      out += rest[0];
    else
      out += reference;
    rest.remove_prefix(1);
  }
  return out;
}

}  // namespace lapwing
