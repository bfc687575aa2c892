// SPDX-License-Identifier: Apache-2.0
#include "plugins/flight_logs/mcap/mcap_file.h"

#include <lz4frame.h>
#include <zstd.h>

#include <algorithm>
#include <map>
#include <memory>

#include "framework/core/error.h"
#include "framework/flight_log/byte_reader.h"

namespace lapwing::mcap_log {
namespace {

constexpr std::string_view kMagic("\x89MCAP0\r\n", 8);
constexpr std::size_t kLargestChunk = std::size_t{1} << 30;  // bytes, opened
constexpr std::size_t kMostAtOnce = std::size_t{1} << 24;    // bytes that are set aside unseen

// Reads the fields of a record; stays failed once one does not fit.
class Fields {
 public:
  explicit Fields(std::string_view body) : body_(body) {}
  template <class T>
  T number() {
    const auto value = number_in<T>(body_, at_);
    good_ = good_ && value;
    at_ += sizeof(T);
    return value.value_or(T{});
  }
  std::string_view text() { return bytes(number<std::uint32_t>()); }
  std::string_view bytes(std::uint64_t size) {
    if (!good_ || size > body_.size() - at_) {
      good_ = false;
      return {};
    }
    const std::string_view found = body_.substr(at_, static_cast<std::size_t>(size));
    at_ += static_cast<std::size_t>(size);
    return found;
  }
  std::string_view rest() {
    return good_ && at_ <= body_.size() ? body_.substr(at_) : std::string_view();
  }
  bool good() const { return good_; }

 private:
  std::string_view body_;
  std::size_t at_ = 0;
  bool good_ = true;
};

// Opened in parts, so that a size that is only stated takes no memory. Null where it does not open.
std::optional<std::string> opened_zstd(std::string_view bytes, std::size_t size) {
  const std::unique_ptr<ZSTD_DStream, decltype(&ZSTD_freeDStream)> stream(ZSTD_createDStream(),
                                                                          &ZSTD_freeDStream);
  if (!stream) throw std::bad_alloc();
  std::string out;
  ZSTD_inBuffer in{bytes.data(), bytes.size(), 0};
  while (out.size() < size) {
    const std::size_t from = out.size();
    out.resize(std::min(size, from + kMostAtOnce));
    ZSTD_outBuffer part{out.data() + from, out.size() - from, 0};
    const std::size_t left = ZSTD_decompressStream(stream.get(), &part, &in);
    out.resize(from + part.pos);
    if (ZSTD_isError(left) || (part.pos == 0 && in.pos == in.size)) return std::nullopt;
    if (left == 0 && in.pos == in.size) break;
  }
  return out.size() == size ? std::optional(std::move(out)) : std::nullopt;
}

std::optional<std::string> opened_lz4(std::string_view bytes, std::size_t size) {
  LZ4F_dctx* made = nullptr;
  if (LZ4F_isError(LZ4F_createDecompressionContext(&made, LZ4F_VERSION))) throw std::bad_alloc();
  const std::unique_ptr<LZ4F_dctx, decltype(&LZ4F_freeDecompressionContext)> context(
      made, &LZ4F_freeDecompressionContext);
  std::string out;
  std::size_t at = 0;
  while (out.size() < size) {
    const std::size_t from = out.size();
    out.resize(std::min(size, from + kMostAtOnce));
    std::size_t made_now = out.size() - from, taken = bytes.size() - at;
    const std::size_t left = LZ4F_decompress(context.get(), out.data() + from, &made_now,
                                             bytes.data() + at, &taken, nullptr);
    out.resize(from + made_now);
    at += taken;
    if (LZ4F_isError(left) || (made_now == 0 && taken == 0)) return std::nullopt;
    if (left == 0) break;
  }
  return out.size() == size ? std::optional(std::move(out)) : std::nullopt;
}

class Reading {
 public:
  explicit Reading(const std::function<void(const Message&)>& take) : take_(take) {}

