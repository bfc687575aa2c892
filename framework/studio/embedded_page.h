// SPDX-License-Identifier: Apache-2.0
// Files of the page, as the build embeds them (embed_page.cmake). Internal to this room.
#pragma once

#include <span>
#include <string_view>

namespace lapwing {

struct EmbeddedFile {
  std::string_view path;  // "/studio.js"
  const char *begin, *end;
};

std::span<const EmbeddedFile> embedded_page();

}  // namespace lapwing
