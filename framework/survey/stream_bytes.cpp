// SPDX-License-Identifier: Apache-2.0
#include "framework/survey/stream_bytes.h"

#include <algorithm>
#include <bit>
#include <charconv>
#include <cstring>
#include <fstream>
#include <sstream>

#include "framework/core/error.h"

namespace lapwing {
namespace {

constexpr std::size_t kBlock = 1 << 20;        // bytes read at once
constexpr std::size_t kLongestText = 1 << 16;  // of a line or a word

bool is_space(char c) {
  return c == ' ' || (c >= '\t' && c <= '\r');
}

}  // namespace

StreamBytes::StreamBytes(const std::filesystem::path& path) : name_(path.string()) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error)) fail("it is no file that can be read");
  size_ = std::filesystem::file_size(path, error);
  stream_ = std::make_unique<std::ifstream>(path, std::ios::binary);
  if (error || !*stream_) fail("it cannot be read");
}

StreamBytes::StreamBytes(std::string_view bytes, const std::string& name)
    : name_(name),
      stream_(std::make_unique<std::istringstream>(std::string(bytes))),
      size_(bytes.size()) {}

void StreamBytes::fail(const std::string& why) const {
  throw InputError("'" + name_ + "': " + why);
}

void StreamBytes::fail_short(const char* what, std::uint64_t missing) const {
  fail("it is cut short: it ends within " + std::string(what) + ", " + std::to_string(missing) +
       " bytes too early");
}

bool StreamBytes::have(std::size_t count) {
  if (end_ - begin_ >= count) return true;
  if (begin_ < end_) std::memmove(buffer_.data(), buffer_.data() + begin_, end_ - begin_);
  end_ -= begin_;
  begin_ = 0;
  const std::uint64_t wanted =
      std::min<std::uint64_t>(size_ - read_, std::max(count - end_, kBlock));
  buffer_.resize(std::max(buffer_.size(), end_ + static_cast<std::size_t>(wanted)));
  if (wanted > 0) {
    stream_->read(buffer_.data() + end_, static_cast<std::streamsize>(wanted));
    const auto got = static_cast<std::uint64_t>(stream_->gcount());
    if (got != wanted) fail("it cannot be read to its end");
    end_ += static_cast<std::size_t>(got);
    read_ += got;
  }
  return end_ >= count;
}

const char* StreamBytes::take(std::size_t count, const char* what) {
  if (count > left()) fail_short(what, count - left());
  have(count);
  const char* bytes = buffer_.data() + begin_;
  begin_ += count;
  return bytes;
}

std::string_view StreamBytes::peek(std::size_t count) {
  have(count);
  return {buffer_.data() + begin_, std::min(count, end_ - begin_)};
}

bool StreamBytes::line(std::string_view& text) {
  if (!have(1)) return false;
  have(kLongestText);
  const std::string_view there(buffer_.data() + begin_, end_ - begin_);
  const std::size_t end = there.find('\n');
  if (end == there.npos && left() >= kLongestText)
    fail("a line has more than " + std::to_string(kLongestText) + " bytes");
  text = there.substr(0, end);
  begin_ += std::min(text.size() + 1, there.size());
  if (!text.empty() && text.back() == '\r') text.remove_suffix(1);
  return true;
}

bool StreamBytes::word(std::string_view& text) {
  do {
    while (begin_ < end_ && is_space(buffer_[begin_])) ++begin_;
  } while (begin_ == end_ && have(1));
  if (begin_ == end_) return false;
  std::size_t size = 0;
  const auto find_end = [&] {
    while (begin_ + size < end_ && !is_space(buffer_[begin_ + size])) ++size;
    return begin_ + size < end_;
  };
  if (!find_end()) {  // the word may go on in the next block
    have(kLongestText);
    find_end();
  }
  if (size >= kLongestText) fail("a word has more than " + std::to_string(kLongestText) + " bytes");
  text = {buffer_.data() + begin_, size};
  begin_ += size;
  return true;
}

void StreamBytes::seek(std::uint64_t place, const char* what) {
  if (place > size_) fail_short(what, place - size_);
  if (place <= read_ && place + end_ >= read_) {  // it is in the buffer
    begin_ = end_ - static_cast<std::size_t>(read_ - place);
    return;
  }
  stream_->clear();
  stream_->seekg(static_cast<std::streamoff>(place));
  if (!*stream_) fail("it cannot be read at byte " + std::to_string(place));
  begin_ = end_ = 0;
  read_ = place;
}

std::uint64_t little_number(const char* bytes, std::size_t count) {
  std::uint64_t bits = 0;
  for (std::size_t i = 0; i < count; ++i)
    bits |= static_cast<std::uint64_t>(static_cast<unsigned char>(bytes[i])) << (8 * i);
  return bits;
}

double little_double(const char* bytes) {
  return std::bit_cast<double>(little_number(bytes, 8));
}

bool number_in(std::string_view text, double& value) {
  if (text.starts_with('+')) text.remove_prefix(1);
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc{} && end == text.data() + text.size() && !text.empty();
}

}  // namespace lapwing
