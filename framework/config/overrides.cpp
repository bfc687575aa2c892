// SPDX-License-Identifier: Apache-2.0
#include "framework/config/overrides.h"

#include <algorithm>
#include <charconv>
#include <vector>

#include "framework/config/yaml.h"

namespace lapwing {

namespace {

// One step of a path: a key, or the number of a list entry where `index` is above 0.
struct Step {
  std::string key;
  std::size_t index = 0;
};

struct Override {
  std::vector<Step> path;
  Value value;
  Origin origin;  // "--set step=0.1"
};

// `text` with its option, as the user wrote it.
[[noreturn]] void malformed(const std::string& text, const std::string& why) {
  throw InputError(text + ": " + why);
}

// Of a long list, its beginning tells which one it is.
std::string shortened(const std::string& text) {
  constexpr std::size_t kLongest = 80;
  if (text.size() <= kLongest) return text;
  std::size_t end = kLongest - 3;
  while (end > 0 && (static_cast<unsigned char>(text[end]) & 0xc0) == 0x80) --end;  // in UTF-8
  return text.substr(0, end) + "...";
}

void set_origins(Value& value, const Origin& origin) {
  value.with_origin(origin);
  if (value.is_list()) {
    for (Value& entry : value.as_list()) set_origins(entry, origin);
  }
  if (value.is_map()) {
    for (auto& entry : value.as_map()) set_origins(entry.second, origin);
  }
}

bool is_key_letter(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' ||
         c == '-';
}

// Reads "[2]" at the start of `rest` and removes it.
Step read_index(std::string_view& rest, const std::string& text) {
  const std::size_t end = rest.find(']');
  if (end == rest.npos) malformed(text, "'[' is never closed");
  const std::string_view digits = rest.substr(1, end - 1);
  Step step;
  const auto [last, code] =
      std::from_chars(digits.data(), digits.data() + digits.size(), step.index);
  if (code != std::errc{} || last != digits.data() + digits.size() || step.index == 0) {
    malformed(text, "'" + std::string(rest.substr(0, end + 1)) +
                        "' names no list entry; entries are counted from 1");
  }
  rest.remove_prefix(end + 1);
  return step;
}

std::vector<Step> parse_path(std::string_view rest, const std::string& text) {
  std::vector<Step> path;
  for (;;) {
    const auto end = std::find_if_not(rest.begin(), rest.end(), is_key_letter);
    const auto length = static_cast<std::size_t>(end - rest.begin());
    if (length == 0) malformed(text, "a key is missing; expected key.path=value");
    const std::string key(rest.substr(0, length));
    if (!path.empty() && key.find_first_not_of("0123456789") == key.npos)
      malformed(text, "'." + key + "' is not a key; an entry of a list is written " +
                          path.back().key + "[" + key + "]");
    path.push_back({key, 0});
    rest.remove_prefix(length);
    while (!rest.empty() && rest.front() == '[') path.push_back(read_index(rest, text));
    if (rest.empty()) return path;
    if (rest.front() != '.') {
      malformed(text, std::string("'") + rest.front() + "' cannot be part of a key");
    }
    rest.remove_prefix(1);
  }
}

Override parse_override(const std::string& text, const std::string& option) {
  const std::string shown = option + " " + text;
  const std::size_t equals = text.find('=');
  if (equals == text.npos) malformed(shown, "'=' is missing; expected key.path=value");
  Override result;
  result.path = parse_path(std::string_view(text).substr(0, equals), shown);
  const std::string value = text.substr(equals + 1);
  if (value.find_first_not_of(" \t") == value.npos) {
    malformed(shown, "the value is missing; write '' for an empty text, null for nothing");
  }
  Value read;
  try {
    read = from_yaml("value: " + value, "value");  // of a key, so that a null is not an empty map
  } catch (const InputError& error) {
    malformed(shown, error.what());
  }
  if (read.as_map().size() != 1) malformed(shown, "the value must be one value");
  result.value = read.at("value");
  result.origin = {shortened(shown), 0};
  set_origins(result.value, result.origin);
  return result;
}

std::string written(const std::vector<Step>& path, std::size_t count) {
  std::string text;
  for (std::size_t i = 0; i < count; ++i) {
    if (path[i].index > 0)
      text += "[" + std::to_string(path[i].index) + "]";
    else
      text += (text.empty() ? "" : ".") + path[i].key;
  }
  return text;
}

// The node that the path's last list entry names; what follows are keys alone, counted by `used`.
Value* find_entry(Value& base, const Override& over, const std::string& text, std::size_t& used) {
  Value* node = &base;
  used = 0;
  for (std::size_t i = over.path.size(); i > 0; --i) {
    if (over.path[i - 1].index == 0) continue;
    used = i;
    break;
  }
  for (std::size_t i = 0; i < used; ++i) {
    const Step& step = over.path[i];
    if (step.index == 0) {
      node = node->find(step.key);
      if (!node) malformed(text, "there is no " + written(over.path, i + 1));
      continue;
    }
    const std::string list = written(over.path, i);
    if (!node->is_list()) malformed(text, list + " is " + node->describe_type() + ", not a list");
    const std::size_t size = node->as_list().size();
    if (step.index > size) {
      malformed(text, "there is no " + written(over.path, i + 1) + "; the list has " +
                          std::to_string(size) + (size == 1 ? " entry" : " entries"));
    }
    node = &node->as_list()[step.index - 1];
  }
  return node;
}

}  // namespace

void apply_override(Value& base, const std::string& text, const std::string& option) {
  const Override over = parse_override(text, option);
  std::size_t used = 0;
  Value* node = find_entry(base, over, option + " " + text, used);
  Value layer = over.value;
  for (std::size_t i = over.path.size(); i > used; --i) {
    Value map = Value::map();
    map.with_origin(over.origin);
    map.set(over.path[i - 1].key, std::move(layer));
    layer = std::move(map);
  }
  merge(*node, layer);
}

Value layered(Value lowest, std::span<const Value> layers, std::span<const std::string> overrides) {
  for (const Value& layer : layers) merge(lowest, layer);
  for (const std::string& text : overrides) apply_override(lowest, text);
  return lowest;
}

}  // namespace lapwing
