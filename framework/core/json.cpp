// SPDX-License-Identifier: Apache-2.0
#include "framework/core/json.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <iterator>
#include <limits>
#include <nlohmann/json.hpp>
#include <set>
#include <vector>

namespace lapwing {

namespace {

constexpr std::size_t kAnnounced = 1u
                                   << 20;   // bytes of values, from one call of `hold` to the next
constexpr std::size_t kMaximumDepth = 200;  // a Value is built and destroyed recursively

class Writer {
 public:
  explicit Writer(int indent) : indent_(indent) {}
  std::string take() { return std::move(out_); }

  void write(const Value& value, const std::string& path, int depth) {
    switch (value.type()) {
      case Value::Type::null:
        out_ += "null";
        return;
      case Value::Type::boolean:
        out_ += value.as_boolean() ? "true" : "false";
        return;
      case Value::Type::integer:
        out_ += std::to_string(value.as_integer());
        return;
      case Value::Type::number:
        write_number(value.as_number(), path);
        return;
      case Value::Type::text:
        write_text(value.as_text(), path);
        return;
      case Value::Type::list:
        write_list(value.as_list(), path, depth);
        return;
      case Value::Type::map:
        write_map(value.as_map(), path, depth);
        return;
    }
  }

 private:
  void write_number(double number, const std::string& path) {
    if (!std::isfinite(number)) {
      throw Error((path.empty() ? "the value" : path) + ": JSON cannot hold " +
                  (std::isnan(number) ? "NaN" : "an infinite number"));
    }
    char buffer[32];
    const auto [end, code] = std::to_chars(buffer, buffer + sizeof buffer, number);
    const std::string_view digits(buffer, static_cast<std::size_t>(end - buffer));
    out_ += digits;
    // Keeps the type: 3.0 reads back as a number, not as an integer.
    if (digits.find_first_of(".e") == digits.npos) out_ += ".0";
  }

  void write_text(const std::string& text, const std::string& path) {
    const bool plain = std::all_of(text.begin(), text.end(), [](unsigned char c) {
      return c >= 0x20 && c < 0x7f && c != '"' && c != '\\';
    });
    if (plain) {
      (out_ += '"').append(text) += '"';
      return;
    }
    try {
      out_ += nlohmann::json(text).dump();
    } catch (const nlohmann::json::exception&) {
      throw Error((path.empty() ? "the value" : path) + ": the text is not valid UTF-8");
    }
  }

  void new_line(int depth) {
    if (indent_ < 0) return;
    out_ += '\n';
    out_.append(static_cast<std::size_t>(indent_ * depth), ' ');
  }

  void write_list(const Value::List& list, const std::string& path, int depth) {
    // Vectors stay on one line; so does the empty list.
    const bool flat =
        std::all_of(list.begin(), list.end(), [](const Value& entry) { return entry.is_number(); });
    out_ += '[';
    for (std::size_t i = 0; i < list.size(); ++i) {
      if (i > 0) out_ += indent_ >= 0 && flat ? ", " : ",";
      if (!flat) new_line(depth + 1);
      write(list[i], path + "[" + std::to_string(i + 1) + "]", depth + 1);
    }
    if (!flat) new_line(depth);
    out_ += ']';
  }

  void write_map(const Value::Map& map, const std::string& path, int depth) {
    out_ += '{';
    bool first = true;
    for (const auto& [key, value] : map) {
      if (!first) out_ += ',';
      first = false;
      new_line(depth + 1);
      const std::string key_path = path.empty() ? key : path + "." + key;
      write_text(key, key_path);
      out_ += indent_ < 0 ? ":" : ": ";
      write(value, key_path, depth + 1);
    }
    if (!first) new_line(depth);
    out_ += '}';
  }

  int indent_;
  std::string out_;
};

// Where the reader stands. The lexer looks one character ahead to end a number, hence the line of
// the last character that is not white space.
struct Position {
  int line = 1;
  int line_of_token = 1;
};

// Feeds the parser and counts lines as it goes.
class CountingIterator {
 public:
  using iterator_category = std::input_iterator_tag;
  using value_type = char;
  using difference_type = std::ptrdiff_t;
  using pointer = const char*;
  using reference = const char&;

  CountingIterator(const char* at, Position* position) : at_(at), position_(position) {}
  reference operator*() const { return *at_; }
  CountingIterator& operator++() {
    if (*at_ == '\n')
      ++position_->line;
    else if (*at_ != ' ' && *at_ != '\t' && *at_ != '\r')
      position_->line_of_token = position_->line;
    ++at_;
    return *this;
  }
  CountingIterator operator++(int) {
    CountingIterator before = *this;
    ++*this;
    return before;
  }
  bool operator==(const CountingIterator& other) const { return at_ == other.at_; }
  bool operator!=(const CountingIterator& other) const { return at_ != other.at_; }

 private:
  const char* at_;
  Position* position_;
};

// Receives the parser's events and builds the tree.
class Builder final : public nlohmann::json_sax<nlohmann::json> {
 public:
  Builder(const std::string& source, const Position& position, const HoldValues& hold)
      : source_(source), position_(position), announce_(hold) {}
  Value take() { return std::move(root_); }

