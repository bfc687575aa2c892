// SPDX-License-Identifier: Apache-2.0
// Snippets of the guides: what a README tells its reader to type.
#pragma once

#include <algorithm>
#include <filesystem>
#include <sstream>
#include <string>
#include <vector>

#include "framework/core/files.h"

namespace lapwing {

struct Snippet {
  std::string language;  // "sh", "lua"
  std::string text;
  bool excerpt = false;  // fenced as "lua excerpt": a piece that nobody could type as it stands
  int line = 0;          // of its first line in the file
};

// The fenced blocks of a section: from its heading, which begins with `heading`, to the next one of
// the same depth.
inline std::vector<Snippet> snippets_of(const std::filesystem::path& readme,
                                        const std::string& heading) {
  std::vector<Snippet> snippets;
  std::istringstream lines(read_file(readme));
  bool inside = false, fenced = false;
  const std::string depth = heading.substr(0, heading.find(' ') + 1);
  int number = 0;
  for (std::string line; std::getline(lines, line);) {
    ++number;
    if (!fenced && line.rfind(depth, 0) == 0) inside = line.rfind(heading, 0) == 0;
    if (line.rfind("```", 0) == 0) {
      fenced = !fenced;
      const std::string marks = line.substr(3);
      if (fenced && inside)
        snippets.push_back({marks.substr(0, marks.find(' ')), "",
                            marks.find(" excerpt") != marks.npos, number + 1});
    } else if (fenced && inside) {
      snippets.back().text += line + "\n";
    }
  }
  return snippets;
}

// Every README and guide of the project, sorted.
inline std::vector<std::filesystem::path> guides_in(const std::filesystem::path& source) {
  namespace fs = std::filesystem;
  std::vector<fs::path> files;
  for (auto at = fs::recursive_directory_iterator(source); at != fs::end(at); ++at) {
    const std::string name = at->path().filename().string();
    if (at->is_directory() && (name[0] == '.' || name == "build" || name == "out"))
      at.disable_recursion_pending();
    else if (at->path().extension() == ".md")
      files.push_back(at->path());
  }
  std::sort(files.begin(), files.end());
  return files;
}

// The folder of `configs/` whose `small` makes a mission quick that takes minutes as it stands; ""
// for Lua that does not.
inline std::string slow_kind(const std::string& lua) {
  constexpr const char* kKinds[][2] = {
      {"mission.map", "mapping"}, {"mission.scan", "scan"}, {"mission.explore", "explore"}};
  for (const auto& [module, kind] : kKinds)
    if (lua.find("\"" + std::string(module) + "\"") != lua.npos ||
        lua.find("'" + std::string(module) + "'") != lua.npos)
      return kind;
  return "";
}

}  // namespace lapwing
