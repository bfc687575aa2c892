// SPDX-License-Identifier: Apache-2.0
#include "framework/items/item_times.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <sstream>

#include "framework/core/error.h"
#include "framework/core/files.h"

namespace lapwing {

namespace fs = std::filesystem;

namespace {

constexpr const char* kTimes = "times";
constexpr double kUnknown = 1;  // s; equal for all, so that only the order of items counts

struct Mean {
  double sum = 0;
  std::size_t count = 0;

  void add(double value) {
    sum += value;
    ++count;
  }
  double value() const { return sum / static_cast<double>(count); }
};

bool is_times_file(const fs::path& file) {
  const std::string name = file.filename().string();
  return name.starts_with("items.") && name.ends_with(".txt");
}

}  // namespace

ItemTimes ItemTimes::read(const fs::path& folder) {
  ItemTimes times;
  std::error_code code;
  for (fs::directory_iterator entry(folder / kTimes, code), end; !code && entry != end;
       entry.increment(code)) {
    if (!is_times_file(entry->path())) continue;
    std::istringstream lines(read_file(entry->path()));
    for (std::string line; std::getline(lines, line);) {
      ItemSeconds seconds;
      int read = 0;
      if (std::sscanf(line.c_str(), "%lf %lf %n", &seconds.item, &seconds.preparation, &read) < 2 ||
          read == 0 || !(seconds.item >= 0 && seconds.preparation >= 0) ||
          !std::isfinite(seconds.item + seconds.preparation))
        continue;
      times.add(line.substr(static_cast<std::size_t>(read)), seconds);
    }
  }
  return times;
}

const ItemSeconds* ItemTimes::find(const std::string& file) const {
  const auto found = measured_.find(file);
  return found == measured_.end() ? nullptr : &found->second;
}

std::vector<double> ItemTimes::expected(const std::vector<Item>& items) const {
  std::map<std::string, Mean> kinds;
  Mean all;
  for (const Item& item : items) {
    const ItemSeconds* own = find(item.file);
    if (!own) continue;
    all.add(own->item);
    for (const std::string& kind : item.kinds) kinds[kind].add(own->item);
  }
  std::vector<double> expected;
  for (const Item& item : items) {
    double seconds = all.count > 0 ? all.value() : kUnknown;
    for (auto kind = item.kinds.rbegin(); kind != item.kinds.rend(); ++kind)
      if (const auto mean = kinds.find(*kind); mean != kinds.end()) seconds = mean->second.value();
    if (const ItemSeconds* own = find(item.file)) seconds = own->item;
    expected.push_back(seconds);
  }
  return expected;
}

std::vector<double> ItemTimes::preparations(const std::vector<Item>& items,
                                            std::size_t groups) const {
  std::vector<Mean> means(groups);
  Mean all;
  for (const Item& item : items) {
    const ItemSeconds* own = find(item.file);
    if (!own || !(own->preparation > 0)) continue;
    means[item.group].add(own->preparation);
    all.add(own->preparation);
  }
  std::vector<double> seconds;
  for (const Mean& mean : means)
    seconds.push_back(mean.count > 0 ? mean.value() : all.count > 0 ? all.value() : 0);
  return seconds;
}

std::size_t ItemTimes::count(const std::vector<Item>& items) const {
  std::size_t measured = 0;
  for (const Item& item : items) measured += find(item.file) != nullptr;
  return measured;
}

ItemTimesLog::ItemTimesLog(const fs::path& folder, const std::string& part) {
  const fs::path file = folder / kTimes / (part.empty() ? "items.txt" : "items." + part + ".txt");
  const auto refuse = [&](const std::string& why) {
    throw InputError("cannot write '" + file.string() + "': " + why);
  };
  std::error_code made;
  fs::create_directories(file.parent_path(), made);
  if (made) refuse(made.message());
  descriptor_ = ::open(file.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0666);
  if (descriptor_ < 0) refuse(std::strerror(errno));
  // A file system without locks refuses nobody.
  if (::flock(descriptor_, LOCK_EX | LOCK_NB) == 0 || errno != EWOULDBLOCK) return;
  ::close(descriptor_);
  descriptor_ = -1;
  throw InputError("another process makes this part of '" + folder.string() +
                   "'; wait until it ends, or choose another shard");
}

ItemTimesLog::~ItemTimesLog() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

void ItemTimesLog::add(const std::string& file, const ItemSeconds& seconds) {
  char numbers[64];
  std::snprintf(numbers, sizeof numbers, "%.6g %.6g ", seconds.item, seconds.preparation);
  const std::string line = numbers + file + "\n";
  // One call, so that a line is whole; what of it a full disk takes is left out when it is read.
  [[maybe_unused]] const ssize_t written = ::write(descriptor_, line.data(), line.size());
}

}  // namespace lapwing