  bool null() override { return put(Value()); }
  bool boolean(bool v) override { return put(Value(v)); }
  bool number_integer(number_integer_t v) override { return put(Value(std::int64_t{v})); }
  bool number_unsigned(number_unsigned_t v) override {
    if (v > static_cast<number_unsigned_t>(std::numeric_limits<std::int64_t>::max())) {
      return put(Value(static_cast<double>(v)));
    }
    return put(Value(static_cast<std::int64_t>(v)));
  }
  bool number_float(number_float_t v, const string_t&) override { return put(Value(v)); }
  bool string(string_t& v) override { return put(Value(std::move(v))); }
  bool binary(binary_t&) override { return false; }  // never sent for JSON text
  bool start_object(std::size_t) override { return open(Value::map()); }
  bool start_array(std::size_t) override { return open(Value::list()); }
  bool end_object() override { return close(); }
  bool end_array() override { return close(); }
  bool key(string_t& name) override {
    Level& top = stack_.back();
    if (!top.keys.insert(name).second) fail("repeated key '" + name + "'");
    hold(2 * (name.size() + sizeof name));
    top.key = name;
    return true;
  }
  bool parse_error(std::size_t, const std::string&, const nlohmann::detail::exception& e) override {
    // "[json.exception.parse_error.101] parse error at line 3, column 5: syntax error while ..."
    const std::string text = e.what();
    int line = 0;
    int column = 0;
    const std::size_t at = text.find("line ");
    if (at == text.npos ||
        std::sscanf(text.c_str() + at, "line %d, column %d", &line, &column) != 2) {
      const std::size_t end = text.find("] ");
      fail("invalid JSON: " + (end == text.npos ? text : text.substr(end + 2)));
    }
    const std::size_t message = text.find(": ", at);
    throw InputError(source_ + ":" + std::to_string(line) + ":" + std::to_string(column) +
                     ": invalid JSON: " + (message == text.npos ? text : text.substr(message + 2)));
  }

 private:
  struct Level {
    Value value;
    std::string key;             // of the entry that comes next
    std::set<std::string> keys;  // seen so far
  };

  [[noreturn]] void fail(const std::string& message) const { throw InputError(here(), message); }
  Origin here() const { return {source_, position_.line_of_token}; }

  void hold(std::size_t bytes) {
    held_ += bytes;
    if (held_ < announced_ || !announce_) return;
    announce_(held_);
    announced_ = held_ + kAnnounced;
  }
  bool put(Value value) {
    hold(sizeof(Value) + source_.size() + (value.is_text() ? value.as_text().size() : 0));
    if (value.origin().line == 0) value.with_origin(here());
    if (stack_.empty()) {
      root_ = std::move(value);
      return true;
    }
    Level& top = stack_.back();
    if (top.value.is_list())
      top.value.push_back(std::move(value));
    else
      top.value.as_map().emplace_back(std::move(top.key), std::move(value));
    return true;
  }
  bool open(Value value) {
    if (stack_.size() >= kMaximumDepth) {
      fail("nested deeper than " + std::to_string(kMaximumDepth) + " levels");
    }
    value.with_origin(here());
    stack_.push_back({std::move(value), {}, {}});
    return true;
  }
  bool close() {
    Value value = std::move(stack_.back().value);
    stack_.pop_back();
    return put(std::move(value));
  }

  const std::string& source_;
  const Position& position_;
  const HoldValues& announce_;
  std::size_t held_ = 0, announced_ = kAnnounced;  // bytes
  std::vector<Level> stack_;
  Value root_;
};

}  // namespace

std::size_t first_invalid_utf8(std::string_view text) {
  for (std::size_t i = 0; i < text.size();) {
    const auto lead = static_cast<unsigned char>(text[i]);
    const std::size_t length = lead < 0x80   ? 1
                               : lead < 0xc2 ? 0
                               : lead < 0xe0 ? 2
                               : lead < 0xf0 ? 3
                               : lead < 0xf5 ? 4
                                             : 0;
    if (length == 0 || i + length > text.size()) return i;
    const auto second = static_cast<unsigned char>(length > 1 ? text[i + 1] : 0x80);
    // Too long for what they say, halves of a pair, and what is above the last character.
    if ((lead == 0xe0 && second < 0xa0) || (lead == 0xed && second > 0x9f) ||
        (lead == 0xf0 && second < 0x90) || (lead == 0xf4 && second > 0x8f))
      return i;
    for (std::size_t k = 1; k < length; ++k) {
      if ((static_cast<unsigned char>(text[i + k]) & 0xc0) != 0x80) return i;
    }
    i += length;
  }
  return text.npos;
}

bool is_utf8(std::string_view text) {
  return first_invalid_utf8(text) == text.npos;
}

std::string as_utf8(std::string_view text) {
  const std::string dumped =
      nlohmann::json(text).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
  return nlohmann::json::parse(dumped).get<std::string>();
}

std::string to_json(const Value& value, int indent) {
  Writer writer(indent);
  writer.write(value, "", 0);
  return writer.take();
}

Value from_json(std::string_view text, const std::string& source, const HoldValues& hold) {
  Position position;
  Builder builder(source, position, hold);
  const CountingIterator begin(text.data(), &position);
  const CountingIterator end(text.data() + text.size(), &position);
  nlohmann::json::sax_parse(begin, end, &builder);
  return builder.take();
}

}  // namespace lapwing
