// SPDX-License-Identifier: Apache-2.0
#include "plugins/flight_logs/ulog/ulog_file.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <set>

#include "framework/core/error.h"
#include "framework/flight_log/byte_reader.h"

namespace lapwing::ulog {
namespace {

constexpr std::string_view kMagic("\x55\x4c\x6f\x67\x01\x12\x35", 7);
// A sync record: its size, its type and these eight bytes.
constexpr std::string_view kSync("\x08\x00\x53\x2f\x73\x13\x20\x25\x0c\xbb\x12", 11);
constexpr std::size_t kHead = 16;        // bytes before the first record
constexpr std::size_t kMostPadding = 8;  // bytes behind the last field of data

class Reading {
 public:
  Reading(std::string_view bytes, Formats& formats, const Listener& listener)
      : bytes_(bytes), formats_(formats), listener_(listener) {}

  Outcome run() {
    std::size_t at = kHead;
    outcome_.read = std::min(at, bytes_.size());
    while (at < bytes_.size()) {
      const std::size_t end = next_part(at);
      const Head head = head_at(at);
      if (head.next > end) {
        if (end < bytes_.size() && jump(at, end)) continue;
        if (resume(at, bytes_.size())) continue;
        cut(at, head);
        break;
      }
      if (!step(at, end, head)) break;
    }
    say_unusable();
    return outcome_;
  }

 private:
  struct Head {
    char type = 0;         // 0: not even a head is there
    std::size_t next = 0;  // the place behind the record
  };

  Head head_at(std::size_t at) const {
    const auto size = number_in<std::uint16_t>(bytes_, at);
    if (!size || at + 3 > bytes_.size()) return {0, bytes_.size() + 1};
    return {bytes_[at + 2], at + 3 + *size};
  }

  // One record that is whole, or what stands in its place. False: nothing behind it can be read.
  bool step(std::size_t& at, std::size_t end, const Head& head) {
    if (is_torn(at, head.next, end)) return true;
    const std::string_view body = bytes_.substr(at + 3, head.next - at - 3);
    if (!take(head.type, body, at)) {
      if (!lettered(head.type) || !head_follows(head.next, end))
        return resume(at, bytes_.size()) || lost(at);
      note_unusable(at, head);
    } else {
      outcome_.read += head.next - at;
    }
    at = head.next;
    return true;
  }

  // Bytes that were lost from a record let it reach into the ones behind it: to the middle of one,
  // or, where as many bytes were lost as some of them have, to the end of one. Then the record is
  // dropped, and `at` becomes the place of the first record that it reached into.
  bool is_torn(std::size_t& at, std::size_t next, std::size_t end) {
    if (!certain_at(next, end)) return resume(at, next);
    const std::size_t inner = first_within(at, next);
    if (inner == next) return false;
    skip_to(inner, at);
    return true;
  }

  // Whether the part ends there, or a record that can be told from other bytes begins.
  bool certain_at(std::size_t at, std::size_t end) const {
    return at == end || next_if_certain(at, end).has_value();
  }

  // The place behind the record that begins there, if it ends before `end` and can be told from
  // other bytes. The type is compared first: it excludes nearly all places.
  std::optional<std::size_t> next_if_certain(std::size_t at, std::size_t end) const {
    if (at + 3 > end) return {};
    const char type = bytes_[at + 2];
    if (type != 'D' && type != 'S' && type != 'L' && type != 'O') return {};
    const Head head = head_at(at);
    if (head.next > end || !certain(type, bytes_.substr(at + 3, head.next - at - 3))) return {};
    return head.next;
  }

  // The first place within the record at `at` from which whole records lead to its end, `next`;
  // else `next`. A dropout alone is too short to be told from the data of a record.
  std::size_t first_within(std::size_t at, std::size_t next) const {
    std::set<std::size_t> leading{next};
    for (std::size_t place = next - 1; place > at; --place) {
      const auto behind = next_if_certain(place, next);
      if (!behind || !leading.count(*behind)) continue;
      if (*behind < next || bytes_[place + 2] != 'O') leading.insert(place);
    }
    return *leading.begin();
  }

