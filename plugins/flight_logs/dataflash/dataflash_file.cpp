// SPDX-License-Identifier: Apache-2.0
#include "plugins/flight_logs/dataflash/dataflash_file.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "framework/core/error.h"
#include "framework/flight_log/byte_reader.h"

namespace lapwing::dataflash {
namespace {

constexpr char kHead1 = '\xa3', kHead2 = '\x95';
constexpr int kFmt = 128;
constexpr std::size_t kFmtSize = 89, kHeadSize = 3;
constexpr std::size_t kMostFactors = 1000;  // that a file defines; real ones define 20

// Bytes of a type; 0 for one that no version has.
std::size_t size_of(char type) {
  switch (type) {
    case 'b':
    case 'B':
    case 'M':
      return 1;
    case 'h':
    case 'H':
    case 'c':
    case 'C':
    case 'g':
      return 2;
    case 'i':
    case 'I':
    case 'e':
    case 'E':
    case 'L':
    case 'f':
    case 'n':
      return 4;
    case 'd':
    case 'q':
    case 'Q':
      return 8;
    case 'N':
      return 16;
    case 'a':
    case 'Z':
      return 64;
    default:
      return 0;
  }
}

// What a type itself scales by; nothing where FMTU's multiplier counts.
std::optional<double> own_factor(char type) {
  if (type == 'c' || type == 'C' || type == 'e' || type == 'E') return 0.01;
  if (type == 'L') return 1e-7;
  return std::nullopt;
}

// IEEE 754's half precision.
double half(std::uint16_t bits) {
  const int exponent = bits >> 10 & 31, mantissa = bits & 1023;
  const double sign = bits & 0x8000 ? -1 : 1;
  if (exponent == 31) return mantissa ? NAN : sign * INFINITY;
  if (exponent == 0) return sign * std::ldexp(mantissa, -24);
  return sign * std::ldexp(1024 + mantissa, exponent - 25);
}

std::string text_in(std::string_view body, std::size_t at, std::size_t size) {
  const std::string_view text = body.substr(std::min(at, body.size()), size);
  return std::string(text.substr(0, text.find('\0')));
}

template <class T>
double read(std::string_view body, std::size_t at) {
  const auto number = number_in<T>(body, at);
  return number ? static_cast<double>(*number) : NAN;
}

class Reading {
 public:
  Reading(std::string_view bytes,
          const std::function<void(int, const Kind&, std::string_view)>& take)
      : bytes_(bytes), take_(take) {}

  Outcome run() {
    std::size_t at = 0;
    while (at < bytes_.size()) {
      const int number = number_at(at);
      const std::size_t size = number < 0 ? 0 : size_of_kind(number);
      if (size == 0) {
        skip(at, bytes_.size());
      } else if (bytes_.size() - at < size) {
        outcome_.damage =
            "it ends within a message " + name_of(number) + " at byte " + std::to_string(at);
        break;
      } else if (!head_follows(at + size) && skip_to_message(at, at + size)) {
        continue;  // bytes that were lost from it let it reach into the ones behind it
      } else {
        if (message(number, bytes_.substr(at + kHeadSize, size - kHeadSize)))
          outcome_.read += size;
        else if (unusable_++ == 0)
          first_unusable_ = name_of(number) + " at byte " + std::to_string(at);
        at += size;
      }
    }
    say_damage();
    return outcome_;
  }

 private:
  // Of the head of a message; -1 where there is none.
  int number_at(std::size_t at) const {
    const bool head = at < bytes_.size() && bytes_.size() - at >= kHeadSize &&
                      bytes_[at] == kHead1 && bytes_[at + 1] == kHead2;
    return head ? static_cast<unsigned char>(bytes_[at + 2]) : -1;
  }

  // Whether a message may begin there, or the file ends, perhaps within a head.
  bool head_follows(std::size_t at) const {
    return bytes_.size() - at < kHeadSize || number_at(at) >= 0;
  }

