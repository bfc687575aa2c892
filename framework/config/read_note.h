// SPDX-License-Identifier: Apache-2.0
// Which files a run reads, as its log says and as whoever runs it hears.
#pragma once

#include <filesystem>
#include <functional>
#include <set>
#include <string>
#include <string_view>

namespace lapwing {

// A line of the log (level debug): "reads PATH", the path whole and without links.
void note_read(const std::filesystem::path& path);

// While one lives, it hears of every file that is noted on its thread, the path whole and without
// links; the one that was there before does not.
class ReadListener {
 public:
  explicit ReadListener(std::function<void(const std::filesystem::path&)> hear);
  ~ReadListener();
  ReadListener(const ReadListener&) = delete;
  ReadListener& operator=(const ReadListener&) = delete;

 private:
  std::function<void(const std::filesystem::path&)> hear_;
  const std::function<void(const std::filesystem::path&)>* before_;
};

// The paths that lines of a run's log name. One with control characters is shown as text there, and
// names no file.
std::set<std::string> noted_reads(std::string_view log);

}  // namespace lapwing
