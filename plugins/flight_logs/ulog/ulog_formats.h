// SPDX-License-Identifier: Apache-2.0
// Message formats of a ULog file: which numbers stand where in the bytes of a message.
// https://docs.px4.io/main/en/dev_log/ulog_file_format.html
#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace lapwing::ulog {

enum class NumberType { i8, u8, i16, u16, i32, u32, i64, u64, f32, f64, boolean, character };

struct Number {
  NumberType type = NumberType::u8;
  std::size_t offset = 0;  // bytes from the beginning of the message, its id excluded
};

// A number, or an array of numbers one behind the other.
struct Field {
  std::string name;  // "x", "q", "esc[0].rpm"
  Number first;
  std::size_t count = 0;  // of an array; 0: not an array
};

struct Format {
  std::vector<Field> fields;  // those of a format within it by themselves
  std::size_t size = 0;       // bytes, the padding at the end excluded, which files may leave out

  // Of a field ("x", "esc[0].rpm") or of an element of an array ("q[2]").
  std::optional<Number> number(std::string_view name) const;
};

// The number as a double; `bytes` is the message without its id and at least `size` long.
double value_of(const Number& number, std::string_view bytes);

// Definitions as they come, "name:type a;type[3] b;...", which may name each other.
class Formats {
 public:
  // InputError for a line of another form. A format that was resolved stays as it is.
  void add(std::string_view definition);
  // Resolved with what it contains. InputError for a format that is not defined, that contains
  // itself, or that is longer than a message can be (65535 bytes); and once 2^17 fields were laid
  // out, those of refused formats and of arrays of formats included. An array of numbers is one.
  const Format& resolved(const std::string& name);

 private:
  struct Member {
    std::string type, name;
    std::size_t count = 0;  // of an array; 0: not an array
  };
  void append(const std::string& name, const std::string& prefix, int depth, Format& into);

  std::map<std::string, std::vector<Member>> defined_;
  std::map<std::string, Format> resolved_;
  std::size_t fields_ = 0;  // laid out so far, those of formats that were refused included
};

}  // namespace lapwing::ulog
