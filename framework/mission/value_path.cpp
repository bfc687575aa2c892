// SPDX-License-Identifier: Apache-2.0
#include "framework/mission/value_path.h"

#include <charconv>

namespace lapwing {

const Value* at_path(const Value& root, std::string_view path) {
  const Value* at = &root;
  while (!path.empty() && at) {
    const std::size_t end = path.find_first_of(".[]");
    const std::string_view part = path.substr(0, end);
    if (at->is_list() && !part.empty()) {
      std::size_t place = 0;
      const auto [last, error] = std::from_chars(part.data(), part.data() + part.size(), place);
      const bool there = error == std::errc{} && last == part.data() + part.size() && place >= 1 &&
                         place <= at->as_list().size();
      at = there ? &at->as_list()[place - 1] : nullptr;
    } else if (!part.empty()) {
      at = at->find(part);
    }
    path = end == path.npos ? std::string_view() : path.substr(end + 1);
  }
  return at;
}

const Value& innermost_at(const Value& root, std::string_view path) {
  while (true) {
    if (const Value* value = at_path(root, path)) return *value;
    const std::size_t end = path.find_last_of(".[");
    if (end == path.npos) return root;
    path = path.substr(0, end);
  }
}

}  // namespace lapwing
