// SPDX-License-Identifier: Apache-2.0
#include "framework/config/yaml.h"

#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/exceptions.h>
#include <yaml-cpp/parser.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <optional>
#include <sstream>
#include <unordered_map>
#include <vector>

#include "framework/core/files.h"
#include "framework/core/json.h"

namespace lapwing {

namespace {

bool is_any_of(std::string_view text, std::initializer_list<std::string_view> words) {
  return std::find(words.begin(), words.end(), text) != words.end();
}

// Matches [-+]? digits, or a number with point or exponent; sets `integral` accordingly.
bool looks_numeric(std::string_view text, bool& integral) {
  const auto skip_digits = [](std::string_view& rest) {
    std::size_t count = 0;
    while (!rest.empty() && rest.front() >= '0' && rest.front() <= '9') {
      rest.remove_prefix(1);
      ++count;
    }
    return count;
  };
  const auto skip_sign = [](std::string_view& rest) {
    if (!rest.empty() && (rest.front() == '-' || rest.front() == '+')) rest.remove_prefix(1);
  };
  skip_sign(text);
  std::size_t digits = skip_digits(text);
  integral = text.empty();
  if (!text.empty() && text.front() == '.') {
    text.remove_prefix(1);
    digits += skip_digits(text);
  }
  if (digits == 0) return false;
  if (!text.empty() && (text.front() == 'e' || text.front() == 'E')) {
    text.remove_prefix(1);
    skip_sign(text);
    if (skip_digits(text) == 0) return false;
  }
  return text.empty();
}

// The value of a plain (unquoted) scalar; nothing when it is a number that is not finite.
std::optional<Value> typed_scalar(const std::string& text) {
  if (is_any_of(text, {"", "~", "null", "Null", "NULL"})) return Value();
  if (is_any_of(text, {"true", "True", "TRUE"})) return Value(true);
  if (is_any_of(text, {"false", "False", "FALSE"})) return Value(false);
  const std::string_view unsigned_text =
      std::string_view(text).substr(text.front() == '-' || text.front() == '+' ? 1 : 0);
  if (is_any_of(unsigned_text, {".inf", ".Inf", ".INF", ".nan", ".NaN", ".NAN"})) {
    return std::nullopt;
  }
  bool integral = false;
  if (!looks_numeric(text, integral)) return Value(text);
  const char* begin = text.data() + (text.front() == '+' ? 1 : 0);
  const char* end = text.data() + text.size();
  std::int64_t integer = 0;
  if (integral && std::from_chars(begin, end, integer).ec == std::errc{}) return Value(integer);
  double number = 0.0;
  const std::errc code = std::from_chars(begin, end, number).ec;
  if (code == std::errc::result_out_of_range && std::abs(std::strtod(begin, nullptr)) < 1.0) {
    return Value(0.0);  // too small to tell from zero
  }
  if (code != std::errc{} || !std::isfinite(number)) return std::nullopt;
  return Value(number);
}

// yaml-cpp reads a collection in flow style to its end before it hands out any of it, with some 250
// bytes for each of these.
constexpr std::ptrdiff_t kMostFlowSigns = 200'000;

bool is_flow_sign(char letter) {
  return letter == ',' || letter == '[' || letter == ']' || letter == '{' || letter == '}';
}

// Receives the parser's events and builds the tree.
class Builder final : public YAML::EventHandler {
 public:
  explicit Builder(const std::string& source) : source_(source) {}

  Value take() {
    errors_.throw_if_any();
    return std::move(root_);
  }

  void OnDocumentStart(const YAML::Mark&) override {}
  void OnDocumentEnd() override {}
  void OnAnchor(const YAML::Mark& mark, const std::string& name) override {
    refuse(mark, "anchor '&" + name + "' is not supported; write the value out");
  }
  void OnAlias(const YAML::Mark& mark, YAML::anchor_t) override {
    refuse(mark, "an alias ('*name') is not supported; write the value out");
    if (expects_key()) {
      stack_.back().key = "";
      return;
    }
    put(Value(), mark);
  }
  void OnNull(const YAML::Mark& mark, YAML::anchor_t) override {
    if (expects_key()) {
      refuse(mark, "a key is missing before ':'");
      stack_.back().key = "";
      return;
    }
    put(Value(), mark);
  }
  void OnScalar(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t,
                const std::string& text) override {
    check_tag(mark, tag);
    if (expects_key()) {
      take_key(mark, tag, text);
      return;
    }
    if (tag != "?") {
      put(Value(text), mark);
      return;
    }
    std::optional<Value> value = typed_scalar(text);
    if (!value) refuse(mark, "'" + text + "' is not a finite number");
    put(value ? std::move(*value) : Value(), mark);
  }
  void OnSequenceStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t,
                       YAML::EmitterStyle::value) override {
    check_tag(mark, tag);
    open(Value::list(), mark);
  }
  void OnSequenceEnd() override { close(); }
  void OnMapStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t,
                  YAML::EmitterStyle::value) override {
    check_tag(mark, tag);
    open(Value::map(), mark);
  }
  void OnMapEnd() override { close(); }

