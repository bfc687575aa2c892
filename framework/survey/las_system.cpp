// SPDX-License-Identifier: Apache-2.0
#include "framework/survey/las_system.h"

#include <map>

#include "framework/survey/stream_bytes.h"

namespace lapwing {
namespace {

// Ids of keys, and values that refer to no code (OGC 19-008r4).
constexpr int kGeographicSystem = 2048, kProjectedSystem = 3072, kProjectedCitation = 3073;
constexpr int kCitation = 1026, kVerticalSystem = 4096, kVerticalUnit = 4099;
constexpr int kOwn = 32767;           // user-defined
constexpr int kFirstVertical = 3855;  // EPSG; below and from 5001 to 5199 are codes of old
constexpr int kOldVertical = 5000, kLastOldVertical = 5199;
constexpr int kTextTag = 34737;

// A record's text ends at its first zero byte.
std::string before_zero(const std::string& text) {
  return text.substr(0, text.find('\0'));
}

class GeoKeys {
 public:
  GeoKeys(const std::string& bytes, const std::string& text) : text_(text) {
    const auto number = [&](std::size_t place) {
      return static_cast<int>(little_number(bytes.data() + 2 * place, 2));
    };
    if (bytes.size() < 8) return;
    const auto count = static_cast<std::size_t>(number(3));
    whole_ = bytes.size() >= 8 * (count + 1);
    for (std::size_t k = 1; whole_ && k <= count; ++k)
      entries_[number(4 * k)] = {number(4 * k + 1), number(4 * k + 2), number(4 * k + 3)};
  }

  bool whole() const { return whole_; }
  // A code that the key holds; 0 without the key.
  int code(int key) const {
    const auto found = entries_.find(key);
    return found == entries_.end() || found->second.tag != 0 ? 0 : found->second.value;
  }
  // A text that the key refers to; "" without it.
  std::string text(int key) const {
    const auto found = entries_.find(key);
    if (found == entries_.end() || found->second.tag != kTextTag) return "";
    const auto from = static_cast<std::size_t>(found->second.value);
    if (from >= text_.size()) return "";
    std::string part = text_.substr(from, static_cast<std::size_t>(found->second.count));
    return part.substr(0, part.find_first_of(std::string("|\0", 2)));
  }

 private:
  struct Entry {
    int tag = 0, count = 0, value = 0;
  };
  const std::string& text_;
  std::map<int, Entry> entries_;
  bool whole_ = false;
};

bool vertical_code(int code) {
  return code >= kFirstVertical && code < kOwn && (code < kOldVertical || code > kLastOldVertical);
}

LasSystem system_of_keys(const LasSystemRecords& records) {
  LasSystem system;
  const GeoKeys keys(records.keys, records.text);
  if (!keys.whole()) {
    system.note = "its GeoTIFF keys are damaged";
    return system;
  }
  system.height_unit = metres_of_unit(keys.code(kVerticalUnit));
  const int projected = keys.code(kProjectedSystem), geographic = keys.code(kGeographicSystem);
  const int code = projected > 0 ? projected : geographic;
  if (code == 0 || code == kOwn) {
    std::string words = keys.text(kProjectedCitation);
    if (words.empty()) words = keys.text(kCitation);
    system.note = code == 0 ? "its GeoTIFF keys name no system"
                            : "its GeoTIFF keys define a system of their own" +
                                  (words.empty() ? "" : ", '" + words.substr(0, 80) + "'");
    return system;
  }
  system.text = "EPSG:" + std::to_string(code);
  const int vertical = keys.code(kVerticalSystem);
  if (vertical_code(vertical))
    system.text += "+" + std::to_string(vertical);
  else if (vertical > 0)
    system.note = "its vertical system " + std::to_string(vertical) + " is no EPSG code";
  return system;
}

}  // namespace

double metres_of_unit(int code) {
  switch (code) {
    case 9001:
      return 1;
    case 9002:
      return 0.3048;
    case 9003:
      return 1200.0 / 3937.0;  // US survey foot
    default:
      return 0;
  }
}

LasSystem system_of_las(const LasSystemRecords& records, bool prefer_wkt) {
  const std::string wkt = before_zero(records.wkt);
  if (!wkt.empty() && (prefer_wkt || records.keys.empty())) return {wkt, 0, ""};
  if (records.keys.empty()) return {};
  return system_of_keys(records);
}

}  // namespace lapwing
