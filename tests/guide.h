// Snippets of the guides: what a README tells its reader to type.
#pragma once

#include <filesystem>
#include <sstream>
#include <string>
#include <vector>

#include "framework/core/files.h"

namespace lapwing {

struct Snippet {
  std::string language;  // "sh", "lua"
  std::string text;
};

// The fenced blocks of a section: from its heading, which begins with `heading`, to the next one of
// the same depth.
inline std::vector<Snippet> snippets_of(const std::filesystem::path& readme,
                                        const std::string& heading) {
  std::vector<Snippet> snippets;
  std::istringstream lines(read_file(readme));
  bool inside = false, fenced = false;
  const std::string depth = heading.substr(0, heading.find(' ') + 1);
  for (std::string line; std::getline(lines, line);) {
    if (!fenced && line.rfind(depth, 0) == 0) inside = line.rfind(heading, 0) == 0;
    if (line.rfind("```", 0) == 0) {
      fenced = !fenced;
      if (fenced && inside) snippets.push_back({line.substr(3), ""});
    } else if (fenced && inside) {
      snippets.back().text += line + "\n";
    }
  }
  return snippets;
}

}  // namespace lapwing