 private:
  struct Level {
    Value value;
    std::optional<std::string> key;  // read, its value not yet
    int key_line = 0;
    bool repeated = false;
    std::unordered_map<std::string, int> keys;  // those so far, and their lines
  };

  bool expects_key() const {
    return !stack_.empty() && stack_.back().value.is_map() && !stack_.back().key;
  }
  void refuse(const YAML::Mark& mark, const std::string& message) {
    errors_.add({source_, mark.line + 1}, "", message);
  }
  void check_tag(const YAML::Mark& mark, const std::string& tag) {
    if (!is_any_of(tag, {"", "?", "!"})) refuse(mark, "tag '" + tag + "' is not supported");
  }
  void take_key(const YAML::Mark& mark, const std::string& tag, const std::string& text) {
    Level& top = stack_.back();
    if (tag == "?" && text == "<<") refuse(mark, "the merge key '<<' is not supported");
    const auto [known, fresh] = top.keys.emplace(text, mark.line + 1);
    top.repeated = !fresh;
    if (top.repeated) {
      refuse(mark, "repeated key '" + text + "', first on line " + std::to_string(known->second));
    }
    top.key = text;
    top.key_line = mark.line + 1;
  }
  Origin origin_here(const Value& value, const YAML::Mark& mark) const {
    const bool keyed = !stack_.empty() && stack_.back().key;
    const bool has_own_line = !value.is_null() && !value.is_list() && !value.is_map();
    return {source_, keyed && !has_own_line ? stack_.back().key_line : mark.line + 1};
  }
  void put(Value value, const YAML::Mark& mark) {
    value.with_origin(origin_here(value, mark));
    add(std::move(value));
  }
  void add(Value value) {
    if (stack_.empty()) {
      root_ = std::move(value);
      return;
    }
    Level& top = stack_.back();
    if (top.value.is_list()) {
      top.value.push_back(std::move(value));
      return;
    }
    if (!top.repeated) top.value.as_map().emplace_back(*top.key, std::move(value));
    top.key.reset();
  }
  void open(Value value, const YAML::Mark& mark) {
    if (expects_key()) {
      throw InputError({source_, mark.line + 1}, "a key must be a text, not a list or a map");
    }
    if (stack_.size() >= kMaximumYamlDepth) {
      throw InputError({source_, mark.line + 1},
                       "nested deeper than " + std::to_string(kMaximumYamlDepth) + " levels");
    }
    value.with_origin(origin_here(value, mark));
    stack_.push_back({std::move(value), std::nullopt, 0, false, {}});
  }
  void close() {
    Value value = std::move(stack_.back().value);
    stack_.pop_back();
    add(std::move(value));
  }

  const std::string& source_;
  std::vector<Level> stack_;
  Value root_;
  Diagnostics errors_;
};

void require_plain_text(std::string_view text, const std::string& source) {
  if (text.size() > kMaximumYamlBytes) {
    throw InputError(source + ": larger than " + std::to_string(kMaximumYamlBytes) + " bytes");
  }
  if (std::count_if(text.begin(), text.end(), is_flow_sign) > kMostFlowSigns) {
    throw InputError(source + ": more than " + std::to_string(kMostFlowSigns) +
                     " of the characters [ ] { } and comma: too many entries for YAML");
  }
  // yaml-cpp would guess an encoding instead.
  const std::size_t bad = std::min(first_invalid_utf8(text), text.find('\0'));
  if (bad == text.npos) return;
  const auto line = 1 + std::count(text.begin(), text.begin() + static_cast<long>(bad), '\n');
  throw InputError({source, static_cast<int>(line)}, "not UTF-8 text");
}

}  // namespace

Value from_yaml(std::string_view text, const std::string& source) {
  require_plain_text(text, source);
  std::istringstream stream{std::string(text)};
  Builder builder(source);
  try {
    YAML::Parser parser(stream);
    parser.HandleNextDocument(builder);
    Value value = builder.take();
    Builder rest(source);
    if (parser.HandleNextDocument(rest)) {
      throw InputError(source + ": a second document ('---') is not supported");
    }
    if (value.is_null()) value = Value::map().with_origin({source, 1});
    return value;
  } catch (const YAML::Exception& error) {
    const bool somewhere = !error.mark.is_null();
    throw InputError(source +
                     (somewhere ? ":" + std::to_string(error.mark.line + 1) + ":" +
                                      std::to_string(error.mark.column + 1)
                                : "") +
                     ": invalid YAML: " + error.msg);
  }
}

Value read_yaml(const std::filesystem::path& file) {
  return from_yaml(read_file(file, kMaximumYamlBytes), file.string());
}

}  // namespace lapwing