  // Whether a message of a known kind begins there, with another one behind it.
  bool begins(std::size_t at) const {
    const int number = number_at(at);
    const std::size_t size = number < 0 ? 0 : size_of_kind(number);
    return size > 0 && at + size <= bytes_.size() && head_follows(at + size);
  }

  std::size_t size_of_kind(int number) const {
    if (number == kFmt) return kFmtSize;
    const auto kind = kinds_.find(number);
    return kind == kinds_.end() ? 0 : kind->second.size;
  }
  std::string name_of(int number) const { return number == kFmt ? "FMT" : kinds_.at(number).name; }

  void note_skipped(std::size_t from, std::size_t to) {
    if (outcome_.skipped == 0) first_skipped_ = from;
    outcome_.skipped += to - from;
  }

  // To the next message before `end`, if there is one.
  bool skip_to_message(std::size_t& at, std::size_t end) {
    for (std::size_t next = bytes_.find(kHead1, at + 1); next < end;
         next = bytes_.find(kHead1, next + 1)) {
      if (!begins(next)) continue;
      note_skipped(at, next);
      at = next;
      return true;
    }
    return false;
  }

  void skip(std::size_t& at, std::size_t end) {
    if (skip_to_message(at, end)) return;
    note_skipped(at, end);
    at = end;
  }

  void say_damage() {
    std::string& damage = outcome_.damage;
    if (damage.empty() && outcome_.skipped > 0)
      damage = std::to_string(outcome_.skipped) + " bytes are no message, the first at byte " +
               std::to_string(first_skipped_);
    if (unusable_ == 0) return;
    damage +=
        (damage.empty() ? "" : "; ") + std::to_string(unusable_) +
        (unusable_ == 1 ? " message cannot be used, " : " messages cannot be used, the first ") +
        first_unusable_;
  }

  // Whether it can be used.
  bool message(int number, std::string_view body) {
    if (number == kFmt) return describe(body);
    const Kind& kind = kinds_.at(number);
    if (kind.columns.empty()) return false;
    if (kind.name == "FMTU")
      scale(kind, body);
    else if (kind.name == "MULT")
      define_factor(kind, body);
    else if (kind.name != "UNIT")
      take_(number, kind, body);
    return true;
  }

  // A kind whose description contradicts itself, or has types of a later version, keeps its size:
  // its messages are passed.
  bool describe(std::string_view body) {
    const int number = static_cast<unsigned char>(body[0]);
    Kind kind;
    kind.size = static_cast<unsigned char>(body[1]);
    kind.name = text_in(body, 2, 4);
    const std::string types = text_in(body, 6, 16);
    std::string labels = text_in(body, 22, 64);
    if (number == kFmt) return kind.size == kFmtSize;
    if (kind.size < kHeadSize) return false;
    std::size_t offset = 0;
    bool known = true;
    for (const char type : types) {
      const std::size_t end = std::min(labels.find(','), labels.size());
      Column column{labels.substr(0, end), type, offset, own_factor(type).value_or(1), 0};
      labels.erase(0, end + 1 > labels.size() ? labels.size() : end + 1);
      const std::size_t size = size_of(type);
      known = known && size > 0;
      offset += size;
      kind.columns.push_back(std::move(column));
    }
    if (!known || offset + kHeadSize != kind.size) {
      if (kinds_.count(number)) return false;
      kind.columns.clear();
    }
    const auto units = fmtu_.find(number);
    if (units != fmtu_.end()) apply(units->second, kind);
    const bool usable = !kind.columns.empty();
    kinds_[number] = std::move(kind);
    return usable;
  }

  struct Units {
    std::string units, factors;
  };

  void scale(const Kind& kind, std::string_view body) {
    const int type = kind.column("FmtType"), units = kind.column("UnitIds"),
              factors = kind.column("MultIds");
    if (type < 0 || units < 0 || factors < 0) return;
    const auto& columns = kind.columns;
    const int number = static_cast<int>(value_of(columns[static_cast<std::size_t>(type)], body));
    fmtu_[number] = {text_of(columns[static_cast<std::size_t>(units)], body),
                     text_of(columns[static_cast<std::size_t>(factors)], body)};
    const auto scaled = kinds_.find(number);
    if (scaled != kinds_.end()) apply(fmtu_[number], scaled->second);
  }

