// SPDX-License-Identifier: Apache-2.0
// The rules of the source tree, as functions of file names and texts.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace lapwing::architecture {

struct SourceFile {
  std::string path;  // from the repository root, with '/'
  std::string text;
};

// One entry per violation: "path:line: what is wrong". Empty: all is well.
using Violations = std::vector<std::string>;

// Which room may include which, and that includes are written from the repository root.
Violations check_includes(const SourceFile& file);
// Which folder may include which third-party header.
Violations check_third_party(const SourceFile& file);
// Names of files and types, `#pragma once`, line lengths, unfinished work, length of mission kinds.
Violations check_style(const SourceFile& file);
// The line by which a source states its licence.
Violations check_licence(const SourceFile& file);
// Rules over several files: one name per plugin, one header per class of the framework, headers
// that one source alone may include.
Violations check_tree(const std::vector<SourceFile>& files);
// The kernel's map, framework/README.md: it lists every existing room, and what it says that a room
// may include is what the rules say (rooms that do not exist yet left out).
Violations check_map(const SourceFile& map, const std::vector<std::string>& existing);

// Every text file of the project's folders; build output is left out.
std::vector<SourceFile> read_tree(const std::filesystem::path& root);

}  // namespace lapwing::architecture
