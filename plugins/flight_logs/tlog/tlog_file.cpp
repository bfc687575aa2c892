// SPDX-License-Identifier: Apache-2.0
#include "plugins/flight_logs/tlog/tlog_file.h"

#include <optional>

#include "framework/core/error.h"
#include "framework/mavlink/packet_parser.h"

namespace lapwing::tlog {
namespace {

using namespace mavlink;

constexpr std::size_t kStamp = 8;                              // bytes
constexpr std::uint64_t kLastTime = std::uint64_t{1} << 52;    // us since 1970: the year 2112
constexpr std::size_t kLargestFile = std::size_t{1} << 30;     // bytes
constexpr std::size_t kHead1 = 6, kHead2 = 10, kChecksum = 2;  // bytes

std::uint8_t byte_at(std::string_view bytes, std::size_t at) {
  return static_cast<std::uint8_t>(bytes[at]);
}

std::uint64_t stamp_at(std::string_view bytes, std::size_t at) {
  std::uint64_t stamp = 0;
  for (std::size_t i = 0; i < kStamp; ++i) stamp = stamp << 8 | byte_at(bytes, at + i);
  return stamp;
}

enum class Look { record, unknown, cut, nothing };

struct Found {
  Look look = Look::nothing;
  std::size_t length = 0;  // bytes, with the stamp
  std::uint64_t stamp = 0;
  Packet packet;
};

// Of a message that is not in the table.
Packet head_of(std::string_view packet) {
  const bool second = byte_at(packet, 0) == kMagic2;
  const std::size_t at = second ? 4 : 2;
  Packet head;
  head.version = second ? 2 : 1;
  head.sequence = byte_at(packet, at);
  head.system = byte_at(packet, at + 1);
  head.component = byte_at(packet, at + 2);
  head.message = byte_at(packet, at + 3);
  if (second)
    head.message |= static_cast<std::uint32_t>(byte_at(packet, 8) << 8 | byte_at(packet, 9) << 16);
  return head;
}

// Whether a record may begin here: what there is of its stamp and magic byte.
bool may_begin(std::string_view bytes, std::size_t at) {
  if (at == bytes.size()) return true;
  if (byte_at(bytes, at) != 0) return false;  // of every time before kLastTime
  if (at + kStamp >= bytes.size()) return true;
  const std::uint8_t magic = byte_at(bytes, at + kStamp);
  return stamp_at(bytes, at) < kLastTime && (magic == kMagic1 || magic == kMagic2);
}

Found look_at(std::string_view bytes, std::size_t at) {
  Found found;
  if (!may_begin(bytes, at)) return found;
  const std::size_t left = bytes.size() - at;
  found.look = Look::cut;
  if (left <= kStamp + 2) return found;
  found.stamp = stamp_at(bytes, at);
  const bool second = byte_at(bytes, at + kStamp) == kMagic2;
  const std::uint8_t flags = second ? byte_at(bytes, at + kStamp + 2) : 0;
  if (flags & ~kSignedFlag) return {};
  const std::size_t length = (second ? kHead2 : kHead1) + byte_at(bytes, at + kStamp + 1) +
                             kChecksum + (flags ? kSignatureLength : 0);
  if (left < kStamp + length) return found;
  found.length = kStamp + length;
  const std::string_view whole = bytes.substr(at + kStamp, length);
  found.packet = head_of(whole);
  if (!find_message(found.packet.message)) {
    found.look = may_begin(bytes, at + found.length) ? Look::unknown : Look::nothing;
    return found;
  }
  PacketParser parser;
  const auto packets = parser.read(whole, Source::datagram);
  found.look = packets.size() == 1 && parser.counts().garbage == 0 ? Look::record : Look::nothing;
  if (found.look == Look::record) found.packet = packets.front();
  return found;
}

class Reading {
 public:
  Reading(std::string_view bytes, const Listener& listener) : bytes_(bytes), listener_(listener) {}

  Outcome run() {
    std::size_t at = 0;
    while (at < bytes_.size()) {
      const Found found = look_at(bytes_, at);
      if (found.look == Look::record || found.look == Look::unknown) {
        take(found, at);
        at += found.length;
        continue;
      }
      if (found.look == Look::cut && !cut_at_) cut_at_ = at;
      if (!wrong_at_) wrong_at_ = at;
      ++waiting_, ++at;
    }
    tell();
    return outcome_;
  }

 private:
  // What seemed to be cut, but is followed by a record, was none.
  void take(const Found& found, std::size_t at) {
    if (waiting_ > 0 && !first_skipped_) first_skipped_ = at - waiting_;
    outcome_.skipped += waiting_;
    waiting_ = 0;
    cut_at_.reset(), wrong_at_.reset();
    outcome_.read += found.length;
    listener_.packet(found.stamp, found.packet, found.look == Look::record);
  }

  void tell() {
    if (outcome_.read == 0)
      throw InputError(
          "byte 0: a telemetry log is records of a time in microseconds since 1970 (8 bytes) and a "
          "packet of MAVLink (it begins with FE or FD); there is no whole record");
    std::string& damage = outcome_.damage;
    if (outcome_.skipped > 0)
      damage = std::to_string(outcome_.skipped) +
               (outcome_.skipped == 1 ? " byte is no record" : " bytes are no record, the first") +
               " at byte " + std::to_string(*first_skipped_);
    if (!wrong_at_) return;
    if (!damage.empty()) damage += "; ";
    damage += cut_at_ == wrong_at_
                  ? "it ends within a record at byte " + std::to_string(*cut_at_)
                  : "the last " + std::to_string(waiting_) + " bytes are no record";
  }

  std::string_view bytes_;
  const Listener& listener_;
  Outcome outcome_;
  std::size_t waiting_ = 0;  // bytes since the last record
  std::optional<std::size_t> cut_at_, wrong_at_, first_skipped_;
};

}  // namespace

bool is_tlog(std::string_view bytes) {
  if (bytes.size() <= kStamp) return false;
  const Look look = look_at(bytes, 0).look;
  return look == Look::record || look == Look::unknown;
}

Outcome read_records(std::string_view bytes, const Listener& listener) {
  if (bytes.size() > kLargestFile)
    throw InputError("it has " + std::to_string(bytes.size()) +
                     " bytes; a telemetry log of at most 1 GiB is read: split it");
  return Reading(bytes, listener).run();
}

}  // namespace lapwing::tlog