  void apply(const Units& units, Kind& kind) const {
    for (std::size_t i = 0; i < kind.columns.size(); ++i) {
      Column& column = kind.columns[i];
      if (i < units.units.size()) column.unit = units.units[i];
      if (own_factor(column.type) || i >= units.factors.size()) continue;
      const auto factor = factors_.find(units.factors[i]);
      column.factor = factor == factors_.end() || !(factor->second > 0) ? 1 : factor->second;
    }
  }

  void define_factor(const Kind& kind, std::string_view body) {
    const int id = kind.column("Id"), factor = kind.column("Mult");
    if (id < 0 || factor < 0) return;
    const double which = value_of(kind.columns[static_cast<std::size_t>(id)], body);
    const double value = value_of(kind.columns[static_cast<std::size_t>(factor)], body);
    if (!std::isfinite(which + value) || which < 0 || which > 255) return;
    if (++defined_factors_ > kMostFactors) return;
    factors_[static_cast<char>(which)] = value;
    for (auto& [number, scaled] : kinds_) {
      const auto units = fmtu_.find(number);
      if (units != fmtu_.end()) apply(units->second, scaled);
    }
  }

  std::string_view bytes_;
  const std::function<void(int, const Kind&, std::string_view)>& take_;
  Outcome outcome_;
  std::size_t first_skipped_ = 0, unusable_ = 0;
  std::string first_unusable_;
  std::map<int, Kind> kinds_;
  std::map<int, Units> fmtu_;
  std::map<char, double> factors_;
  std::size_t defined_factors_ = 0;
};

}  // namespace

int Kind::column(std::string_view label) const {
  const auto found = std::find_if(columns.begin(), columns.end(),
                                  [&](const Column& column) { return column.label == label; });
  return found == columns.end() ? -1 : static_cast<int>(found - columns.begin());
}

double value_of(const Column& column, std::string_view body) {
  const std::size_t at = column.offset;
  const auto scaled = [&](double value) { return column.factor * value; };
  switch (column.type) {
    case 'b':
      return scaled(read<std::int8_t>(body, at));
    case 'B':
    case 'M':
      return scaled(read<std::uint8_t>(body, at));
    case 'h':
    case 'c':
      return scaled(read<std::int16_t>(body, at));
    case 'H':
    case 'C':
      return scaled(read<std::uint16_t>(body, at));
    case 'g': {
      const auto bits = number_in<std::uint16_t>(body, at);
      return bits ? scaled(half(*bits)) : NAN;
    }
    case 'i':
    case 'e':
    case 'L':
      return scaled(read<std::int32_t>(body, at));
    case 'I':
    case 'E':
      return scaled(read<std::uint32_t>(body, at));
    case 'f':
      return scaled(read<float>(body, at));
    case 'd':
      return scaled(read<double>(body, at));
    case 'q':
      return scaled(read<std::int64_t>(body, at));
    case 'Q':
      return scaled(read<std::uint64_t>(body, at));
    default:
      return NAN;
  }
}

std::string text_of(const Column& column, std::string_view body) {
  return text_in(body, column.offset, size_of(column.type));
}

bool is_dataflash(std::string_view bytes) {
  // FMT describes itself first: its head, its number 128 and its size 89.
  return bytes.size() >= 5 && bytes[0] == kHead1 && bytes[1] == kHead2 &&
         static_cast<unsigned char>(bytes[2]) == kFmt &&
         static_cast<unsigned char>(bytes[3]) == kFmt &&
         static_cast<unsigned char>(bytes[4]) == kFmtSize;
}

Outcome read_messages(std::string_view bytes,
                      const std::function<void(int, const Kind&, std::string_view)>& take) {
  if (!is_dataflash(bytes))
    throw InputError("byte 0: a DataFlash log begins with a3 95 80 80 59, the description of FMT");
  return Reading(bytes, take).run();
}

}  // namespace lapwing::dataflash