  static bool known(char type) {
    return std::string_view("BFIMPQARDLCSO").find(type) != std::string_view::npos;
  }
  // A later version may have further records, whose types are letters.
  static bool lettered(char type) { return type >= 'A' && type <= 'Z'; }

  // Whether a record may begin there, and another one behind it; the last one of a file that was
  // cut may be.
  bool head_follows(std::size_t at, std::size_t end) const {
    for (int k = 0; k < 2 && at + 3 <= end; ++k) {
      const Head head = head_at(at);
      if (!lettered(head.type)) return false;
      if (head.next > end) return end == bytes_.size();
      at = head.next;
    }
    return true;
  }

  // Whether a record begins there beyond doubt: a sync, or three in a row that can be told from
  // other bytes, or fewer that end the file, other than a dropout alone.
  bool begins(std::size_t at) const {
    constexpr int kRow = 3;
    std::size_t place = at;
    for (int found = 0; found < kRow; ++found) {
      if (place == bytes_.size()) return found > 1 || (found == 1 && bytes_[at + 2] != 'O');
      const auto next = next_if_certain(place, bytes_.size());
      if (!next) return false;
      if (found == 0 && bytes_[at + 2] == 'S') return true;
      place = *next;
    }
    return true;
  }

  bool certain(char type, std::string_view body) const {
    switch (type) {
      case 'D':
        return fits(body);
      case 'S':
        return body == kSync.substr(3);
      case 'L':
        return body.size() > 9 && body[0] >= '0' && body[0] <= '7';
      case 'O':
        return body.size() == 2;
      default:
        return false;
    }
  }

  // Of data: a topic that is logged, and its size but for what pads the end.
  bool fits(std::string_view body) const {
    const auto id = number_in<std::uint16_t>(body, 0);
    const auto topic = id ? topics_.find(*id) : topics_.end();
    return topic != topics_.end() && has_size_of(*topic->second.format, body);
  }

  static bool has_size_of(const Format& format, std::string_view body) {
    const std::size_t size = body.size() - 2;
    return size >= format.size && size < format.size + kMostPadding;
  }

  // The end of the part of the file that a place lies in: data that were appended later follow a
  // part that may end within a record.
  std::size_t next_part(std::size_t at) const {
    for (const std::size_t appended : appended_)
      if (appended > at) return appended;
    return bytes_.size();
  }

  // What a part leaves unfinished is dropped.
  bool jump(std::size_t& at, std::size_t end) {
    outcome_.skipped += end - at;
    at = end;
    return true;
  }

  void cut(std::size_t at, const Head& head) {
    outcome_.damage = "it ends within " +
                      (head.type == 0     ? "the head of a record"
                       : known(head.type) ? std::string("a record '") + head.type + "'"
                                          : "a record of an unknown type") +
                      " at byte " + std::to_string(at);
  }

  // Goes on at the next place before `end` where a record begins beyond doubt, if there is one.
  bool resume(std::size_t& at, std::size_t end) {
    for (std::size_t next = at + 1; next < end; ++next) {
      if (!begins(next)) continue;
      skip_to(next, at);
      return true;
    }
    return false;
  }

  void skip_to(std::size_t next, std::size_t& at) {
    lost(at);
    outcome_.skipped += next - at;
    at = next;
  }

  // Says where it was that no record begins. False, for the end of the reading.
  bool lost(std::size_t at) {
    if (outcome_.damage.empty())
      outcome_.damage = "byte " + std::to_string(at) + " begins no record";
    return false;
  }

  // A whole record that says what cannot be understood: data of a topic that nobody described.
  void note_unusable(std::size_t at, const Head& head) {
    if (unusable_++ == 0)
      first_unusable_ = std::string("'") + head.type + "' at byte " + std::to_string(at);
  }

  void say_unusable() {
    if (unusable_ == 0) return;
    if (!outcome_.damage.empty()) outcome_.damage += "; ";
    outcome_.damage +=
        std::to_string(unusable_) +
        (unusable_ == 1 ? " record cannot be used, " : " records cannot be used, the first ") +
        first_unusable_;
  }

