// SPDX-License-Identifier: Apache-2.0
// Measured times of items, and the times that other items are expected to take.
//
// Times are notes for the order of work. No result depends on them, so they are in files of their
// own: `times/items.txt`, or `times/items.3_of_10.txt` of a shard, a line for each item that was
// made. A damaged line is left out.
#pragma once

#include <filesystem>
#include <map>

#include "framework/items/item.h"

namespace lapwing {

class ItemTimes {
 public:
  // Of a folder of results; none where there are no such files.
  static ItemTimes read(const std::filesystem::path& folder);

  void add(const std::string& file, const ItemSeconds& seconds) { measured_[file] = seconds; }
  const ItemSeconds* find(const std::string& file) const;

  // By item: its own time, else the mean of a kind of its own (Item::kinds, in their order), else
  // the mean of all; 1 s if nothing was measured.
  std::vector<double> expected(const std::vector<Item>& items) const;
  // By group: the mean of the group's measured preparations, else of all, else 0.
  std::vector<double> preparations(const std::vector<Item>& items, std::size_t groups) const;
  // Items of this list that were measured.
  std::size_t count(const std::vector<Item>& items) const;

 private:
  std::map<std::string, ItemSeconds> measured_;  // by file
};

// Appends lines to a file of times, from one thread at a time. While it lives, no other process
// can have the file.
class ItemTimesLog {
 public:
  // `part`: "" or "3_of_10". InputError if another process makes this part, or the file cannot be
  // written.
  ItemTimesLog(const std::filesystem::path& folder, const std::string& part);
  ~ItemTimesLog();
  ItemTimesLog(const ItemTimesLog&) = delete;
  ItemTimesLog& operator=(const ItemTimesLog&) = delete;

  // A line that cannot be written is left out.
  void add(const std::string& file, const ItemSeconds& seconds);

 private:
  int descriptor_ = -1;
};

}  // namespace lapwing
