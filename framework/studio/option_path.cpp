// SPDX-License-Identifier: Apache-2.0
#include "framework/studio/option_path.h"

#include <algorithm>
#include <charconv>

namespace lapwing {
namespace {

bool is_key_character(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' ||
         c == '-';
}

[[noreturn]] void malformed(std::string_view text, const std::string& why) {
  throw InputError("'" + std::string(text.substr(0, 120)) + "' is not a path: " + why +
                   "; expected, for example, keyframes[2].position");
}

PathStep take_key(std::string_view& rest, std::string_view text) {
  const auto end = std::find_if_not(rest.begin(), rest.end(), is_key_character);
  const auto length = static_cast<std::size_t>(end - rest.begin());
  if (length == 0) malformed(text, "a key is missing");
  PathStep step{std::string(rest.substr(0, length)), 0};
  rest.remove_prefix(length);
  return step;
}

PathStep take_index(std::string_view& rest, std::string_view text) {
  PathStep step;
  const std::size_t end = rest.find(']');
  if (end == rest.npos) malformed(text, "'[' is never closed");
  const char *first = rest.data() + 1, *last = rest.data() + end;
  const auto [stop, error] = std::from_chars(first, last, step.index);
  if (error != std::errc{} || stop != last || step.index == 0)
    malformed(text, "entries of lists are counted from 1");
  rest.remove_prefix(end + 1);
  return step;
}

}  // namespace

bool is_path_key(std::string_view key) {
  return !key.empty() && std::all_of(key.begin(), key.end(), is_key_character);
}

OptionPath option_path(std::string_view text) {
  OptionPath path;
  std::string_view rest = text;
  for (;;) {
    path.push_back(take_key(rest, text));
    while (!rest.empty() && rest.front() == '[') path.push_back(take_index(rest, text));
    if (path.size() > kDeepestPath) malformed(text, "it is too deep");
    if (rest.empty()) return path;
    if (rest.front() != '.') malformed(text, "'.' or '[' is missing");
    rest.remove_prefix(1);
  }
}

std::string to_text(const OptionPath& path) {
  std::string text;
  for (const PathStep& step : path) {
    if (step.index > 0)
      text += "[" + std::to_string(step.index) + "]";
    else
      text += (text.empty() ? "" : ".") + step.key;
  }
  return text;
}

bool overlap(const OptionPath& a, const OptionPath& b) {
  return std::equal(
      a.begin(), a.begin() + static_cast<std::ptrdiff_t>(std::min(a.size(), b.size())), b.begin());
}

const Value* find_at(const Value& document, const OptionPath& path, std::size_t steps) {
  const Value* node = &document;
  for (std::size_t i = 0; i < steps && node; ++i) {
    const PathStep& step = path[i];
    if (step.index == 0)
      node = node->find(step.key);
    else if (node->is_list() && step.index <= node->as_list().size())
      node = &node->as_list()[step.index - 1];
    else
      node = nullptr;
  }
  return node;
}

}  // namespace lapwing
