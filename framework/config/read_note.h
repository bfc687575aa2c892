// SPDX-License-Identifier: Apache-2.0
// Which files a run reads, as its log says.
#pragma once

#include <filesystem>
#include <set>
#include <string>
#include <string_view>

namespace lapwing {

// A line of the log (level debug): "reads PATH", the path whole and without links.
void note_read(const std::filesystem::path& path);

// The paths that lines of a run's log name. One with control characters is shown as text there, and
// names no file.
std::set<std::string> noted_reads(std::string_view log);

}  // namespace lapwing