  // Whether the record is sound.
  bool take(char type, std::string_view body, std::size_t at) {
    switch (type) {
      case 'B':
        return flags(body, at);
      case 'F':
        return define(body);
      case 'I':
        return inform(body, 0);
      case 'M':
        return inform(body, 1);
      case 'A':
        return subscribe(body);
      case 'R':
        return unsubscribe(body);
      case 'D':
        return data(body);
      case 'L':
        return text(body, 1);
      case 'C':
        return text(body, 3);
      case 'O':
        return dropout(body);
      case 'P':
      case 'Q':
        return !body.empty();
      case 'S':
        return body == kSync.substr(3);
      default:
        return lettered(type) && !body.empty();
    }
  }

  bool flags(std::string_view body, std::size_t at) {
    if (body.size() < 40 || at != kHead) return false;
    for (std::size_t k = 0; k < 8; ++k) {
      const auto unknown = static_cast<unsigned char>(body[8 + k]) & (k == 0 ? 0xfe : 0xff);
      if (unknown)
        throw InputError("byte " + std::to_string(at + 11 + k) +
                         ": the file needs a feature of ULog that this version does not know");
    }
    for (std::size_t k = 0; k < 3; ++k) {
      const auto offset = *number_in<std::uint64_t>(body, 16 + 8 * k);
      if (offset > kHead && offset < bytes_.size())
        appended_.push_back(static_cast<std::size_t>(offset));
    }
    std::sort(appended_.begin(), appended_.end());
    return true;
  }

  bool define(std::string_view body) {
    try {
      formats_.add(body);
    } catch (const InputError&) {
      return false;
    }
    return true;
  }

  bool inform(std::string_view body, std::size_t before) {
    if (body.size() < before + 2) return false;
    const std::size_t length = static_cast<unsigned char>(body[before]);
    if (length == 0 || before + 1 + length > body.size()) return false;
    listener_.information(body.substr(before + 1, length), body.substr(before + 1 + length));
    return true;
  }

  bool subscribe(std::string_view body) {
    if (body.size() < 4) return false;
    const auto id = *number_in<std::uint16_t>(body, 1);
    Topic topic{std::string(body.substr(3)), static_cast<unsigned char>(body[0]), nullptr};
    try {
      topic.format = &formats_.resolved(topic.name);
    } catch (const InputError&) {
      return false;
    }
    topics_[id] = std::move(topic);
    return true;
  }

  bool unsubscribe(std::string_view body) {
    const auto id = number_in<std::uint16_t>(body, 0);
    return id && topics_.erase(*id) > 0;
  }

  bool data(std::string_view body) {
    const auto id = number_in<std::uint16_t>(body, 0);
    if (!id) return false;
    const auto topic = topics_.find(*id);
    if (topic == topics_.end() || !has_size_of(*topic->second.format, body)) return false;
    const std::string_view message = body.substr(2);
    if (const auto time = topic->second.format->number("timestamp"))
      time_ = std::max(time_, 1e-6 * value_of(*time, message));
    listener_.data(topic->second, message);
    return true;
  }

  bool text(std::string_view body, std::size_t before) {
    const auto time = number_in<std::uint64_t>(body, before);
    if (!time) return false;
    listener_.message(1e-6 * static_cast<double>(*time), body.substr(before + 8));
    return true;
  }

  bool dropout(std::string_view body) {
    const auto milliseconds = number_in<std::uint16_t>(body, 0);
    if (!milliseconds) return false;
    listener_.dropout(time_, 1e-3 * *milliseconds);
    return true;
  }

  std::string_view bytes_;
  Formats& formats_;
  const Listener& listener_;
  Outcome outcome_;
  std::vector<std::size_t> appended_;
  std::map<std::uint16_t, Topic> topics_;
  double time_ = 0;  // s, of the last data
  std::size_t unusable_ = 0;
  std::string first_unusable_;
};

}  // namespace

bool is_ulog(std::string_view bytes) {
  return bytes.starts_with(kMagic);
}

Outcome read_records(std::string_view bytes, Formats& formats, const Listener& listener) {
  if (!is_ulog(bytes)) throw InputError("byte 0: a ULog begins with 'ULog' and the bytes 01 12 35");
  if (bytes.size() < kHead)
    throw InputError("byte " + std::to_string(bytes.size()) +
                     ": the file ends within its head of 16 bytes");
  return Reading(bytes, formats, listener).run();
}

}  // namespace lapwing::ulog
