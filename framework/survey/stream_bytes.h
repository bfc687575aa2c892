// SPDX-License-Identifier: Apache-2.0
// A file read from front to back in blocks, so that it need not fit in memory.
#pragma once

#include <cstdint>
#include <filesystem>
#include <istream>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace lapwing {

// Not thread-safe. What `take`, `line` and `word` return is valid until the next call. All of them
// throw InputError, naming the file, where the system cannot read it.
class StreamBytes {
 public:
  // InputError for what is no regular file that can be read.
  explicit StreamBytes(const std::filesystem::path& path);
  // Of bytes in memory, which are copied.
  StreamBytes(std::string_view bytes, const std::string& name);

  const std::string& name() const { return name_; }
  std::uint64_t size() const { return size_; }
  std::uint64_t position() const { return read_ - (end_ - begin_); }
  std::uint64_t left() const { return size_ - position(); }

  // The next `count` bytes, at most 16 MiB. InputError where the file has fewer: "it ends within
  // `what`".
  const char* take(std::size_t count, const char* what);
  // The next bytes without passing over them, `count` or as many as there are.
  std::string_view peek(std::size_t count);
  // The next line without its end, of at most 64 KiB; false at the end of the file.
  bool line(std::string_view& text);
  // The next word between white space, likewise.
  bool word(std::string_view& text);
  // InputError where the place lies beyond the end of the file.
  void seek(std::uint64_t position, const char* what);

  // "'name': why"
  [[noreturn]] void fail(const std::string& why) const;

 private:
  // Whether so many bytes are in the buffer, after reading on.
  bool have(std::size_t count);
  [[noreturn]] void fail_short(const char* what, std::uint64_t missing) const;

  std::string name_;
  std::unique_ptr<std::istream> stream_;
  std::uint64_t size_ = 0, read_ = 0;  // bytes; `read_` are in or behind the buffer
  std::vector<char> buffer_;
  std::size_t begin_ = 0, end_ = 0;  // of the buffer
};

// Little-endian numbers.
std::uint64_t little_number(const char* bytes, std::size_t count);
double little_double(const char* bytes);

// A decimal number that is all of the text, also "+1", "inf" and "nan"; false for anything else.
bool number_in(std::string_view text, double& value);

}  // namespace lapwing