  // Records one after the other; where they end too early, the place. `inside` a chunk.
  void records(std::string_view bytes, std::size_t start, bool inside) {
    std::size_t at = start;
    while (at < bytes.size()) {
      if (!inside && bytes.substr(at) == kMagic) {
        whole_ = true;
        outcome.read = bytes.size();
        return;
      }
      const auto size = number_in<std::uint64_t>(bytes, at + 1);
      if (!size || *size > bytes.size() - at - 9) {
        spoil(inside, "it ends within a record at byte ", at);
        return;
      }
      const auto code = static_cast<unsigned char>(bytes[at]);
      if (!record(code, bytes.substr(at + 9, static_cast<std::size_t>(*size)), inside)) {
        spoil(inside, "a record is not as its kind wants it, at byte ", at);
        return;
      }
      at += 9 + static_cast<std::size_t>(*size);
      if (!inside) outcome.read = at;
    }
    if (!inside && !whole_) spoil(inside, "its end is missing, at byte ", at);
  }

  void tell(const std::function<void(const Channel&)>& channels) const {
    for (const auto& [id, channel] : channels_) channels(channel);
  }

  Outcome outcome;

 private:
  void spoil(bool inside, const char* what, std::size_t at) {
    if (!outcome.damage.empty()) return;
    outcome.damage = what + std::to_string(at) + (inside ? " of a chunk" : "");
  }

  bool record(unsigned char code, std::string_view body, bool inside) {
    Fields fields(body);
    switch (code) {
      case 0x00:
        return false;
      case 0x01:
        fields.text();
        outcome.library = fields.text();
        return fields.good();
      case 0x03: {
        const auto id = fields.number<std::uint16_t>();
        schemas_[id] = fields.text();
        return fields.good();
      }
      case 0x04:
        return channel(fields);
      case 0x05:
        return message(fields);
      case 0x06:
        return !inside && chunk(fields);
      default:
        return true;  // the summary, attachments, metadata, what later versions add
    }
  }

  bool channel(Fields& fields) {
    const auto id = fields.number<std::uint16_t>();
    const auto schema = fields.number<std::uint16_t>();
    const std::string topic(fields.text()), encoding(fields.text());
    if (!fields.good()) return false;
    if (channels_.count(id)) return true;  // repeated in the summary
    const auto known = schemas_.find(schema);
    channels_[id] = {topic, encoding, known == schemas_.end() ? std::string() : known->second, 0};
    return true;
  }

  bool message(Fields& fields) {
    const auto found = channels_.find(fields.number<std::uint16_t>());
    fields.number<std::uint32_t>();
    const auto time = fields.number<std::uint64_t>();
    fields.number<std::uint64_t>();
    if (!fields.good() || found == channels_.end()) return false;
    ++found->second.messages;
    take_({&found->second, time, fields.rest()});
    return true;
  }

  bool chunk(Fields& fields) {
    fields.number<std::uint64_t>();
    fields.number<std::uint64_t>();
    const auto size = fields.number<std::uint64_t>();
    fields.number<std::uint32_t>();
    const std::string compression(fields.text());
    const std::string_view packed = fields.bytes(fields.number<std::uint64_t>());
    if (!fields.good() || size > kLargestChunk) return false;
    if (compression.empty()) {
      records(packed, 0, true);
      return outcome.damage.empty();
    }
    if (compression != "zstd" && compression != "lz4")
      throw InputError("its chunks are compressed by '" + compression.substr(0, 40) +
                       "'; lz4, zstd and none can be read");
    const auto opened = compression == "zstd" ? opened_zstd(packed, static_cast<std::size_t>(size))
                                              : opened_lz4(packed, static_cast<std::size_t>(size));
    if (!opened) return false;
    records(*opened, 0, true);
    return outcome.damage.empty();
  }

  const std::function<void(const Message&)>& take_;
  std::map<std::uint16_t, std::string> schemas_;
  std::map<std::uint16_t, Channel> channels_;
  bool whole_ = false;
};

}  // namespace

bool is_mcap(std::string_view bytes) {
  return bytes.starts_with(kMagic);
}

Outcome read_messages(std::string_view bytes, const std::function<void(const Message&)>& take,
                      const std::function<void(const Channel&)>& channels) {
  if (!is_mcap(bytes))
    throw InputError("byte 0: an MCAP begins with the bytes 89 4d 43 41 50 30 0d 0a");
  Reading reading(take);
  reading.outcome.read = kMagic.size();
  reading.records(bytes, kMagic.size(), false);
  reading.tell(channels);
  return reading.outcome;
}

}  // namespace lapwing::mcap_log
