// SPDX-License-Identifier: Apache-2.0
// Numbers in the files of COLMAP, binary (little-endian) and text. Internal to the room.
#pragma once

#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>

#include "framework/core/error.h"

namespace lapwing {

class BinaryFields {
 public:
  BinaryFields(std::string_view bytes, std::string name) : bytes_(bytes), name_(std::move(name)) {}

  template <class T>
  T take() {
    if (bytes_.size() - at_ < sizeof(T)) fail("is cut short");
    T value;
    std::memcpy(&value, bytes_.data() + at_, sizeof(T));
    at_ += sizeof(T);
    return value;
  }
  double number() {
    const double value = take<double>();
    if (!std::isfinite(value)) fail("has a number that is not finite");
    return value;
  }
  // A count of entries that take at least so many bytes each.
  std::size_t count(std::size_t bytes_each) {
    const auto value = take<std::uint64_t>();
    if (value > (bytes_.size() - at_) / bytes_each)
      fail("is cut short: it counts " + std::to_string(value) + " entries");
    return static_cast<std::size_t>(value);
  }
  // Up to a byte of 0.
  std::string text() {
    const std::size_t end = bytes_.find('\0', at_);
    if (end == std::string_view::npos) fail("is cut short in a name");
    std::string value(bytes_.substr(at_, end - at_));
    at_ = end + 1;
    return value;
  }
  bool ended() const { return at_ == bytes_.size(); }
  [[noreturn]] void fail(const std::string& why) const {
    throw InputError("'" + name_ + "': byte " + std::to_string(at_) + ": " + why);
  }

 private:
  std::string_view bytes_;
  std::size_t at_ = 0;
  std::string name_;
};

// Lines that are not comments, and the words of each.
class TextFields {
 public:
  TextFields(std::string_view bytes, std::string name) : bytes_(bytes), name_(std::move(name)) {}

  // The next line that is no comment and, unless `empty` is set, has a word. False at the end.
  bool next_line(bool empty = false) {
    while (at_ < bytes_.size()) {
      const std::size_t end = std::min(bytes_.find('\n', at_), bytes_.size());
      line_ = bytes_.substr(at_, end - at_);
      at_ = end + 1;
      ++number_;
      skip_blanks();
      if (!line_.empty() ? line_.front() != '#' : empty) return true;
    }
    line_ = {};
    return false;
  }
  bool has_word() const { return !line_.empty(); }
  std::string_view word() {
    if (line_.empty()) fail("the line is cut short");
    const std::size_t end = std::min(line_.find_first_of(" \t\r"), line_.size());
    const std::string_view found = line_.substr(0, end);
    line_.remove_prefix(end);
    skip_blanks();
    return found;
  }
  // The rest of the line: names may have blanks.
  std::string rest() {
    std::string found(line_);
    while (!found.empty() && (found.back() == ' ' || found.back() == '\r')) found.pop_back();
    line_ = {};
    return found;
  }
  template <class T>
  T whole() {
    const std::string_view text = word();
    T value{};
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc{} || end != text.data() + text.size())
      fail("expected a whole number, got '" + std::string(text) + "'");
    return value;
  }
  double number() {
    const std::string_view text = word();
    double value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc{} || end != text.data() + text.size() || !std::isfinite(value))
      fail("expected a finite number, got '" + std::string(text) + "'");
    return value;
  }
  [[noreturn]] void fail(const std::string& why) const {
    throw InputError("'" + name_ + "', line " + std::to_string(number_) + ": " + why);
  }

 private:
  void skip_blanks() {
    line_.remove_prefix(std::min(line_.find_first_not_of(" \t\r"), line_.size()));
  }

  std::string_view bytes_, line_;
  std::size_t at_ = 0, number_ = 0;
  std::string name_;
};

}  // namespace lapwing
