// SPDX-License-Identifier: Apache-2.0
#include "framework/core/temporary_names.h"

#include <signal.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <charconv>
#include <chrono>
#include <fstream>
#include <mutex>
#include <optional>
#include <set>
#include <sstream>

#include "framework/core/checksum.h"

namespace lapwing {
namespace {

constexpr std::string_view kMark = ".tmp-";
constexpr std::size_t kLongestPart = 150;  // of the name; most file systems allow 255 bytes in all

// Field 22 of /proc/PID/stat; nothing where there is no such file.
std::optional<unsigned long long> start_of(long process) {
  std::ifstream file("/proc/" + std::to_string(process) + "/stat");
  std::string text;
  if (!std::getline(file, text)) return std::nullopt;
  const std::size_t name_end = text.rfind(')');  // a program's name may hold anything
  if (name_end == std::string::npos) return std::nullopt;
  std::istringstream fields(text.substr(name_end + 1));
  std::string field;
  for (int k = 3; k <= 22; ++k) fields >> field;
  unsigned long long start = 0;
  const auto [end, error] = std::from_chars(field.data(), field.data() + field.size(), start);
  return error == std::errc{} && end == field.data() + field.size() ? std::optional(start)
                                                                    : std::nullopt;
}

// Process numbers mean something on one machine, until it starts again, in one space of them.
const std::string& this_place() {
  static const std::string place = [] {
    std::string text;
    std::getline(std::ifstream("/proc/sys/kernel/random/boot_id"), text);
    std::error_code code;
    text += std::filesystem::read_symlink("/proc/self/ns/pid", code).string();
    return sha256(text).substr(0, 8);
  }();
  return place;
}

struct Owner {
  std::string place;
  long process = 0;
  unsigned long long start = 0;
};

std::optional<Owner> owner_of(const std::string& name) {
  const std::size_t at = name.rfind(kMark);
  if (name.empty() || name[0] != '.' || at == std::string::npos) return std::nullopt;
  Owner owner;
  unsigned count = 0;
  const char* const last = name.data() + name.size();
  const auto number = [&](const char* from, auto& value, bool more) -> const char* {
    const auto [end, error] = std::from_chars(from, last, value);
    if (error != std::errc{} || end == from) return nullptr;
    return more ? (end != last && *end == '-' ? end + 1 : nullptr) : end;
  };
  const std::size_t place_end = name.find('-', at + kMark.size());
  if (place_end == std::string::npos) return std::nullopt;
  owner.place = name.substr(at + kMark.size(), place_end - at - kMark.size());
  if (owner.place.size() != this_place().size()) return std::nullopt;
  const char* next = number(name.data() + place_end + 1, owner.process, true);
  if (next) next = number(next, owner.start, true);
  if (next) next = number(next, count, false);
  return next == last && owner.process > 0 ? std::optional(owner) : std::nullopt;
}

// Where nothing is known of it, it lives.
bool lives(const Owner& owner, const std::filesystem::path& left) {
  if (owner.place != this_place()) {
    std::error_code code;
    const auto written = std::filesystem::last_write_time(left, code);
    return code || std::filesystem::file_time_type::clock::now() - written < std::chrono::hours(24);
  }
  if (::kill(static_cast<pid_t>(owner.process), 0) != 0 && errno == ESRCH) return false;
  const auto start = start_of(owner.process);
  return !start || owner.start == 0 || *start == owner.start;
}

}  // namespace

std::string temporary_name(const std::string& name) {
  static std::atomic<unsigned> counter{0};
  const long process = ::getpid();  // not kept: a fork has its own
  return "." + name.substr(0, kLongestPart) + std::string(kMark) + this_place() + "-" +
         std::to_string(process) + "-" + std::to_string(start_of(process).value_or(0)) + "-" +
         std::to_string(counter++);
}

void clear_dead_temporaries(const std::filesystem::path& folder) {
  static std::mutex mutex;
  static std::set<std::pair<pid_t, std::string>> seen;  // a fork looks for itself
  std::error_code code;
  const std::filesystem::path whole = std::filesystem::absolute(folder, code);
  {
    const std::lock_guard lock(mutex);
    if (!seen.insert({::getpid(), (code ? folder : whole).string()}).second) return;
  }
  std::filesystem::directory_iterator item(folder, code);
  for (; !code && item != std::filesystem::directory_iterator(); item.increment(code)) {
    const auto owner = owner_of(item->path().filename().string());
    std::error_code ignored;
    if (owner && !lives(*owner, item->path())) std::filesystem::remove_all(item->path(), ignored);
  }
}

}  // namespace lapwing
